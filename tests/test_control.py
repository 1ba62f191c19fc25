"""Commands and states: typed, checked, locked."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import labkit as lk
from labkit.control import COMMANDS


@pytest.mark.parametrize("kind", COMMANDS)
def test_a_command_is_a_locked_copy_of_what_was_given(kind):
    """It keeps its numbers when the caller's array changes, and nobody can write to it."""
    x = np.arange(7.0)
    command = kind(x)
    x[0] = 9.0
    assert_array_equal(command.value, np.arange(7.0))
    with pytest.raises(ValueError, match="read-only"):
        command.value[0] = 1.0
    with pytest.raises(AttributeError):
        command.value = x
    assert_array_equal(kind([1, 2, 3, 4, 5, 6, 7]).value, np.arange(1.0, 8.0))


def test_a_state_unpacks():
    """A state is a tuple of time, angles, speeds and external torque, which is zero by default."""
    t, q, dq, tau_ext = lk.State(0.5, np.zeros(7), np.ones(7))
    assert (t, q[0], dq[0], tau_ext[0]) == (0.5, 0.0, 1.0, 0.0)
