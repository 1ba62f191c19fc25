"""The mark of a defence in nbgrader's gradebook: an assignment that only a person marks."""

from __future__ import annotations

from collections.abc import Sequence

from nbgrader.api import MissingEntry

from ...course.authoring.layout import DEFENCE, Course
from ...errors import LabkitError
from ..nbgrader.autograded_notebook import as_typed
from ..nbgrader.gradebook import open_gradebook
from ..nbgrader.unreleased import enter_tasks
from .draw import ASKED, FULL, Asked

LINES = tuple(f"question_{k + 1}" for k in range(ASKED))
"""The names of the questions in the gradebook."""
OWN_WORK = "Work of the student's own that you choose, as fewer functions were accepted."
"""The text of a question without an accepted function."""


def await_mark(course: Course, student: str, asked: Sequence[Asked]) -> None:
    """Enter a defence in the gradebook, to be marked by hand; a mark that was given stays."""
    texts = dict.fromkeys(LINES, OWN_WORK) | {
        LINES[k]: _text(k, one) for k, one in enumerate(asked)
    }
    with open_gradebook(course) as book:
        for grade in enter_tasks(course, book, DEFENCE, student, texts, FULL):
            grade.needs_manual_grade = grade.manual_score is None
        book.db.commit()


def give_mark(course: Course, student: str, points: Sequence[int]) -> None:
    """Write the points of a defence that was held, one number for each question.

    Raises:
        LabkitError: There are too few or too many numbers, one is too high, or no page was printed.
    """
    if len(points) != ASKED or not all(0 <= x <= FULL for x in points):
        raise LabkitError(
            f"{','.join(map(str, points))} is not a mark; give {ASKED} whole numbers from 0 to "
            f"{FULL}, such as --mark 2,3,1"
        )
    with open_gradebook(course) as book:
        try:
            submission = book.find_submission(DEFENCE, student)
        except MissingEntry:
            raise LabkitError(
                f"no page was printed for {student}; type: labkit defence {student}"
            ) from None
        for grade in (x for notebook in submission.notebooks for x in notebook.grades):
            grade.manual_score = float(points[LINES.index(grade.name)])
            grade.needs_manual_grade = False
        book.db.commit()


def _text(number: int, one: Asked) -> str:
    """A question as formgrader shows it."""
    head = f"**{number + 1} · {one.of.question.name}**, line {one.edit.at}: {one.edit.says}"
    change = f"handed in: {one.edit.was.strip()}\nnow:       {one.edit.now.strip()}"
    return "\n\n".join(
        (head, as_typed(change, "text"), as_typed("\n".join(one.edit.lines), "python"))
    )
