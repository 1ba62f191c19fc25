"""Marking, which tries a function on the cases of a question and returns a verdict.

The function may run in this process or in another one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import repeat
from typing import Any, NamedTuple

import numpy as np

from ..errors import Diverged, LabkitError
from ..log import Log
from ..shapes import Array
from .advice import full_description
from .calling import NoAnswer, called
from .judges import AtMost, Close, Judge, as_expected, numbers, shares_error
from .question import Call, Case, Choice, Loop, Mistake, Question, Raised, Test, Tuned
from .verdict import Difference, Kind, Misconception, Outcome, TestResult, Verdict

Function = Callable[..., Any]


class PublicRun(NamedTuple):
    """A run of the arm on a case that the student can see.

    Attributes:
        test: The name of the test to which the run belongs.
        case: The case.
        log: The motion of the arm, up to the moment when it diverged, if it did.
        complete: Whether the run reached its end.
    """

    test: str
    case: Loop | Tuned
    log: Log
    complete: bool


class Mismatch(NamedTuple):
    """The expected and the returned numbers of one call.

    Attributes:
        call: The call as the student would type it.
        expected: All numbers of the expected answer, shape (n,).
        given: All numbers of the student's answer, shape (n,).
    """

    call: str
    expected: Array
    given: Array


@dataclass(frozen=True, eq=False)
class PublicResult:
    """The result of the public cases alone.

    Attributes:
        results: One for each test, from its public cases only.
        answers: The answer to each case that was tried.
        failing: The first call with a wrong answer, if there is one.
    """

    results: tuple[TestResult, ...]
    answers: Mapping[Case, Any]
    failing: Call | None = None

    @property
    def outcome(self) -> Outcome:
        """The outcome of all tests together."""
        return _outcome(self.results)

    def runs(self, question: Question) -> Iterator[PublicRun]:
        """The public runs of the arm, for replays."""
        for test in question.tests:
            for case in test.cases:
                answer = self.answers.get(case)
                log = answer.log if isinstance(answer, _Failure) else answer
                if isinstance(case, Loop | Tuned) and isinstance(log, Log):
                    yield PublicRun(test.name, case, log, complete=log is answer)

    def first_mismatch(self, question: Question) -> Mismatch | None:
        """The numbers of the first public call whose answer is wrong but has the right form."""
        for case in question.calls:
            answer: Any = self.answers.get(case)
            try:
                expected, given = numbers(case.expected), numbers(answer)
            except (TypeError, ValueError, OverflowError):
                continue
            same_form = expected.shape == given.shape and np.isfinite(given).all()
            if same_form and question.judge(answer, case.expected) is not None:
                return Mismatch(case.shown(question.name), expected, given)
        return None


def mark(question: Question, function: Function, tried: PublicResult | None = None) -> Verdict:
    """Try every test of a question, its public cases before any hidden one.

    The hidden cases of a test are tried if none of its public cases failed.

    Args:
        question: The question, with or without its hidden cases.
        function: The student's function, or one that calls it in another process and raises
            `NoAnswer` where that fails.
        tried: The result of the public cases, if they have been tried already.

    Returns:
        The verdict.  If a gate fails, no points are earned.
    """
    tried = tried or try_public(question, function)
    pairs = zip(question.tests, tried.results, strict=True)
    results = tuple(_try_hidden(question, test, result, function) for test, result in pairs)
    outcome, known = _outcome(results), None
    asked = all(call in tried.answers for call in question.calls)
    if outcome in (Outcome.WRONG, Outcome.ERROR) and asked:
        known = recognise(question, [tried.answers[call] for call in question.calls])
    verdict = Verdict(
        question.name,
        outcome,
        0.0,
        question.points,
        results,
        complete=question.complete,
        mistake=known and Misconception(known.name, known.says, known.cure),
    )
    return replace(verdict, earned=_earned(verdict))


def all_alike(question: Question, outcome: Outcome, kind: Kind | None = None) -> Verdict:
    """The verdict in which every test has the same outcome, and no points are earned."""
    why = None if kind is None else Difference(kind)
    tests = tuple(TestResult(t.name, t.weight, outcome, difference=why) for t in question.tests)
    return Verdict(question.name, outcome, 0.0, question.points, tests)


def not_counted(question: Question, tools: tuple[str, ...]) -> Verdict:
    """The verdict on an answer that is not tried, because its text uses withheld tools."""
    return replace(all_alike(question, Outcome.NOT_COUNTED), withheld=tools)


def try_public(question: Question, function: Function) -> PublicResult:
    """Try the public cases of every test.

    If one fails, all public calls are made, so that a known mistake can be recognised.
    """
    answers: dict[Case, Any] = {}
    results, failing = [], None
    for test in question.tests:
        cases = [case for case in test.cases if not case.hidden]
        results.append(_try(test, cases, question, function, answers))
        stopped = next(reversed(answers)) if results[-1].difference else None
        failing = failing or (stopped if isinstance(stopped, Call) else None)
    if _outcome(results) in (Outcome.WRONG, Outcome.ERROR):
        for call in question.calls:
            if call not in answers:
                answers[call] = ask(call, function)
    return PublicResult(tuple(_with_factors(question, results, answers)), answers, failing)


def _with_factors(
    question: Question, results: Sequence[TestResult], answers: Mapping[Case, Any]
) -> Iterator[TestResult]:
    """The results; a factor stays only if it holds in every public call where that part is wrong.

    One number of one call may be a multiple of another by chance.
    """
    wrong: dict[str, list[Difference]] = {}
    pairs = [(test, case) for test in question.tests for case in test.cases if case in answers]
    for test, case in pairs:
        found = _difference(question, test, case, answers[case])
        if found and isinstance(case, Call):
            wrong.setdefault(found.part, []).append(found)
    for result in results:
        d = result.difference
        if d is not None and d.times is not None:
            others = [x.times for x in wrong[d.part]]
            same = all(x is not None and np.isclose(x, d.times, rtol=1e-6) for x in others)
            if not same or (len(others) == 1 and isinstance(d.expected, float) and not d.at):
                result = replace(result, difference=replace(d, times=None))
        yield result


def _outcome(results: Sequence[TestResult]) -> Outcome:
    """The outcome of all tests together; a test that was not tried does not count.

    A stub is not attempted, although its hidden cases, which do not say how they failed, are wrong.
    """
    outcomes = {result.outcome for result in results}
    shown = {result.outcome for result in results if not result.hidden}
    if Outcome.NOT_ATTEMPTED in shown and not shown - {Outcome.NOT_ATTEMPTED, Outcome.NOT_TRIED}:
        return Outcome.NOT_ATTEMPTED
    if len(outcomes) > 1:
        outcomes.discard(Outcome.NOT_TRIED)
    if len(outcomes) == 1:
        return outcomes.pop()
    ranked = (Outcome.NOT_COUNTED, Outcome.WRONG)
    return next((worst for worst in ranked if worst in outcomes), Outcome.ERROR)


def recognise(question: Question, answers: list[Any]) -> Mistake | None:
    """The known mistake that gives exactly these answers to the public calls, or None.

    An answer that is right where a mistake is wrong is not that mistake, however close they are.
    """
    judge, expected = repeat(question.judge), [call.expected for call in question.calls]
    for mistake in question.mistakes:
        if answers and len(answers) == len(mistake.answers):
            known = map(as_expected, mistake.answers, expected)
            alike = all(map(_same, judge, answers, known))
            if alike and all(map(shares_error, judge, answers, mistake.answers, expected)):
                return mistake
    return None


def fingerprint(question: Question, function: Function) -> tuple[Any, ...]:
    """A function's answer to each public call, or `Raised` if it raises an exception."""
    given = [ask(case, called(function)) for case in question.calls]
    return tuple(Raised(a.kind) if isinstance(a, _Failure) else a for a in given)


@dataclass(frozen=True)
class _Failure(Raised):
    """An exception in place of an answer."""

    sentence: str
    log: Log | None = None


def ask(case: Case, function: Function) -> Any:
    """The function's answer to a case, or `Raised` in its place."""
    try:
        return case.ask(function)
    except (Exception, SystemExit) as error:  # exit() in a function must not end the notebook
        return _failure(error)


def _failure(error: BaseException) -> _Failure:
    """An exception from the student's code, or from the loop around it, in place of an answer."""
    cause = error.__cause__ if isinstance(error, LabkitError) and error.__cause__ else error
    kind = cause.kind if isinstance(cause, NoAnswer) else type(cause).__name__
    known = isinstance(error, NoAnswer) or (isinstance(error, LabkitError) and error.__cause__)
    sentence = str(error) if known else full_description(error)
    log = error.log if isinstance(error, Diverged) and isinstance(error.log, Log) else None
    return _Failure(kind, sentence, log)


_WRONG = {"ArgumentChanged": Kind.CHANGED, "NotComparable": Kind.REFUSED}
"""Exceptions that labkit raises about an answer, which is then wrong; others are errors."""


def _try_hidden(
    question: Question, test: Test, public: TestResult, function: Function
) -> TestResult:
    """The result of a test with its hidden cases, which are tried if no public one failed."""
    cases = [case for case in test.cases if case.hidden]
    failed = public.outcome not in (Outcome.RIGHT, Outcome.NOT_TRIED)
    return public if failed or not cases else _try(test, cases, question, function, {})


def _try(
    test: Test,
    cases: Sequence[Case],
    question: Question,
    function: Function,
    answers: dict[Case, Any],
) -> TestResult:
    """Try cases of one test until one fails; add the answers to the public ones to ``answers``."""
    outcome = Outcome.RIGHT if cases else Outcome.NOT_TRIED
    result = TestResult(test.name, test.weight, outcome, also=test.also)
    for case in cases:
        answer = ask(case, function)
        if not case.hidden:
            answers[case] = answer
        found = _difference(question, test, case, answer)
        if found is None:
            continue
        if case.hidden:  # how it failed would reveal the case to an attacker
            return replace(result, outcome=Outcome.WRONG, hidden=True)
        outcome, shown = _outcome_of(answer), case.shown(question.name)
        return replace(result, outcome=outcome, call=shown, difference=found)
    return result


def _outcome_of(answer: Any) -> Outcome:
    """The outcome of a test whose answer is not right."""
    if not isinstance(answer, _Failure) or answer.kind in _WRONG:
        return Outcome.WRONG
    if answer.kind == "NotImplementedError":
        return Outcome.NOT_ATTEMPTED
    return Outcome.ERROR


def _difference(question: Question, test: Test, case: Case, answer: Any) -> Difference | None:
    """How an answer differs from the expected one, or None."""
    if isinstance(answer, _Failure):
        kind = _WRONG.get(answer.kind, Kind.RAISED)
        return Difference(kind, found=answer.sentence, error=answer.kind)
    if answer is None and isinstance(case, Call | Choice):
        return Difference(Kind.NOTHING)
    try:
        if isinstance(case, Call):
            return _judge(question, test)(answer, case.expected)
        return AtMost()(case.measured(answer), case.expected)
    except LabkitError as error:
        return Difference(Kind.REFUSED, found=str(error))
    except Exception:  # comparing an odd answer may raise anything
        return Difference(Kind.OTHER)


def _judge(question: Question, test: Test) -> Judge:
    """The question's judge, limited to the part of the answer that the test looks at."""
    judge = question.judge
    return replace(judge, only=test.part) if test.part and isinstance(judge, Close) else judge


def _same(judge: Judge, answer: Any, known: Any) -> bool:
    kind, known_kind = (x.kind if isinstance(x, Raised) else None for x in (answer, known))
    if kind is not None or known_kind is not None:
        return kind == known_kind
    try:
        return judge.same(answer, known)
    except Exception:
        return False


def _earned(verdict: Verdict) -> float:
    if verdict.right:
        return float(verdict.points)
    failed = {test.outcome for test in verdict.tests if not test.weight}
    if failed - {Outcome.RIGHT, Outcome.NOT_TRIED} or verdict.outcome is Outcome.NOT_COUNTED:
        return 0.0
    right = sum(test.weight for test in verdict.tests if test.outcome is Outcome.RIGHT)
    return round(verdict.points * right / sum(test.weight for test in verdict.tests), 2)
