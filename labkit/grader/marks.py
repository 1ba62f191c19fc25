"""A student's mark, line by line, as read from the gradebook for every page and every table.

A mark comes from the gradebook, so it includes changes by hand, extra credit and deductions for
lateness.  If the gradebook has no mark, or one that differs from the result of grading, the reason
is given instead of a mark: nobody gets a 0 that they did not earn.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import DEFENCE, Course
from ..course.notebook import question_of
from ..errors import LabkitError
from .clean import clean_line, clean_text, span
from .collect import Participant, participants
from .each import Failure, for_student
from .gradebook import apply_rules, open_gradebook
from .results import Result, Results
from .roster import Student, read_roster
from .submission import Submission, digest, is_name, misnamed, plain_name, students


@dataclass(frozen=True)
class MarkLine:
    """The points for one question, and where they come from.

    Attributes:
        name: The name of the question.
        points: Full marks.
        automatic: The points that the grader gave; None if a person marks the question.
        by_hand: The points that a person gave, which count instead; None if there are none.
        extra: Extra credit.
        comment: The comment that a person wrote.
        open: Whether a person still has to mark the question, or to look at it again.
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
        """The points that count; None if the question is not marked yet."""
        given = self.automatic if self.by_hand is None else self.by_hand
        return None if given is None else round(given + self.extra, 4)

    @property
    def origin(self) -> str:
        """Where the score comes from, in words; empty if it is the grader's alone."""
        said = []
        if self.by_hand is not None:
            same = self.automatic in {None, self.by_hand}
            instead = "" if same else f", instead of {self.automatic:g}"
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
        person: The student, as described by the roster or, failing that, by the gradebook.
        listed: Whether the student is in the roster.
        when: When the work was handed in, as text.
        due: When the work was due, as text.
        lines: One for each question; none if no mark counts.
        raw: Points before deductions for lateness; None if no mark counts.
        penalty: Points deducted for lateness.
        points: Full marks; 0 if neither the gradebook nor the release says what they are.
        late: How late the work was, in words; empty if it was in time.
        moodle: The student as Moodle's download calls them, or None.
        result: The result of grading; None if there is no complete one.
        missing: Why no mark counts, and what to do; empty if one does, or nothing was handed in.
        remark: Anything else to know about the mark, such as that the file was rejected.
        author: Who handed in the team's report, if that was another member of the team.
    """

    person: Student
    listed: bool = False
    when: str = ""
    due: str = ""
    lines: tuple[MarkLine, ...] = ()
    raw: float | None = None
    penalty: float = 0.0
    points: float = 0.0
    late: str = ""
    moodle: Participant | None = None
    result: Result | None = None
    missing: str = ""
    remark: str = ""
    author: str = ""

    @property
    def student(self) -> str:
        """The name of the student's folder."""
        return self.person.id

    @property
    def absent(self) -> bool:
        """Whether the student handed in nothing."""
        return self.raw is None and not self.missing

    @property
    def open(self) -> tuple[str, ...]:
        """The questions that a person still has to mark."""
        return tuple(line.name for line in self.lines if line.open)

    @property
    def questions(self) -> Mapping[str, tuple[float, float]]:
        """The points of each question, with their maximum; none if no mark counts."""
        return {x.name: (x.score or 0.0, x.points) for x in self.lines if self.raw is not None}

    @property
    def score(self) -> float | str:
        """The points that count; an empty cell if no mark does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)

    @property
    def full(self) -> float | str:
        """Full marks; an empty cell if they are not known."""
        return self.points or ""

    @property
    def cells(self) -> tuple[float | str, float | str, float | str]:
        """Points before deductions, the deduction, and the score; or three empty cells."""
        return ("", "", "") if self.raw is None else (self.raw, self.penalty, self.score)

    @property
    def login(self) -> str:
        """The login; else the folder's name, unless the roster gave the folder."""
        made = self.listed or not is_name(self.student)
        return self.person.login or ("" if made else self.student)


def marks_of(course: Course, assignment: str, only: str | None = None) -> list[Mark]:
    """The marks of everybody in the roster, and of all others with work or a mark, by name.

    The rules may have changed since the work was graded, so they are applied to the gradebook
    first.

    Args:
        course: The course.
        assignment: The assignment.
        only: The one student to read, without a team's report that another handed in; by default
            all students.

    Raises:
        LabkitError: The gradebook, the roster or the rules cannot be used.
    """
    with open_gradebook(course) as book:
        apply_rules(course, book, assignment)
        submissions = {plain_name(s.student.id): s for s in book.assignment_submissions(assignment)}
        rows = list(_own_marks(course, assignment, submissions, only))
    released = not only and (course.bundle / f"{assignment}.json").exists()
    shared = released and Bundle.of(course, assignment).is_report
    return list(_of_teams(rows)) if shared else rows


def _of_teams(rows: Sequence[Mark]) -> Iterator[Mark]:
    """A team member's hand-in counts for each of the others who handed in nothing."""
    reports: dict[str, Mark] = {}
    for row in rows:
        if row.person.team and not row.absent:
            reports.setdefault(row.person.team, row)
    for row in rows:
        report = reports.get(row.person.team) if row.absent else None
        if report is None:
            yield row
            continue
        mine = replace(report, person=row.person, listed=row.listed, moodle=row.moodle)
        remark = f"the team's report, handed in by {report.student}"
        yield replace(mine, author=report.student, remark=remark)


def _own_marks(
    course: Course, assignment: str, submissions: Mapping[str, Any], only: str | None
) -> Iterator[Mark]:
    """The mark of each student for what they handed in themselves.

    Args:
        course: The course.
        assignment: The assignment.
        submissions: The gradebook's submissions, by student.
        only: One student; by default all students.
    """
    called, handed_in = participants(course).get(assignment, {}), {*students(course, assignment)}
    results = {one.student: one for one in current_results(course, assignment, only)}
    roster = read_roster(course)
    listed = {student.id for student in roster.students}
    full = max((float(s.max_score) for s in submissions.values()), default=0.0)
    full = full or full_marks(course, assignment)
    everybody = results.keys() | submissions.keys() | listed
    for student in sorted(everybody if only is None else everybody & {only}):
        submission, result = submissions.get(student), results.get(student)
        person = roster.get(student) or Student(student)
        row = Mark(person, student in listed, points=full, moodle=called.get(student))
        if submission is None and result is None:
            nothing = "no defence yet" if assignment == DEFENCE else "nothing was handed in"
            yield replace(row, remark=nothing)
            continue
        done = for_student(student, _marked, row, submission, result, assignment)
        if isinstance(done, Failure):
            yield replace(row, missing=done.why)
        else:
            yield replace(done, remark=_remark(done, student in handed_in))


def _remark(row: Mark, handed_in: bool) -> str:
    """Why the mark is as it is, if it was rejected, is empty, or outlived its submission."""
    if row.missing or row.result is None:
        return ""
    if row.result.unanswered:
        if row.result.rejected:
            return f"rejected: {row.result.rejected}; ask for the file again"
        return f"{row.result.unanswered}; ask for the right one"
    return "" if handed_in else "nothing of theirs is in submitted/; the mark stays as it was"


def mark_of(result: Result) -> Mark:
    """The mark for a result by itself, without the gradebook."""
    verdicts = [question.verdict for question in result.questions]
    lines = tuple(MarkLine(v.name, v.points, v.earned) for v in verdicts)
    who = Student(result.student)
    return Mark(who, lines=lines, raw=result.score, points=result.points, result=result)


def _marked(row: Mark, submission: Any, one: Result | Failure | None, assignment: str) -> Mark:
    """The row with the mark in the gradebook, or with the reason why it does not count."""
    if isinstance(one, Failure):
        row = replace(row, missing=one.why)
    elif one is not None:
        row = replace(row, result=one)
    if submission is None:
        why = f"graded, but not in the gradebook; {how_to_grade(assignment, row.student)}"
        return replace(row, missing=row.missing or why)
    if not row.listed:
        who = submission.student
        names = (who.first_name, who.last_name, who.email, who.lms_user_id)
        first, last, email, number = (clean_line(name or "") for name in names)
        person = Student(row.student, first, last, email, number, id_number=number)
        row = replace(row, person=person)
    row = replace(
        row,
        when=str(submission.timestamp or ""),
        due=str(submission.duedate or ""),
        points=float(submission.max_score),
    )
    lines = tuple(_lines(submission))
    missing = row.missing or _differs(assignment, row, lines)
    if missing:
        return replace(row, missing=missing)
    row = replace(row, lines=lines, late=span(submission.total_seconds_late))
    if none := [line.name for line in lines if line.score is None]:
        how = "mark by hand, in formgrader"
        if assignment == DEFENCE:
            how = f"type: labkit defence {shlex.quote(row.student)} --mark A,B,C"
        why = f"still to be marked: {', '.join(none)}; {how}"
        return replace(row, missing=why)
    if row.open:
        why = f"changed after the mark by hand: {', '.join(row.open)}; look at it in formgrader"
        return replace(row, missing=why)
    penalty = float(submission.late_submission_penalty or 0.0)
    return replace(row, raw=float(submission.score), penalty=penalty)


def _lines(submission: Any) -> Iterator[MarkLine]:
    for notebook in submission.notebooks:
        said = {c.name: c.manual_comment for c in notebook.comments}
        order = {cell.name: k for k, cell in enumerate(notebook.notebook.source_cells)}
        for grade in sorted(notebook.grades, key=lambda g: order.get(g.name, len(order))):
            name = question_of(grade.name)
            yield MarkLine(
                name,
                float(grade.max_score),
                grade.auto_score,
                grade.manual_score,
                float(grade.extra_credit or 0.0),
                clean_text(said.get(name) or ""),
                bool(grade.needs_manual_grade),
            )


def _differs(assignment: str, row: Mark, lines: tuple[MarkLine, ...]) -> str:
    """Where result and gradebook disagree, and what to do; empty if they agree."""
    if row.result is None:
        return ""
    earned = {q.verdict.name: q.verdict.earned for q in row.result.questions}
    for line in lines:
        score = 0.0 if row.result.rejected else earned.get(line.name, line.automatic)
        if line.automatic != score:
            return (
                f"the result gives {_said(score)} for {line.name}, the gradebook "
                f"{_said(line.automatic)}; {how_to_grade(assignment, row.student)}"
            )
    return ""


def _said(score: float | None) -> str:
    return "nothing" if score is None else f"{score:g}"


def current_results(
    course: Course, assignment: str, student: str | None = None
) -> Iterator[Result | Failure]:
    """The result of every student who handed in or was graded.

    Args:
        course: The course.
        assignment: The name of the assignment.
        student: Look at this student only.

    Yields:
        In order of name, the result; or why none counts, and what to type.  None counts if the
        submission is not graded, if another one has been handed in since, if a later release has
        other questions or points, or if the file is damaged.
    """
    if assignment == DEFENCE:
        return  # it has a command of its own, and no result files
    results = Results(course, assignment)
    handed_in = set(students(course, assignment))
    released = _released(course, assignment)
    if student is None:
        yield from misnamed(course, assignment)
    for name in sorted(handed_in | set(results.students())):
        if not is_name(name):
            yield Failure(plain_name(name), f"a file in {results.folder} has this name; delete it")
        elif student in {None, name}:
            is_there = name in handed_in
            yield for_student(name, _current_result, course, results, name, is_there, released)


def full_marks(course: Course, assignment: str) -> float:
    """All points of an assignment, those that a person gives included; 0 before its release."""
    if not (course.bundle / f"{assignment}.json").exists():
        return 0.0
    bundle = Bundle.of(course, assignment)
    return bundle.points + bundle.by_hand


def how_to_grade(assignment: str, student: str) -> str:
    """What to type to grade a student's submission and record the result."""
    return f"type: labkit grade {assignment} --student {shlex.quote(student)}"


def _released(course: Course, assignment: str) -> Mapping[str, float] | None:
    """The points of each question in the last release; None before the first."""
    if not (course.bundle / f"{assignment}.json").exists():
        return None
    return {q["name"]: q["points"] for q in Bundle.of(course, assignment).data["questions"]}


def _current_result(
    course: Course,
    results: Results,
    student: str,
    is_handed_in: bool,
    released: Mapping[str, float] | None,
) -> Result:
    assignment = results.folder.name
    remedy = how_to_grade(assignment, student)
    if not is_handed_in:
        remedy = f"nothing of theirs is in submitted/; restore {results.path(student)} or delete it"
    try:
        result = results.read(student)
    except LabkitError as error:
        raise LabkitError(f"{error}; {remedy}") from None
    if result is None:
        raise LabkitError(f"handed in but not graded; {remedy}")
    if is_handed_in:
        data, _, _ = Submission.of(course, assignment, student).read()
        if digest(data) != result.hashes["submission"]:
            raise LabkitError(f"handed in again but not graded since; {remedy}")
        if released is not None and not result.rejected and result.asked != released:
            raise LabkitError(
                f"graded before the last release; type: labkit grade {assignment}, and add --lower "
                "if that keeps the old mark"
            )
    return result
