"""The mark of each student, the one that every page and every table shows.

It comes from the gradebook, so what was changed by hand, extra credit and what late rules took away
count.  Where there is none, or where it differs from the result, there is no mark but the reason
why: nobody is given a 0 that they did not earn.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..course.layout import Course
from ..course.notebook import question_of
from .class_list import Student
from .clean import clean_line, clean_text
from .each import Failed
from .gradebook import open_gradebook
from .identity import lms_users
from .platforms import LmsUser
from .results import Result
from .roster import read_roster
from .rules import settle_lateness
from .standing import full_marks, grade_again, standing
from .submission import is_name, plain_name, students
from .team_reports import for_teams
from .whys import settle_whys


@dataclass(frozen=True)
class Line:
    """What one question brings, and where that comes from.

    Attributes:
        name: The question.
        points: Full marks.
        automatic: What the machine gave; None where a person marks.
        by_hand: What a person gave, which counts instead.
        extra: Extra credit.
        comment: What a person wrote.
        open: Whether a person has to mark it still, or once more.
    """

    name: str
    points: float
    automatic: float | None = None
    by_hand: float | None = None
    extra: float = 0.0
    comment: str = ""
    open: bool = False

    @property
    def score(self) -> float | None:
        """What counts; None where nobody marked it."""
        given = self.automatic if self.by_hand is None else self.by_hand
        return None if given is None else round(given + self.extra, 4)

    @property
    def origin(self) -> str:
        """Where the score comes from, in words; empty if it is the machine's alone."""
        said = []
        if self.by_hand is not None:
            instead = "" if self.automatic is None else f", instead of {self.automatic:g}"
            said.append(f"{self.by_hand:g} by hand{instead}")
        if self.extra:
            said.append(f"{self.extra:g} extra credit")
        if self.open:
            said.append("not marked yet" if self.score is None else "to be looked at again")
        return "; ".join(said)


@dataclass(frozen=True)
class Mark:
    """One student's mark for an assignment.

    Attributes:
        student: The name of the student's folder.
        first: First name, if the gradebook knows it.
        last: Last name.
        email: Address.
        lms: Number in the learning platform, if the gradebook knows it.
        when: When it came in, as text.
        due: When it was due, as text.
        lines: One for each question; none where no mark counts.
        raw: Points before late rules; None where no mark counts.
        penalty: What late rules take.
        points: What full marks would be; 0 where neither gradebook nor release says so.
        late: How late it came, in words; empty if it came in time.
        person: The student as the roster knows them, or None.
        user: How the platform knows the student from which the work was collected, or None.
        result: What the grader found; None where there is no whole result.
        missing: Why no mark counts, and what to do; empty where one does, or nothing came.
        remark: What else should be known of the mark, such as that the file was rejected.
        author: Who handed in the team's report, if that was another member of the team.
    """

    student: str
    first: str = ""
    last: str = ""
    email: str = ""
    lms: str = ""
    when: str = ""
    due: str = ""
    lines: tuple[Line, ...] = ()
    raw: float | None = None
    penalty: float = 0.0
    points: float = 0.0
    late: str = ""
    person: Student | None = None
    user: LmsUser | None = None
    result: Result | None = None
    missing: str = ""
    remark: str = ""
    author: str = ""

    @property
    def absent(self) -> bool:
        """Whether the student is in the roster, and nothing came."""
        return self.raw is None and not self.missing

    @property
    def open(self) -> tuple[str, ...]:
        """Questions that a person has to mark still."""
        return tuple(line.name for line in self.lines if line.open)

    @property
    def questions(self) -> Mapping[str, tuple[float, float]]:
        """Points of each question, with their maximum; none where no mark counts."""
        return {x.name: (x.score or 0.0, x.points) for x in self.lines if self.raw is not None}

    @property
    def score(self) -> float | str:
        """What counts; an empty cell where nothing does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)

    @property
    def full(self) -> float | str:
        """What full marks would be; an empty cell where nobody knows."""
        return self.points or ""

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


def marks_of(course: Course, assignment: str, only: str | None = None) -> Iterator[Mark]:
    """Everybody in the roster, and all others who handed in or are graded, in order of name.

    Args:
        course: The course.
        assignment: Which.
        only: One student, by what they handed in themselves; by default all.
    """
    rows = _own_marks(course, assignment, only)
    yield from rows if only else for_teams(course, assignment, rows)


def _own_marks(course: Course, assignment: str, only: str | None) -> Iterator[Mark]:
    """The mark of each student for what they handed in themselves."""
    by_platform, handed_in = lms_users(course, assignment), set(students(course, assignment))
    roster = read_roster(course)
    stand = {one.student: one for one in standing(course, assignment, only)}
    with open_gradebook(course) as book:
        settle_whys(course, book, assignment)
        settle_lateness(course, book, assignment)
        there = {plain_name(s.student.id): s for s in book.assignment_submissions(assignment)}
        full = max((float(s.max_score) for s in there.values()), default=0.0)
        listed = {student.id for student in roster.students}
        everybody = stand.keys() | there.keys() | listed
        for student in sorted(everybody if only is None else everybody & {only}):
            submission, one = there.get(student), stand.get(student)
            row = Mark(
                student, points=full or full_marks(course, assignment), person=roster.get(student)
            )
            row = replace(row, user=by_platform.get(student), remark="nothing was handed in")
            if submission is not None or one is not None:
                row = _marked(replace(row, remark=""), submission, one, assignment)
            if isinstance(one, Result) and one.rejected and not row.missing:
                row = replace(row, remark=f"rejected: {one.rejected}")
            elif row.raw is not None and one is not None and student not in handed_in:
                gone = "nothing of theirs is in submitted/; the mark stays as it was"
                row = replace(row, remark=gone)
            yield _named(row)


def mark_of(result: Result) -> Mark:
    """What a result is worth, where no gradebook has been asked."""
    verdicts = [question.verdict for question in result.questions]
    lines = tuple(Line(v.name, v.points, v.earned) for v in verdicts)
    return Mark(result.student, lines=lines, raw=result.score, points=result.points, result=result)


def _named(row: Mark) -> Mark:
    """A row with the name that the roster has."""
    who = row.person
    if who is None:
        return row
    return replace(row, first=who.first_name, last=who.last_name, email=who.email)


def _marked(row: Mark, submission: Any, one: Result | Failed | None, assignment: str) -> Mark:
    """A row with what the gradebook says, or why that does not count."""
    if isinstance(one, Failed):
        row = replace(row, missing=one.why)
    elif one is not None:
        row = replace(row, result=one)
    if submission is None:
        why = f"graded and not in the gradebook; {grade_again(assignment, row.student)}"
        return replace(row, missing=row.missing or why)
    who = submission.student
    names = (who.first_name, who.last_name, who.email, who.lms_user_id)
    first, last, email, lms = (clean_line(name or "") for name in names)
    row = replace(
        row,
        first=first,
        last=last,
        email=email,
        lms=lms,
        when=str(submission.timestamp or ""),
        due=str(submission.duedate or ""),
        points=float(submission.max_score),
    )
    lines = tuple(_lines(submission))
    missing = row.missing or _differs(assignment, row, lines)
    if missing:
        return replace(row, missing=missing)
    row = replace(row, lines=lines, late=_span(submission.total_seconds_late))
    none = [line.name for line in lines if line.score is None]
    if none:
        return replace(
            row, missing=f"no mark for {', '.join(none)}; give it by hand, in formgrader"
        )
    penalty = float(submission.late_submission_penalty or 0.0)
    return replace(row, raw=float(submission.score), penalty=penalty)


def _lines(submission: Any) -> Iterator[Line]:
    for notebook in submission.notebooks:
        said = {c.name: c.manual_comment for c in notebook.comments}
        order = {cell.name: k for k, cell in enumerate(notebook.notebook.source_cells)}
        for grade in sorted(notebook.grades, key=lambda g: order.get(g.name, len(order))):
            name = question_of(grade.name)
            yield Line(
                name,
                float(grade.max_score),
                grade.auto_score,
                grade.manual_score,
                float(grade.extra_credit or 0.0),
                clean_text(said.get(name) or ""),
                bool(grade.needs_manual_grade),
            )


def _differs(assignment: str, row: Mark, lines: tuple[Line, ...]) -> str:
    """Where result and gradebook do not say the same, and what to do; empty if they do."""
    if row.result is None:
        return ""
    earned = {q.verdict.name: q.verdict.earned for q in row.result.questions}
    for line in lines:
        score = 0.0 if row.result.rejected else earned.get(line.name, line.automatic)
        if line.automatic != score:
            return (
                f"the result gives {_said(score)} for {line.name}, the gradebook "
                f"{_said(line.automatic)}; {grade_again(assignment, row.student)}"
            )
    return ""


def _span(seconds: float) -> str:
    """A time in words; empty if there is none."""
    if seconds <= 0:
        return ""
    days, rest = divmod(int(seconds), 86400)
    hours, minutes = rest // 3600, rest % 3600 // 60
    found = [(days, "day"), (hours, "hour")] if days else [(hours, "hour"), (minutes, "minute")]
    said = [f"{n} {what}{'s' * (n != 1)}" for n, what in found if n]
    return " ".join(said) or "less than a minute"


def _said(score: float | None) -> str:
    return "nothing" if score is None else f"{score:g}"
