"""Verdicts in words; `differences` writes the sentences about what was found."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ..errors import ControllerError, listed
from .differences import likely_cause, sentence, words
from .forms import COMMITTED, OWN_ARM
from .question import Loop, Question, Test, Tuned, in_points, is_shortened
from .verdict import Difference, Kind, Misconception, Outcome, TestResult, Verdict
from .withheld import name_in_notebook

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


def head(verdict: Verdict) -> str:
    """The verdict in one line."""
    points = in_points(verdict.points)
    says = outcome_word(verdict)
    if verdict.withheld:
        says += f": {why_not_counted(verdict.withheld)}"
    elif awaits_marking(verdict):
        return (
            f"{verdict.name}: a possible answer. When it is marked, it earns {points} if it is "
            "right for your own arm."
        )
    elif verdict.outcome is Outcome.RIGHT and not verdict.complete:
        return (
            f"{verdict.name}: {says} on all cases here; {points} if the instructor's cases agree."
        )
    return f"{verdict.name}: {says}. {verdict.earned:g} of {points}."


def outcome_word(verdict: Verdict) -> str:
    """The words for a verdict's outcome; a valid prediction is committed, not right or wrong."""
    return "committed" if verdict.right and is_prediction(verdict) else HEADS[verdict.outcome]


def is_prediction(verdict: Verdict) -> bool:
    """Whether the verdict is on a prediction, which earns its point for being made."""
    return [test.name for test in verdict.tests] == [COMMITTED]


def awaits_marking(verdict: Verdict) -> bool:
    """Whether only marking can tell if the answer is right, because it depends on one's own arm."""
    right = verdict.outcome is Outcome.RIGHT and not verdict.complete
    return right and any(test.name == OWN_ARM for test in verdict.tests)


def why_not_counted(withheld: Iterable[str]) -> str:
    """Why an answer that uses withheld tools is not counted, as the end of a sentence about it."""
    names = [name_in_notebook(tool) for tool in withheld]
    # a whole package is never what the student should write
    own = all("." in name for name in names)
    why = "this question asks you to write" if own else "may not be used in this answer"
    return f"uses {listed(names)}, which {why}"


@dataclass(frozen=True)
class Message:
    """What a student reads after a check, in this order; `str` gives lines of text.

    Attributes:
        head: The verdict in one line.
        helps: The sentences that help most.
        tests: A line for each test.
        numbers: The calls that failed, what was expected, and how to repeat one of them.
        printed: What the student's code printed during the check.
        hint: How to get a hint.
    """

    head: str
    helps: Sequence[str] = ()
    tests: Sequence[str] = ()
    numbers: Sequence[str] = ()
    printed: Sequence[str] = ()
    hint: str = ""

    def __str__(self) -> str:
        lines = [*self.helps, *self.tests]
        lines += ["Where it fails:", *(f"  {x}" for x in self.numbers)] if self.numbers else []
        lines += [PRINTED, *(f"  {x}" for x in self.printed)] if self.printed else []
        lines += [self.hint] if self.hint else []
        return "\n".join(map(wrapped, [self.head, *(f"  {line}" for line in lines)]))


PRINTED = "While it was tried, your code printed:"
"""The line above what the student's code printed."""


def message(
    question: Question,
    verdict: Verdict,
    printed: str = "",
    depends_on: Sequence[str] = (),
    *,
    cure: bool = True,
) -> Message:
    """Everything that a student reads after a check.

    Args:
        question: The question.
        verdict: The verdict on the answer.
        printed: What the student's code printed while it was tried.
        depends_on: Names of the wrong answers that this one uses.
        cure: Whether to tell the cure of a known mistake, besides its cause.
    """
    helps, hint = list[str](), ""
    if verdict.outcome is not Outcome.RIGHT:
        if question.hints:
            call = f'hint("{question.name}", 1)'
            hint = f"Stuck? Run `{call}` in a new cell (press Esc, then B). It is free."
        if depends_on:
            is_, it = ("is", "it") if len(depends_on) == 1 else ("are", "them")
            helps.append(
                f"It uses your {listed(depends_on)}, which {is_} not right yet; correct {it} first."
            )
    tests, numbers = list[str](), list[str]()
    match verdict.outcome:
        case Outcome.NOT_ATTEMPTED:
            helps.append(f"To do: {question.asks}")
        case Outcome.RIGHT:
            helps += [] if verdict.complete or awaits_marking(verdict) else _unseen(question)
        case Outcome.NOT_COUNTED:
            it = "it" if len(verdict.withheld) == 1 else "them"
            helps.append(f"You may use {it} elsewhere in the notebook; here, write {it} yourself.")
        case _:
            helps += _helps(verdict, cure=cure)
            tests = [test_name(test, verdict) for test in verdict.tests]
            numbers = _numbers(question, verdict)
    return Message(head(verdict), helps, tests, numbers, _printed(printed), hint)


def summary(verdict: Verdict) -> list[str]:
    """A verdict for an instructor: its head, and after a failure also the mistake and each test."""
    lines = [head(verdict)]
    if verdict.outcome in (Outcome.WRONG, Outcome.ERROR):
        lines += [f"  {mistake(verdict.mistake)}"] if verdict.mistake else []
        lines += [f"  {test_line(test, verdict)}" for test in verdict.tests]
    return lines


def mistake(known: Misconception, *, cure: bool = True) -> str:
    """The name of a known mistake, its cause and, if it may be told, its cure."""
    parts = (mistake_name(known), known.says, known.cure if cure else "")
    return " ".join(filter(None, parts))


def mistake_name(known: Misconception) -> str:
    """A sentence with the name of a known mistake; "" if the mistake has no name."""
    return f"A well-known mistake: {known.name}." if known.name else ""


def failures(failed: int, of: int) -> str:
    """How many tests failed."""
    return f"{failed} of {of} test{'s' * (of != 1)} failed"


def _helps(verdict: Verdict, *, cure: bool) -> Iterator[str]:
    """What helps most: a known mistake, else a difference and its likely cause, if any."""
    if verdict.mistake:
        yield mistake(verdict.mistake, cure=cure)
    elif lead := _lead(verdict):
        test = next(x for x in verdict.tests if x.difference is lead)
        clear = len(test.call) <= 60 and not is_shortened(test.call)
        where = f"`{test.call}`" if clear else f'the test "{test.name}"'
        of_one_call = lead.kind is Kind.NUMBERS and not _is_value(test.call)  # others may differ
        run = f" This was {test.call}." if lead.kind is Kind.MEASURE else ""
        yield f"{sentence(lead, f'In {where}, ' if of_one_call else '')}{run}"


def _lead(verdict: Verdict) -> Difference | None:
    """The most informative difference; None if there is a known mistake, which says more."""
    found = [test.difference for test in verdict.tests if test.difference and not verdict.mistake]
    return next(filter(likely_cause, found), found[0] if found else None)


def _unseen(question: Question) -> Iterator[str]:
    """Sentences about what only the instructor's copy of a question tests."""
    also = dict.fromkeys(test.also for test in question.tests if test.also)
    if also:
        yield f"The instructor also tries: {'; '.join(also)}."
    for test in question.tests:
        if not test.cases:
            yield f"Not tried here, although it earns points: {test.name}."


def wrapped(line: str) -> str:
    """A line, folded at spaces so that a notebook does not break it within a word."""
    margin = " " * (len(line) - len(line.lstrip()))
    return textwrap.fill(line, WIDTH, subsequent_indent=f"{margin}  ", break_long_words=False)


def test_line(test: TestResult, verdict: Verdict) -> str:
    """A test in one line, which says whether it passed, and if it failed, on which case and why."""
    says = "" if test.outcome in _SHORT else why(test)
    return f"{test_name(test, verdict)}{says and f': {says}'}"


def test_name(test: TestResult, verdict: Verdict) -> str:
    """The name of a test, after its status in brackets, and what it is worth."""
    return f"[{test_status(test)}] {test.name}{worth(test, verdict)}"


def test_status(test: TestResult) -> str:
    """The status of a test: "passed", "failed" or "not tried here"."""
    return _SHORT.get(test.outcome, "failed")


def worth(test: TestResult, verdict: Verdict) -> str:
    """The points that a test is worth, or a remark that nothing counts without it."""
    if not test.weight:
        return " (needed before anything counts)"
    share = Fraction(test.weight / sum(x.weight for x in verdict.tests)).limit_denominator(1000)
    points = float(verdict.points * share)
    if abs(points - round(points, 2)) < 1e-6:
        return f" (worth {round(points, 2):g} of {in_points(verdict.points)})"
    return f" (worth {share} of the {in_points(verdict.points)})"


def why(test: TestResult) -> str:
    """On which case a test failed, and how; "" if neither is known."""
    hidden = f"a hidden case ({test.also})" if test.also else "a hidden case"
    where = hidden if test.hidden else test.call
    if test.difference is None:
        return where
    before, expected, got, guess = words(test.difference)
    text = f"{before}expected {expected}, got {got}{guess and f'; it {guess}'}" if got else before
    return f"{where}{text if text[:1] == ' ' else f': {text}'}" if where else text.strip()


def _numbers(question: Question, verdict: Verdict) -> list[str]:
    """The cases that failed, each difference once, and how to repeat such a call."""
    lines, before = list[str](), list[TestResult]()
    for test, result in zip(question.tests, verdict.tests, strict=True):
        if result.difference is not None:
            if not _again(test, result.difference, result.call, before):
                lines += _parts(result, result.difference is _lead(verdict))
            before.append(result)
    if any(is_shortened(test.call) for test in verdict.tests):
        name = question.name
        lines += ["To try the first call yourself:", f'  args, kwargs = lk.course.case("{name}")']
        lines.append(f"  {name}(*args, **kwargs)")
    return lines


def _again(test: Test, difference: Difference, call: str, before: list[TestResult]) -> bool:
    """Whether a difference repeats an earlier one, as when a run stops for a call's reason."""
    earlier = [(x.difference, x.call) for x in before]
    if difference.kind is Kind.RAISED and any(isinstance(x, Loop | Tuned) for x in test.cases):
        if difference.error == ControllerError.__name__:
            return bool(before)
        return any(x and x.kind is Kind.RAISED and x.error == difference.error for x, _ in earlier)
    numbers = words(difference)[2]  # the same ones may answer another call
    return any(x == difference and (called == call or not numbers) for x, called in earlier)


def _parts(test: TestResult, led: bool) -> list[str]:
    """A call with its expected and its actual answer, on lines of their own if they are long."""
    start, expected, got, _ = words(test.difference) if test.difference else ("", "", "", "")
    if not got:  # a sentence
        if not led:
            return [why(test)]
        said = test.difference and test.difference.kind is Kind.MEASURE  # with its call
        return [] if said or _is_value(test.call) else [test.call]
    short = f"{test.call}: {start}expected {expected}, got {got}"
    if len(short) < WIDTH - 4:
        return [short]
    return [f"{test.call}: {start}".rstrip(), f"  expected {expected}", f"  got      {got}"]


def _is_value(call: str) -> bool:
    """Whether it asks for a value that the student wrote down, which takes no arguments."""
    return call.endswith("()")


def _printed(text: str, most: int = 6, longest: int = 160) -> list[str]:
    lines = [line for line in text.splitlines() if line.strip()]
    lines = [x if len(x) <= longest else f"{x[: longest - 3]}..." for x in lines]
    more = [f"... and {len(lines) - most} more lines"] if len(lines) > most else []
    return [*lines[:most], *more]
