"""Arrays: what came in becomes what the mathematics means, or a sentence."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from labkit.errors import OutOfRange, ShapeError
from labkit.shapes import as_array, as_gains, as_number, as_vector


@given(arrays(np.float64, array_shapes(max_dims=3), elements=st.floats(-1e9, 1e9)))
def test_a_fitting_array_comes_back_as_it_is_without_a_copy(x):
    """An array of floats that has the shape is returned itself."""
    assert as_array(x, x.shape, "x") is x


@given(array_shapes(max_dims=3, max_side=8), array_shapes(max_dims=3, max_side=8))
def test_nothing_is_broadcast_reshaped_or_squeezed(have, want):
    """Any other shape than the one that is asked for is a ShapeError."""
    x = np.zeros(have)
    if have == want:
        assert as_array(x, want, "x").shape == want
    else:
        with pytest.raises(ShapeError):
            as_array(x, want, "x")


def test_lists_and_whole_numbers_are_read_as_floats_and_left_alone():
    """They and single precision become doubles, and the list is as it was."""
    x = [1, 2, 3]
    a = as_array(x, (3,), "x")
    assert a.dtype == np.float64
    assert x == [1, 2, 3]
    assert as_array(np.array([1, 2, 3], dtype=np.float32), (3,), "x").dtype == np.float64


def test_a_huge_but_finite_array_is_no_infinity():
    """Numbers of 1e200 and -1e300, whose squares overflow, are accepted."""
    x = np.array([1e200, -1e300])
    assert as_array(x, (2,), "x") is x


def test_a_vector_is_a_locked_copy():
    """It does not follow the caller's array, and nobody can write to it."""
    x = np.zeros(7)
    v = as_vector(x, 7, "x")
    x[0] = 1.0
    assert v[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        v[0] = 1.0


def test_one_gain_serves_all_joints():
    """One number becomes seven equal ones; three numbers for three joints are kept."""
    assert as_gains(2, 7, "Kp").tolist() == [2.0] * 7
    assert as_gains([1, 2, 3], 3, "Kp").tolist() == [1.0, 2.0, 3.0]


def test_a_number_may_stand_at_its_least():
    """With a least of 0, zero is accepted and -1e-9 refused."""
    assert as_number(np.float32(0), "duration", least=0.0) == 0.0
    with pytest.raises(OutOfRange, match="at least 0"):
        as_number(-1e-9, "duration", least=0.0)
