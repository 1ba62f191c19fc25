"""Observed causes of wrong answers that no known mistake explains.

Each sentence states what holds in all public calls: every number has the other sign, an argument is
a factor too many, or two arguments are exchanged.
This is true only of a function that answers the same call alike, so a call is repeated first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, permutations
from math import degrees, pi
from time import monotonic
from typing import Any

import numpy as np

from ..shapes import Array
from .judges import accepts, factor, numbers
from .marking import Function, PublicResult, ask
from .question import Call, Case, Question, Raised
from .verdict import Kind, Misconception, Outcome, Verdict

LONGEST = 3.0
"""Time that is spent on calling a function again, in [s]."""
Parts = list[Array]
"""An answer, part by part."""

_FACTORS = {
    "2": 2.0,
    "π": pi,
    "2π": 2.0 * pi,
    "√2": 2.0**0.5,
    "1000": 1e3,
    "9.81": 9.81,
    "180/π (degrees for radians)": degrees(1.0),
    "9.8/9.81": 9.8 / 9.81,
}
"""Factors that have a likely cause, by their names."""
_POWERS = {"multiplied by `{}`": 1.0, "divided by `{}`": -1.0}


def diagnosed(
    question: Question, verdict: Verdict, tried: PublicResult, function: Function
) -> Verdict:
    """The verdict on a wrong answer, with the observed cause unless it is a known mistake.

    Args:
        question: The question.
        verdict: The verdict on the answer.
        tried: The result of the public cases.
        function: The student's function, which is called again with one argument changed.
    """
    if verdict.outcome not in (Outcome.WRONG, Outcome.ERROR):
        return verdict
    if _varies(question, tried.answers, function):
        return replace(verdict, mistake=Misconception("", VARIES))
    if verdict.mistake:
        return verdict
    if any(test.difference and test.difference.kind is Kind.TYPE for test in verdict.tests):
        return verdict  # the numbers of another command type reveal nothing
    says = cause(question, tried.answers, function)
    return replace(verdict, mistake=Misconception("", says)) if says else verdict


VARIES = (
    "Your function gives another answer when the same call is repeated. Let it depend on its "
    "arguments alone, not on earlier calls or on chance."
)


def _varies(question: Question, answers: Mapping[Case, Any], function: Function) -> bool:
    """Whether the function answers a public call differently when it is repeated."""
    until = monotonic() + LONGEST
    for call in question.calls:
        if isinstance(call, Call) and call in answers and monotonic() < until:
            before, now = answers[call], ask(call, function)
            if isinstance(before, Raised) or isinstance(now, Raised):
                kinds = [getattr(x, "kind", "") for x in (before, now)]
                if kinds[0] != kinds[1] and "TimeoutError" not in kinds:
                    return True
                continue
            try:
                a, b = numbers(before), numbers(now)
            except (TypeError, ValueError, OverflowError):
                continue
            if a.shape != b.shape or not np.allclose(a, b, rtol=1e-9, atol=1e-12, equal_nan=True):
                return True
    return False


def cause(question: Question, answers: Mapping[Case, Any], function: Function) -> str:
    """A sentence about what is observed of a wrong answer; "" if nothing explains it."""
    calls = [call for call in question.calls if isinstance(call, Call) and call in answers]
    if not calls or len(calls) < len(question.calls) or not question.arguments:
        return ""
    given = [numeric_parts(answers[call]) for call in calls]
    expected = [numeric_parts(call.expected) for call in calls]
    if not any(expected):
        return ""
    alike = all(map(same_form, given, expected))
    found = related(question, calls, given, expected) if alike else ""
    return found or _exchanged(question, calls, function)


def _exchanged(question: Question, calls: Sequence[Call], function: Function) -> str:
    """Which change of its arguments, such as an exchange of two, makes the function right."""
    changed = [dict(exchanges(call, question.arguments)) for call in calls]
    for label in changed[0]:
        if all(
            label in one and accepts(question.judge, try_call(one[label], function), call.expected)
            for one, call in zip(changed, calls, strict=True)
        ):
            return f"Your function is right in every call if {label} before it is called."
    return ""


def exchanges(call: Call, names: Sequence[str]) -> Iterator[tuple[str, Call]]:
    """The call with two arguments exchanged, or one transposed, each under a label."""
    given = arguments(call, names)
    for (a, x), (b, y) in combinations(given.items(), 2):
        alike = np.shape(x) == np.shape(y) if _numeric(x) and _numeric(y) else False
        if alike or (type(x) is type(y) and isinstance(x, tuple)):
            yield f"`{a}` and `{b}` are exchanged", _with(call, names, {a: y, b: x})
    for name, x in given.items():
        if isinstance(x, np.ndarray) and x.ndim == 2 and x.shape[0] == x.shape[1]:
            yield f"`{name}` is transposed", _with(call, names, {name: x.T})


def arguments(call: Call, names: Sequence[str]) -> dict[str, Any]:
    """The arguments of a call by their names."""
    return dict(zip(names, call.args, strict=False)) | dict(call.kwargs)


def _with(call: Call, names: Sequence[str], new: dict[str, Any]) -> Call:
    args = tuple(new.get(name, x) for name, x in zip(names, call.args, strict=False))
    return replace(call, args=args, kwargs={k: new.get(k, x) for k, x in call.kwargs.items()})


def _numeric(x: Any) -> bool:
    return isinstance(x, float | int | np.ndarray) and not isinstance(x, bool)


def try_call(call: Call, function: Function) -> Any:
    """The function's answer to a call; None if it raises, because such a call reveals nothing."""
    try:
        with np.errstate(all="ignore"):
            return call.ask(function)
    except Exception:
        return None


def numeric_parts(answer: Any) -> list[Array]:
    """The numbers of an answer, part by part; empty if it does not consist of numbers."""
    answer = getattr(answer, "value", answer)
    items = answer if isinstance(answer, tuple) else (answer,)
    try:
        return [np.asarray(x, dtype=float) for x in items if x is not None]
    except (TypeError, ValueError):
        return []


def same_form(a: Parts, b: Parts) -> bool:
    """Whether two answers have the same form, and the numbers of the first are finite."""
    pairs = zip(a, b, strict=False)
    return len(a) == len(b) and all(x.shape == y.shape and np.isfinite(x).all() for x, y in pairs)


def _near(a: Array, b: Array) -> bool:
    scale = max(float(np.abs(b).max(initial=0.0)), 1e-3)
    return bool(np.allclose(a, b, rtol=1e-6, atol=1e-8 * scale))


def all_near(a: Sequence[Array], b: Sequence[Array]) -> bool:
    """Whether two lists of arrays hold the same numbers, apart from rounding."""
    return all(map(_near, a, b))


def related(
    question: Question, calls: Sequence[Call], given: list[Parts], expected: list[Parts]
) -> str:
    """A sentence about how the wrong parts of an answer are related to the right ones, or ""."""
    if len(set(map(len, expected))) > 1:
        return ""
    parts: list[tuple[Sequence[Array], Sequence[Array]]] = list(
        zip(zip(*given, strict=True), zip(*expected, strict=True), strict=True)
    )
    wrong = [k for k, (a, b) in enumerate(parts) if not all_near(a, b)]
    names = getattr(question.judge, "parts", ()) or getattr(calls[0].expected, "_fields", ())
    what, rest = "your answer", ""
    if not wrong:
        return ""
    if _only_at_rest(given, expected):
        return "Your answer is wrong only where nothing moves: before the start or from the end on."
    if len(parts) > len(wrong):
        what = "the wrong part of your answer"
        if len(names) == len(parts):
            what = "each of " * (len(wrong) > 1) + " and ".join(f"your `{names[k]}`" for k in wrong)
        rest = ", and the rest is right"
    by_name = [arguments(call, question.arguments) for call in calls]
    a, b = parts[wrong[0]] if len(wrong) == 1 else (_joined(x, wrong) for x in (given, expected))
    says = next(_relations(a, b, by_name, joined=len(wrong) > 1), "")
    return f"In every call {what} {says}{rest}." if says else ""


def _joined(answers: list[Parts], which: list[int]) -> list[Array]:
    return [np.concatenate([np.ravel(parts[k]) for k in which]) for parts in answers]


def _only_at_rest(given: list[Parts], expected: list[Parts]) -> bool:
    """Whether all calls with a wrong answer are at rest, while other calls are not."""
    still = [len(e) == 3 and not any(x.any() for x in e[1:]) for e in expected]
    right = [all_near(g, e) for g, e in zip(given, expected, strict=True)]
    return all(a or b for a, b in zip(still, right, strict=True)) and not all(still)


def _relations(
    a: Sequence[Array], b: Sequence[Array], given: Sequence[Mapping[str, Any]], joined: bool
) -> Iterator[str]:
    if not any(x.any() for x in b):
        return
    if not any(x.any() for x in a):
        yield "is zero"
    if (
        not a[0].ndim
        and len(a) > 1
        and all_near(a, [a[0]] * len(a))
        and not all_near(b, [b[0]] * len(b))
    ):
        yield f"is {float(a[0]):.5g}, whatever its arguments are"
    if all_near(a, [-x for x in b]):
        yield "has the other sign"
    if len({x.shape for x in b}) == 1 and b[0].ndim and not joined:
        yield from _exchanged_rows(a, b) if b[0].ndim == 2 else ()
        yield from _rows(a, b)
    moved = [(x, y, g) for x, y, g in zip(a, b, given, strict=True) if x.any() or y.any()]
    factors = list(filter(None, (factor(x, y) for x, y, _ in moved)))
    if 1 < len(factors) == len(moved):
        yield from _factors(np.array(factors), [g for _, _, g in moved])


def _exchanged_rows(a: Sequence[Array], b: Sequence[Array]) -> Iterator[str]:
    rows = range(len(b[0]))
    for order in permutations(rows) if len(rows) <= 6 else ():
        if order != tuple(rows) and all_near(a, [x[list(order)] for x in b]):
            yield f"has the right rows in another order ({', '.join(map(str, order))})"


def _rows(a: Sequence[Array], b: Sequence[Array]) -> Iterator[str]:
    """Relations in which only some components are wrong, all of them in the same manner."""
    for axis, kind in enumerate(("row", "column") if b[0].ndim == 2 else ("component",)):
        wrong = [
            k
            for k in range(b[0].shape[axis])
            if not all_near([np.take(x, [k], axis) for x in a], [np.take(x, [k], axis) for x in b])
        ]
        if not 0 < len(wrong) < b[0].shape[axis]:
            continue
        c, d = ([np.take(x, wrong, axis) for x in z] for z in (a, b))
        which = f"{kind}{'s' * (len(wrong) > 1)} {', '.join(map(str, wrong))}"
        be, have = ("are", "have") if len(wrong) > 1 else ("is", "has")
        if not any(x.any() for x in c):
            yield f"is right except for {which}, which {be} zero"
        if all_near(c, [-x for x in d]):
            yield f"is right except for {which}, which {have} the other sign"


def _factors(factors: Array, given: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    for words, value in _FACTORS.items():
        if np.allclose(factors, value, rtol=1e-6):
            yield f"is {words} times what it should be"
        if np.allclose(factors, 1.0 / value, rtol=1e-6):
            yield f"is what it should be, divided by {words}"
    if np.ptp(factors) > 1e-6 * np.abs(factors).max():
        for name in given[0]:
            x = [g[name] for g in given if name in g]
            if len(x) == len(given) and all(isinstance(y, float | int) and y > 0 for y in x):
                for words, power in _POWERS.items():
                    if np.allclose(factors, np.power(x, power), rtol=1e-6):
                        yield f"is what it should be, {words.format(name)}"
    else:
        yield f"is {factors[0]:.5g} times what it should be"
