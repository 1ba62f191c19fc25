"""Arrays: what came in becomes what the mathematics means, or a sentence."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from labkit.errors import LabkitError, NotFinite, OutOfRange, ShapeError, TypeMismatch
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


@pytest.mark.parametrize(
    ("x", "error", "words"),
    [
        (np.zeros((7, 1)), ShapeError, r"q has shape \(7, 1\), expected \(7,\).*ravel"),
        (np.zeros((1, 7)), ShapeError, r"q has shape \(1, 7\), expected \(7,\).*ravel"),
        (np.zeros(6), ShapeError, "give 7 numbers, not 6"),
        ([0.0] * 8, ShapeError, "give 7 numbers, not 8"),
        (3.0, ShapeError, "give all 7"),
        (np.zeros((7, 7)), ShapeError, "a matrix came where a vector belongs"),
        (np.zeros((7, 1)).view(np.matrix), ShapeError, r"\(7, 1\)"),
        ("home", TypeMismatch, r"'home' \(str\), expected 7 real numbers"),
        (None, TypeMismatch, r"None \(NoneType\)"),
        ([0, 0, 0, 0, 0, 0, "a"], TypeMismatch, "real numbers"),
        ([[1, 2], [3]], TypeMismatch, "rows of different lengths"),
        (np.zeros(7, dtype=complex), TypeMismatch, "real numbers"),
        (np.zeros(7, dtype=object), TypeMismatch, "real numbers"),
        ({"s0": 0.0}, TypeMismatch, "dict"),
        ([0, 0, 0, np.nan, 0, 0, 0], NotFinite, "q holds nan at index 3.*division by zero"),
        ([0, 0, np.inf, 0, 0, 0, 0], NotFinite, "q holds inf at index 2"),
        ([0, 0, 0, 0, 0, 0, -np.inf], NotFinite, "q holds -inf at index 6"),
    ],
)
def test_what_does_not_fit_is_named_with_its_value_and_the_way_out(x, error, words):
    """A wrong shape, type or number for seven joints is a LabkitError with name and value."""
    with pytest.raises(error, match=words) as caught:
        as_array(x, (7,), "q")
    assert isinstance(caught.value, LabkitError)


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


def test_the_place_of_a_nan_in_a_matrix_is_row_and_column():
    """A NaN in the second row, third column is reported at index (1, 2)."""
    x = np.eye(3)
    x[1, 2] = np.nan
    with pytest.raises(NotFinite, match=r"index \(1, 2\)"):
        as_array(x, (3, 3), "x")


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


@pytest.mark.parametrize(
    ("x", "error", "words"),
    [
        ([1, 2], ShapeError, "Kp has shape"),
        (-1.0, OutOfRange, "Kp is -1 at index 0; a gain is at least 0"),
        ([1, 1, -2], OutOfRange, "Kp is -2 at index 2"),
        (np.nan, NotFinite, "Kp is nan"),
        ("high", TypeMismatch, "Kp"),
        ([[1], [1, 2]], TypeMismatch, "Kp has rows of different lengths"),
        (None, TypeMismatch, "Kp"),
    ],
)
def test_a_bad_gain_is_named(x, error, words):
    """A wrong number of gains, a negative one with its index, NaN and words are refused."""
    with pytest.raises(error, match=words):
        as_gains(x, 3, "Kp")


@pytest.mark.parametrize(
    ("x", "error", "words"),
    [
        ("two", TypeMismatch, "v_max is 'two'"),
        (None, TypeMismatch, "v_max is None"),
        ("2", TypeMismatch, r"v_max is '2' \(str\), expected one real number"),
        ([1.0, 2.0], ShapeError, r"v_max has shape \(2,\), expected one number"),
        (
            [1.0],
            ShapeError,
            r"take the one number out of it, as in x\[0\], or leave out the brackets",
        ),
        (np.nan, NotFinite, "v_max is nan"),
        (np.inf, NotFinite, "v_max is inf"),
        (0.0, OutOfRange, "v_max is 0; it must be greater than 0"),
        (-1, OutOfRange, "v_max is -1"),
    ],
)
def test_a_bad_number_is_named(x, error, words):
    """A word, an array, NaN, infinity and what is not above the limit are refused by name."""
    with pytest.raises(error, match=words):
        as_number(x, "v_max", above=0.0)


def test_a_number_may_stand_at_its_least():
    """With a least of 0, zero is accepted and -1e-9 refused."""
    assert as_number(np.float32(0), "duration", least=0.0) == 0.0
    with pytest.raises(OutOfRange, match="at least 0"):
        as_number(-1e-9, "duration", least=0.0)
