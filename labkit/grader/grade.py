"""Grade one notebook: read it, plan which cells run, call its functions, and mark the answers.

This side knows what is expected, and shares no process with the student's code.  Answers return
as plain data, which is read with limits.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from typing import TypeVar

from ..course.authoring.bundle import Bundle
from ..course.handin import receipt
from ..course.marking import PublicResult, all_alike, mark, not_counted, try_public
from ..course.messages import why_not_counted
from ..course.question import Question
from ..course.serialize import read_record, record_data
from ..course.source import withheld_tools
from ..course.verdict import Kind, Outcome, Verdict
from ..errors import LabkitError, listed
from . import evidence
from .clean import clean_data, clean_line
from .plan import Cell, plan
from .results import Answer, Result, engine
from .sandbox.launch import Sandbox
from .sandbox.limits import MAX_TEXT, Limits, TextBudget
from .sandbox.protocol import Disconnected
from .sandbox.session import RemoteFunction, Session
from .submission import digest

T = TypeVar("T")


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
    with closing(Session(sandbox, limits)) as session:
        try:
            cells = session.read(data)
            _refuse_other(cells, bundle)
            todo = plan(cells, bundle.data["cells"])
        except LabkitError as error:
            return rejection(str(error), student, bundle, sandbox.level, data)
        tools = {q.name: withheld_tools(todo.looks, q.name, q.withheld) for q in bundle.questions}
        unasked = todo.emptied() | {name for name, used in tools.items() if used}
        session.steps = todo.steps
        with suppress(Disconnected):
            session.start()
        functions = [RemoteFunction(q, session) for q in bundle.questions if q.name not in unasked]
        tried = {function.question.name: _try_public(function) for function in functions}
        failed = session.failed()  # what is shown of cells is fixed before the first hidden case
        verdicts = {f.question.name: _mark(f, tried[f.question.name]) for f in functions}
        spent = session.spent
    wrong = {q.name for q in bundle.questions} - {k for k, v in verdicts.items() if v.right}
    budget = TextBudget()

    def answer(question: Question) -> Answer:
        name = question.name
        verdict = verdicts.get(name) or _unasked(question, tools[name])
        notes = [todo.notes.get(name, "")]
        if tools[name]:
            notes.append(f"it {why_not_counted(tools[name])}")
        if verdict.outcome in (Outcome.WRONG, Outcome.ERROR):
            notes.append(_cause(todo.uses(name) & wrong - {name}))
        told = tuple(map(clean_line, filter(None, notes)))
        found = Answer(verdict, told, budget.take(todo.source(name)))
        return _with_evidence(found, question, tried[name]) if name in tried else found

    result = replace(
        _ungraded(student, bundle, sandbox.level, data),
        score=round(sum(verdict.earned for verdict in verdicts.values()), 2),
        questions=tuple(map(answer, bundle.questions)),
        written={name: budget.take(text) for name, text in todo.written.items()},
        own=tuple({**own, "source": budget.take(own["source"])} for own in todo.own),
        cells=tuple(
            {k: budget.take(v) if isinstance(v, str) else v for k, v in cell.items()}
            for cell in failed
        ),
        seconds={"all": time.perf_counter() - began, "student": spent},
        receipt=receipt(cell["source"] for cell in cells),
    )
    cut = f"only {MAX_TEXT // 10**6} MB of text is kept; cut short: {budget.cut}"
    result = replace(result, notes=tuple(filter(None, (note, cut if budget.cut else ""))))
    return read_record(Result, clean_data(record_data(result)))


def rejection(why: str, student: str, bundle: Bundle, level: str, data: bytes = b"") -> Result:
    """The result of a submission that cannot be graded."""
    return replace(_ungraded(student, bundle, level, data), rejected=clean_line(why))


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


def hashes(data: bytes, bundle: Bundle) -> dict[str, str]:
    """The hashes that identify what a result was made from."""
    return {"submission": digest(data), "bundle": bundle.data["hash"], "engine": engine()}


def _refuse_other(cells: Sequence[Cell], bundle: Bundle) -> None:
    """Refuse a notebook with none of the answers' cells, if most that have a name are unknown."""
    named = {cell["grade_id"] for cell in cells} - {""}
    ours = named & {cell.get("grade_id") for cell in bundle.data["cells"]}
    if 2 * len(ours) < len(named) and not named & {q.name for q in bundle.questions}:
        raise LabkitError(
            f"this looks like another assignment's notebook: only {len(ours)} of its {len(named)} "
            f"named cells are of {bundle.data['assignment']}"
        )


def _try_public(function: RemoteFunction) -> PublicResult:
    """Try the public cases, which come before all questions' hidden ones, so as to reveal none."""
    question = function.question
    odd = PublicResult(_incomparable(question).tests, {})
    tried = _safely(function, lambda: try_public(question, function), odd)
    if tried.outcome is Outcome.RIGHT:
        function.session.right.append(question.name)
    return tried


def _mark(function: RemoteFunction, tried: PublicResult) -> Verdict:
    """Mark an answer, whose public cases were tried."""
    question = function.question
    return _safely(function, lambda: mark(question, function, tried), _incomparable(question))


def _safely(function: RemoteFunction, step: Callable[[], T], otherwise: T) -> T:
    """What a step returns; ``otherwise`` if the answer is so odd that comparing it raises."""
    try:
        return step()
    except Exception:
        return otherwise
    finally:
        function.session.close_question()


def _incomparable(question: Question) -> Verdict:
    """The verdict on a question whose answers cannot be compared."""
    return all_alike(question, Outcome.ERROR, Kind.OTHER)


def _unasked(question: Question, tools: tuple[str, ...]) -> Verdict:
    """The verdict on a question that was not tried: it uses a withheld tool, or has no answer."""
    return not_counted(question, tools) if tools else all_alike(question, Outcome.NOT_ATTEMPTED)


def _cause(used: set[str]) -> str:
    """A note on an answer that uses others that are not right; empty if it uses none."""
    if not used:
        return ""
    is_, it = ("are", "them") if len(used) > 1 else ("is", "it")
    return f"it uses your {listed(sorted(used))}, which {is_} not right; correct {it} first"


def _with_evidence(answer: Answer, question: Question, tried: PublicResult) -> Answer:
    """The answer with what can be drawn of its public cases."""
    with suppress(Exception):  # it may be too odd to be drawn
        runs, numbers = evidence.runs(question, tried), evidence.numbers(question, tried)
        return replace(answer, runs=runs, numbers=numbers)
    return answer
