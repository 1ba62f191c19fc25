"""Commands and states: typed, checked, locked."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import labkit as lk
from labkit.control import COMMANDS
from labkit.errors import LabkitError, NotFinite, ShapeError, TypeMismatch


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


@pytest.mark.parametrize("kind", COMMANDS)
@pytest.mark.parametrize(
    ("x", "error", "words"),
    [
        (np.zeros((7, 1)), ShapeError, "ravel"),
        (np.zeros((1, 7)), ShapeError, "ravel"),
        (np.zeros((7, 7)), ShapeError, "a matrix came where a vector belongs"),
        (0.0, TypeMismatch, "a number for each joint"),
        (None, TypeMismatch, "None"),
        ("stop", TypeMismatch, "stop"),
        (1j * np.ones(7), TypeMismatch, "real numbers"),
        ([np.nan] + [0.0] * 6, NotFinite, "nan at index 0"),
        ([0.0] * 6 + [np.inf], NotFinite, "inf at index 6"),
    ],
)
def test_a_bad_command_is_refused_when_it_is_made(kind, x, error, words):
    """A wrong shape, type or number is named with the kind of command."""
    with pytest.raises(error, match=f"{kind.__name__}.*{words}") as caught:
        kind(x)
    assert isinstance(caught.value, LabkitError)


@pytest.mark.parametrize("kind", COMMANDS)
def test_a_command_of_too_few_numbers_is_refused_when_it_is_given(ideal, kind):
    """Six numbers make a command, which an arm of seven joints refuses."""
    with pytest.raises(ShapeError, match=f"{kind.__name__} .*give 7 numbers, not 6"):
        ideal.apply(kind(np.zeros(6)))


def test_a_state_unpacks():
    """A state is a tuple of time, angles, speeds and external torque, which is zero by default."""
    t, q, dq, tau_ext = lk.State(0.5, np.zeros(7), np.ones(7))
    assert (t, q[0], dq[0], tau_ext[0]) == (0.5, 0.0, 1.0, 0.0)
