"""Errors: one family, each also the built-in that a Python programmer would catch."""

import pickle

import pytest

from labkit import errors
from labkit.errors import JointLimitExceeded, LabkitError, ShapeError, UnknownName


@pytest.mark.parametrize(
    ("builtin", "names"),
    [
        (ValueError, ("ShapeError", "NotFinite", "JointLimitExceeded", "Unreachable")),
        (TypeError, ("TypeMismatch",)),
        (KeyError, ("UnknownName",)),
        (RuntimeError, ("Closed",)),
    ],
)  # fmt: skip
def test_an_error_is_also_the_builtin_one_that_is_usual(builtin, names):
    """Each is also the error that a Python programmer would catch."""
    assert all(issubclass(getattr(errors, x), LabkitError) for x in names)
    assert all(issubclass(getattr(errors, x), builtin) for x in names)


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
