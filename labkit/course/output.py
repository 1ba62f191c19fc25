"""A check's verdict as data in the output of its cell, for whoever reads the file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .marking import Outcome, Verdict

_KEY = "labkit"


def as_metadata(verdict: Verdict) -> dict[str, Any]:
    """The metadata of an output that shows a verdict."""
    return {
        _KEY: {
            "question": verdict.name,
            "outcome": verdict.outcome.value,
            "earned": verdict.earned,
            "points": verdict.points,
            "withheld": list(verdict.withheld),
            "complete": verdict.complete,
        }
    }


def verdict_in(output: Any) -> Verdict | None:
    """The verdict that an output of a notebook's file shows, or None."""
    try:
        data = output["metadata"][_KEY]
        return Verdict(
            str(data["question"]),
            Outcome(data["outcome"]),
            float(data["earned"]),
            float(data["points"]),
            withheld=tuple(map(str, data["withheld"])),
            complete=bool(data["complete"]),
        )
    except (KeyError, TypeError, ValueError, OverflowError):
        return None


def last_verdict(cells: Sequence[Mapping[str, Any]], question: str) -> Verdict | None:
    """The verdict that stands last in a notebook's file on a question, or None."""
    for cell in reversed(cells):
        outputs = cell.get("outputs")
        for output in outputs if isinstance(outputs, list) else ():
            verdict = verdict_in(output)
            if verdict is not None and verdict.name == question:
                return verdict
    return None
