"""A verdict as sentences."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator

from .marking import Outcome, Verdict
from .question import Question, Test
from .withheld import spoken

WIDTH = 79
"""Of a line, in characters."""

HEADS = {
    Outcome.NOT_ATTEMPTED: "not attempted yet",
    Outcome.NOT_TRIED: "not tried here",
    Outcome.NOT_COUNTED: "not counted",
    Outcome.ERROR: "it stopped with an error",
    Outcome.WRONG: "not yet right",
    Outcome.RIGHT: "right",
}
"""What each outcome is called."""


_SHORT = {Outcome.RIGHT: "passed", Outcome.NOT_TRIED: "not tried here"}
"""Of tests of which no more is to be said."""


def head(verdict: Verdict) -> str:
    """The verdict in a line."""
    points = f"{verdict.points:g} point{'' if verdict.points == 1 else 's'}"
    says = HEADS[verdict.outcome]
    if verdict.withheld:
        says += f": {uses(verdict.withheld)}"
    elif verdict.outcome is Outcome.RIGHT and not verdict.complete:
        return f"{verdict.name}: {says} on all public cases; {points} if the hidden ones agree."
    return f"{verdict.name}: {says}. {verdict.earned:g} of {points}."


def uses(withheld: Iterable[str]) -> str:
    """Why an answer that uses withheld tools is not counted."""
    names = [spoken(tool) for tool in withheld]
    own = all("." in name for name in names)  # nobody is asked to write a whole package
    why = "this question asks you to write" if own else "may not be used in this answer"
    return f"uses {' and '.join(names)}, which {why}"


def tell(
    question: Question, verdict: Verdict, printed: str = "", leans_on: tuple[str, ...] = ()
) -> str:
    """Everything that a student is told.

    Args:
        question: What was asked.
        verdict: What came of it.
        printed: What the student's code wrote while it was tried.
        leans_on: Other answers that it uses, and that are not right.

    Returns:
        Lines of text, the verdict first.
    """
    lines = [head(verdict)]
    if verdict.outcome is Outcome.NOT_ATTEMPTED:
        lines.append(f"  To do: {question.asks}")
    elif verdict.outcome is Outcome.RIGHT:
        lines += [] if verdict.complete else _unseen(question)
    elif verdict.outcome is Outcome.NOT_COUNTED:
        lines.append("  Elsewhere in the notebook you may use it; here write it yourself.")
    else:
        lines += _results(question, verdict)
        if verdict.mistake is not None:
            lines.append(f"  This is a well-known one: {verdict.mistake.name}.")
            lines.append(f"  {verdict.mistake.says}")
    if leans_on and verdict.outcome is not Outcome.RIGHT:
        names = ", ".join(leans_on)
        lines.append(f"  Note: it uses your {names}, which is not right yet; mend that first.")
    lines += _printed(printed)
    if verdict.outcome is not Outcome.RIGHT and question.hints:
        lines.append(f'  Stuck? hint("{question.name}", 1) costs nothing, and nobody sees it.')
    return "\n".join(wrapped(line) for line in lines)


def _unseen(question: Question) -> Iterator[str]:
    """What a student's copy of a question leaves to the teacher's."""
    also = dict.fromkeys(test.also for test in question.tests if test.also)
    if also:
        yield f"  The teacher also tries: {'; '.join(also)}."
    for test in question.tests:
        if not test.cases:
            yield f"  Not tried here, and points hang on it: {test.name}."


def hint(question: Question, level: int) -> str:
    """One hint, and how to get the next; or that there is none of that number."""
    name, hints = question.name, question.hints
    if not isinstance(level, int) or not 1 <= level <= len(hints):
        return wrapped(
            f"{name} has {len(hints)} hints, and no hint {level!r}. If it does not work with all "
            "of them, ask the teacher or a forum; labkit submit-check --forum says what to send."
        )
    more = f'\n(hint("{name}", {level + 1}) says more)' if level < len(hints) else ""
    return wrapped(f"{name}, hint {level} of {len(hints)}: {hints[level - 1]}") + more


def wrapped(line: str) -> str:
    """A line folded where a notebook would otherwise break it within a word."""
    margin = " " * (len(line) - len(line.lstrip()))
    return textwrap.fill(line, WIDTH, subsequent_indent=f"{margin}  ", break_long_words=False)


def _results(question: Question, verdict: Verdict) -> list[str]:
    """Each test in a line; of one that failed also the call, and what came of it."""
    lines: list[str] = []
    said: set[str] = set()
    for test, result in zip(question.tests, verdict.tests, strict=True):
        gate = "" if result.weight else " (needed before anything counts)"
        if result.outcome in _SHORT:
            lines.append(f"  [{_SHORT[result.outcome]}] {result.name}{gate}")
            continue
        where, why = _split(question, test, result.says)
        short = f"  [failed] {result.name}{gate}: {where}{why}"
        if _again(why, said):
            lines.append(f"  [failed] {result.name}{gate}: the same")
        elif len(short) <= WIDTH:
            lines.append(short)
        else:
            lines.append(f"  [failed] {result.name}{gate}:")
            lines += [f"      {part}" for part in _parts(f"{where}{why}", verdict.mistake is None)]
        said.add(why)
    return lines


def _again(why: str, said: set[str]) -> bool:
    """Whether that was told before; a run stops as the single calls did, in the arm's words."""
    if why.startswith(" raised controller failed"):
        kinds = {text.split(":")[0].removeprefix(" raised ") for text in said if " raised " in text}
        return any(f": {kind}: " in why for kind in kinds)
    none = why.startswith(" raised ControllerError: controller returned") and bool(said)
    return none or (why in said and ", got " not in why)


def _split(question: Question, test: Test, says: str) -> tuple[str, str]:
    """What was tried, and what came of it."""
    for case in test.cases:
        where = case.shown(question.name)
        if says.startswith(where):
            return where, says.removeprefix(where)
    return "", says


def _parts(text: str, guess: bool) -> list[str]:
    """A call and two answers too long for a line: the answers below each other, and a guess why."""
    before, found, rest = text.partition("expected ")
    expected, got, given = rest.partition(", got ")
    if not (found and got):
        return [text]
    given, _, means = given.partition("; ")
    more = [f"({means})"] if means and guess else []
    return [before.rstrip(), f"  expected {expected}", f"  got      {given}", *more]


def _printed(text: str, most: int = 6) -> list[str]:
    lines = [line[:160] for line in text.splitlines() if line.strip()]
    if not lines:
        return []
    more = [f"    ... and {len(lines) - most} more lines"] if len(lines) > most else []
    return ["  While it was tried, your code printed:", *(f"    {x}" for x in lines[:most]), *more]
