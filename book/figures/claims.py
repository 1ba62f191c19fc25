"""The evidence for sentences of the book: the numbers they state and the conclusions they draw.

A sentence with a number shows one that was passed to `told`; a sentence with a comparison contains
the words of a `claim`, which has a check.  `told.json`, beside this file, has the values from when
somebody last read the sentences.  The build stops if they change.  `book/_tools/book_claims.py
--read` then stores the new values and prints those that changed.

A claim is worth something only if it can fail.  Therefore each check is also tried on wrong data:
with the opposite sign, at half the size, with the rows swapped, with all rows pooled.
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
"""The reports of the pages from their last run, in a file for each process."""
NEAR = 0.05
"""The relative change of a number that is allowed before its sentence must be read again."""

Numbers = tuple[float, ...]


class ConclusionFails(AssertionError):
    """Raised to stop the build if the runs no longer show what the prose says."""


def told(name: str, value: float) -> None:
    """Note a number of the prose.

    Args:
        name: The name that the prose uses for the number, unique in the whole book.
        value: The number.

    Raises:
        ConclusionFails: The number has changed since its sentence was read.
    """
    _note(name, (float(value),), lambda x: True)


def claim(conclusion: str, check: Callable[..., Any], **data: Any) -> None:
    """Note a conclusion of the prose.

    Args:
        conclusion: Words that the page contains exactly as they are given here.
        check: Called with ``data``; says whether the conclusion holds.
        data: The evidence for the conclusion, each item a number or a sequence of numbers.

    Raises:
        ConclusionFails: The conclusion does not hold, or its data have changed since the sentence
            was read.
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
        values: The number or numbers in the sentence.
        actual: The same numbers, computed by the code.
        near: The relative difference that rounding may cause.

    Raises:
        ConclusionFails: The numbers differ.
    """
    shown = [values] if isinstance(values, float | int) else list(values)
    x = [float(v) for v in (actual if isinstance(actual, Iterable) else [actual])]

    def agree(x: Sequence[float]) -> bool:
        pairs = zip(x, shown, strict=True)
        return all(math.isclose(a, b, rel_tol=near, abs_tol=1e-12) for a, b in pairs)

    claim(sentence, agree, x=x)


def mutations(x: Numbers) -> Iterator[tuple[str, Numbers]]:
    """Wrong data, made by changing the right ones."""
    yield "sign", tuple(-v for v in x)
    yield "half", tuple(0.5 * v for v in x)
    if len(x) > 1:
        mean = sum(x) / len(x)
        yield "swapped", (*x[1:], x[0])
        yield "pooled", (mean,) * len(x)


def near(x: Numbers, y: Numbers) -> bool:
    """Whether numbers have stayed the same."""
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
