"""Exceptions in words: the line they came from and what to do about them."""

import numpy as np
import pytest
from scipy.optimize import brentq

import labkit as lk
from labkit.course.advice import full_description, line_of
from labkit.course.calling import reply

STATE = lk.State(0.0, np.zeros(7), np.zeros(7))
SAMPLE = lk.Sample(*np.zeros((3, 7)))
FIXED = np.zeros(3)
FIXED.setflags(write=False)


def writes():
    FIXED[0] = 1.0


def misspells(angles=None):
    return anglesx  # noqa: F821


@pytest.mark.parametrize(
    ("does", "remedy"),
    [
        (lambda: STATE.position, "it has t, q, dq, tau_ext"),
        (lambda: STATE - STATE, "did you mean state.q?"),
        (lambda: SAMPLE - np.zeros(7), "did you mean target.position?"),
        (lambda: SAMPL.position, "did you mean SAMPLE?"),  # noqa: F821
        (misspells, "did you mean angles?"),
        (lambda: math.sqrt(2.0), "to use it, begin the cell with `import math`"),  # noqa: F821
        (lambda: ct.tf([1], [1, 1]), "begin the cell with `import control as ct`"),  # noqa: F821
        (lambda: stats.t, "begin the cell with `from scipy import stats`"),  # noqa: F821
        (lambda: sqrt(2.0), "did you mean np.sqrt?"),  # noqa: F821
        (lambda: pi, "did you mean np.pi?"),  # noqa: F821
        (lambda: lenn([]), "did you mean len?"),  # noqa: F821
        (lambda angles=None: angle, "did you mean angles or np.angle?"),  # noqa: F821
        (writes, "make a new array"),
        (lambda: np.zeross(3), "did you mean zeros?"),
        (lambda: np.sqr(2.0), "did you mean sqrt?"),
        (lambda: FIXED.shap, "did you mean shape?"),
        (lambda: 2.0 ^ 2, "a power is written with **"),
        (lambda: FIXED ^ 2, "a power is written with **"),
        (lambda: np.zeros(6, 7), "give the shape in one pair of brackets"),
        (lambda: FIXED.sum + 1.0, "brackets call a method"),
        (lambda: 1.0 - lk.Model("left").gravity, "brackets call a method"),
        (
            lambda: np.eye(4) @ np.zeros(3),
            "the left side of @ has 4 columns and the right side 3 rows",
        ),
        (
            lambda: 2.0 @ np.zeros(3),
            "a single number beside @, in the line ``; @ needs an array on each side; use * for",
        ),
        (
            lambda: np.zeros(6) + np.zeros(7),
            "the tip's velocity has 6 numbers, the joints' 7",
        ),
        (lambda: np.zeros(3) - np.zeros(7), "so the sizes must be equal"),
        (lambda: np.linalg.inv(np.zeros((6, 7))), "only a square matrix"),
        (lambda: FIXED(2.0), "is a * missing"),
        (lambda: brentq(lambda w: 1.6 - w - 60.0, 0.0, 9.0), "degrees among radians"),
        (lambda: brentq(lambda w: 1.6 + w, 0.0, 9.0), "look for a wrong sign, bounds that are too"),
    ],
)
def test_a_usual_slip_has_a_way_out(does, remedy):
    """What Python and numpy say is followed by what to do, beside the line that raised."""
    with pytest.raises(Exception) as caught:
        does()
    line = line_of(caught.value)  # it quotes this test's own table
    assert remedy in full_description(caught.value).replace(line, "")


@pytest.mark.parametrize(
    "does",
    [lambda: opt, lambda: stat, lambda: np.cosinus(1.0), lambda: np.linalg.cos(1.0)],  # noqa: F821
)
def test_a_name_is_suggested_only_if_it_is_close(does):
    """A forgotten import is no misspelt `oct`, and a cosine no cross product."""
    assert "did you mean" not in reply(does, (), {})["says"]


def test_matrices_are_to_be_multiplied_only_if_they_can_be():
    """`@` is not suggested for a series, for a line that has one, or for sizes that do not fit."""
    j, log = np.zeros((6, 7)), np.zeros((71, 7))
    for wrong in (
        lambda: np.zeros(71) * log,
        lambda: j @ log.T * j,
        lambda: j - np.eye(4),
        lambda: np.eye(4) - np.zeros((2, 4)),
    ):
        says = reply(wrong, (), {})["says"]
        assert "so the sizes must be equal" in says and "use @" not in says

    def fits():
        return j * np.eye(7)

    assert reply(fits, (), {})["says"].endswith("; use @ to multiply matrices")


def test_only_the_answers_own_parameters_are_to_be_left():
    """A wrong call within the answer is a matter of that line, and no parameter is changed."""
    advice = "leave the parameter names in the function's first line as they were given"
    assert advice in reply(writes, (1,), {})["says"]
    assert advice in reply(lambda q: q, (), {"dq": 1.0})["says"]
    for inside in (lambda: writes(1), lambda: np.dot(FIXED), lambda: lk.Model("left").gravity()):
        says = reply(inside, (), {})["says"]
        assert "argument" in says and advice not in says


def test_the_line_is_the_students():
    """The last line outside labkit is quoted, not the one in labkit that raised."""
    with pytest.raises(lk.LabkitError) as caught:
        lk.JointVelocity(np.zeros((3, 1)))
    assert "in the line `lk.JointVelocity(np.zeros((3, 1)))`" in full_description(caught.value)
