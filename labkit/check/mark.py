"""Marking: put a question to a function and come to a verdict.

The function may live here or in another process; marking does not care.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any

from ..errors import LabkitError
from .judge import AtMost, Judge
from .question import Call, Case, Mistake, Question, Raised, Test


class Outcome(Enum):
    """What came of a question."""

    NOT_ATTEMPTED = "not attempted"
    ERROR = "error"
    WRONG = "wrong"
    RIGHT = "right"


class Failed(Exception):
    """A function in another process did not answer.

    Attributes:
        kind: The type of the exception there.
    """

    def __init__(self, kind: str, sentence: str) -> None:
        """What happened there."""
        self.kind = kind
        super().__init__(sentence)


@dataclass(frozen=True)
class TestResult:
    """What came of one test.

    Attributes:
        name: What it looked at.
        weight: Its share of the points; 0 is a gate.
        outcome: Never partly right.
        says: Why not right; empty where it is.
        hidden: Whether a hidden case decided; ``says`` then names its class only.
    """

    __test__ = False

    name: str
    weight: float
    outcome: Outcome
    says: str = ""
    hidden: bool = False


@dataclass(frozen=True, eq=False)
class Verdict:
    """What came of a question.

    Attributes:
        name: The question's.
        outcome: Right only if every test is.
        earned: Points.
        points: What full marks would be.
        tests: One result each.
        mistake: The known mistake that gives the same answers, if there is one.
        answers: What came back from each public call, for figures.
    """

    name: str
    outcome: Outcome
    earned: float
    points: float
    tests: tuple[TestResult, ...]
    mistake: Mistake | None = None
    answers: tuple[Any, ...] = ()


def mark(question: Question, function: Callable[..., Any]) -> Verdict:
    """Try every test of a question.

    Args:
        question: With its hidden cases, or without.
        function: The student's, or one that asks the student's in another process; that one raises
            `Failed`.

    Returns:
        The verdict.  Gates come first; without them nothing is earned.
    """
    answers: dict[int, Any] = {}
    results = tuple(_try(test, question, function, answers) for test in question.tests)
    outcomes = {result.outcome for result in results}
    if outcomes == {Outcome.NOT_ATTEMPTED}:
        outcome = Outcome.NOT_ATTEMPTED
    elif outcomes == {Outcome.RIGHT}:
        outcome = Outcome.RIGHT
    else:
        outcome = Outcome.WRONG if Outcome.WRONG in outcomes else Outcome.ERROR
    mistake = None
    if outcome in (Outcome.WRONG, Outcome.ERROR):
        for call in question.calls:
            if id(call) not in answers:
                answers[id(call)] = _answer(call, function)
        mistake = recognise(question, [answers[id(call)] for call in question.calls])
    return Verdict(
        name=question.name,
        outcome=outcome,
        earned=_earned(question, results),
        points=question.points,
        tests=results,
        mistake=mistake,
        answers=tuple(answers.get(id(call)) for call in question.calls),
    )


def recognise(question: Question, answers: list[Any]) -> Mistake | None:
    """The known mistake that gives just these answers on the public calls, if there is one."""
    for mistake in question.mistakes:
        if len(answers) == len(mistake.answers) and all(
            _same(question.judge, a, b) for a, b in zip(answers, mistake.answers, strict=True)
        ):
            return mistake
    return None


def fingerprint(question: Question, function: Callable[..., Any]) -> tuple[Any, ...]:
    """What a function gives on each public call; `Raised` where it raises."""
    given = (_answer(call, function) for call in question.calls)
    return tuple(Raised(a.kind) if isinstance(a, _Failure) else a for a in given)


@dataclass(frozen=True)
class _Failure(Raised):
    """An exception as an answer."""

    sentence: str
    not_attempted: bool = False


def _answer(case: Case, function: Callable[..., Any]) -> Any:
    try:
        return case.ask(function)
    except (Exception, SystemExit) as error:  # exit() in a function must not end the notebook
        return _failure(error)


def _failure(error: BaseException) -> _Failure:
    """What to say of an exception that came out of the student's code, or of the loop around it."""
    cause = error.__cause__ if isinstance(error, LabkitError) and error.__cause__ else error
    kind = cause.kind if isinstance(cause, Failed) else type(cause).__name__
    sentence = str(error) if isinstance(error, LabkitError | Failed) else f"{kind}: {error}"
    return _Failure(kind, sentence, not_attempted=kind == "NotImplementedError")


def _try(test: Test, question: Question, function: Callable[..., Any], answers: Any) -> TestResult:
    """Put the cases of one test, until one fails."""
    for case in test.cases:
        answer = _answer(case, function)
        if isinstance(case, Call) and not case.hidden:
            answers[id(case)] = answer
        where = f"a hidden case ({test.also})" if case.hidden else case.shown(question.name)
        if isinstance(answer, _Failure):
            outcome = Outcome.NOT_ATTEMPTED if answer.not_attempted else Outcome.ERROR
            says = f"{where} raised {answer.kind if case.hidden else answer.sentence}"
            return TestResult(test.name, test.weight, outcome, says, case.hidden)
        judge = question.judge if isinstance(case, Call) else AtMost()
        found = judge(answer, case.expected)
        if found is not None:
            says = where if case.hidden else f"{where}: {found}"
            return TestResult(test.name, test.weight, Outcome.WRONG, says, case.hidden)
    return TestResult(test.name, test.weight, Outcome.RIGHT)


def _same(judge: Judge, answer: Any, known: Any) -> bool:
    if isinstance(answer, Raised) or isinstance(known, Raised):
        return (
            isinstance(answer, Raised) and isinstance(known, Raised) and answer.kind == known.kind
        )
    return judge.same(answer, known)


def _earned(question: Question, results: tuple[TestResult, ...]) -> float:
    if any(r.weight == 0.0 and r.outcome is not Outcome.RIGHT for r in results):
        return 0.0
    whole = sum(r.weight for r in results)
    share = sum(r.weight for r in results if r.outcome is Outcome.RIGHT) / whole
    return round(question.points * share, 2)
