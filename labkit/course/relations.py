"""Relations between a wrong answer's numbers and the right ones that hold in every call."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations
from math import degrees, pi
from typing import Any

import numpy as np

from ..shapes import Array
from .judges import factor
from .probes import arguments
from .question import Call, Question

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
