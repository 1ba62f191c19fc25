"""Whys: a person marks two of each student's; the others get full points if written.

Nobody knows before the deadline which two, because they are drawn under a key of the term.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from functools import partial
from typing import Any

from ..course.authoring.layout import Course
from .seeds import key_of, rank

DRAWN = 2
"""The number of whys that a person marks, per student and term."""
_WHY = re.compile(r'^# %% \[markdown\].*\bwhy="(\w+)"', re.MULTILINE)


def drawn(
    key: str, student: str, whys: Iterable[str], marked: Collection[str] = ()
) -> frozenset[str]:
    """The whys that a person marks: first those that are marked already, then by lot."""
    by_lot = sorted(whys, key=partial(rank, key, student))
    return frozenset(sorted(by_lot, key=lambda name: name not in marked)[:DRAWN])


def credit_whys(course: Course, book: Any, assignment: str) -> None:
    """Give full points in the gradebook to the whys that were written and are not drawn.

    They are drawn among those of the notebooks that were released since the term began; among all
    of the course's if no term was begun.  A mark that somebody gave by hand stays, and so does the
    0 of a why that is blank.  A why with such a mark is one of the two, also where the lot, which
    is by the name of the folder, says otherwise since a list was imported.

    Raises:
        LabkitError: There is such a why, and the term's record cannot be read.
    """
    waiting = [
        (submission.student.id, grade)
        for submission in book.assignment_submissions(assignment)
        for notebook in submission.notebooks
        for grade in notebook.grades
        if grade.needs_manual_grade and grade.auto_score is None and grade.manual_score is None
    ]
    if not waiting:
        return
    texts = {x: course.notebook_source(x).read_text(encoding="utf-8") for x in course.names()}
    whys = {name: x for x, text in texts.items() for name in _WHY.findall(text)}
    waiting = [(student, grade) for student, grade in waiting if grade.name in whys]
    if not waiting:
        return
    by_hand = book.db.query(type(waiting[0][1])).filter_by(needs_manual_grade=False)
    marked = {
        (grade.notebook.assignment.student.id, grade.name)
        for grade in by_hand
        if grade.manual_score is not None
    }
    released, term = {path.stem for path in course.bundle.glob("*.json")}, course.term.exists()
    asked = [name for name, x in whys.items() if x in released or not term]
    key = key_of(course, "the whys")
    for student, grade in waiting:
        mine = [name for name in asked if (student, name) in marked]
        if grade.name not in drawn(key, student, asked, mine):
            grade.auto_score, grade.needs_manual_grade = grade.max_score, False
    book.db.commit()
