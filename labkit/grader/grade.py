"""Grade one notebook: read it, plan which cells run, call its functions, and mark the answers.

This side knows what is expected, and shares no process with the student's code.  Answers return
as plain data, which is read with limits.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Iterable, Mapping
from contextlib import closing, suppress
from dataclasses import replace
from typing import Any, cast

from ..course.authoring.bundle import Bundle
from ..course.handin import receipt
from ..course.marking import PublicResult, all_alike, mark, not_counted, try_public
from ..course.messages import why_not_counted
from ..course.question import Question
from ..course.serialize import read_record, record_data
from ..course.source import withheld_tools
from ..course.verdict import Kind, Outcome, Verdict
from . import evidence
from .clean import clean_data, clean_line, how_many
from .plan import Plan, plan
from .results import OTHER_NOTEBOOK, Answer, FailedCell, Hashes, OwnCell, Result, engine
from .sandbox.launch import Sandbox
from .sandbox.limits import MAX_TEXT, Limits, TextBudget
from .sandbox.protocol import Disconnected, ProtocolError
from .sandbox.session import RemoteFunction, Session
from .submission import digest

_STUDENT_TEXTS = {
    "cells": ("error", "output"),
    "own": ("source",),
    "written": ("written",),
    "questions": ("source", "found"),
}
"""The texts of a result that the student wrote; if there is too much, the last are cut."""


def grade(
    data: bytes,
    student: str,
    bundle: Bundle,
    sandbox: Sandbox,
    limits: Limits,
    note: str = "",
) -> Result:
    """Grade one notebook.

    Args:
        data: The contents of the file.
        student: The student who handed it in.
        bundle: The release that it is compared with.
        sandbox: Where its code runs.
        limits: What it may use.
        note: What was unusual about the file.

    Returns:
        The result; nothing that a notebook does raises an exception here.
    """
    began = time.perf_counter()
    bundle = bundle.of_student(student)
    cells = parse(data, sandbox, limits)
    if isinstance(cells, str):
        return rejection(cells, student, bundle, sandbox.level, data)
    todo = plan(cells, bundle.data["cells"])
    other = _other_notebook(cells, bundle)
    tools = {q.name: withheld_tools(todo.looks, q.name, q.withheld) for q in bundle.questions}
    absent = todo.emptied()
    questions = [q for q in bundle.questions if q.name not in absent and not tools[q.name]]
    with closing(Session(sandbox, todo.steps, limits)) as session:
        with suppress(Disconnected):
            session.start()
        functions = [RemoteFunction(question, session) for question in questions]
        tried = {function.question.name: _try_public(function) for function in functions}
        failed = session.failed()  # what is shown of cells is fixed before the first hidden case
        verdicts = {
            name: _mark_safely(function, before)
            for function, (name, before) in zip(functions, tried.items(), strict=True)
        }
        spent, passed = session.spent, {*session.right}
    wrong = {k for k, v in verdicts.items() if v.outcome in (Outcome.WRONG, Outcome.ERROR)}
    result = replace(
        _ungraded(student, bundle, sandbox.level, data),
        score=round(sum(v.earned for v in verdicts.values()), 2),
        questions=tuple(
            _answer(
                question,
                verdicts.get(question.name) or _unasked_verdict(question, tools),
                tried.get(question.name),
                todo,
                todo.causes(question.name, wrong, passed),
            )
            for question in bundle.questions
        ),
        notes=(*filter(None, (note, other)), *todo.notes.get("", ())),
        cells=cast(tuple[FailedCell, ...], failed),
        own=cast(tuple[OwnCell, ...], todo.own),
        written=todo.written,
        seconds={"all": round(time.perf_counter() - began, 4), "student": round(spent, 4)},
        receipt=receipt(cell["source"] for cell in cells),
    )
    return _cut_to_budget(result)


def rejection(why: str, student: str, bundle: Bundle, level: str, data: bytes = b"") -> Result:
    """The result of a submission that cannot be graded."""
    return replace(_ungraded(student, bundle, level, data), rejected=clean_line(why))


def _cut_to_budget(result: Result) -> Result:
    """The result with every text cleaned, and the student's texts cut to what a result may hold."""
    budget, data = TextBudget(), record_data(result)

    def cut(x: Any, names: Collection[str], theirs: bool) -> Any:
        if isinstance(x, str):
            return budget.take(x) if theirs else x
        if isinstance(x, dict):
            order = sorted(x, key=lambda name: name != "source")  # source first
            return {name: cut(x[name], names, theirs or name in names) for name in order}
        return [cut(y, names, theirs) for y in x] if isinstance(x, list | tuple) else x

    for part, names in _STUDENT_TEXTS.items():
        data |= cut({part: data[part]}, names, theirs=False)
    note = f"only {MAX_TEXT // 10**6} MB of text is kept; cut short: {how_many(budget.cut, 'text')}"
    data["notes"] = [*data["notes"], *[note] * bool(budget.cut)]
    return read_record(Result, clean_data(data))


def _ungraded(student: str, bundle: Bundle, level: str, data: bytes) -> Result:
    return Result(
        bundle.data["assignment"],
        student,
        0.0,
        bundle.points,
        bundle.data["seed"],
        hashes(data, bundle),
        isolation=level,
    )


def hashes(data: bytes, bundle: Bundle) -> Hashes:
    """The hashes that identify what a result was made from."""
    return {"submission": digest(data), "bundle": bundle.data["hash"], "engine": engine()}


def parse(data: bytes, sandbox: Sandbox, limits: Limits) -> list[dict[str, Any]] | str:
    """The cells of a notebook, which a process of its own reads, or why it cannot be read."""
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


def _other_notebook(cells: list[dict[str, Any]], bundle: Bundle) -> str:
    """A sentence if most cells that nbgrader named are from another assignment, else ""."""
    named = {cell["grade_id"] for cell in cells} - {""}
    ours = named & {cell.get("grade_id") for cell in bundle.data["cells"]}
    if 2 * len(ours) >= len(named):
        return ""
    name = bundle.data["assignment"]
    return f"{OTHER_NOTEBOOK}: only {len(ours)} of the {len(named)} named cells are of {name}"


def _try_public(function: RemoteFunction) -> PublicResult:
    """Try the public cases, which come before all questions' hidden ones, so as to reveal none."""
    try:
        tried = try_public(function.question, function)
        if tried.outcome is Outcome.RIGHT:
            function.session.right.append(function.question.name)
        return tried
    except Exception:
        return PublicResult(_incomparable(function.question).tests, {})
    finally:
        function.session.close_question()


def _mark_safely(function: RemoteFunction, tried: PublicResult) -> Verdict:
    """Mark an answer, even one that is so odd that comparing it raises an exception."""
    question = function.question
    try:
        return mark(question, function, tried)
    except Exception:
        return _incomparable(question)
    finally:
        function.session.close_question()


def _unasked_verdict(question: Question, tools: Mapping[str, tuple[str, ...]]) -> Verdict:
    """The verdict on a question that was not tried: it uses a withheld tool, or has no answer."""
    if tools[question.name]:
        return not_counted(question, tools[question.name])
    return all_alike(question, Outcome.NOT_ATTEMPTED)


def _incomparable(question: Question) -> Verdict:
    """The verdict on a question whose answers cannot be compared."""
    return all_alike(question, Outcome.ERROR, Kind.OTHER)


def _answer(
    question: Question,
    verdict: Verdict,
    tried: PublicResult | None,
    todo: Plan,
    more: Iterable[str] = (),
) -> Answer:
    why = (f"it {why_not_counted(verdict.withheld)}",) if verdict.withheld else ()
    notes = tuple(map(clean_line, (*why, *todo.notes.get(verdict.name, ()), *more)))
    answer = Answer(verdict, notes, todo.source(verdict.name))
    if tried is None:
        return answer
    try:
        return replace(
            answer,
            runs=evidence.runs(question, tried),
            numbers=evidence.numbers(question, tried),
        )
    except Exception:  # the answer is too odd to be drawn
        return answer
