"""A result in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .results import Result


def line(result: Result) -> str:
    """A result in one line, for the person who grades."""
    if result.rejected:
        return f"{result.student}: rejected; {result.rejected}"
    return f"{result.student}: {result.score:g} of {result.points:g}"


def question_lines(question: Mapping[str, Any]) -> list[str]:
    """A question's verdict, the verdict first, then why."""
    outcome = {
        "not attempted": "not attempted",
        "error": "it stopped with an error",
        "wrong": "not yet right",
        "right": "right",
    }[question["outcome"]]
    lines = [
        f"{question['name']}: {outcome}. {question['earned']:g} of {question['points']:g} points."
    ]
    if question["outcome"] in {"wrong", "error"}:
        for test in question["tests"]:
            gate = "" if test["weight"] else " (needed before anything counts)"
            right = test["outcome"] == "right"
            says = "" if right else f": {test['says']}"
            lines.append(f"  [{'passed' if right else 'failed'}] {test['name']}{gate}{says}")
        if question["mistake"]:
            lines.append(f"  This is a well-known one: {question['mistake']['name']}.")
            lines.append(f"  {question['mistake']['says']}")
    lines += [f"  Note: {note}." for note in question["notes"]]
    return lines
