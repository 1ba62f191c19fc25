"""Release: from the course's sources to the students' notebooks.

The answers are cleared by nbgrader's own `generate_assignment`, because its autograde needs the
records that it keeps; here it is only fed, and its result verified.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat

from ..errors import LabkitError
from ..grader.migrate import make_room
from . import Question, question_data
from .layout import Course
from .notebook import Notebook, source_notebook, without_hidden
from .question_codec import pack_hidden
from .solved import solution_notebook
from .student import FILE
from .unearned import refusals
from .withheld import find

FORBIDDEN = ("BEGIN SOLUTION", "BEGIN HIDDEN", "from solutions", "import solutions")


@dataclass(frozen=True)
class Released:
    """What one release made.

    Attributes:
        name: The assignment.
        folder: The students' copy.
        questions: How many.
        points: In all.
        hidden: How many hidden cases.
    """

    name: str
    folder: Path
    questions: int
    points: float
    hidden: int

    def __str__(self) -> str:
        return (
            f"{self.name}: {self.questions} questions, {self.points:g} points, "
            f"{self.hidden} hidden cases"
        )


def release(course: Course, name: str, seed: int) -> Released:
    """Make an assignment: for students, for nbgrader, for graders, and solved.

    Args:
        course: The course.
        name: Of the assignment, such as "01_paths".
        seed: Of the hidden cases; keep your own, the repository's is public.

    Returns:
        What was made.

    Raises:
        UnknownName: No such assignment.
        LabkitError: nbgrader refused, an answer would have leaked, a question withholds what there
            is not, pays without work or takes one mistake for another, or marks given by hand would
            have been lost.
    """
    problems = {problem.name: problem for problem in course.problems(name)}
    questions = {key: problem.question(seed) for key, problem in problems.items()}
    for question in questions.values():
        for withheld in question.withheld:
            if find(withheld)[1] is None:
                raise LabkitError(f"{question.name} withholds {withheld}, which does not exist")
    source = source_notebook(course.notebook_source(name), questions)
    if reasons := refusals(source, problems, questions):
        raise LabkitError("\n".join([f"{name} is not released:", *reasons]))
    solved = solution_notebook(source, problems)
    public = _checks(name, [q.public() for q in questions.values()])
    added = make_room(course, name, source)  # once nothing of the author's can be refused any more
    _write(course.source / name, source, public)
    _write(course.solution / name, solved, public)
    _write_bundle(course, name, seed, source, questions, added)
    _generate(course, name)
    _verify(course.release / name, questions)
    hidden = sum(case.hidden for q in questions.values() for t in q.tests for case in t.cases)
    points = sum(q.points for q in questions.values())
    return Released(name, course.release / name, len(questions), points, hidden)


def manifest(source: Notebook) -> list[dict[str, Any]]:
    """What each cell is, in order: how a grader knows cells without trusting a submission."""
    return [
        {
            "id": cell.id,
            "type": cell.cell_type,
            "kind": cell.metadata["lab"],
            "grade_id": cell.metadata.get("nbgrader", {}).get("grade_id"),
            "source": without_hidden(cell.source),
        }
        for cell in source.cells
    ]


def _checks(name: str, questions: list[Question]) -> str:
    data = {"assignment": name, "questions": [question_data(q) for q in questions]}
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")) + "\n"


def _write(folder: Path, notebook: Notebook, checks: str) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    nbformat.write(notebook, folder / f"{folder.name}.ipynb")
    (folder / FILE).write_text(checks, encoding="utf-8")


def _write_bundle(
    course: Course,
    name: str,
    seed: int,
    source: Notebook,
    questions: Mapping[str, Question],
    added: Iterable[str],
) -> None:
    path = course.bundle / f"{name}.json"
    before = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    late = sorted({*before.get("added", ()), *added} & set(questions))
    data: dict[str, Any] = {
        "assignment": name,
        "seed": seed,
        "cells": manifest(source),
        "questions": [question_data(q) for q in questions.values()],
        **({"added": late} if late else {}),
    }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    data["hash"] = hashlib.sha256(text.encode()).hexdigest()
    course.bundle.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(data) + "\n", encoding="utf-8")


def _generate(course: Course, name: str) -> None:
    from ..grader.nbgrader_api import nbgrader_api, reason

    shutil.rmtree(course.release / name, ignore_errors=True)
    api = nbgrader_api(course)
    result = api.generate_assignment(name, force=True, create=True)
    if not result["success"]:
        raise LabkitError(
            f"nbgrader could not make {name}: {reason(result)}; mend that and release it again"
        )
    path = course.release / name / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    source = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    for cell, original in zip(notebook.cells, source.cells, strict=True):
        cell["id"] = original["id"]
    notebook.metadata = source.metadata
    nbformat.write(notebook, path)


def _verify(folder: Path, questions: Mapping[str, Question]) -> None:
    """Whatever nbgrader did: no answer and no hidden case may leave."""
    for path in folder.rglob("*"):
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        for word in (*FORBIDDEN, *(pack_hidden(q) for q in questions.values())):
            if word in text:
                shutil.rmtree(folder)
                raise LabkitError(f"{path.name} would have shown {word[:40]!r}; nothing released")
