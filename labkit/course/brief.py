"""Briefs, which are the texts above the places where students write a function or a why."""

from __future__ import annotations

import re
import unicodedata

from .question import Question, in_points

WORDS, WHY_POINTS = (25, 80), 2.0
"""The smallest and the largest number of words in a why, and its points."""
RUBRIC = (
    "2 points: the right cause, and how it leads to what you saw. 1 point: the right cause, but "
    "a step is missing or wrong. 0 points: another cause, or only a repetition of what you saw."
)
"""The rubric by which a person marks a why."""
PLACEHOLDER = "*Double-click here and write your text in place of this line.*"
"""The initial text of a why; nbgrader's settings have the same text."""


def words_of(text: str) -> list[str]:
    """The words that a reader sees, without placeholder, HTML comments and invisible characters."""
    text = re.sub(r"<!--(-?>|.*?(-->|\Z))", "", text.replace(PLACEHOLDER, ""), flags=re.DOTALL)
    return "".join(x for x in text if unicodedata.category(x) != "Cf").split()


def words_in_all(count: int) -> str:
    """A number of words with its unit, such as "1 word" or "30 words"."""
    return f"{count} word{'s' * (count != 1)}"


def brief_of_why(name: str, points: float, asks: str) -> str:
    """The text above a why, with its rubric."""
    least, most = WORDS
    head = f"**Why? `{name}`** · {in_points(points)} · {least} to {most} words of your own"
    return f"{head}\n\n{asks}\n\n<details><summary>How it is marked</summary>{RUBRIC}</details>"


def heading(does: str, name: str, points: float, core: bool) -> str:
    """The first line of a brief: what to do, for how many points, and whether it is core."""
    return f"**{does}: `{name}`** · {in_points(points)} · {'core' if core else 'extension'}"


def where_hints_are(name: str) -> str:
    """The line of a brief that tells students how to get a hint."""
    return f'- Stuck? `hint("{name}", 1)` in a new cell (Esc, B): it is free.'


def brief(question: Question) -> str:
    """The text above a stub: the task, the points, and what the answer may not use."""
    head = heading("Your turn", question.name, question.points, question.core)
    names = " or ".join(f"`{name.replace('labkit.', 'lk.')}`" for name in question.withheld)
    return f"{head}\n\n{question.asks}" + (f" Do not use {names}." if names else "")
