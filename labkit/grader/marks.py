"""The mark of each student, the one that every table shows.

It comes from the gradebook, so what was changed by hand and what late rules took away counts.
Where there is none, or where it differs from the result, there is no mark but the reason why:
nobody is given a 0 that they did not earn.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ..course.layout import Course
from ..course.notebook import question_of
from .clean import clean_line
from .each import Failed
from .gradebook import automatic, open_gradebook
from .identity import lms_users
from .platforms import LmsUser
from .results import Result
from .roster import Student, read_roster
from .standing import grade_again, standing
from .submission import is_name, plain_name, students


@dataclass(frozen=True)
class Mark:
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
        user: How the platform knows the student from which the work was collected, or None.
        missing: Why no mark counts, and what to do; empty where one does.
        remark: What else should be known of the mark, such as that the file was rejected.
    """

    student: str
    first: str = ""
    last: str = ""
    email: str = ""
    lms: str = ""
    when: str = ""
    due: str = ""
    questions: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    raw: float | None = None
    penalty: float = 0.0
    points: float = 0.0
    user: LmsUser | None = None
    missing: str = ""
    remark: str = ""
    person: Student | None = None

    @property
    def score(self) -> float | str:
        """What counts; an empty cell where nothing does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)

    @property
    def cells(self) -> tuple[float | str, float | str, float | str]:
        """Points before late rules, what these take, and what counts; or three empty cells."""
        return ("", "", "") if self.raw is None else (self.raw, self.penalty, self.score)

    @property
    def login(self) -> str:
        """Their login: the name of the folder, unless that was made from a download or is unfit."""
        if self.person and self.person.login:
            return self.person.login
        if self.user:
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
        return self.user.number if self.user and self.user.system == system else ""


def marks_of(course: Course, assignment: str) -> Iterator[Mark]:
    """Everybody who handed in, was graded or is in the gradebook, in order of name."""
    by_platform, handed_in = lms_users(course, assignment), set(students(course, assignment))
    roster = read_roster(course)
    stand = {one.student: one for one in standing(course, assignment)}
    full = max((one.points for one in stand.values() if isinstance(one, Result)), default=0.0)
    with open_gradebook(course) as book:
        there = {plain_name(s.student.id): s for s in book.assignment_submissions(assignment)}
        for student in sorted(stand.keys() | there.keys()):
            submission, one = there.get(student), stand.get(student)
            row = Mark(student, points=full)
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
                _named(row, person), user=by_platform.get(student), person=person, remark=remark
            )


def _named(row: Mark, person: Student | None) -> Mark:
    """A row with the name that the roster has."""
    if person is None:
        return row
    return replace(row, first=person.first_name, last=person.last_name, email=person.email)


def _marked(row: Mark, submission: Any) -> Mark:
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
