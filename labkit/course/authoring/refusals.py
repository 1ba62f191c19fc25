"""Reasons to refuse a release: points without work, and mistakes that cannot be told apart.

A notebook calls `use(question, answer, stand_in)`, and a stand-in must earn nothing.  To try it,
only the earlier statements that the stand-in needs are run, so no arm moves and no figure is drawn;
the other answers in them are right.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pkgutil import resolve_name
from typing import Any

import numpy as np

from ...control import JointTorque
from ...errors import LabkitError
from ..calling import LocalFunction
from ..causes import by_terms
from ..judges import Judge, TipTorque, numbers
from ..marking import fingerprint, mark, recognise
from ..notebook import Notebook
from ..question import Call, Question, Raised
from ..serialize import encode
from ..source import analyse, needed, withheld_tools
from ..verdict import Outcome
from .layout import OUTCOMES
from .problem import Problem

USE = "def use(name, function, given, yours=None, **options):\n    return yours or function\n"
"""Replaces the notebook's `use`, because the other answers are right."""
STAND_IN = "the_stand_in"
"""The name of a stand-in while it is tried alone."""


def refusals(
    source: Notebook, problems: Mapping[str, Problem], questions: Mapping[str, Question]
) -> list[str]:
    """Why an assignment should not be released, a sentence for each reason.

    Args:
        source: The notebook with its solution regions.
        problems: The problems by name.
        questions: The questions that they become, with their hidden cases.
    """
    texts = stand_ins(source)
    return [
        f"{name}: {reason}"
        for name, problem in problems.items()
        for reason in _reasons(problem, questions[name], texts.get(name))
    ]


def _reasons(problem: Problem, question: Question, text: str | None) -> Iterator[str]:
    whole = sum(test.weight for test in question.tests)
    for test in question.tests:
        if test.weight and not any(case.hidden for case in test.cases):
            yield (
                f"the test {test.name!r} carries {question.points * test.weight / whole:g} of "
                f"{question.points:g} points and has no hidden case; give its Trial `hidden` cases"
            )
    earned = _earned(question, memorised(question))
    if earned > 0.0:
        yield (
            f"an answer that memorises its public cases earns {earned:g} of {question.points:g} "
            "points; add hidden cases to the tests that carry points"
        )
    earned = 0.0 if text is None else _stand_in_earns(question, text)
    if earned > 0.0:
        yield (
            f"the stand-in, the third argument of use(), earns {earned:g} of {question.points:g} "
            "points; make it worse than the answer, or withhold its tool"
        )
    for outcome in {*problem.outcomes} - {*OUTCOMES}:
        yield f"it has the outcome {outcome!r}; take one of {', '.join(OUTCOMES)}"
    for withheld in question.withheld:
        try:
            resolve_name(withheld)
        except (ImportError, AttributeError):
            yield f"it withholds {withheld}, which does not exist; correct the name"
    yield from _alike(question, problem)
    yield from _untold(question)


def _alike(question: Question, problem: Problem) -> Iterator[str]:
    """Reasons why a known mistake cannot be told from another one, or from a right answer."""
    for mistake in question.mistakes:
        failures = {_failure(x) for x in mistake.answers}
        if failures and "" not in failures:
            yield (
                f"its known mistake {mistake.name!r} {' or '.join(sorted(failures))} on each "
                "public call, so that any answer that does so would be taken for it; correct the "
                "mistake's function"
            )
        other = recognise(question, list(mistake.answers))
        if other is not mistake:
            yield (
                f"its known mistakes {other and other.name!r} and {mistake.name!r} give the same "
                "answers on all public calls; change a number, add a call, or write one for both"
            )
    right = recognise(question, list(fingerprint(question, problem.answer)))
    if right is not None:
        yield (
            f"its known mistake {right.name!r} gives the right answers on all public calls; "
            "change a number, or add a call that shows it"
        )


def _untold(question: Question) -> Iterator[str]:
    """Terms of the law which are not told if they count twice."""
    for term in question.terms:
        if term.factor:
            pairs = zip(question.calls, term.values, strict=False)
            twice = {call: numbers(call.expected) + numbers(x) for call, x in pairs}
            if by_terms(question, twice) is None:
                yield (
                    f"its term {term.name!r} is not told if it counts twice; let the terms add up "
                    "to the answer, and let each be in a public call without the others"
                )


def _failure(answer: Any) -> str:
    """What a known mistake does where it gives no answer, such as "raises NameError"; else ""."""
    if isinstance(answer, Raised):
        return f"raises {answer.kind}"
    try:
        given = numbers(answer)
    except (LabkitError, TypeError, ValueError):
        return ""
    return "returns NaN" if given.size and np.isnan(given).all() else ""


def memorised(question: Question) -> Callable[..., Any]:
    """An answer that only knows the answers to the public calls."""
    known = {
        _key(case.args, case.kwargs): _right(question.judge, case.expected)
        for case in question.calls
        if isinstance(case, Call)
    }

    def recite(*args: Any, **kwargs: Any) -> Any:
        """The answer from ``checks.json``; for an unknown call, the first answer there."""
        return known.get(_key(args, kwargs), next(iter(known.values()), None))

    return recite


def _right(judge: Judge, expected: Any) -> Any:
    """A right answer, made from the expected one."""
    if isinstance(expected, TipTorque):
        return JointTorque(expected.value)
    return expected


def _key(args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> str:
    return json.dumps(encode([list(args), dict(kwargs)]))


def _stand_in_earns(question: Question, text: str) -> float:
    """The points that the stand-in earns as an answer; none if it uses a withheld tool."""
    cell = analyse(text)  # the stand-in and what it calls
    if any(withheld_tools([cell], name, question.withheld) for name in cell["binds"]):
        return 0.0
    return _earned(question, LocalFunction(_run(text)))


def _earned(question: Question, function: Callable[..., Any]) -> float:
    """The points that a function earns; if a gate fails, the other tests are not tried."""
    gates = tuple(replace(test, weight=1.0) for test in question.tests if not test.weight)
    if gates and mark(replace(question, tests=gates), function).outcome is not Outcome.RIGHT:
        return 0.0
    return mark(question, function).earned


def stand_ins(source: Notebook) -> dict[str, str]:
    """The stand-in of each question that has one, as Python text that defines `STAND_IN`.

    Args:
        source: The notebook with its solution regions.
    """
    cells = (ast.parse(cell.source).body for cell in source.cells if cell.cell_type == "code")
    statements = [statement for body in cells for statement in body]
    found = {}
    for k, statement in enumerate(statements):
        for node in ast.walk(statement):
            match node:
                case ast.Call(ast.Name("use"), [ast.Constant(str() as name), _, given, *_]):
                    found[name] = _text(given, statements[:k])
    return found


def _text(given: ast.expr, before: Sequence[ast.stmt]) -> str:
    """The stand-in as a separate function, after the earlier statements that it needs."""
    made = f"def {STAND_IN}(*args, **kwargs):\n    return ({ast.unparse(given)})(*args, **kwargs)"
    source = "\n".join([*map(ast.unparse, before), made])
    return "\n\n".join([USE, *needed(source, STAND_IN, ["use"])])


def _run(text: str) -> Callable[..., Any]:
    """The stand-in that a text defines."""
    names: dict[str, Any] = {"__name__": STAND_IN}
    exec(text, names)
    function: Callable[..., Any] = names[STAND_IN]
    return function
