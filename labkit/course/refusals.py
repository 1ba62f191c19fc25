"""What a release refuses: points that nobody works for, and mistakes that cannot be told apart.

A notebook says `use(question, answer, stand_in)`, and a stand-in must earn nothing.  Of all that
stands before it in the notebook only what the stand-in needs is run, so no arm moves and no figure
is drawn; the other answers are right there.
"""

from __future__ import annotations

import ast
import dis
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import CodeType
from typing import Any

from ..control import JointTorque
from .equivalence import Judge, TipTorque
from .judges import Within
from .marking import fingerprint, mark, recognise
from .notebook import Notebook
from .problem import Problem
from .question import Call, Question
from .reply import Here
from .serialize import encode
from .source import look, names_defined
from .verdict import Outcome
from .withheld import withheld_tools, withhold

USE = "def use(name, function, given, yours=None, **options):\n    return yours or function\n"
"""Takes the place of the notebook's, since the other parts are right."""


def refusals(
    source: Notebook, problems: Mapping[str, Problem], questions: Mapping[str, Question]
) -> list[str]:
    """Why an assignment should not be released, a sentence for each reason.

    Args:
        source: The notebook with its solution regions.
        problems: By name.
        questions: The same as questions, hidden cases included.
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
                f"{question.points:g} points and has no hidden case; give its Trial a maker of them"
            )
    most = problem.free_share * question.points
    earned = _earned(question, by_heart(question))
    if earned > most:
        yield (
            f"an answer that memorises its public cases earns {earned:g} of {question.points:g} "
            f"points; the problem's free_share allows {most:g}. Give the tests that "
            "pay hidden cases"
        )
    earned = 0.0 if text is None else _stand_in_earns(question, text)
    if earned > most:
        yield (
            "the stand-in that the notebook uses until a student has an answer, the third argument "
            f"of use(), earns {earned:g} of {question.points:g} points; the problem's free_share "
            f"allows {most:g}. Make the stand-in worse than the answer, or withhold the tool that "
            "it uses"
        )
    yield from _alike(question, problem)


def _alike(question: Question, problem: Problem) -> Iterator[str]:
    """Known mistakes that are not told from another one, or from a right answer."""
    for mistake in question.mistakes:
        other = recognise(question, list(mistake.answers))
        if other is not mistake:
            yield (
                f"its known mistakes {other and other.name!r} and {mistake.name!r} give the same "
                "answers on all public calls, so that one is taken for the other; change a number, "
                "add a call that tells them apart, or say both in one sentence"
            )
    right = recognise(question, list(fingerprint(question, problem.answer)))
    if right is not None:
        yield (
            f"its known mistake {right.name!r} gives the right answers on all public calls; "
            "change a number, or add a call that shows it"
        )


def by_heart(question: Question) -> Callable[..., Any]:
    """An answer that knows the public calls with their answers, and nothing else."""
    known = {
        _key(case.args, case.kwargs): _right(question.judge, case.expected)
        for case in question.calls
        if isinstance(case, Call)
    }

    def recite(*args: Any, **kwargs: Any) -> Any:
        """The answer from ``checks.json``; for any other call the first one."""
        return known.get(_key(args, kwargs), next(iter(known.values()), None))

    return recite


def _right(judge: Judge, expected: Any) -> Any:
    """A right answer, from what it is compared with."""
    if isinstance(expected, TipTorque):
        return JointTorque(expected.value)
    return sum(expected[0]) / 2.0 if isinstance(judge, Within) else expected


def _key(args: tuple[Any, ...], kwargs: Mapping[str, Any]) -> str:
    return json.dumps(encode([list(args), dict(kwargs)]))


def _stand_in_earns(question: Question, text: str) -> float:
    """What the stand-in is worth as an answer; withheld tools count nothing."""
    if withheld_tools([look(text)], question.name, question.withheld):
        return 0.0
    function = _run(question.name, text)
    with withhold(question.withheld, function.__globals__):
        return _earned(question, Here(function, question.withheld))


def _earned(question: Question, function: Callable[..., Any]) -> float:
    """Points, found quickly: where a gate fails the other tests are not tried."""
    gates = tuple(replace(test, weight=1.0) for test in question.tests if not test.weight)
    if gates and mark(replace(question, tests=gates), function).outcome is not Outcome.RIGHT:
        return 0.0
    return mark(question, function).earned


def stand_ins(source: Notebook) -> dict[str, str]:
    """The stand-in of each question that has one, as Python text that defines it by that name.

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
                    found[name] = _text(name, given, statements[:k])
    return found


def _run(name: str, text: str) -> Callable[..., Any]:
    """The function of that name which a text defines."""
    names: dict[str, Any] = {"__name__": f"the stand-in of {name}"}
    exec(text, names)
    function: Callable[..., Any] = names[name]
    return function


def _text(name: str, given: ast.expr, before: Sequence[ast.stmt]) -> str:
    """The stand-in as a function of its own, after all that it needs from what stands before."""
    call = f"return ({ast.unparse(given)})(*args, **kwargs)"
    parts = [f"def {name}(*args, **kwargs):\n    {call}\n"]
    wanted = set(_needs(parts[0]))
    for statement in reversed(before):
        if not wanted.isdisjoint({*names_defined(statement)} - {"use"}):
            parts.append(ast.unparse(statement))
            wanted.update(_needs(parts[-1]))
    return "\n\n".join([USE, *reversed(parts)])


def _needs(text: str) -> Iterator[str]:
    """The names that a statement takes from outside, its functions' bodies included."""
    waiting = [compile(text, "", "exec")]
    while waiting:
        code = waiting.pop()
        waiting += [x for x in code.co_consts if isinstance(x, CodeType)]
        yield from (
            x.argval for x in dis.get_instructions(code) if x.opname in ("LOAD_GLOBAL", "LOAD_NAME")
        )
