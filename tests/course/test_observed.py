"""What is seen of a wrong answer that no known mistake gives."""

import numpy as np
import pytest
from questions import DOUBLE

import labkit as lk
from labkit import recordings
from labkit.course import Choice, mark
from labkit.course.authoring.problem import Problem, Trial, call
from labkit.course.judges import AtMost, Close
from labkit.course.marking import try_public
from labkit.course.observed import VARIES, diagnosed
from labkit.course.student import Desk
from labkit.course.verdict import Misconception
from labkit.recordings import read_trials
from solutions.comparison.hidden import stiffer


def law(state, target, *, kp, kd):
    """A joint law with two terms."""
    return kp * (target.position - state.q) + kd * (target.velocity - state.dq)


def states(seed):
    """A call of the law at random numbers."""
    q, dq, p, v, a = np.random.default_rng(seed).normal(size=(5, 3))
    return call(lk.State(0.0, q, dq), lk.Sample(p, v, a), kp=2.0 + seed, kd=0.3)


LAW = Problem("law", 1, "Give it.", law, (Trial("any", (states(1), states(2)), weight=1.0),))
SCALED = Problem(
    "scaled",
    1,
    "Give it.",
    lambda x, d: np.array([x, x * x]) / d,
    (Trial("any", (call(2.0, 3.0), call(5.0, 7.0)), weight=1.0),),
)


def seen(problem, function):
    """What a student reads of an answer."""
    question = problem.question(1).public()
    tried = try_public(question, function)
    mistake = diagnosed(question, mark(question, function, tried), tried, function).mistake
    return mistake.says if mistake else ""


@pytest.mark.parametrize(
    "function, says",
    [
        (lambda state, target, *, kp, kd: -law(state, target, kp=kp, kd=kd), "has the other sign"),
        (
            lambda state, target, *, kp, kd: law(state, target, kp=kd, kd=kp),
            "`kp` and `kd` are exc",
        ),
    ],
)
def test_the_cause_is_seen_in_the_numbers(function, says):
    """A sign and exchanged gains are told, each in its sentence."""
    assert says in seen(LAW, function)


def test_of_a_function_with_a_memory_only_that_is_said():
    """Also where its first answers are those of a known mistake; a right one hears nothing."""
    calls = []

    def remembers(x):
        calls.append(x)
        return x * x + 0.1 * (len(calls) > 3)

    verdict, *_ = Desk({"double": DOUBLE}).verdict("double", remembers)
    assert verdict.mistake == Misconception("", VARIES)
    verdict, *_ = Desk({"double": DOUBLE}).verdict("double", lambda x: x * x)
    assert verdict.mistake.name == "squared"


def test_a_factor_that_is_an_argument_is_told():
    """An answer that is not divided by an argument is told so."""
    assert "multiplied by `d`" in seen(SCALED, lambda x, d: np.array([x, x * x]))


def test_an_answer_that_never_changes_is_told_so():
    """Rather than that it does not feel one of its arguments, of which it feels none."""
    ratio = Problem(
        "ratio",
        1,
        "Give it.",
        lambda x, y: x / y,
        (Trial("any", (call(2.0, 3.0), call(5.0, 7.0)), weight=1.0),),
    )
    says = "In every call your answer is 0.01, whatever its arguments are."
    assert seen(ratio, lambda x, y: min(x / y, 0.01)) == says
    assert seen(ratio, lambda x, y: x) != says


def test_only_the_wrong_parts_of_an_answer_are_spoken_of():
    """Of three parts two are wrong by a factor: these are named, and the rest is called right."""
    parts = Problem(
        "parts",
        1,
        "Give it.",
        lambda x, d: (x, x / d, x * x / d),
        (Trial("any", (call(2.0, 3.0), call(5.0, 7.0)), weight=1.0),),
        judge=Close(parts=("s", "ds", "dds")),
    )
    says = seen(parts, lambda x, d: (x, x, x * x))
    assert "each of your `ds` and your `dds`" in says and "the rest is right" in says
    assert "multiplied by `d`" in says
    assert "your `ds` has the other sign, and" in seen(parts, lambda x, d: (x, -x / d, x * x / d))


def test_calls_of_several_forms_are_compared_all_the_same():
    """Answers with more parts in one call than in another, and calls that leave an argument out."""
    several = Problem("f", 1, "x", lambda n: (1.0,) * n, (Trial("any", (call(2), call(3))),))
    assert seen(several, lambda n: (2.0,) * n) == ""
    trial = Trial("any", (call(2.0, d=3.0), call(5.0)))
    some = Problem("f", 1, "x", lambda x, d=1.0: x * d, (trial,))
    assert seen(some, lambda x, d=1.0: 2.0 * x * d).endswith("is 2 times what it should be.")
    assert seen(some, lambda x, d=1.0: x * d * d + x * (d == 1.0)) == ""


def test_nothing_is_said_of_what_is_not_seen():
    """Of an answer without any relation to the right one nothing is said, nor of a right one."""
    assert seen(SCALED, lambda x, d: np.array([np.cos(x + d), 1.3])) == ""
    assert seen(SCALED, lambda x, d: np.array([x, x * x]) / d) == ""


LINE = read_trials(recordings.LINE)
SLOWER = stiffer(LINE, 4.0)


def gains_for(*arms):
    """A question whose function chooses gains on each arm, with at most 3 mm on its worst seed."""
    cases = tuple(Choice(trials, {"worst_mm": 3.0}) for trials in arms)
    return Problem("gains", 1, "Choose.", two_answers, (Trial("two", cases),), judge=AtMost())


def two_answers(runner):
    """Other gains where the runner returns infinity."""
    return (9.0 if runner(30.0, 0.0) == np.inf else 30.0), 0.0


def test_the_same_gains_for_arms_that_differ_are_named():
    """The pair is in the sentence, whether it was typed or found; one arm shows nothing."""
    says = "Your function returns the same gains, (30, 0), for arms that differ."
    assert seen(gains_for(LINE, SLOWER), lambda runner: (30, np.float64(0.0))).startswith(says)
    assert seen(gains_for(SLOWER, SLOWER), lambda runner: (30.0, 0.0)) == ""


def test_other_gains_and_those_that_cannot_be_tried_are_not_called_the_same():
    """Two pairs are two; beyond the record, below 0 or without two numbers, the judge says more."""
    both = gains_for(LINE, SLOWER)
    assert seen(both, lambda runner: (two_answers(runner)[0] / 4.0, 0.0)) == ""
    for given in ((200.0, 0.0), (-1.0, 0.0), (30.0,), None, "30", iter((30.0, 0.0))):
        assert seen(both, lambda runner, given=given: given) == ""


def test_the_numbers_of_another_command_tell_nothing():
    """Of a velocity where a torque is asked its kind is told, and nothing of its numbers."""
    torque = Problem(
        "torque",
        1,
        "Give it.",
        lambda state, target, *, kp, kd: lk.JointTorque(law(state, target, kp=kp, kd=kd)),
        LAW.trials,
        judge=Close(),
    )

    assert "has the other sign" in seen(torque, lambda *s, **k: lk.JointTorque(-law(*s, **k)))
    assert seen(torque, lambda *s, **k: lk.JointVelocity(-law(*s, **k))) == ""
