"""The page of a defence: a side for the student, and one with the answers for the examiner."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from ...course.authoring.layout import DEFENCE, Course
from ...errors import LabkitError
from ..atomic import write
from ..feedback.page import error_over_time, measures, number_by_number
from ..nbgrader.gradebook import open_gradebook
from ..pages import file, render_page
from ..rules import read_rules
from .draw import ASKED, FULL, Asked, known

RUBRIC = (
    "says which line was changed, and what it was before",
    "says what the arm will do, or what is returned, before the answer is shown",
    "explains the picture by the line: which term, which sign, which frame",
)
"""The criteria for each question, at one point each."""
LINES = tuple(f"question_{k + 1}" for k in range(ASKED))
"""The names of the questions in the gradebook."""


def write_page(course: Course, student: str, asked: Sequence[Asked]) -> Path:
    """Write the page of a student, and return its file."""
    page = render_page(
        "defence.html.j2",
        file("defence.css"),
        replays=any(one.run and one.run["motion"] for one in asked),
        student=student,
        course=read_rules(course).name,
        asked=asked,
        rubric=RUBRIC,
        full=FULL,
        count=ASKED,
        command=f"labkit defence {shlex.quote(student)} --mark {','.join(['?'] * ASKED)}",
        error_over_time=error_over_time,
        rows=rows,
        number_by_number=number_by_number,
    )
    path = course.build / "defence" / f"{student}.html"
    write(path, page)
    return path


def rows(one: Asked) -> Iterator[tuple[str, str, str, str]]:
    """Each measure with a limit: its words, the value now, the value as handed in, the limit."""
    now, own = (
        {} if run is None else {x.words: x for x in measures(run)} for run in (one.run, one.own)
    )
    for words, row in (own | now).items():
        if row.limit:
            found, was = (t[words].value if words in t else "none" for t in (now, own))
            yield words, found, was, row.limit


def give_mark(course: Course, student: str, points: Sequence[int]) -> None:
    """Write the points of a defence that was held into the gradebook, a number for each question.

    Raises:
        LabkitError: There are too few or too many numbers, one is too high, or nobody is so called.
    """
    if len(points) != ASKED or not all(0 <= x <= FULL for x in points):
        raise LabkitError(f"give {ASKED} whole numbers from 0 to {FULL}, such as --mark 2,3,1")
    known(course, student)
    with open_gradebook(course) as book:
        book.update_or_create_assignment(DEFENCE)
        book.update_or_create_notebook(DEFENCE, DEFENCE)
        for name in LINES:
            about = {"max_score": FULL, "cell_type": "markdown"}
            book.update_or_create_grade_cell(name, DEFENCE, DEFENCE, **about)
        book.update_or_create_student(student)
        submission = book.update_or_create_submission(DEFENCE, student)
        for grade in (x for notebook in submission.notebooks for x in notebook.grades):
            grade.manual_score = float(points[LINES.index(grade.name)])
            grade.needs_manual_grade = False
        book.db.commit()
