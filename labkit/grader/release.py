"""Release an assignment: prepare it, update the gradebook, write it, let nbgrader clear it.

nbgrader's own `generate_assignment` clears the answers, because nbgrader's autograde needs the
records that it keeps; this module prepares its input and verifies its result.  An author's mistakes
are reported before anything is written: the file, the question, and what to do.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import nbformat

from ..course.authoring.layout import Course
from ..course.authoring.release import Prepared, prepare, write
from ..course.notebook import BLANK, grade_id, manifest
from ..course.source import analyse
from ..errors import LabkitError
from .gradebook import nbgrader_api, open_gradebook, reason

FORBIDDEN = (
    "BEGIN SOLUTION",
    "BEGIN HIDDEN",
    '"hidden":true',
    "from solutions",
    "import solutions",
)
"""Texts that no student's copy may contain."""
_POINTS = re.compile(r"([0-9.]+) points?\b")


@dataclass(frozen=True)
class Released:
    """The outcome of one release.

    Attributes:
        name: The assignment.
        questions: The number of questions.
        points: The total of points, which is the maximum that a platform needs.
        by_hand: The points of each cell that a person marks, by its name.
        handed_in: Whether students have handed it in.
    """

    name: str
    questions: int
    points: float
    by_hand: Mapping[str, float]
    handed_in: bool

    def __str__(self) -> str:
        by_hand = ", ".join(f"{k} {v:g}" for k, v in self.by_hand.items())
        says = f"{self.name}: {self.questions} questions, {self.points:g} points"
        says += f"; by hand: {by_hand}" if by_hand else ""
        return f"{says}\n{_IN_TERM.format(self.name)}" if self.handed_in else says


_IN_TERM = (
    "No mark has changed; to see those that would, type: labkit grade {} --diff. "
    "Students go on in their own notebook, with the new checks.json."
)
"""What becomes of marks and of notebooks that students have begun."""


def release(course: Course, name: str, seed: int) -> Released:
    """Make an assignment: for students, for nbgrader, for graders, and solved.

    Args:
        course: The course.
        name: The name of the assignment, such as "01_paths".
        seed: The seed of the hidden cases; use a secret one, as the repository's is public.

    Returns:
        The outcome.

    Raises:
        UnknownName: There is no such assignment.
        LabkitError: `prepare` or nbgrader refused, an answer would have leaked, or students have
            handed in and the questions are others now.
    """
    made = prepared(course, name, seed)
    handed_in = _refuse_other_questions(course, made)
    write(made)
    generate(course, name)
    _verify(course.release / name)
    by_hand = {m["grade_id"]: m["points"] for m in manifest(made.source) if "points" in m}
    return Released(name, len(made.questions), _points(made), by_hand, handed_in)


def _points(made: Prepared) -> float:
    by_hand = sum(m.get("points", 0.0) for m in manifest(made.source))
    return float(sum(q.points for q in made.questions.values()) + by_hand)


def _refuse_other_questions(course: Course, made: Prepared) -> bool:
    """Whether students have handed it in.

    Raises:
        LabkitError: nbgrader would refuse the release, because the questions are others now.
    """
    named = {grade_id(cell) for cell in made.source.cells} - {""}
    with open_gradebook(course) as book:
        there = [one for one in book.assignments if one.name == made.name and one.num_submissions]
        known = {cell.name for one in there for x in one.notebooks for cell in x.source_cells}
    if there and (other := known ^ named):
        raise LabkitError(
            f"students have handed in {made.name}, so it takes no other questions now "
            f"({min(other)}); keep a question with 0 points, or wait for the next term"
        )
    return bool(there)


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
    """Delete the release if it would show an answer or a hidden case."""
    for path in folder.rglob("*"):
        text = path.read_text(encoding="utf-8") if path.is_file() else ""
        for word in FORBIDDEN:
            if word in text:
                shutil.rmtree(folder)
                raise LabkitError(f"{path.name} would have shown {word!r}; nothing released")


def prepared(course: Course, name: str, seed: int) -> Prepared:
    """The prepared assignment.

    Raises:
        LabkitError: The text, a problem, an answer or a known mistake must be corrected.
    """
    path = course.notebook_source(name)
    made = prepare(course, name, seed)
    reasons = []
    for number, cell in enumerate(made.source.cells, start=1):
        if cell.cell_type == "code" and (why := analyse(cell.source)["broken"]):
            reasons.append(f"cell {number} {grade_id(cell)} is not Python: {why}")
    promised = _POINTS.findall(made.source.cells[0].source) if made.source.cells else []
    if promised and _points(made) not in map(float, promised):
        says = f"the first cell says {promised[0]} points, the questions come to {_points(made):g}"
        reasons.append(says)
    if reasons:
        raise LabkitError("\n".join([f"{path.name}:", *reasons]))
    return made
