"""What is seen of a wrong answer that no known mistake gives."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from questions import DOUBLE

import labkit as lk
from labkit.course import mark
from labkit.course.authoring.problem import Problem, Trial, call
from labkit.course.causes import VARIES, by_terms, diagnosed
from labkit.course.judges import Close
from labkit.course.marking import try_public
from labkit.course.student import Desk
from labkit.course.verdict import Misconception


def law(state, target, *, kp, kd):
    """A joint law with two terms."""
    return kp * (target.position - state.q) + kd * (target.velocity - state.dq)


def states(seed):
    """A call of the law at random numbers."""
    q, dq, p, v, a = np.random.default_rng(seed).normal(size=(5, 3))
    return call(lk.State(0.0, q, dq), lk.Sample(p, v, a), kp=2.0 + seed, kd=0.3)


LAW = Problem(
    "law", 1, "Give it.", law, (Trial("any", tuple(map(states, range(1, 5))), weight=1.0),)
)
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
            "arguments are exchanged",
        ),
    ],
)
def test_the_cause_is_seen_in_the_numbers(function, says):
    """A sign and exchanged gains are told, each in its sentence."""
    assert says in seen(LAW, function)


def terms(state, target, *, kp, kd):
    """The terms of the law, and two that are taken for them."""
    e, de = target.position - state.q, target.velocity - state.dq
    return {"P": kp * e, "D": kd * de}, {"own": kd * state.dq, "speed": target.acceleration}


def test_each_term_with_another_factor_than_in_the_law_is_told():
    """Whichever of four terms are missing, reversed, scaled or added, up to all at once."""
    asked, names, law = (
        replace(LAW, terms=terms).question(1),
        ["P", "D", "own", "speed"],
        (1, 1, 0, 0),
    )

    def weighted(*args, **kwargs):
        values = [*terms(*args, **kwargs)[0].values(), *terms(*args, **kwargs)[1].values()]
        return sum(c * x for c, x in zip(factors, values, strict=True))

    for factors in product((1.0, 0.0, -1.0, 2.5), (1.0, 0.0), (0.0, -1.0), (0.0, 3.0)):
        found = by_terms(asked, {call: call.ask(weighted) for call in asked.calls})
        off = [x for x, c, right in zip(names, factors, law, strict=True) if c != right]
        assert (found is None) == (not off)
        if found is not None:
            assert [x for x in names if f" {x} " in found.says] == off
            assert all(x in found.cure for x in off)


def test_an_answer_that_is_no_sum_of_terms_is_left_alone():
    """A square is no term, and three numbers fit no seven terms."""
    asked = replace(LAW, terms=terms).question(1)
    squares = {call: call.expected**2 for call in asked.calls}
    assert by_terms(asked, squares) is None and by_terms(LAW.question(1), squares) is None


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


def test_nothing_is_said_of_what_is_not_seen():
    """Of an answer without any relation to the right one nothing is said, nor of a right one."""
    assert seen(SCALED, lambda x, d: np.array([np.cos(x + d), 1.3])) == ""
    assert seen(SCALED, lambda x, d: np.array([x, x * x]) / d) == ""


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
