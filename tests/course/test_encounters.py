"""Runs that meet something, runs with chosen gains, and how both travel."""

import json

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from questions import says

import labkit as lk
from labkit.control import springs
from labkit.course import (
    AtMost,
    Call,
    Gains,
    Loop,
    Question,
    Test,
    Tuned,
    question_data,
    read_question,
)
from labkit.course.marking import mark
from labkit.course.serialize import decode, encode

READY = lk.robot("left").ready
FLOATING = lk.Plant(name="floating", gravity_compensation=True, armature=0.05, viscous=0.7)
STAY = lk.Hold(READY, 0.5)


def travelled(value):
    return decode(json.loads(json.dumps(encode(value))))


def test_a_state_keeps_its_external_torque():
    """What the arm feels travels with the state."""
    state = lk.State(0.25, READY, np.ones(7), np.arange(7.0))
    for a, b in zip(travelled(state), state, strict=True):
        assert_array_equal(a, b)


@pytest.mark.parametrize(
    "thing",
    [
        lk.Push((1.0, 2.0, 3.0), start=0.1),
        lk.Spring((0.5, 0.1, 0.2), 200.0, 3.0),
        lk.Wall((0.9, 0.2, 0.1), (-1.0, 0.0, 0.0), stiffness=900.0),
        lk.Table(height=-0.1),
    ],
    ids=lambda thing: type(thing).__name__,
)
def test_things_travel(thing):
    """What an arm meets arrives as it was, an endless push included."""
    again = travelled(thing)
    assert type(again) is type(thing)
    for name, value in vars(thing).items():
        assert_array_equal(getattr(again, name), value)


def hold(state, target):
    return springs(40.0, 4.0)(state, target)


def test_a_run_meets_its_things():
    """A push moves the arm of a loop, and none is left where there is no push."""
    alone = Loop(STAY, plant=FLOATING)
    pushed = Loop(STAY, plant=FLOATING, things=(lk.Push((0.0, 10.0, 0.0)),))
    left, moved = (case.measured(case.ask(hold))["max_mm"] for case in (alone, pushed))
    assert left < 1e-6 < 1.0 < moved


def soft(model):
    return 50.0, 10.0 * np.ones(7)


def tuned(limit):
    loop = Loop(STAY, plant=FLOATING, q0=READY + 0.05)
    return Tuned((lk.Model("left", FLOATING),), loop, {"max_mm": limit})


def test_chosen_gains_drive_springs():
    """The run is that of springs and dampers with the gains that the function gave."""
    case = tuned(100.0)
    assert_array_equal(case.ask(soft).q, case.loop.ask(springs(50.0, 10.0)).q)


def question(limit):
    model = lk.Model("left", FLOATING)
    tests = (Test("a pair", (Call((model,)),), 0.0), Test("a run", (tuned(limit),)))
    return Question("soft", 2.0, "Choose.", Gains(), tests)


@pytest.mark.parametrize(("limit", "points"), [(200.0, 2.0), (1.0, 0.0)])
def test_a_question_about_gains_travels(limit, points):
    """As data and back, hidden or not, it gives the same marks."""
    q = question(limit)
    again = read_question(json.loads(json.dumps(question_data(q))))
    assert mark(again, soft).earned == mark(q, soft).earned == points


def test_gains_that_are_none_earn_nothing():
    """A pair is two things, a number or seven each, none below 0."""
    judge = Gains()
    assert judge((1.0, np.ones(7)), None) is None
    assert judge([0.0, [1, 2, 3, 4, 5, 6, 7]], None) is None
    for wrong in (3.0, (1.0,), (1.0, -1.0), (1.0, np.ones(6)), (np.nan, 1.0), None):
        assert judge(wrong, None) is not None
        assert not judge.same(wrong, wrong)


def test_gains_are_alike_within_a_factor():
    """A mistake is known by gains like its own, not by the last digit."""
    judge = Gains()
    assert judge.same((100.0, 20.0), (120.0, 15.0))
    assert not judge.same((100.0, 20.0), (160.0, 20.0))
    assert not judge.same((100.0, 20.0), (100.0, 20.0 * np.arange(7)))


def test_measures_come_with_their_units():
    """Too much is said in words: what, how much, in which unit."""
    words = says(
        AtMost()({"rms_velocity_mm_s": 81.23, "max_deg": 3.0}, {"rms_velocity_mm_s": 75.0})
    )
    assert words == "the RMS error of the tip's velocity is 81.2 mm/s; the limit is 75 mm/s"
    assert says(AtMost()({"max_deg": 3.0}, {"max_deg": 2.0})) == (
        "the largest error of the tip's orientation is 3 degrees; the limit is 2 degrees"
    )
    words = says(AtMost()({"saturated": 0.2}, {"saturated": 0.1}))
    assert words == "saturated is 0.2; the limit is 0.1"


def test_springs_pull_to_the_target_and_brake_the_difference():
    """The law of the joint springs, number by number."""
    state, target = lk.State(0.0, READY, np.ones(7)), lk.Sample(READY + 0.1, np.zeros(7), READY)
    np.testing.assert_allclose(springs(10.0, 2.0)(state, target).value, 10.0 * 0.1 - 2.0)
