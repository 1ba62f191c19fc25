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

from ..errors import listed
from ..shapes import Array
from .judges import TipTorque, accepts, factor, numbers
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
    found = by_terms(question, tried.answers) or observed(question, tried.answers, function)
    return replace(verdict, mistake=found)


_PLAIN = {
    (0.0, 1.0): "is missing",
    (-1.0, 1.0): "has the other sign",
    (1.0, 0.0): "is added",
    (-1.0, 0.0): "is subtracted",
}
"""What is said of a found factor and the right one."""
MOST_WRONG = 4
"""The most terms that `by_terms` tells to be wrong; more say nothing to a student."""


def by_terms(question: Question, answers: Mapping[Any, Any]) -> Misconception | None:
    """Which terms of a law have another factor than the right one, in all public calls together.

    The answer's numbers are fitted by the law's terms, and by at most two that are taken for one.
    """
    calls = [call for call in question.calls if isinstance(call, Call) and call in answers]
    if not question.terms or len(calls) < len(question.terms[0].values):
        return None
    try:
        given = np.concatenate([_effect(call, answers[call]) for call in calls])
        columns = [
            np.concatenate([_effect(call, x) for call, x in zip(calls, term.values, strict=True)])
            for term in question.terms
        ]
    except (TypeError, ValueError):
        return None
    law = [k for k, term in enumerate(question.terms) if term.factor]
    others = [k for k, term in enumerate(question.terms) if not term.factor]
    for count in range(3):
        fits = [
            _factors_of(question, columns, given, [*law, *x]) for x in combinations(others, count)
        ]
        if told := [fit for fit in fits if 0 < len(fit) <= MOST_WRONG]:
            wrong = min(told, key=_plainness)
            return Misconception("", _says(wrong), _cure(wrong))
    return None


def _effect(call: Call, answer: Any) -> Array:
    """The numbers that count of an answer: of a torque that is judged at the tip, its effect."""
    found = numbers(answer)
    if isinstance(call.expected, TipTorque):
        return np.asarray(call.expected.accelerates @ found)
    if found.shape != numbers(call.expected).shape or not np.isfinite(found).all():
        raise ValueError("the answer has another form")
    return found


def _factors_of(
    question: Question, columns: Sequence[Array], given: Array, which: Sequence[int]
) -> dict[str, tuple[float, float]]:
    """The found and the right factor of each wrong term; empty if these terms do not fit."""
    A = np.stack([columns[k] for k in which], axis=1)
    size = np.linalg.norm(A, axis=0)
    if len(given) < 2 * len(which) or not size.all():
        return {}
    x, _, rank, _ = np.linalg.lstsq(A / size, given)
    if rank < len(which) or not _near((A / size) @ x, given):
        return {}
    pairs = zip([question.terms[k] for k in which], x / size, strict=True)
    return {t.name: (float(f), t.factor) for t, f in pairs if abs(f - t.factor) > 1e-4}


def _plainness(wrong: Mapping[str, tuple[float, float]]) -> tuple[int, int]:
    """How many terms are wrong, and how many of their factors are not whole."""
    return len(wrong), sum(abs(found - round(found)) > 1e-4 for found, _ in wrong.values())


def _says(wrong: Mapping[str, tuple[float, float]]) -> str:
    """How the terms of an answer differ from those of the law."""
    told = []
    for name, (found, right) in wrong.items():
        times = f"counts {found:.3g} times" if right else f"is added {found:.3g} times"
        plain = (k for k in _PLAIN if k[1] == right and abs(k[0] - found) < 1e-4)
        told.append(f"{name} {_PLAIN.get(next(plain, (2.0, 2.0)), times)}")
    return f"Compared with the law, in every call {listed(told)}."


def _cure(wrong: Mapping[str, tuple[float, float]]) -> str:
    """What to do about the terms of an answer."""
    once = [name for name, (_, right) in wrong.items() if right]
    never = [name for name, (_, right) in wrong.items() if not right]
    told = [f"The law has {listed(once)} once."] if once else []
    return " ".join([*told, *([f"Leave out {listed(never)}."] if never else [])])


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


def observed(
    question: Question, answers: Mapping[Case, Any], function: Function
) -> Misconception | None:
    """What is observed of a wrong answer in all calls; None if nothing explains it."""
    calls = [call for call in question.calls if isinstance(call, Call) and call in answers]
    if not calls or len(calls) < len(question.calls) or not question.arguments:
        return None
    given = [numeric_parts(answers[call]) for call in calls]
    expected = [numeric_parts(call.expected) for call in calls]
    if not any(expected):
        return None
    alike = all(map(same_form, given, expected))
    says = related(question, calls, given, expected) if alike else ""
    return Misconception("", says) if says else _exchanged(question, calls, function)


def _exchanged(
    question: Question, calls: Sequence[Call], function: Function
) -> Misconception | None:
    """Which change of its arguments, such as an exchange of two, makes the function right."""
    changed = [dict(exchanges(call, question.arguments)) for call in calls]
    for label in changed[0]:
        if all(
            label in one and accepts(question.judge, try_call(one[label], function), call.expected)
            for one, call in zip(changed, calls, strict=True)
        ):
            says = "In every call two arguments are exchanged, or one is transposed."
            cure = f"Your function is right if {label} before it is called."
            return Misconception("", says, cure)
    return None


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
