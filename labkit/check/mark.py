"""Marking: put a question to a function and come to a verdict.

The function may live here or in another process; marking does not care.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from ..errors import Diverged, LabkitError
from ..log import Log
from .cases import Call, Case, Choice, Loop, Tuned
from .judge import AtMost, Judge
from .question import Mistake, Question, Raised, Test
from .raised import told


class Outcome(Enum):
    """What came of a question."""

    NOT_ATTEMPTED = "not attempted"
    ERROR = "error"
    WRONG = "wrong"
    RIGHT = "right"


class Failed(LabkitError):
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
class Ran:
    """A run of the arm on a case that the student can see.

    Attributes:
        test: The name of the test that it belongs to.
        case: What was asked.
        log: What the arm did; up to the moment when it ran away, if it did.
        complete: Whether it came to its end.
    """

    test: str
    case: Loop | Tuned
    log: Log
    complete: bool


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
        runs: The public runs of the arm, for replays.
    """

    name: str
    outcome: Outcome
    earned: float
    points: float
    tests: tuple[TestResult, ...]
    mistake: Mistake | None = None
    answers: tuple[Any, ...] = ()
    runs: tuple[Ran, ...] = ()


@dataclass(frozen=True, eq=False)
class Tried:
    """What came of the public cases alone.

    Attributes:
        results: One for each test, as far as its public cases tell.
        answers: What came back from each case that was asked.
    """

    results: tuple[TestResult, ...]
    answers: Mapping[Case, Any]


def mark(question: Question, function: Callable[..., Any], tried: Tried | None = None) -> Verdict:
    """Try every test of a question, its public cases before any hidden one.

    Args:
        question: With its hidden cases, or without.
        function: The student's, or one that asks the student's in another process; that one raises
            `Failed`.
        tried: What came of the public cases, if they were tried already.

    Returns:
        The verdict.  Gates come first; without them nothing is earned.
    """
    tried = tried or try_public(question, function)
    results = tuple(
        result
        if result.outcome is not Outcome.RIGHT
        else _try(test, [c for c in test.cases if c.hidden], question, function, {})
        for test, result in zip(question.tests, tried.results, strict=True)
    )
    outcome, mistake = _outcome(question, results), None
    answers = [tried.answers.get(call) for call in question.calls]
    asked = all(call in tried.answers for call in question.calls)
    if outcome in (Outcome.WRONG, Outcome.ERROR) and asked:
        mistake = recognise(question, answers)
    return Verdict(
        name=question.name,
        outcome=outcome,
        earned=_earned(question, results),
        points=question.points,
        tests=results,
        mistake=mistake,
        answers=tuple(answers),
        runs=tuple(_runs(question, tried)),
    )


def _runs(question: Question, tried: Tried) -> Iterator[Ran]:
    for test in question.tests:
        for case in test.cases:
            answer = tried.answers.get(case)
            log = answer.log if isinstance(answer, _Failure) else answer
            if isinstance(case, Loop | Tuned) and isinstance(log, Log):
                yield Ran(test.name, case, log, complete=log is answer)


def try_public(question: Question, function: Callable[..., Any]) -> Tried:
    """Try the public cases of every test.

    Where one fails, all public calls are made, by which a known mistake can be told.
    """
    answers: dict[Case, Any] = {}
    results = tuple(
        _try(test, [c for c in test.cases if not c.hidden], question, function, answers)
        for test in question.tests
    )
    if _outcome(question, results) in (Outcome.WRONG, Outcome.ERROR):
        for call in question.calls:
            if call not in answers:
                answers[call] = _answer(call, function)
    return Tried(results, answers)


def _outcome(question: Question, results: tuple[TestResult, ...]) -> Outcome:
    """What the tests come to together; one without cases has nothing to say."""
    tried = zip(question.tests, results, strict=True)
    outcomes = {result.outcome for test, result in tried if test.cases}
    if len(outcomes) == 1:
        return outcomes.pop()
    return Outcome.WRONG if Outcome.WRONG in outcomes else Outcome.ERROR


def recognise(question: Question, answers: list[Any]) -> Mistake | None:
    """The known mistake that gives just these answers on the public calls, if there is one."""
    for mistake in question.mistakes:
        if (
            answers
            and len(answers) == len(mistake.answers)
            and all(
                _same(question.judge, a, b) for a, b in zip(answers, mistake.answers, strict=True)
            )
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
    log: Log | None = None


def _answer(case: Case, function: Callable[..., Any]) -> Any:
    try:
        return case.ask(function)
    except (Exception, SystemExit) as error:  # exit() in a function must not end the notebook
        return _failure(error)


def _failure(error: BaseException) -> _Failure:
    """What to say of an exception that came out of the student's code, or of the loop around it."""
    cause = error.__cause__ if isinstance(error, LabkitError) and error.__cause__ else error
    kind = cause.kind if isinstance(cause, Failed) else type(cause).__name__
    known = isinstance(error, Failed) or (isinstance(error, LabkitError) and error.__cause__)
    sentence = str(error) if known else told(error)
    log = error.log if isinstance(error, Diverged) and isinstance(error.log, Log) else None
    return _Failure(kind, sentence, log)


def _try(
    test: Test,
    cases: Iterable[Case],
    question: Question,
    function: Callable[..., Any],
    answers: dict[Case, Any],
) -> TestResult:
    """Put some cases of one test, until one fails."""
    for case in cases:
        answer = _answer(case, function)
        if not case.hidden:
            answers[case] = answer
        hidden = f"a hidden case ({test.also})" if test.also else "a hidden case"
        where = hidden if case.hidden else case.shown(question.name)
        if isinstance(answer, _Failure):
            stub = answer.kind == "NotImplementedError"
            outcome = Outcome.NOT_ATTEMPTED if stub else Outcome.ERROR
            says = f"{where} raised {answer.kind if case.hidden else answer.sentence}"
            return TestResult(test.name, test.weight, outcome, says, case.hidden)
        found = _difference(question, case, answer)
        if found is not None:
            says = where if case.hidden else f"{where}: {found}"
            return TestResult(test.name, test.weight, Outcome.WRONG, says, case.hidden)
    return TestResult(test.name, test.weight, Outcome.RIGHT)


def _difference(question: Question, case: Case, answer: Any) -> str | None:
    """How an answer differs from what is expected; None if it does not."""
    if answer is None and isinstance(case, Call | Choice):
        return "it gave nothing back (None); does every way through it end in a return?"
    if isinstance(case, Call):
        return question.judge(answer, case.expected)
    try:
        return AtMost()(case.measured(answer), case.expected)
    except LabkitError as error:
        return str(error)


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
