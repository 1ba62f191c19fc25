"""Release an assignment: prepare it, update the gradebook, write it, let nbgrader clear it.

nbgrader's own `generate_assignment` clears the answers, because nbgrader's autograde needs the
records that it keeps; this module prepares its input and verifies its result.  An author's mistakes
are reported before anything is written: the file, the question, and what to do.
"""

from __future__ import annotations

import ast
import re
import shutil
import traceback
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import nbformat

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course, check_outcomes
from ..course.authoring.problem import Problem
from ..course.authoring.release import Prepared, prepare, write
from ..course.notebook import BLANK, by_hand, grade_id, kind, manifest, nbgrader_info
from ..course.source import analyse, parsed
from ..errors import LabkitError
from .clean import how_many
from .gradebook import nbgrader_api, open_gradebook, reason
from .results import Results
from .roster import lay_arms

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
        folder: The students' copy.
        questions: The number of questions.
        points: The total of points.
        hidden: The number of hidden cases.
        by_hand: The points of each cell that a person marks, by its name.
        outdated: The number of submissions that were graded with another release.
    """

    name: str
    folder: Path
    questions: int
    points: float
    hidden: int
    by_hand: Mapping[str, float]
    outdated: int

    def __str__(self) -> str:
        by_hand = self.by_hand.items()
        lines = [
            f"{self.name}: {self.questions} questions, {self.points:g} points, "
            f"{self.hidden} hidden cases",
            *(f"to be marked by hand: {k}, {how_many(v, 'point')}" for k, v in by_hand),
        ]
        if self.outdated:
            lines.append(
                f"graded with another release: {how_many(self.outdated, 'submission')}; "
                f"type: labkit grade {self.name}, and with --lower if a mark is then kept"
            )
        return "\n  ".join(lines)


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
    _refuse_other_questions(course, made)
    write(made)
    generate(course, name)
    _verify(course.release / name)
    lay_arms(course, name)
    questions = made.questions.values()
    hidden = sum(case.hidden for q in questions for t in q.tests for case in t.cases)
    by_hand = {m["grade_id"]: m["points"] for m in manifest(made.source) if "points" in m}
    points = sum(q.points for q in questions) + sum(by_hand.values())
    bundle = Bundle.of(course, name)
    outdated = sum(
        result.hashes["bundle"] != bundle.of_student(result.student).data["hash"]
        for result in Results(course, name)
        if not result.rejected
    )
    return Released(name, course.release / name, len(questions), points, hidden, by_hand, outdated)


def _refuse_other_questions(course: Course, made: Prepared) -> None:
    """Raise a LabkitError if nbgrader would refuse the release, before anything is written."""
    named = {grade_id(cell) for cell in made.source.cells} - {""}
    with open_gradebook(course) as book:
        there = [one for one in book.assignments if one.name == made.name and one.num_submissions]
        known = {cell.name for one in there for x in one.notebooks for cell in x.source_cells}
    if there and (other := known ^ named):
        raise LabkitError(
            f"students have handed in {made.name}, so it takes no other questions now "
            f"({min(other)}); keep a question with 0 points, or wait for the next term"
        )


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
    """The prepared assignment, or an error that explains the author's mistake.

    Raises:
        LabkitError: The text, a problem, an answer or a known mistake must be corrected.
    """
    path = course.notebook_source(name)
    try:
        _check_types(path, course.problems(name))
        for problem in course.problems(name):
            check_outcomes(path.with_name("problems.py"), problem.name, problem.outcomes)
        for asked in course.predictions(name):
            outcomes = getattr(asked, "outcomes", ())  # a prediction has none
            check_outcomes(path.with_name("predictions.py"), asked.name, outcomes)
        made = prepare(course, name, seed)
    except (LabkitError, MemoryError):
        raise
    except Exception as error:
        raise LabkitError(_where(course, error)) from error
    if reasons := [*_unreadable(made), *_not_importable(made), *_sums(made)]:
        raise LabkitError("\n".join([f"{path.name}:", *reasons]))
    return made


def _check_types(path: Path, problems: object) -> None:
    """Raise a LabkitError unless PROBLEMS is a tuple of problems with points."""
    file = path.with_name("problems.py")
    if not isinstance(problems, tuple) or not all(isinstance(x, Problem) for x in problems):
        raise LabkitError(f"{file}: PROBLEMS has to be a tuple of Problem(...)")
    for problem in problems:
        points = problem.points
        if (
            isinstance(points, bool)
            or not isinstance(points, int | float)
            or not 0 <= points <= 1000
        ):
            raise LabkitError(f"{file}: {problem.name} has points={points!r}; give it 0 or more")


def _where(course: Course, error: Exception) -> str:
    """Where in the course's own files an exception arose, in which question, and its message."""
    said = f"{type(error).__name__}: {error}"
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}, line {error.lineno}: {said}; correct it"
    place, question = "", ""
    for frame, line in traceback.walk_tb(error.__traceback__):
        file = Path(frame.f_code.co_filename)
        if file.is_relative_to(course.root / "solutions"):
            place = f"{file}, line {line}"
        asked = frame.f_locals.get("self")
        question = asked.name if isinstance(asked, Problem) else question
    of = f"the question {question}: " if question else ""
    return f"{of}{place}{': ' * bool(place)}{said}; correct it"


def _unreadable(made: Prepared) -> Iterator[str]:
    """A sentence for each cell that Python cannot parse, so that no student could run it."""
    for number, cell in enumerate(made.source.cells, start=1):
        broken = analyse(cell.source)["broken"] if cell.cell_type == "code" else ""
        if broken:
            what = f"the stub of {grade_id(cell)}" if grade_id(cell) else f"cell {number}"
            yield f"{what} is not Python: {broken}"


def _not_importable(made: Prepared) -> Iterator[str]:
    """A sentence for each import in a stub or its solution that fails."""
    for cell in made.source.cells:
        if kind(cell) != "answer" or analyse(cell.source)["broken"]:
            continue
        nodes = list(ast.walk(parsed(cell.source)[1]))
        tried = {x for node in nodes if isinstance(node, ast.Try) for x in ast.walk(node)}
        for node in nodes:
            if isinstance(node, ast.Import | ast.ImportFrom) and node not in tried:
                try:
                    exec(ast.unparse(node), {"__name__": "stub"})
                except (Exception, SystemExit) as error:
                    says = ast.unparse(node)
                    yield f"the stub of {grade_id(cell)} says `{says}`: {error}; correct it"


def _sums(made: Prepared) -> Iterator[str]:
    """A sentence if the questions do not add up to the points that the first cell promises."""
    found = _POINTS.findall(made.source.cells[0].source) if made.source.cells else []
    manual = sum(float(nbgrader_info(x)["points"]) for x in made.source.cells if by_hand(x))
    points = sum(q.points for q in made.questions.values()) + manual
    if found and points not in map(float, found):
        yield f"the first cell says {found[0]} points, and the questions come to {points:g}"
