"""From an assignment's source text to its notebooks.

In the source, a code cell with ``question="name"`` holds a stub whose solution region imports the
answer; ``setup=true`` marks cells that students should leave alone.  A brief before the stub and
the check after it are written here, from the question.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import nbformat

from ..errors import LabkitError
from . import Question
from .handin import defines
from .question_codec import pack_hidden

Notebook = Any
KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
END_HIDDEN = "### END HIDDEN TESTS\n"


def source_notebook(path: Path, questions: Mapping[str, Question]) -> Notebook:
    """The notebook that nbgrader takes as its source: solutions and hidden cases inside.

    Args:
        path: The source, in jupytext's percent format.
        questions: By name, hidden cases included.

    Raises:
        LabkitError: Stubs and questions do not match.
    """
    import jupytext  # slow to load, and only a release needs it

    text = jupytext.read(path, fmt="py:percent")
    cells: list[dict[str, Any]] = []
    asked: list[str] = []
    for cell in text.cells:
        name, setup = cell.metadata.get("question"), cell.metadata.get("setup", False)
        if name is None:
            kind = "setup" if setup else "walk"
            meta = _nbgrader(f"setup-{len(cells)}", locked=True) if setup else {}
            cells.append(_cell(cell.cell_type, cell.source, kind, meta))
            continue
        if name not in questions:
            raise LabkitError(f"{path.name} asks {name!r}, which has no Problem")
        question = questions[name]
        asked.append(name)
        _check_stub(path, name, cell)
        cells.append(_cell("markdown", brief(question), "brief", {}))
        cells.append(_cell("code", cell.source, "answer", _nbgrader(name, solution=True)))
        hidden = f'from labkit.course import also\n\nalso("{name}", "{pack_hidden(question)}")'
        check = f'### BEGIN HIDDEN TESTS\n{hidden}\n{END_HIDDEN}check("{name}", {name})'
        meta = _nbgrader(f"{name}-check", locked=True, grade=True, points=question.points)
        cells.append(_cell("code", check, "check", meta))
    for name in questions:
        if asked.count(name) != 1:
            raise LabkitError(f"{path.name} has {asked.count(name)} stubs of {name}, and needs one")
    for number, cell in enumerate(cells):
        cell["id"] = f"{path.stem.replace('_', '-')}-{number:02d}"
    meta = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    return nbformat.from_dict(
        {"cells": cells, "metadata": meta, "nbformat": 4, "nbformat_minor": 5}
    )


def without_hidden(source: str) -> str:
    """A cell's text as students have it."""
    return source.rpartition(END_HIDDEN)[2]


def _check_stub(path: Path, name: str, cell: Mapping[str, Any]) -> None:
    marks = [line.strip() for line in cell["source"].splitlines() if "### " in line]
    if marks != ["### BEGIN SOLUTION", "### END SOLUTION"]:
        raise LabkitError(
            f"{path.name}: the stub of {name} needs one region between a line ### BEGIN SOLUTION "
            "and a line ### END SOLUTION"
        )
    if not defines(cell, name):
        raise LabkitError(f"{path.name}: the stub of {name} defines no {name}")


def brief(question: Question) -> str:
    """What stands above a stub: the task, the points, how it is tried, what is withheld."""
    points = f"{question.points:g} point{'' if question.points == 1 else 's'}"
    lines = [f"**Your turn: `{question.name}`** · {points}", "", question.asks]
    also = list(dict.fromkeys(test.also for test in question.tests if test.also))
    gates = [test.name for test in question.tests if not test.weight]
    lines += ["", f"- Needed before anything counts: {'; '.join(gates)}."] if gates else [""]
    if also:
        lines.append(f"- Also tried when it is marked: {'; '.join(also)}.")
    if question.withheld:
        names = ", ".join(f"`{name.replace('labkit.', 'lk.')}`" for name in question.withheld)
        lines.append(f"- Write it yourself: {names} may not be used in the answer.")
    if question.hints:
        lines.append(f'- Stuck? `hint("{question.name}", 1)`: free, and nobody is told.')
    return "\n".join(lines)


def _cell(kind: str, source: str, lab: str, nbgrader: dict[str, Any]) -> dict[str, Any]:
    metadata: dict[str, Any] = {"lab": lab}
    if nbgrader:
        metadata |= {"nbgrader": nbgrader, "deletable": False}
        metadata["editable"] = not nbgrader["locked"]
    cell = {"cell_type": kind, "metadata": metadata, "source": source}
    return cell | ({"outputs": [], "execution_count": None} if kind == "code" else {})


def _nbgrader(grade_id: str, **flags: Any) -> dict[str, Any]:
    base = {"grade": False, "locked": False, "solution": False, "task": False}
    return {"schema_version": 3, "grade_id": grade_id, **base, **flags}
