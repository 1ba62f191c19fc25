"""Authors' errors as sentences: the file, the question, what is wrong, and what to do."""

from __future__ import annotations

import re
import traceback
from collections.abc import Iterator
from pathlib import Path

from ..course.layout import Course
from ..course.notebook import about, by_hand, grade_id
from ..course.problem import Problem
from ..course.release import Prepared, prepare
from ..course.source import look
from ..errors import LabkitError

_POINTS = re.compile(r"([0-9.]+) points?\b")


def prepared(course: Course, name: str, seed: int) -> Prepared:
    """What `prepare` makes, or in one sentence why an author's mistake is in the way.

    Raises:
        LabkitError: The text, the problems, an answer or a known mistake must be corrected.
    """
    path = course.notebook_source(name)
    try:
        _check_types(path, course.problems(name))
        made = prepare(course, name, seed)
    except (LabkitError, MemoryError):
        raise
    except Exception as error:
        raise LabkitError(f"{name} is not released: {_where(course, error)}") from error
    if reasons := [*_unreadable(made), *_sums(made)]:
        raise LabkitError("\n".join([f"{name} is not released; {path.name}:", *reasons]))
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
    """The place of an exception in the course's own files, the question, and what it says."""
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
    return f"{of}{place or 'somewhere'}: {said}; correct it"


def _unreadable(made: Prepared) -> Iterator[str]:
    """Cells that Python cannot read, which no student could run."""
    for number, cell in enumerate(made.source.cells, start=1):
        broken = look(cell.source)["broken"] if cell.cell_type == "code" else ""
        if broken:
            what = f"the stub of {grade_id(cell)}" if grade_id(cell) else f"cell {number}"
            yield f"{what} is not Python: {broken}"


def _sums(made: Prepared) -> Iterator[str]:
    """Points that the first cell promises and the questions do not add up to."""
    found = _POINTS.findall(made.source.cells[0].source) if made.source.cells else []
    manual = sum(float(about(x)["points"]) for x in made.source.cells if by_hand(x))
    points = sum(q.points for q in made.questions.values()) + manual
    if found and points not in map(float, found):
        yield f"the first cell says {found[0]} points, and the questions come to {points:g}"
