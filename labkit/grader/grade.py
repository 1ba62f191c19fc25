"""Grade one notebook: read it, plan what runs, ask its functions, reach the verdicts.

This side owns what is expected and shares no process with the student's code; what comes back is
plain data, read with limits.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from contextlib import closing, suppress
from dataclasses import replace
from typing import Any

from ..course.marking import Outcome, TestResult, Tried, Verdict, mark, not_counted, try_public
from ..course.messages import uses
from ..course.question import Question
from ..course.withheld_names import withheld_tools
from . import seen
from .clean import clean_line
from .plan import Plan, plan
from .results import Bundle, Result, digest, engine, versions
from .sandbox.launch import Sandbox
from .sandbox.limits import TRICKS, Limits, TextBudget
from .sandbox.protocol import Disconnected, ProtocolError
from .sandbox.session import RemoteFunction, Session

ADDED = (
    "this question came after the notebook was handed in, which does not have it; it counts 0 "
    "until the new notebook is handed in, into which `labkit merge` brings the work done so far"
)


def grade(
    data: bytes, student: str, bundle: Bundle, sandbox: Sandbox, limits: Limits, note: str = ""
) -> Result:
    """Grade one notebook.

    Args:
        data: The file.
        student: Whose.
        bundle: What it is held against.
        sandbox: Where its code runs.
        limits: What it may use.
        note: What was unusual about the file.

    Returns:
        The result, whatever the notebook does.
    """
    began = time.perf_counter()
    cells = parse(data, sandbox, limits)
    if isinstance(cells, str):
        return rejection(cells, student, bundle, sandbox.level, data)
    todo = plan(cells, bundle.data["cells"])
    absent = bundle.added - todo.places.keys()
    todo = replace(todo, notes={**todo.notes, **dict.fromkeys(absent, (ADDED,))})
    tools = {q.name: withheld_tools(todo.looks, q.name, q.withheld) for q in bundle.questions}
    questions = [q for q in bundle.questions if q.name not in absent and not tools[q.name]]
    with closing(Session(sandbox, todo.steps, limits)) as session:
        with suppress(Disconnected):
            session.start()
        functions = [RemoteFunction(question, session) for question in questions]
        tried = [_public(function) for function in functions]
        failed = session.failed()  # nothing shown of cells is made after the first hidden case
        verdicts = {
            function.question.name: _guarded(function, before)
            for function, before in zip(functions, tried, strict=True)
        }
        spent = session.spent
    result = replace(
        _ungraded(student, bundle, sandbox.level, data),
        score=round(sum(v.earned for v in verdicts.values()), 2),
        questions=tuple(
            _verdict(question, verdicts.get(question.name) or _untried(question, tools), todo)
            for question in bundle.questions
        ),
        notes=(*((note,) if note else ()), *todo.notes.get("", ())),
        cells=failed,
        own=todo.own,
        tricks=todo.tricks,
        seconds={"all": round(time.perf_counter() - began, 4), "student": round(spent, 4)},
    )
    return _shortened(result)


def rejection(why: str, student: str, bundle: Bundle, level: str, data: bytes = b"") -> Result:
    """The result of a submission that cannot be graded."""
    return replace(_ungraded(student, bundle, level, data), rejected=clean_line(why))


def _shortened(result: Result) -> Result:
    """The same with no more of the student's texts than a result has room for."""
    budget = TextBudget()

    def short(things: Iterable[Mapping[str, Any]], *keys: str) -> tuple[dict[str, Any], ...]:
        return tuple({**x, **{key: budget.take(x[key]) for key in keys}} for x in things)

    tricks = tuple(map(budget.take, result.tricks[:TRICKS]))
    more = len(result.tricks) - TRICKS
    result = replace(
        result,
        tricks=(*tricks, f"and {more} more such things") if more > 0 else tricks,
        questions=tuple(
            {**x, "tests": list(short(x["tests"], "says"))}
            for x in short(result.questions, "source")
        ),
        cells=short(result.cells, "error", "output"),
        own=short(result.own, "source"),
    )
    if not budget.cut:
        return result
    note = f"there is more text than is kept; {budget.cut} of its pieces are cut short here"
    return replace(result, notes=(*result.notes, note))


def _ungraded(student: str, bundle: Bundle, level: str, data: bytes) -> Result:
    return Result(
        bundle.data["assignment"],
        student,
        0.0,
        bundle.points,
        isolation=level,
        versions=versions(),
        hashes=hashes(data, bundle),
        seed=bundle.data["seed"],
    )


def hashes(data: bytes, bundle: Bundle) -> dict[str, str]:
    """What a result is known by."""
    return {"submission": digest(data), "bundle": bundle.data["hash"], "engine": engine()}


def parse(data: bytes, sandbox: Sandbox, limits: Limits) -> list[dict[str, Any]] | str:
    """The cells of a notebook, read in a process of its own; or why there are none."""
    try:
        with sandbox.spawn("parse", limits, size=len(data)) as process:
            process.connection.socket.settimeout(limits.parse)
            with suppress(BrokenPipeError):  # an empty file is answered before it is sent
                process.connection.socket.sendall(data)
            found = process.connection.read(limits.parse)
    except (OSError, ProtocolError):
        return "the file cannot be read within the limits of time and memory"
    if "cells" not in found:
        return str(found.get("rejected", "the file cannot be read"))
    return list(found["cells"])


def _public(function: RemoteFunction) -> Tried:
    """The public cases.  All questions' come before any hidden one, so that none can tell of it."""
    try:
        tried = try_public(function.question, function)
        if tried.outcome is Outcome.RIGHT:
            function.session.right.append(function.question.name)
        return tried
    except Exception:
        return Tried(tuple(_lost(function.question)), {})
    finally:
        function.session.close_question()


def _guarded(function: RemoteFunction, tried: Tried) -> Verdict:
    """The verdict, even where an answer is so odd that comparing it fails."""
    question = function.question
    try:
        return mark(question, function, tried)
    except Exception:
        tests = tuple(_lost(question))
        return Verdict(question.name, Outcome.ERROR, 0.0, question.points, tests)
    finally:
        function.session.close_question()


def _untried(question: Question, tools: Mapping[str, tuple[str, ...]]) -> Verdict:
    """Of a question that was not asked: it uses what is withheld, or is not in the notebook."""
    if tools[question.name]:
        return not_counted(question, tools[question.name])
    tests = tuple(TestResult(t.name, t.weight, Outcome.NOT_ATTEMPTED) for t in question.tests)
    return Verdict(question.name, Outcome.NOT_ATTEMPTED, 0.0, question.points, tests)


def _lost(question: Question) -> list[TestResult]:
    says = "the answer cannot be compared with anything"
    return [TestResult(t.name, t.weight, Outcome.ERROR, says) for t in question.tests]


def _verdict(question: Question, verdict: Verdict, todo: Plan) -> dict[str, Any]:
    return {
        "name": verdict.name,
        "outcome": verdict.outcome.value,
        "earned": verdict.earned,
        "points": verdict.points,
        "tests": [
            {
                "name": t.name,
                "weight": t.weight,
                "outcome": t.outcome.value,
                "says": clean_line(t.says),
                "hidden": t.hidden,
            }
            for t in verdict.tests
        ],
        "withheld": list(verdict.withheld),
        "mistake": verdict.mistake and {"name": verdict.mistake.name, "says": verdict.mistake.says},
        "notes": [clean_line(note) for note in _notes(verdict, todo)],
        "source": todo.source(verdict.name),
        **_seen(question, verdict),
    }


def _notes(verdict: Verdict, todo: Plan) -> tuple[str, ...]:
    why = (f"it {uses(verdict.withheld)}",) if verdict.withheld else ()
    return (*why, *todo.notes.get(verdict.name, ()))


def _seen(question: Question, verdict: Verdict) -> dict[str, Any]:
    """What students may see of their work; nothing where it is too odd to be drawn."""
    try:
        return {"runs": seen.runs(question, verdict), "numbers": seen.numbers(question, verdict)}
    except Exception:
        return {"runs": [], "numbers": None}
