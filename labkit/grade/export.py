"""Marks as tables: nbgrader's, one column per question, and what Canvas and Moodle read.

Marks come from the gradebook, so what was changed by hand and what late rules took away counts.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from .course import Course
from .gradebook import open_gradebook


@dataclass(frozen=True)
class Row:
    """One student's marks for an assignment.

    Attributes:
        student: The name of his folder.
        first: First name, if the gradebook knows it.
        last: Last name.
        email: Address.
        lms: His number in the learning platform.
        when: When it came in, as text.
        due: When it was due, as text.
        questions: Points of each question, with their maximum.
        raw: Points before late rules.
        penalty: What late rules take.
        points: What full marks would be.
    """

    student: str
    first: str
    last: str
    email: str
    lms: str
    when: str
    due: str
    questions: dict[str, tuple[float, float]]
    raw: float
    penalty: float
    points: float

    @property
    def score(self) -> float:
        """What counts."""
        return round(max(0.0, self.raw - self.penalty), 4)


def rows(course: Course, assignment: str) -> Iterator[Row]:
    """Everybody's marks, in order of name."""
    with open_gradebook(course) as (book, _):
        for submission in sorted(
            book.assignment_submissions(assignment), key=lambda s: str(s.student.id)
        ):
            who = submission.student
            grades = [grade for notebook in submission.notebooks for grade in notebook.grades]
            yield Row(
                student=str(who.id),
                first=who.first_name or "",
                last=who.last_name or "",
                email=who.email or "",
                lms=who.lms_user_id or "",
                when=str(submission.timestamp or ""),
                due=str(submission.assignment.duedate or ""),
                questions={
                    grade.name.removesuffix("-check"): (float(grade.score), float(grade.max_score))
                    for grade in grades
                },
                raw=float(submission.score),
                penalty=float(submission.late_submission_penalty or 0.0),
                points=float(submission.max_score),
            )


def nbgrader(assignment: str, marks: Sequence[Row]) -> list[list[Any]]:
    """The columns of ``nbgrader export``."""
    head = "assignment duedate timestamp student_id last_name first_name email raw_score"
    table: list[list[Any]] = [[*head.split(), "late_submission_penalty", "score", "max_score"]]
    for r in marks:
        table.append(
            [assignment, r.due, r.when, r.student, r.last, r.first, r.email]
            + [r.raw, r.penalty, r.score, r.points]
        )
    return table


def questions(assignment: str, marks: Sequence[Row]) -> list[list[Any]]:
    """One column for each question; the second line says what full marks are."""
    names = list(dict.fromkeys(name for r in marks for name in r.questions))
    most = {name: r.questions[name][1] for r in marks for name in r.questions}
    table: list[list[Any]] = [["student", *names, "penalty", "score"]]
    if marks:
        table.append(["(full marks)", *(most[name] for name in names), "", marks[0].points])
    for r in marks:
        each = [r.questions.get(name, ("", ""))[0] for name in names]
        table.append([r.student, *each, r.penalty, r.score])
    return table


def canvas(assignment: str, marks: Sequence[Row]) -> list[list[Any]]:
    """What Canvas's gradebook imports: its five columns, then the assignment's."""
    table: list[list[Any]] = [
        ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", assignment]
    ]
    table.append(["    Points Possible", "", "", "", "", marks[0].points if marks else ""])
    for r in marks:
        name = ", ".join(x for x in (r.last, r.first) if x) or r.student
        table.append([name, r.lms, "", r.student, "", r.score])
    return table


def moodle(assignment: str, marks: Sequence[Row]) -> list[list[Any]]:
    """What Moodle's grade import maps: a column to know the user by, and the grade."""
    table: list[list[Any]] = [["ID number", "Username", "Email address", assignment]]
    table += [[r.lms, r.student, r.email, r.score] for r in marks]
    return table


LAYOUTS: dict[str, Callable[[str, Sequence[Row]], list[list[Any]]]] = {
    "nbgrader": nbgrader,
    "questions": questions,
    "canvas": canvas,
    "moodle": moodle,
}


def as_csv(table: Sequence[Sequence[Any]]) -> str:
    """A table as text; nothing in it can become a formula in a spreadsheet."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([[_safe(x) for x in row] for row in table])
    return out.getvalue()


def _safe(x: Any) -> Any:
    return f"'{x}" if isinstance(x, str) and x[:1] in {"=", "+", "-", "@", "\t", "\r"} else x
