"""Marking: outcomes, gates first, mistakes named; calls, runs, and runs with chosen gains."""

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from questions import CALLS, DOUBLE, HIDDEN, double, square

import labkit as lk
from labkit.control import springs
from labkit.course import (
    Call,
    Close,
    Gains,
    Loop,
    Mistake,
    Outcome,
    Question,
    Raised,
    Test,
    Tuned,
    case,
    check,
    fingerprint,
    question_data,
    read_question,
)
from labkit.course.marking import mark, recognise, try_public
from labkit.course.messages import why
from labkit.course.serialize import decode, encode


def stub(x):
    raise NotImplementedError


def broken(x):
    return x["two"]


@pytest.mark.parametrize(
    ("function", "outcome", "earned"),
    [
        (double, Outcome.RIGHT, 4.0),
        (lambda x: x + x, Outcome.RIGHT, 4.0),
        (lambda x: np.float64(2 * x), Outcome.RIGHT, 4.0),
        (stub, Outcome.NOT_ATTEMPTED, 0.0),
        (broken, Outcome.ERROR, 0.0),
        (sys.exit, Outcome.ERROR, 0.0),
        (square, Outcome.WRONG, 0.0),
        (lambda x: 0.0, Outcome.WRONG, 0.0),
        (lambda x: None, Outcome.WRONG, 0.0),
        (lambda x: float("nan"), Outcome.WRONG, 0.0),
        (lambda x: abs(2.0 * x), Outcome.WRONG, 3.0),
    ],
)
def test_outcomes_and_points(function, outcome, earned):
    """Not attempted, error, wrong, right; a failed gate leaves nothing, a failed test its share."""
    verdict = mark(DOUBLE, function)
    assert (verdict.outcome, verdict.earned) == (outcome, earned)


def test_a_mistake_is_named_only_by_all_its_answers():
    """The square is recognised; one answer more or less like it is not."""
    assert mark(DOUBLE, square).mistake.name == "squared"
    assert mark(DOUBLE, lambda x: x * x if x > 0 else 5.0).mistake is None
    assert mark(DOUBLE, double).mistake is None


def test_a_mistake_that_is_wrong_where_the_answer_is_right_is_not_its_name():
    """An answer 1 part in 10^5 off a mistake is not that mistake where only it is accepted."""
    nearly = lambda x: 2.0 * x * (1.0 + 1e-5) if x > 0 else 5.0  # noqa: E731
    given = fingerprint(DOUBLE, nearly)
    question = replace(DOUBLE, mistakes=(replace(DOUBLE.mistakes[0], answers=given),))
    assert mark(question, nearly).mistake.name == "squared"
    assert mark(question, lambda x: 2.0 * x if x > 0 else 5.0).mistake is None


def test_a_mistake_may_be_an_exception():
    """A function that raises where a known mistake raises is that mistake."""
    question = replace(
        DOUBLE, mistakes=(replace(DOUBLE.mistakes[0], answers=fingerprint(DOUBLE, broken)),)
    )
    assert fingerprint(DOUBLE, broken) == (Raised("TypeError"),) * 3
    assert mark(question, broken).mistake.name == "squared"
    assert mark(question, lambda x: 1 / 0).mistake is None


def test_hidden_cases_decide_and_are_not_told():
    """A hidden case counts; its verdict holds its class, and not how it failed."""
    question = replace(
        DOUBLE, tests=(*DOUBLE.tests[:2], Test("more", (CALLS[2], HIDDEN), 1.0, "any number"))
    )
    crammed = {2.0: 4.0, 3.0: 6.0, -1.0: -2.0}

    def stub(x):
        return crammed[x] if x in crammed else stopped()

    def stopped():
        raise NotImplementedError

    cheats = (lambda x: crammed.get(x, 0.0), crammed.get, crammed.__getitem__, stub)
    verdict, *others = [mark(question, cheat) for cheat in cheats]
    assert verdict.earned == 3.0
    (failed,) = [t for t in verdict.tests if t.outcome is not Outcome.RIGHT]
    assert failed.hidden and why(failed) == "a hidden case (any number)"
    assert others == [verdict] * 3


def loop_question(**settings):
    q0 = lk.robot("left").ready
    loop = Loop(lk.Hold(q0, 0.4), q0=q0 + 0.05, expected={"max_mm": 5.0}, **settings)
    return replace(DOUBLE, tests=(Test("closed loop", (loop,)),), mistakes=())


def test_a_closed_loop_after_it_has_settled():
    """A run is measured from its settling time on; without one, the start counts."""

    def controller(state, target):
        return lk.JointVelocity(20.0 * (target.position - state.q))

    assert mark(loop_question(settle=0.3), controller).outcome is Outcome.RIGHT
    verdict = mark(loop_question(), controller)
    assert verdict.outcome is Outcome.WRONG and "the limit is 5 mm" in why(verdict.tests[0])


def test_a_closed_loop_that_breaks():
    """A controller that raises, or has no return, or is a stub, ends in its own outcome."""
    for controller, outcome in (
        (lambda state, target: None, Outcome.ERROR),
        (lambda state, target: 1 / 0, Outcome.ERROR),
        (lambda state, target: stub(0), Outcome.NOT_ATTEMPTED),
    ):
        assert mark(loop_question(), controller).outcome is outcome


class Odd:
    """An answer that cannot even be looked at."""

    def __array__(self, *args, **kwargs):
        raise RuntimeError


def test_an_answer_that_cannot_be_compared_is_wrong_and_no_mistake():
    """Neither the judge nor the search for mistakes fails by it."""
    verdict = mark(DOUBLE, lambda x: Odd())
    assert (verdict.outcome, verdict.earned, verdict.mistake) == (Outcome.WRONG, 0.0, None)


def test_no_hidden_case_is_asked_where_a_public_one_failed():
    """Where all public ones are right, each hidden case is asked once."""
    question = replace(DOUBLE, tests=(Test("a", (*CALLS, HIDDEN)),), mistakes=())
    for function, hidden in ((double, 1), (square, 0)):
        seen = []
        mark(question, lambda x, f=function, seen=seen: seen.append(x) or f(x))
        assert seen.count(7.5) == hidden


def test_a_test_may_look_at_a_part_of_the_answer():
    """The other part earns in its own test."""
    call = Call((1.0,), expected=(1.0, 2.0))
    tests = tuple(Test(name, (call,), w, part=name) for name, w in (("kp", 1.0), ("kd", 3.0)))
    question = replace(DOUBLE, judge=Close(parts=("kp", "kd")), tests=tests, mistakes=())
    earned = [mark(question, lambda x, y=y: y).earned for y in ((1.0, 0.0), (0.0, 2.0), (1.0, 2.0))]
    assert earned == [1.0, 3.0, 4.0]


ROOT = Path(__file__).parents[2]


@pytest.fixture
def beside(tmp_path, monkeypatch):
    shutil.copy(ROOT / "assignments/00_warmup/checks.json", tmp_path)
    monkeypatch.chdir(tmp_path)


def test_the_failing_call_can_be_run(beside, capsys):
    """A check that shows <3 x 3 numbers> says how to get them, and they fail as it said."""

    def orientation_error(R_wd, R_wt):
        return lk.se3.rotation_log(R_wt.T @ R_wd)

    check("orientation_error", orientation_error)
    assert 'args, kwargs = lk.course.case("orientation_error")' in capsys.readouterr().out
    args, kwargs = case("orientation_error")
    right = lk.se3.orientation_error(*args)
    assert not np.allclose(orientation_error(*args, **kwargs), right)


READY = lk.robot("left").ready
FLOATING = lk.Plant(name="floating", gravity_compensation=True, armature=0.05, viscous=0.7)
STAY = lk.Hold(READY, 0.5)


def travelled(value):
    return decode(json.loads(json.dumps(encode(value))))


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


def test_the_public_runs_are_kept_with_what_they_reached():
    """A whole one, and one up to the moment at which the arm was lost; a call is no run."""
    question = loop_question()
    question = replace(question, tests=(*question.tests, Test("a call", CALLS[:1])))
    for kind, size, complete in ((lk.JointVelocity, 0.0, True), (lk.JointTorque, 50.0, False)):
        command = kind(np.full(7, size))
        (run,) = try_public(question, lambda *_, command=command: command).runs(question)
        assert (run.test, run.complete) == ("closed loop", complete)
        assert isinstance(run.log, lk.Log) and run.case is question.tests[0].cases[0]


def test_a_factor_stays_only_if_it_holds_in_every_wrong_call():
    """A single wrong number has none; two have one, and so has an array of one call."""
    plain = replace(DOUBLE, mistakes=())
    for answer, times in ((lambda x: -2.0 * x, -1.0), (lambda x: 2.0 * abs(x), None)):
        found = [x.difference.times for x in mark(plain, answer).tests if x.difference]
        assert found == [pytest.approx(times)] * len(found) and found
    one = replace(plain, tests=(Test("an array", (Call((), expected=np.arange(4.0)),)),))
    (test,) = mark(one, lambda: 3.0 * np.arange(4.0)).tests
    assert test.difference.times == pytest.approx(3.0)
    two = replace(plain, tests=(Test("two", (Call((1,), expected=np.ones(3)),)),
                                Test("more", (Call((2,), expected=np.ones(3)),))))  # fmt: skip
    assert all(x.difference.times is None for x in mark(two, lambda x: np.full(3, 1.0 + x)).tests)


def test_without_an_answer_there_is_no_known_mistake():
    """Also if the mistake has none, as where a question has no public call."""
    assert recognise(replace(DOUBLE, mistakes=(Mistake("nothing", "It is none."),)), []) is None


def test_the_outcome_of_all_tests_is_the_worst_that_is_shown():
    """What was not tried does not count, and a stub in one branch is no stub."""
    unseen = replace(DOUBLE, tests=(*DOUBLE.tests, Test("unseen", ())))
    assert mark(unseen, double).outcome is Outcome.RIGHT
    assert mark(DOUBLE, lambda x: stub(x) if x == 3.0 else 2.0 * x).outcome is Outcome.ERROR
    assert mark(DOUBLE, lambda x: stub(x) if x == 3.0 else 5.0).outcome is Outcome.WRONG
