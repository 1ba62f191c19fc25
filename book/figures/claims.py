"""Sentences and what they rest on: the numbers they state, the conclusions they draw.

A sentence with a number shows one that `told` was given; a sentence with a comparison holds the
words of a `claim` with its check.  Both are kept in `told.json` beside this file as they were when
somebody last read the sentences, and the build stops when they move: `book/_tools/book_claims.py
--read` keeps them anew, and shows which moved.

What a claim says is worth something only if it could fail.  So each is tried on data that are
wrong: with the sign turned, at half the size, with the rows swapped, with all rows pooled.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

KEPT = Path(__file__).with_name("told.json")
FOUND = Path(__file__).parents[2] / "build/book/claims"
"""What the pages told when they were last run, a file for each process that ran one."""
NEAR = 0.05
"""How far a number may move, relative to itself, before its sentence must be read again."""

Numbers = tuple[float, ...]


class ConclusionFails(AssertionError):
    """The runs no longer show what the prose says; the build stops here."""


def told(name: str, value: float) -> None:
    """Note a number of the prose.

    Args:
        name: By which the prose asks for it, one in the whole book.
        value: The number.

    Raises:
        ConclusionFails: It is no longer what it was when its sentence was read.
    """
    _note(name, (float(value),), lambda x: True)


def claim(conclusion: str, check: Callable[..., Any], **data: Any) -> None:
    """Note a conclusion of the prose.

    Args:
        conclusion: Words that the page contains exactly as they are given here.
        check: Called with ``data``; whether the conclusion holds.
        data: What it is drawn from, each a number or a sequence of numbers.

    Raises:
        ConclusionFails: It does not hold, or its data are no longer what they were when the
            sentence was read.
    """
    kinds = {name: not isinstance(x, Sequence) for name, x in data.items()}
    sizes = {name: 1 if one else len(data[name]) for name, one in kinds.items()}
    flat = tuple(
        float(x) for name, one in kinds.items() for x in ([data[name]] if one else data[name])
    )

    def again(numbers: Numbers) -> bool:
        parts, at = {}, 0
        for name, one in kinds.items():
            part = numbers[at : at + sizes[name]]
            parts[name], at = (part[0] if one else part), at + sizes[name]
        return bool(check(**parts))

    if not again(flat):
        raise ConclusionFails(f"the text says: {conclusion}; the runs say otherwise: {data}")
    _note(conclusion, flat, again)


def shows(sentence: str, values: float | Sequence[float], actual: Any, near: float = 1e-9) -> None:
    """Bind a sentence to the numbers that it shows.

    Args:
        sentence: Words of the page, as for `claim`.
        values: The number or numbers, as the sentence has them.
        actual: What the code says they are.
        near: How far they may differ, relative to themselves: by rounding.

    Raises:
        ConclusionFails: They differ.
    """
    shown = [values] if isinstance(values, float | int) else list(values)
    x = [float(v) for v in (actual if isinstance(actual, Iterable) else [actual])]

    def agree(x: Sequence[float]) -> bool:
        pairs = zip(x, shown, strict=True)
        return all(math.isclose(a, b, rel_tol=near, abs_tol=1e-12) for a, b in pairs)

    claim(sentence, agree, x=x)


def mutations(x: Numbers) -> Iterator[tuple[str, Numbers]]:
    """Wrong data made of right ones."""
    yield "sign", tuple(-v for v in x)
    yield "half", tuple(0.5 * v for v in x)
    if len(x) > 1:
        mean = sum(x) / len(x)
        yield "swapped", (*x[1:], x[0])
        yield "pooled", (mean,) * len(x)


def near(x: Numbers, y: Numbers) -> bool:
    """Whether numbers are what they were."""
    return len(x) == len(y) and all(
        math.isclose(a, b, rel_tol=NEAR, abs_tol=1e-9) for a, b in zip(x, y, strict=True)
    )


def kept() -> Mapping[str, list[float]]:
    """The numbers and data as they were when somebody last read the sentences."""
    found: Mapping[str, list[float]] = json.loads(KEPT.read_text()) if KEPT.exists() else {}
    return found


def _note(name: str, x: Numbers, check: Callable[[Numbers], bool]) -> None:
    reading = os.environ.get("LAB_BOOK_READ") == "1"
    before = tuple(kept().get(name, x))
    if not reading and not near(x, before):
        raise ConclusionFails(
            f"{name!r} was {before} when its sentence was read and is {x} now: read the sentence "
            "again, then run python book/_tools/book_claims.py --read"
        )
    survived = [kind for kind, wrong in mutations(x) if near(wrong, x) and check(wrong)]
    blind = [kind for kind, wrong in mutations(x) if check(wrong)]
    FOUND.mkdir(parents=True, exist_ok=True)
    line = {"name": name, "data": x, "survived": survived, "check_alone": blind}
    with (FOUND / f"{os.getpid()}.jsonl").open("a") as file:
        file.write(json.dumps(line) + "\n")
