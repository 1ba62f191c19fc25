"""Errors: one family, each also the built-in that a Python programmer would catch."""

import inspect
import pickle

import pytest

from labkit import errors
from labkit.errors import JointLimitExceeded, LabkitError, ShapeError, UnknownName

FAMILY = [
    e for _, e in inspect.getmembers(errors, inspect.isclass) if issubclass(e, LabkitError)
]  # fmt: skip


@pytest.mark.parametrize("error", FAMILY, ids=lambda e: e.__name__)
def test_every_error_is_a_labkit_error_with_a_sentence_of_its_own(error):
    """Each class derives from LabkitError, and its docstring ends with a full stop."""
    assert issubclass(error, LabkitError)
    assert error.__doc__.strip().endswith(".")


@pytest.mark.parametrize(
    ("error", "builtin"),
    [
        (errors.ShapeError, ValueError),
        (errors.TypeMismatch, TypeError),
        (errors.NotFinite, ValueError),
        (errors.OutOfRange, ValueError),
        (errors.JointLimitExceeded, ValueError),
        (errors.UnknownName, KeyError),
        (errors.Unreachable, ValueError),
        (errors.Closed, RuntimeError),
    ],
)
def test_an_error_is_also_the_builtin_one_that_is_usual(error, builtin):
    """Each is also the ValueError, TypeError, KeyError or RuntimeError that one expects."""
    assert issubclass(error, builtin)


@pytest.mark.parametrize(
    ("expected", "actual", "way_out"),
    [
        ((7,), (7, 1), ".ravel()"),
        ((7,), (1, 7), ".ravel()"),
        ((7,), (6,), "give 7 numbers, not 6"),
        ((7,), (), "give all 7"),
        ((7,), (7, 7), "a matrix came where a vector belongs"),
        ((3, 4), (4, 3), "the transpose would fit"),
        ((), (1,), "expected one number; take the one number out of it, as in x[0], or"),
        ((), (7,), "has shape (7,), expected one number"),
    ],
)
def test_a_wrong_shape_names_both_shapes_and_the_way_out(expected, actual, way_out):
    """The sentence has both shapes and the remedy; the attributes keep the shapes."""
    error = ShapeError("q", expected, actual)
    assert str(actual) in str(error)
    assert str(expected or "one number") in str(error)
    assert way_out in str(error)
    assert (error.name, error.expected, error.actual) == ("q", expected, actual)


def test_a_joint_out_of_range_keeps_its_evidence_and_suspects_degrees():
    """45 rad is suspected to be degrees, 1.2 rad is not; joint and value stay attributes."""
    error = JointLimitExceeded("q", "left_s1", 45.0, -2.147, 1.047)
    assert str(error) == (
        "q: joint left_s1 at 45 rad is outside [-2.147, 1.047] rad; "
        "angles are in radians: is this one in degrees?"
    )
    assert (error.joint, error.value) == ("left_s1", 45.0)
    assert "degrees" not in str(JointLimitExceeded("q", "left_s1", 1.2, -2.147, 1.047))


def test_an_unknown_name_lists_those_that_exist_without_extra_quotes():
    """The text is the plain sentence, not the quoted one of a KeyError."""
    error = UnknownName("arm", "middle", ("left", "right"))
    assert str(error) == "no arm 'middle'; there is 'left', 'right'"


@pytest.mark.parametrize(
    "error",
    [
        ShapeError("q", (7,), (6,)),
        JointLimitExceeded("q", "left_s1", 45.0, -2.147, 1.047),
        UnknownName("arm", "middle", ("left", "right")),
        errors.OutOfRange("rate is 0"),
    ],
    ids=lambda e: type(e).__name__,
)
def test_an_error_comes_back_whole_from_another_process(error):
    """One that does not breaks a pool of workers."""
    back = pickle.loads(pickle.dumps(error))
    assert (type(back), str(back), vars(back)) == (type(error), str(error), vars(error))
