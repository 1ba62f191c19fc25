"""Marks as tables: nbgrader's, one column per question, and what Canvas and Moodle read.

Marks come from the gradebook, so what was changed by hand and what late rules took away counts.
Where none is there, or where it does not say what the result says, the cell stays empty: nobody is
given a 0 that nobody earned.

Canvas: the first columns are Student, ID, SIS User ID, SIS Login ID, Section, in this order; a row
whose first cell holds "Points Possible" gives full marks; a student is known by ID, else by SIS ID,
else by login, else by name; an assignment's column is called ``TITLE (NUMBER)``, and a title that
Canvas does not know makes a new assignment (github.com/instructure/canvas-lms,
``lib/gradebook_importer.rb``; the columns also at
teaching.resources.osu.edu, "Import CSV File to Carmen Grades").

Moodle has two doors.  The gradebook's import (docs.moodle.org/en/Grade_import) asks which column to
know users by: "Email address" goes to ``useremail``, "ID number" to ``useridnumber``.  The
assignment's own grading worksheet needs the columns Identifier, Grade and Last modified (grade);
the identifier is "Participant" and the number that the download of submissions bears
(github.com/moodle/moodle, ``mod/assign/feedback/offline/importgradeslib.php``).

Names, addresses and numbers are the roster's, where there is one.
"""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..course.layout import Course
from ..course.notebook import question_of
from .clean import clean_line
from .each import Failed
from .gradebook import automatic, open_gradebook
from .lms import Known, known
from .results import Result
from .roster import Student, read_roster
from .standing import grade_again, standing
from .submission import is_name, plain_name, students


@dataclass(frozen=True)
class Row:
    """One student's marks for an assignment.

    Attributes:
        student: The name of the student's folder.
        first: First name, if the gradebook knows it.
        last: Last name.
        email: Address.
        lms: Number in the learning platform, if the gradebook knows it.
        person: The student as the roster knows them, or None.
        when: When it came in, as text.
        due: When it was due, as text.
        questions: Points of each question, with their maximum; none where no mark counts.
        raw: Points before late rules; None where no mark counts.
        penalty: What late rules take.
        points: What full marks would be.
        known: How the platform knows the student from which the work was collected, or None.
        missing: Why no mark counts, and what to do; empty where one does.
        remark: What else should be known of the mark, such as that the file was rejected.
    """

    student: str
    first: str
    last: str
    email: str
    lms: str
    when: str
    due: str
    questions: dict[str, tuple[float, float]]
    raw: float | None
    penalty: float
    points: float
    known: Known | None = None
    missing: str = ""
    remark: str = ""
    person: Student | None = None

    @property
    def score(self) -> float | str:
        """What counts; an empty cell where nothing does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)

    @property
    def marks(self) -> tuple[float | str, float | str, float | str]:
        """Points before late rules, what these take, and what counts; or three empty cells."""
        return ("", "", "") if self.raw is None else (self.raw, self.penalty, self.score)

    @property
    def login(self) -> str:
        """Their login: the name of the folder, unless that was made from a download or is unfit."""
        if self.person and self.person.login:
            return self.person.login
        if self.known:
            return self.number("exchange")
        return "" if self.person or not is_name(self.student) else self.student

    @property
    def canvas(self) -> str:
        """Their number in Canvas, empty if it is not known."""
        return self.number("canvas") or (self.person.lms_user_id if self.person else self.lms)

    @property
    def id_number(self) -> str:
        """The university's number, empty if it is not known."""
        return self.person.id_number if self.person else self.lms

    def number(self, system: str) -> str:
        """Their number in a platform, empty if it is not known."""
        return self.known.number if self.known and self.known.system == system else ""


def rows(course: Course, assignment: str) -> Iterator[Row]:
    """Everybody who handed in, was graded or is in the gradebook, in order of name."""
    by_platform, handed_in = known(course, assignment), set(students(course, assignment))
    roster = read_roster(course)
    stand = {one.student: one for one in standing(course, assignment)}
    full = max((one.points for one in stand.values() if isinstance(one, Result)), default=0.0)
    with open_gradebook(course) as book:
        there = {plain_name(s.student.id): s for s in book.assignment_submissions(assignment)}
        for student in sorted(stand.keys() | there.keys()):
            submission, one = there.get(student), stand.get(student)
            row = Row(student, "", "", "", "", "", "", {}, None, 0.0, full)
            row = row if submission is None else _marked(row, submission)
            missing, remark = _missing(assignment, student, submission, one), ""
            if missing:
                row = replace(row, questions={}, raw=None, penalty=0.0, missing=missing)
            elif isinstance(one, Result) and one.rejected:
                remark = f"rejected: {one.rejected}"
            elif student not in handed_in:
                remark = "nothing of theirs is in submitted/; the mark stays as it was"
            person = roster.get(student)
            yield replace(
                _named(row, person), known=by_platform.get(student), person=person, remark=remark
            )


def _named(row: Row, person: Student | None) -> Row:
    """A row with the name that the roster has."""
    if person is None:
        return row
    return replace(row, first=person.first_name, last=person.last_name, email=person.email)


def _marked(row: Row, submission: Any) -> Row:
    """A row with what the gradebook says."""
    who = submission.student
    names = (who.first_name, who.last_name, who.email, who.lms_user_id)
    first, last, email, lms = (clean_line(name or "") for name in names)
    grades = [grade for notebook in submission.notebooks for grade in notebook.grades]
    return replace(
        row,
        first=first,
        last=last,
        email=email,
        lms=lms,
        when=str(submission.timestamp or ""),
        due=str(submission.assignment.duedate or ""),
        questions={
            question_of(grade.name): (float(grade.score), float(grade.max_score))
            for grade in grades
        },
        raw=float(submission.score),
        penalty=float(submission.late_submission_penalty or 0.0),
        points=float(submission.max_score),
    )


def _missing(assignment: str, student: str, submission: Any, one: Result | Failed | None) -> str:
    """Why a student has no mark, and what to do; empty where the gradebook has it."""
    if isinstance(one, Failed):
        return one.why
    if submission is None:
        return f"graded and not in the gradebook; {grade_again(assignment, student)}"
    grades = [grade for notebook in submission.notebooks for grade in notebook.grades]
    for grade in grades:
        score = grade.auto_score if one is None else automatic(one, grade.name)
        if grade.auto_score != score:
            return (
                f"the result gives {_said(score)} for {question_of(grade.name)}, the "
                f"gradebook {_said(grade.auto_score)}; {grade_again(assignment, student)}"
            )
    none = [g.name for g in grades if g.auto_score is None and g.manual_score is None]
    if none:
        return f"no mark for {', '.join(none)}; give it by hand, in formgrader"
    return ""


def _said(score: float | None) -> str:
    return "nothing" if score is None else f"{score:g}"


def nbgrader(assignment: str, marks: Sequence[Row]) -> list[list[Any]]:
    """The columns of ``nbgrader export``."""
    head = "assignment duedate timestamp student_id last_name first_name email raw_score"
    table: list[list[Any]] = [[*head.split(), "late_submission_penalty", "score", "max_score"]]
    for r in marks:
        table.append(
            [assignment, r.due, r.when, r.student, r.last, r.first, r.email, *r.marks, r.points]
        )
    return table


def questions(assignment: str, marks: Sequence[Row]) -> list[list[Any]]:
    """One column for each question, and remarks; the second line says what full marks are."""
    names = list(dict.fromkeys(name for r in marks for name in r.questions))
    most = {name: r.questions[name][1] for r in marks for name in r.questions}
    table: list[list[Any]] = [["student", *names, "penalty", "score", "remark"]]
    if marks:
        table.append(["(full marks)", *(most[name] for name in names), "", marks[0].points, ""])
    for r in marks:
        each = [r.questions.get(name, ("", ""))[0] for name in names]
        table.append([r.student, *each, *r.marks[1:], r.missing or r.remark])
    return table


def canvas(column: str, marks: Sequence[Row]) -> list[list[Any]]:
    """What Canvas's gradebook imports; ``column`` as Canvas calls it, "Paths (4711)"."""
    table: list[list[Any]] = [["Student", "ID", "SIS User ID", "SIS Login ID", "Section", column]]
    table.append(["    Points Possible", "", "", "", "", marks[0].points if marks else ""])
    for r in marks:
        name = ", ".join(x for x in (r.last, r.first) if x) or r.student
        sis = r.id_number if r.person else ""
        table.append([name, r.canvas, sis, r.login, "", r.score])
    return table


def moodle(column: str, marks: Sequence[Row]) -> list[list[Any]]:
    """What Moodle's gradebook imports: columns to know the user by, and the grade."""
    table: list[list[Any]] = [
        ["First name", "Last name", "ID number", "Username", "Email address", column]
    ]
    table += [[r.first, r.last, r.id_number, r.login, r.email, r.score] for r in marks]
    return table


def moodle_worksheet(column: str, marks: Sequence[Row]) -> list[list[Any]]:
    """What a Moodle assignment reads as its grading worksheet: who came in its download."""
    table: list[list[Any]] = [
        ["Identifier", "Full name", "Grade", "Maximum Grade", "Last modified (grade)"]
    ]
    once = _participants(marks)
    table += [
        [f"Participant {number}", r.known.name if r.known else "", r.score, r.points, ""]
        for r in marks
        if (number := r.number("moodle")) in once
    ]
    return table


def _participants(marks: Sequence[Row]) -> set[str]:
    """Moodle's numbers that are one student's alone; others would get two marks."""
    numbers = Counter(r.number("moodle") for r in marks)
    return {number for number, count in numbers.items() if number and count == 1}


def left_out(layout: str, marks: Sequence[Row]) -> str:
    """Whom a platform will not know by a table, in a sentence; empty if it knows all."""
    once = _participants(marks)
    ways: dict[str, Callable[[Row], str]] = {
        "canvas": lambda r: r.canvas or r.id_number or r.login,
        "moodle": lambda r: r.email or r.id_number or r.login,
        "moodle-worksheet": lambda r: r.number("moodle") if r.number("moodle") in once else "",
    }
    if layout not in ways:
        return ""
    way = ways[layout]
    lost = [r.student for r in marks if not way(r) or _cell(way(r), True) != way(r)]
    some = ", ".join(lost[:5]) + (", ..." if len(lost) > 5 else "")
    return f"{len(lost)} of {len(marks)} cannot be told by this table: {some}" if lost else ""


LAYOUTS: dict[str, Callable[[str, Sequence[Row]], list[list[Any]]]] = {
    "nbgrader": nbgrader,
    "questions": questions,
    "canvas": canvas,
    "moodle": moodle,
    "moodle-worksheet": moodle_worksheet,
}


IDENTITIES = frozenset(
    ("ID", "SIS User ID", "SIS Login ID", "ID number", "Username", "Email address", "Identifier")
)
"""Columns by which a platform knows a student."""
_PLAIN = re.compile(r"[\w.@+-]*")


def as_csv(table: Sequence[Sequence[Any]]) -> str:
    """A table as text; nothing in it can become a formula in a spreadsheet.

    What could begin a formula gets a quotation mark in front.  An identity gets one only if it
    holds more than letters, digits and ``. _ @ + -``, as the platform would not know it any more;
    `left_out` names such a student.
    """
    identity = [head in IDENTITIES for head in table[0]]
    rows = [[_cell(x, known) for x, known in zip(r, identity, strict=True)] for r in table]
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def _cell(x: Any, identity: bool) -> Any:
    if not isinstance(x, str) or x[:1] not in {"=", "+", "-", "@", "\t", "\r"}:
        return x
    return x if identity and _PLAIN.fullmatch(x) else f"'{x}"
