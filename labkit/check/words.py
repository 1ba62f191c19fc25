"""A verdict as sentences."""

from __future__ import annotations

import textwrap

from .mark import Outcome, TestResult, Verdict
from .question import Question

_HEADS = {
    Outcome.NOT_ATTEMPTED: "not attempted yet",
    Outcome.ERROR: "it stopped with an error",
    Outcome.WRONG: "not yet right",
    Outcome.RIGHT: "right",
}


def head(verdict: Verdict) -> str:
    """The verdict in a line."""
    return (
        f"{verdict.name}: {_HEADS[verdict.outcome]}. "
        f"{verdict.earned:g} of {verdict.points:g} points."
    )


def tell(
    question: Question, verdict: Verdict, printed: str = "", used: tuple[str, ...] = ()
) -> str:
    """Everything that a student is told.

    Args:
        question: What was asked.
        verdict: What came of it.
        printed: What the student's code wrote while it was tried.
        used: Withheld names that it uses.

    Returns:
        Lines of text, the verdict first.
    """
    lines = [head(verdict)]
    if verdict.outcome is Outcome.NOT_ATTEMPTED:
        lines.append(f"  To do: {question.asks}")
    elif verdict.outcome is Outcome.RIGHT:
        also = dict.fromkeys(test.also for test in question.tests if test.also)
        if also and not any(case.hidden for test in question.tests for case in test.cases):
            lines.append(f"  The teacher also tries: {'; '.join(also)}.")
    else:
        lines += [f"  {_line(result)}" for result in verdict.tests]
        if verdict.mistake is not None:
            lines.append(f"  This is a well-known one: {verdict.mistake.name}.")
            lines.append(f"  {verdict.mistake.says}")
    if used:
        names = ", ".join(used)
        lines.append(f"  Note: the question is to write this yourself, and your code uses {names}.")
    lines += _printed(printed)
    if verdict.outcome is not Outcome.RIGHT and question.hints:
        lines.append(f'  Stuck? hint("{question.name}", 1) costs nothing, and nobody sees it.')
    return "\n".join(wrapped(line) for line in lines)


def wrapped(line: str) -> str:
    """A line folded where a notebook would otherwise break it within a word."""
    margin = " " * (len(line) - len(line.lstrip()))
    return textwrap.fill(line, 79, subsequent_indent=f"{margin}  ", break_long_words=False)


def _line(result: TestResult) -> str:
    gate = "" if result.weight else " (needed before anything counts)"
    if result.outcome is Outcome.RIGHT:
        return f"[passed] {result.name}{gate}"
    return f"[failed] {result.name}{gate}: {result.says}"


def _printed(text: str, most: int = 6) -> list[str]:
    lines = [line[:160] for line in text.splitlines() if line.strip()]
    if not lines:
        return []
    more = [f"    ... and {len(lines) - most} more lines"] if len(lines) > most else []
    return ["  While it was tried, your code printed:", *(f"    {x}" for x in lines[:most]), *more]
