"""Verdicts in words: the only place where results become sentences for students."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..control import COMMANDS
from ..errors import ControllerError, listed
from ..shapes import Array
from .judges import COMMITTED
from .question import Loop, Question, Test, Tuned, in_brief, in_points, is_shortened
from .source import name_in_notebook
from .verdict import Difference, Kind, Misconception, Outcome, TestResult, Value, Verdict

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
    elif untold(verdict):
        return f"{verdict.name}: taken. Whether it is right is told with your marks. {points}."
    elif verdict.outcome is Outcome.RIGHT and not verdict.complete:
        return (
            f"{verdict.name}: {says} on all cases here; {points} if the instructor's cases agree."
        )
    return f"{verdict.name}: {says}. {verdict.earned:g} of {points}."


def outcome_word(verdict: Verdict) -> str:
    """The words for a verdict's outcome; a valid prediction is committed, not right or wrong."""
    return "committed" if verdict.right and is_prediction(verdict) else HEADS[verdict.outcome]


def untold(verdict: Verdict) -> bool:
    """Whether nothing that carries points was tried, and nothing else is wrong."""
    return verdict.right and {t.outcome for t in verdict.tests if t.weight} == {Outcome.NOT_TRIED}


def is_prediction(verdict: Verdict) -> bool:
    """Whether the verdict is on a prediction, which earns its point for being made."""
    return [test.name for test in verdict.tests] == [COMMITTED]


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
        hints: Hints, from the idea to nearly the answer; only a card shows them, folded.
    """

    head: str
    helps: Sequence[str] = ()
    tests: Sequence[str] = ()
    numbers: Sequence[str] = ()
    printed: Sequence[str] = ()
    hints: Sequence[str] = ()

    def __str__(self) -> str:
        lines = [*self.helps, *self.tests]
        lines += ["Where it fails:", *(f"  {x}" for x in self.numbers)] if self.numbers else []
        lines += [PRINTED, *(f"  {x}" for x in self.printed)] if self.printed else []
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
    helps, hints = list[str](), question.hints
    if depends_on and verdict.outcome is not Outcome.RIGHT:
        is_, it = ("is", "it") if len(depends_on) == 1 else ("are", "them")
        helps.append(
            f"It uses your {listed(depends_on)}, which {is_} not right yet; correct {it} first."
        )
    tests, numbers = list[str](), list[str]()
    match verdict.outcome:
        case Outcome.NOT_ATTEMPTED:
            helps.append(f"To do: {question.asks}")
            hints = hints[:-1]  # the last one, which is nearly the answer, follows an attempt
        case Outcome.RIGHT:
            hints = ()
            helps += [] if verdict.complete else _unseen(question)
        case Outcome.NOT_COUNTED:
            it = "it" if len(verdict.withheld) == 1 else "them"
            helps.append(f"You may use {it} elsewhere in the notebook; here, write {it} yourself.")
        case _:
            helps += _helps(verdict, cure=cure)
            tests = [test_name(test, verdict) for test in verdict.tests]
            numbers = _numbers(question, verdict)
    return Message(head(verdict), helps, tests, numbers, _printed(printed), hints)


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
    """The difference in the first test that failed; None if a known mistake says more."""
    found = (test.difference for test in verdict.tests if test.difference)
    return None if verdict.mistake else next(found, None)


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


_COMMANDS = [kind.__name__ for kind in COMMANDS]
_NAME = re.compile(r"(?!it |there )\w+(:| is| has| seems) ")
"""The beginning of a sentence that starts with the name of a part, which is not capitalised."""

_MEASURES = {
    "max_mm": ("the largest error of the tip", " mm"),
    "rms_mm": ("the RMS error of the tip", " mm"),
    "max_deg": ("the largest error of the tip's orientation", " degrees"),
    "rms_velocity_mm_s": ("the RMS error of the tip's velocity", " mm/s"),
    "worst_mm": ("the worst error", " mm"),
    "end_mm": ("the error at the end", " mm"),
    "place_step_mm": ("the largest jump of the reference", " mm"),
    "speed_step": ("the largest jump of the reference's speed", " m/s"),
    "end_speed": ("the reference's speed at the end", " m/s"),
    "lines": ("the number of new lines", ""),
}
"""The measures of a run in words, and their units."""

_CAUSES = {
    -1.0: "has the other sign",
    math.degrees(1.0): "seems to be in degrees; use radians",
    1e3: "is a thousand times too large: millimetres for metres?",
    1e-3: "is a thousand times too small",
    2.0: "is twice what is expected",
    0.5: "is half of what is expected",
}
"""The likely cause of each factor by which all numbers are wrong."""


def sentence(d: Difference, start: str = "") -> str:
    """A difference as a sentence, after its ``start``, that tells a student where to begin."""
    text, expected, got, guess = words(d)
    if got and d.several:
        text = f"{text}it gives {got}. Expected: {expected}"
    elif got and d.at:
        text = f"{text}it gives {got} instead of {expected}"
    elif got and isinstance(d.expected, tuple) and isinstance(d.found, tuple):
        text = _farthest(d, np.array(d.expected), np.array(d.found))
    elif got:
        text = f"{d.part or 'it'} is {got} instead of {expected}"
    if guess:
        text = f"{d.part or 'it'} {guess}"
    says = f"{start}it{text}" if text.startswith(" ") else f"{start}{text}"
    if not (d.kind is Kind.CHANGED or _NAME.match(says)):
        says = says[:1].upper() + says[1:]
    return says if says.endswith((".", "?", "!", "`")) else f"{says}."


def _farthest(d: Difference, expected: Array, found: Array) -> str:
    at = tuple(map(int, np.unravel_index(np.argmax(np.abs(found - expected)), found.shape)))
    where = _index(at)
    of = f"{d.part}: " if d.part else ""
    should, is_ = _apart(float(expected[at]), float(found[at]))
    return f"{of}the number at {where} is farthest off: it is {is_} instead of {should}"


def _index(at: Sequence[float]) -> str:
    index = ", ".join(f"{k:g}" for k in at)
    return f"index {f'({index})' if len(at) > 1 else index}"


def words(d: Difference) -> tuple[str, str, str, str]:
    """The place of a difference, what was expected, what was returned, and a likely cause."""
    of = f"{_quoted(d.part)}: " if d.part else ""
    text = ""
    match d.kind:
        case Kind.NUMBERS:
            at = f"at {_index(d.at)} " if d.at else ""
            also = ", or any that moves the tip in the same way" if d.several else ""
            expected, found = _apart(d.expected, d.found)
            return f"{of}{at}", expected + also, found, likely_cause(d)
        case Kind.RESPONSE:
            return f"at {d.at[0]:g} rad/s ", _polar(d.expected), _polar(d.found), ""
        case Kind.MEASURE:
            what, unit = _MEASURES.get(d.part, (d.part.replace("_", " "), ""))
            found = f"{_much(d.found)}{unit}"
            if str(d.found) == "inf":  # the arm was lost, or the gains are beyond the recorded ones
                found = "infinite, because no error was recorded for gains as large as these"
            text = f"{what} is {found}; the limit is {_much(d.expected)}{unit}"
        case Kind.TYPE if not d.expected:
            text = f"{of}the answer should be plain numbers, not a {d.found}"
        case Kind.TYPE:
            text = f"{of}it should be a {d.expected}, not {_instead(d)}"
        case Kind.VALUE:
            text = f"{of}it should be {d.expected}, not {_brief(d.found)}"
        case Kind.KEY:
            text = f"the key {d.part!r} is missing"
        case Kind.PARTS:
            parts = f"{len(d.parts)} values ({', '.join(d.parts)})"
            text = f"{of}it should be {parts}, not {_brief(d.found)}"
        case Kind.NOTHING:
            text = "it returned nothing (None); does each of its branches end with a return?"
        case Kind.RAISED:
            found = str(d.found or d.error)
            run = re.sub("^controller ", "the controller ", found)  # from `run`: a whole sentence
            text = f" raised {found}" if found.startswith(d.error) else run
        case Kind.REFUSED | Kind.CHANGED:
            text = str(d.found or d.error)
        case Kind.OTHER:
            text = "the answer cannot be compared with the expected one"
    return text, "", "", ""


def _quoted(part: str) -> str:
    """The name of a part, in quotation marks if it is a sentence, such as a claim."""
    return f'"{part}"' if part.count(" ") > 1 else part


def likely_cause(d: Difference) -> str:
    """The likely cause of wrong numbers."""
    if d.times is None:
        return ""
    for factor, means in _CAUSES.items():
        if math.isclose(d.times, factor, rel_tol=1e-6):
            return means
    return ""


def _instead(d: Difference) -> str:
    """What was returned instead of the expected type, and how to make that type."""
    if d.found in _COMMANDS:
        return f"a {d.found}"
    what = _brief(d.found) or "plain numbers"
    if d.expected not in _COMMANDS:
        return what
    return f"{what}; return lk.{d.expected}(...) with one number for each joint"


def _apart(expected: Value, found: Value) -> tuple[str, str]:
    """Two values in short notation, with more digits if they would look the same."""
    pairs = [(_brief(expected, n), _brief(found, n)) for n in (0, 9, 12, 17)]
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])


def _brief(x: Value, digits: int = 0) -> str:
    if isinstance(x, float):
        return f"{x:.{digits or 6}g}" if abs(x) > 1e-10 else "0"
    return x if isinstance(x, str) else in_brief(x, digits or 5)


def _polar(x: Value) -> str:
    return f"{x[0]:.4g} at {x[1]:.4g} degrees" if isinstance(x, tuple) else str(x)


def _much(x: Value) -> str:
    return f"{x:.{'3g' if abs(x) < 1e3 else '0f'}}" if isinstance(x, float) else str(x)
