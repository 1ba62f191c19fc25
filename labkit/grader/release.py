"""Release an assignment: prepare it, make room in the gradebook, write it, let nbgrader clear it.

The answers are cleared by nbgrader's own `generate_assignment`, because its autograde needs the
records that it keeps; here it is only fed, and its result verified.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import nbformat

from ..course.layout import Course
from ..course.notebook import BLANK, manifest
from ..course.release import write
from ..errors import LabkitError
from .arms import lay_arms
from .authoring import prepared
from .gradebook import migrate
from .nbgrader_api import nbgrader_api, reason

FORBIDDEN = (
    "BEGIN SOLUTION",
    "BEGIN HIDDEN",
    '"hidden":true',
    "from solutions",
    "import solutions",
)
"""What no student's copy may hold."""


@dataclass(frozen=True)
class Released:
    """What one release made.

    Attributes:
        name: The assignment.
        folder: The students' copy.
        questions: How many.
        points: In all.
        hidden: How many hidden cases.
        by_hand: What a person marks: the name of each cell, and its points.
    """

    name: str
    folder: Path
    questions: int
    points: float
    hidden: int
    by_hand: Mapping[str, float]

    def __str__(self) -> str:
        return (
            f"{self.name}: {self.questions} questions, {self.points:g} points, "
            f"{self.hidden} hidden cases"
            + "".join(
                f"\n  to be marked by hand: {k}, {v:g} points" for k, v in self.by_hand.items()
            )
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
        LabkitError: `prepare` or nbgrader refused, an answer would have leaked, or marks given by
            hand would have been lost.
    """
    made = prepared(course, name, seed)
    added = migrate(course, name, made.source)  # once nothing of the author's can be refused
    write(made, added)
    generate(course, name)
    _verify(course.release / name)
    lay_arms(course, name)
    questions = made.questions.values()
    hidden = sum(case.hidden for q in questions for t in q.tests for case in t.cases)
    by_hand = {m["grade_id"]: m["points"] for m in manifest(made.source) if "points" in m}
    points = sum(q.points for q in questions) + sum(by_hand.values())
    return Released(name, course.release / name, len(questions), points, hidden, by_hand)


def generate(course: Course, name: str) -> None:
    """Let nbgrader make the students' copy of the files in its source folder."""
    shutil.rmtree(course.release / name, ignore_errors=True)
    api = nbgrader_api(course)
    result = api.generate_assignment(name, force=True, create=True)
    if not result["success"]:
        raise LabkitError(
            f"nbgrader could not make {name}: {reason(result)}; correct that and release it again"
        )
    path = course.release / name / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    source = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    for cell, original in zip(notebook.cells, source.cells, strict=True):
        cell["id"] = original["id"]
        cell["source"] = cell["metadata"].pop(BLANK, cell["source"])
    notebook.metadata = source.metadata
    nbformat.write(notebook, path)


def _verify(folder: Path) -> None:
    """Whatever nbgrader did: no answer and no hidden case may leave."""
    for path in folder.rglob("*"):
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        for word in FORBIDDEN:
            if word in text:
                shutil.rmtree(folder)
                raise LabkitError(f"{path.name} would have shown {word!r}; nothing released")
