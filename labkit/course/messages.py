"""Verdicts in words: all sentences about a verdict are written here."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator

from ..control import COMMANDS
from ..errors import ControllerError
from .factors import likely_cause
from .forms import COMMITTED, OWN_ARM
from .question import Loop, Question, Test, Tuned, in_brief
from .verdict import Difference, Kind, Outcome, TestResult, Value, Verdict
from .withheld import spoken

WIDTH = 79
"""Longest line, in characters."""

HEADS = {
    Outcome.NOT_ATTEMPTED: "not attempted yet",
    Outcome.NOT_TRIED: "not tried here",
    Outcome.NOT_COUNTED: "not counted",
    Outcome.ERROR: "it stopped with an error",
    Outcome.WRONG: "not yet right",
    Outcome.RIGHT: "right",
}
"""The words for each outcome."""


_SHORT = {Outcome.RIGHT: "passed", Outcome.NOT_TRIED: "not tried here"}
"""The words for tests that need no explanation."""
_COMMANDS = [kind.__name__ for kind in COMMANDS]


def head(verdict: Verdict) -> str:
    """The verdict in one line."""
    points = f"{verdict.points:g} point{'' if verdict.points == 1 else 's'}"
    committed = verdict.right and [test.name for test in verdict.tests] == [COMMITTED]
    says = "committed" if committed else HEADS[verdict.outcome]
    if verdict.withheld:
        says += f": {uses(verdict.withheld)}"
    elif _waits(verdict):
        return f"{verdict.name}: a possible answer. When it is marked, it earns {points} if it is \
true of your own arm."
    elif verdict.outcome is Outcome.RIGHT and not verdict.complete:
        return f"{verdict.name}: {says} on all cases here; {points} if the teacher's cases agree."
    return f"{verdict.name}: {says}. {verdict.earned:g} of {points}."


def _waits(verdict: Verdict) -> bool:
    """Whether nothing can be said before it is marked: only there is the student's arm known."""
    right = verdict.outcome is Outcome.RIGHT and not verdict.complete
    return right and any(test.name == OWN_ARM for test in verdict.tests)


def uses(withheld: Iterable[str]) -> str:
    """Why an answer that uses withheld tools is not counted."""
    names = [spoken(tool) for tool in withheld]
    # a whole package is never what the student should write
    own = all("." in name for name in names)
    why = "this question asks you to write" if own else "may not be used in this answer"
    return f"uses {' and '.join(names)}, which {why}"


def tell(
    question: Question, verdict: Verdict, printed: str = "", leans_on: tuple[str, ...] = ()
) -> str:
    """Everything that a student reads after a check.

    Args:
        question: The question.
        verdict: The verdict on the answer.
        printed: What the student's code printed while it was tried.
        leans_on: Names of other answers that this one uses and that are not right.

    Returns:
        Lines of text, the verdict first.
    """
    lines = [head(verdict)]
    if verdict.outcome is Outcome.NOT_ATTEMPTED:
        lines.append(f"  To do: {question.asks}")
    elif verdict.outcome is Outcome.RIGHT:
        lines += [] if verdict.complete or _waits(verdict) else _unseen(question)
    elif verdict.outcome is Outcome.NOT_COUNTED:
        lines.append("  You may use it elsewhere in the notebook; here, write it yourself.")
    else:
        lines += _results(question, verdict)
        lines += _mistake(verdict)
    if leans_on and verdict.outcome is not Outcome.RIGHT:
        names = ", ".join(leans_on)
        lines.append(f"  Note: it uses your {names}, not right yet; correct {names} first.")
    lines += _printed(printed)
    if verdict.outcome is not Outcome.RIGHT and question.hints:
        call = f'hint("{question.name}", 1)'
        lines.append(f"  Stuck? Run {call} in a new cell (press Esc, then B). It is free.")
    return "\n".join(wrapped(line) for line in lines)


def summary(verdict: Verdict) -> list[str]:
    """A verdict for a teacher's page: its head, and after a failure each test and the mistake."""
    lines = [head(verdict)]
    if verdict.outcome in (Outcome.WRONG, Outcome.ERROR):
        lines += [f"  {line(test)}" for test in verdict.tests]
        lines += _mistake(verdict)
    return lines


def _mistake(verdict: Verdict) -> Iterator[str]:
    if verdict.mistake is not None:
        if verdict.mistake.name:
            yield f"  This mistake is a well-known one: {verdict.mistake.name}."
        yield f"  {verdict.mistake.says}"


def _unseen(question: Question) -> Iterator[str]:
    """What only the teacher's copy of a question tests."""
    also = dict.fromkeys(test.also for test in question.tests if test.also)
    if also:
        yield f"  The teacher also tries: {'; '.join(also)}."
    for test in question.tests:
        if not test.cases:
            yield f"  Not tried here, and points hang on it: {test.name}."


def wrapped(line: str) -> str:
    """A line folded where a notebook would otherwise break it within a word."""
    margin = " " * (len(line) - len(line.lstrip()))
    return textwrap.fill(line, WIDTH, subsequent_indent=f"{margin}  ", break_long_words=False)


GATE = " (needed before anything counts)"
_MEASURES = {
    "max_mm": ("the largest error of the tip", " mm"),
    "rms_mm": ("the RMS error of the tip", " mm"),
    "max_deg": ("the largest tilt of the tip", " degrees"),
    "rms_velocity_mm_s": ("the RMS error of the tip's speed", " mm/s"),
    "worst_mm": ("the worst error", " mm"),
}
"""Measures of a run in words, with their units."""


def line(test: TestResult) -> str:
    """A test in one line: whether it passed, and if it failed, on which case and why."""
    gate = "" if test.weight else GATE
    if test.outcome in _SHORT:
        return f"[{_SHORT[test.outcome]}] {test.name}{gate}"
    says = why(test)
    return f"[failed] {test.name}{gate}{says and f': {says}'}"


def why(test: TestResult) -> str:
    """On which case a test failed, and how; empty if there is nothing to say."""
    hidden = f"a hidden case ({test.also})" if test.also else "a hidden case"
    where = hidden if test.hidden else test.call
    if test.difference is None:
        return where
    before, expected, got, guess = _words(test.difference)
    text = f"{before}expected {expected}, got {got}{guess and f'; {guess}'}" if got else before
    return f"{where}{text if text[:1] == ' ' else f': {text}'}" if where else text.strip()


def _words(d: Difference) -> tuple[str, str, str, str]:
    """A difference in words: where it is, what was expected, what was returned, a likely cause."""
    of = f"{d.part}: " if d.part else ""
    text = ""
    match d.kind:
        case Kind.NUMBERS if d.expected is None:
            text = f"got {_brief(d.found)}, which is not one of the right values"
        case Kind.NUMBERS:
            index = ", ".join(f"{k:g}" for k in d.at)
            at = f"at index {f'({index})' if len(d.at) > 1 else index} " if d.at else ""
            also = ", or any that moves the tip alike" if d.several else ""
            return f"{of}{at}", _brief(d.expected) + also, _brief(d.found), likely_cause(d)
        case Kind.RESPONSE:
            return f"at {d.at[0]:g} rad/s ", _polar(d.expected), _polar(d.found), ""
        case Kind.MEASURE:
            what, unit = _MEASURES.get(d.part, (d.part.replace("_", " "), ""))
            text = f"{what} is {_much(d.found)}{unit}, allowed {_much(d.expected)}{unit}"
        case Kind.TYPE if not d.expected:
            text = f"{of}plain numbers are asked for, not a {d.found}"
        case Kind.TYPE:
            text = f"{of}it should be a {d.expected}, not {_instead(d)}"
        case Kind.VALUE:
            text = f"{of}it should be {d.expected}, not {_brief(d.found)}"
        case Kind.KEY:
            text = f"the key {d.part!r} is missing"
        case Kind.PARTS:
            parts = f"{len(d.parts)} things ({', '.join(d.parts)})"
            text = f"{of}it should be {parts}, not {_brief(d.found)}"
        case Kind.NOTHING:
            text = "it returned nothing (None); does every branch of it end in a return?"
        case Kind.RAISED:
            text = f" raised {d.found or d.error}"
        case Kind.REFUSED | Kind.CHANGED:
            text = str(d.found or d.error)
        case Kind.OTHER:
            text = "the answer cannot be compared with the expected one"
    return text, "", "", ""


def _instead(d: Difference) -> str:
    """What was returned instead of the type that was asked for, and how to make that type."""
    if d.found in _COMMANDS:
        return f"a {d.found}"
    what = _brief(d.found) or "plain numbers"
    if d.expected not in _COMMANDS:
        return what
    return f"{what}; return lk.{d.expected}(...) with one number for each joint"


def _brief(x: Value) -> str:
    if isinstance(x, float):
        return f"{x:.6g}" if abs(x) > 1e-10 else "0"
    return x if isinstance(x, str) else in_brief(x)


def _polar(x: Value) -> str:
    return f"{x[0]:.4g} at {x[1]:.4g} degrees" if isinstance(x, tuple) else str(x)


def _much(x: Value) -> str:
    return f"{x:.{'3g' if abs(x) < 1e3 else '0f'}}" if isinstance(x, float) else str(x)


def _results(question: Question, verdict: Verdict) -> list[str]:
    """Each test in a line; for one that failed also the call and what it returned."""
    lines: list[str] = []
    before: list[Difference] = []
    for test, result in zip(question.tests, verdict.tests, strict=True):
        short = f"  {line(result)}"
        failed = f"  [failed] {result.name}{'' if result.weight else GATE}:"
        difference = result.difference
        if difference is not None and _again(test, difference, before):
            lines.append(f"{failed} the same")
        elif len(short) <= WIDTH or result.outcome in _SHORT:
            lines.append(short)
        else:
            parts = _parts(result, verdict.mistake is None)
            lines += [failed, *(f"      {part}" for part in parts)]
        before += [difference] if difference else []
    return lines


def _again(test: Test, difference: Difference, before: list[Difference]) -> bool:
    """Whether the student has already read this: a run stops for the same reason as a call did."""
    if difference.kind is Kind.RAISED and any(isinstance(x, Loop | Tuned) for x in test.cases):
        if difference.error == ControllerError.__name__:
            return bool(before)
        return any(x.kind is Kind.RAISED and x.error == difference.error for x in before)
    return difference in before and not _words(difference)[2]


def _parts(test: TestResult, guess: bool) -> list[str]:
    """A call and two answers too long for a line: one below the other, and a likely cause."""
    start, expected, got, means = _words(test.difference) if test.difference else ("", "", "", "")
    if not got:
        return [why(test)]
    more = [f"({means})"] if means and guess else []
    return [f"{test.call}: {start}".rstrip(), f"  expected {expected}", f"  got      {got}", *more]


def _printed(text: str, most: int = 6) -> list[str]:
    lines = [line[:160] for line in text.splitlines() if line.strip()]
    if not lines:
        return []
    more = [f"    ... and {len(lines) - most} more lines"] if len(lines) > most else []
    return ["  While it was tried, your code printed:", *(f"    {x}" for x in lines[:most]), *more]
