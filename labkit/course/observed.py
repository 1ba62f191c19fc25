"""Observed causes: what a wrong answer does to the numbers, where no known mistake gives them.

Each sentence says what is seen on all public calls, so it is true by construction: every number has
the other sign, the answer stays the same without an argument, it is right as soon as one is zero.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import permutations
from math import degrees, pi
from time import monotonic
from typing import Any

import numpy as np

from ..shapes import Array
from .marking import Tried
from .probes import arguments, arrays, exchanges, variations
from .question import Call, Case, Question
from .verdict import Misconception, Outcome, Verdict

Function = Callable[..., Any]
Parts = list[Array]
"""An answer, part by part."""

LONGEST = 3.0
"""Seconds that are spent on asking a function again."""
_FACTORS = {
    "2": 2.0,
    "π": pi,
    "2π": 2.0 * pi,
    "4π²": 4.0 * pi**2,
    "√2": 2.0**0.5,
    "√3": 3.0**0.5,
    "1000": 1e3,
    "9.81": 9.81,
    "180/π (degrees for radians)": degrees(1.0),
    "9.8/9.81": 9.8 / 9.81,
    "10/9.81": 10.0 / 9.81,
}
"""Factors that have a cause, in words."""
_POWERS = {
    "multiplied by `{}`": 1.0,
    "multiplied by `{}` squared": 2.0,
    "divided by `{}`": -1.0,
    "divided by `{}` squared": -2.0,
    "multiplied by the root of `{}`": 0.5,
    "divided by the root of `{}`": -0.5,
}


def explained(question: Question, verdict: Verdict, tried: Tried, function: Function) -> Verdict:
    """The verdict on a wrong answer with what is seen of it, unless it is a known mistake.

    Args:
        question: The question.
        verdict: What came of it.
        tried: What came back from the public cases.
        function: The student's, which is asked again with one argument changed.
    """
    if verdict.mistake or verdict.outcome not in (Outcome.WRONG, Outcome.ERROR):
        return verdict
    says = cause(question, tried.answers, function)
    return replace(verdict, mistake=Misconception("", says)) if says else verdict


def cause(question: Question, answers: Mapping[Case, Any], function: Function) -> str:
    """What is seen of a wrong answer, in a sentence; "" if nothing that tells much."""
    calls = [call for call in question.calls if isinstance(call, Call) and call in answers]
    if not calls or len(calls) < len(question.calls) or not question.arguments:
        return ""
    given = [arrays(answers[call]) for call in calls]
    expected = [arrays(call.expected) for call in calls]
    if not any(expected):
        return ""
    same_form = all(map(_same_form, given, expected))
    found = _related(question, calls, given, expected) if same_form else ""
    found = found or _exchanged(question, calls, function)
    return found or _probed(question, calls, given if same_form else [], function)


def _same_form(a: Parts, b: Parts) -> bool:
    """Whether two answers have one form, and the first is made of finite numbers."""
    pairs = zip(a, b, strict=False)
    return len(a) == len(b) and all(x.shape == y.shape and np.isfinite(x).all() for x, y in pairs)


def _near(a: Array, b: Array) -> bool:
    scale = max(float(np.abs(b).max(initial=0.0)), 1e-3)
    return bool(np.allclose(a, b, rtol=1e-6, atol=1e-8 * scale))


def _all(a: Sequence[Array], b: Sequence[Array]) -> bool:
    return all(map(_near, a, b))


def _related(
    question: Question, calls: Sequence[Call], given: list[Parts], expected: list[Parts]
) -> str:
    """How the one wrong part of an answer, or all of it, is related to the right one."""
    parts = list(zip(zip(*given, strict=True), zip(*expected, strict=True), strict=True))
    wrong = [k for k, (a, b) in enumerate(parts) if not _all(a, b)]
    names = getattr(question.judge, "parts", ()) or getattr(calls[0].expected, "_fields", ())
    what, rest = "your answer", ""
    if not wrong:
        return ""
    if len(parts) > len(wrong) == 1 and len(names) == len(parts):
        what, rest = f"your `{names[wrong[0]]}`", ", and the rest is right"
    elif len(parts) > 1:
        parts = [
            tuple(
                [np.concatenate([np.ravel(x[k]) for k in wrong]) for x in y]
                for y in (given, expected)
            )
        ]
        wrong = [0]
    by_name = [arguments(call, question.arguments) for call in calls]
    says = next(_relations(*parts[wrong[0]], by_name), "")
    return f"In every call {what} {says}{rest}." if says else ""


def _relations(
    a: Sequence[Array], b: Sequence[Array], given: Sequence[Mapping[str, Any]]
) -> Iterator[str]:
    if not any(x.any() for x in b):
        return
    if not any(x.any() for x in a):
        yield "is zero"
    if _all(a, [-x for x in b]):
        yield "has the other sign"
    for name in given[0]:
        x = [g[name] for g in given]
        if all(
            isinstance(y, np.ndarray) and y.shape == z.shape for y, z in zip(x, a, strict=True)
        ) and _all(a, x):
            yield f"is `{name}` itself"
    if len({x.shape for x in b}) == 1 and b[0].ndim:
        yield from _matrices(a, b) if b[0].ndim == 2 else ()
        yield from _rows(a, b)
    told = [(_factor(x, y), g) for x, y, g in zip(a, b, given, strict=True) if x.any() or y.any()]
    if len(told) > 1 and all(factor for factor, _ in told):
        yield from _factors(np.array([factor for factor, _ in told]), [g for _, g in told])


def _matrices(a: Sequence[Array], b: Sequence[Array]) -> Iterator[str]:
    if b[0].shape[0] == b[0].shape[1]:
        if _all(a, [x.T for x in b]):
            yield "is the transpose of what it should be"
        if all(np.linalg.cond(x) < 1e9 for x in b) and _all(a, [np.linalg.inv(x) for x in b]):
            yield "is the inverse of what it should be"
        if _all(a, [np.diag(np.diag(x)) for x in b]):
            yield "has zeros beside the diagonal, and on it, it is right"
    rows = range(len(b[0]))
    for order in permutations(rows) if len(rows) <= 6 else ():
        if order != tuple(rows) and _all(a, [x[list(order)] for x in b]):
            yield f"has the right rows in another order ({', '.join(map(str, order))})"


def _rows(a: Sequence[Array], b: Sequence[Array]) -> Iterator[str]:
    """Where only some components are wrong, and those in one way."""
    for axis, kind in enumerate(("row", "column") if b[0].ndim == 2 else ("component",)):
        wrong = [
            k
            for k in range(b[0].shape[axis])
            if not _all([x.take(k, axis) for x in a], [x.take(k, axis) for x in b])
        ]
        if not 0 < len(wrong) < b[0].shape[axis]:
            continue
        c, d = ([x.take(wrong, axis) for x in z] for z in (a, b))
        which = f"{kind}{'s' * (len(wrong) > 1)} {', '.join(map(str, wrong))}"
        be, have = ("are", "have") if len(wrong) > 1 else ("is", "has")
        if not any(x.any() for x in c):
            yield f"is right but for {which}, which {be} zero"
        if _all(c, [-x for x in d]):
            yield f"is right but for {which}, which {have} the other sign"


def _factor(a: Array, b: Array) -> float:
    """What all numbers of b are multiplied by to give a; 0 if there is no such factor."""
    size = float(np.vdot(b, b))
    factor = float(np.vdot(b, a)) / size if size else 0.0
    return factor if _near(a, factor * b) else 0.0


def _factors(factors: Array, given: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    for words, value in _FACTORS.items():
        if np.allclose(factors, value, rtol=1e-6):
            yield f"is {words} times what it should be"
        if np.allclose(factors, 1.0 / value, rtol=1e-6):
            yield f"is what it should be, divided by {words}"
    if np.ptp(factors) > 1e-6 * np.abs(factors).max():
        for name in given[0]:
            x = [g[name] for g in given]
            if all(isinstance(y, float | int) and y > 0 for y in x):
                for words, power in _POWERS.items():
                    if np.allclose(factors, np.power(x, power), rtol=1e-6):
                        yield f"is what it should be, {words.format(name)}"
    else:
        yield f"is {factors[0]:.5g} times what it should be"


def _exchanged(question: Question, calls: Sequence[Call], function: Function) -> str:
    """What has to be exchanged in its arguments to make the function right."""
    changed = [dict(exchanges(call, question.arguments)) for call in calls]
    for label in changed[0]:
        if all(
            label in one and _right(question, _ask(one[label], function), call.expected)
            for one, call in zip(changed, calls, strict=True)
        ):
            return f"Your function is right in every call if {label} before it is called."
    return ""


def _right(question: Question, answer: Any, expected: Any) -> bool:
    try:
        return question.judge(answer, expected) is None
    except Exception:  # there is no end to what an answer can be
        return False


def _ask(call: Call, function: Function) -> Any:
    try:
        return call.ask(function)
    except Exception:
        return None


def _probed(
    question: Question, calls: Sequence[Call], given: list[Parts], function: Function
) -> str:
    """What the answer does where one argument is changed, and the right one does not do."""
    changed = [dict(variations(call, question.arguments)) for call in calls]
    expected = [arrays(call.expected) for call in calls]
    stays, moves, shares, places = [], [], [], []
    until = monotonic() + LONGEST
    for probe in question.probes:
        if monotonic() > until:
            break
        asked = [_ask(one[probe.label], function) for one in changed]
        found, right = [arrays(x) for x in asked], [arrays(x) for x in probe.answers]
        if not all(map(_same_form, found, right)):
            continue
        same, should = bool(given) and all(map(_all, found, given)), all(map(_all, right, expected))
        if same and not should:
            stays.append(probe.label)
        if given and should and not same:
            moves.append(probe.label)
        if not should and all(map(lambda x, y: _right(question, x, y), asked, probe.answers)):
            if given and (says := _share(given, expected, right)):
                shares.append(says.format(probe.label.split("`")[1], probe.label))
            elif probe.tells:
                places.append(probe.label)
    if shares:
        return shares[0]
    if stays:
        return f"Your answer stays the same if {' or if '.join(stays[:3])}; the right one does not."
    if moves:
        return f"Your answer changes if {' or if '.join(moves[:3])}; the right one does not."
    if places:
        return f"Your answer is right as soon as {' or as soon as '.join(places[:2])}: look there."
    return ""


_SHARES = {
    -1.0: "What `{}` adds to your answer has the other sign: if {}, it is right.",
    2.0: "What `{}` adds to your answer is there twice: if {}, it is right.",
    0.5: "What `{}` adds to your answer is half of what it should be: if {}, it is right.",
}


def _share(given: list[Parts], expected: list[Parts], right: list[Parts]) -> str:
    """By what factor that is wrong which an argument adds to the answer, in words."""
    g, e, r = (
        np.concatenate([x.ravel() for parts in z for x in parts]) for z in (given, expected, right)
    )
    factor = _factor(g - r, e - r)
    return next((says for value, says in _SHARES.items() if abs(factor - value) < 1e-6), "")
