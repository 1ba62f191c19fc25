"""A student's mark, line by line, as read from the gradebook for every page and every table.

A mark comes from the gradebook, so it includes changes by hand, extra credit and deductions for
lateness.  If the gradebook has no mark, or one that differs from the result of grading, the reason
is given instead of a mark: nobody gets a 0 that they did not earn.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import DEFENCE, Course
from ..course.notebook import question_of
from ..errors import LabkitError
from .clean import clean_text, how_many
from .each import Failure, for_student
from .gradebook import apply_rules, open_gradebook
from .results import Result, Results
from .roster import Student, read_roster
from .submission import Submission, digest, misnamed, students


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
        person: The student, as described by the roster.
        lines: One for each question; none if no mark counts.
        raw: Points before deductions for lateness; None if no mark counts.
        penalty: Points deducted for lateness.
        points: Full marks; 0 if neither the gradebook nor the release says what they are.
        late: How late the work was, in words; empty if it was in time.
        result: The result of grading; None if there is no complete one.
        missing: Why no mark counts, and what to do; empty if one does, or nothing was handed in.
        remark: Anything else to know about the mark, such as that the file was rejected.
    """

    person: Student
    lines: tuple[MarkLine, ...] = ()
    raw: float | None = None
    penalty: float = 0.0
    points: float = 0.0
    late: str = ""
    result: Result | None = None
    missing: str = ""
    remark: str = ""

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
    def score(self) -> float | str:
        """The points that count; an empty cell if no mark does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)


def marks_of(course: Course, assignment: str, only: str | None = None) -> list[Mark]:
    """The marks of everybody in the roster, and of all others with work or a mark, by name.

    The rules may have changed since the work was graded, so they are applied to the gradebook
    first.

    Args:
        course: The course.
        assignment: The assignment.
        only: The one student to read; by default all students.

    Raises:
        LabkitError: The gradebook, the roster or the rules cannot be used.
    """
    bundle = _released(course, assignment)
    with open_gradebook(course) as book:
        apply_rules(course, book, assignment)
        return list(_marks(course, assignment, book, bundle, only))


def _released(course: Course, assignment: str) -> Bundle | None:
    """The bundle of the last release; None before the first, and for the defence."""
    there = (course.bundle / f"{assignment}.json").exists()
    return Bundle.of(course, assignment) if there else None


def _marks(
    course: Course, assignment: str, book: Any, bundle: Bundle | None, only: str | None
) -> Iterator[Mark]:
    submissions = {s.student.id: s for s in book.assignment_submissions(assignment)}
    handed_in = {*students(course, assignment)}
    results = {one.student: one for one in current_results(course, assignment, only)}
    listed = read_roster(course)
    full = max((float(s.max_score) for s in submissions.values()), default=0.0)
    full = full or (bundle.points + bundle.by_hand if bundle else 0.0)
    everybody = results.keys() | submissions.keys() | listed.keys()
    for student in sorted(everybody if only is None else everybody & {only}):
        person = listed.get(student) or Student(student, login=student)
        row = Mark(person, points=full)
        if student not in submissions.keys() | results.keys():
            nothing = "no defence yet" if assignment == DEFENCE else "nothing was handed in"
            yield replace(row, remark=nothing)
            continue
        about = row, submissions.get(student), results.get(student), assignment
        done = for_student(student, _marked, *about)
        if isinstance(done, Failure):
            yield replace(row, missing=done.why)
        elif done.missing or done.result is None:
            yield done
        elif done.result.rejected:
            why = f"rejected: {done.result.rejected}; ask for the file again"
            yield replace(done, remark=why)
        else:
            gone = "nothing of theirs is in submitted/; the mark stays as it was"
            yield replace(done, remark="" if student in handed_in else gone)


def mark_of(result: Result) -> Mark:
    """The mark for a result by itself, without the gradebook."""
    verdicts = [question.verdict for question in result.questions]
    lines = tuple(MarkLine(v.name, v.points, v.earned) for v in verdicts)
    who = Student(result.student)
    return Mark(who, lines=lines, raw=result.score, points=result.points, result=result)


def _marked(row: Mark, submission: Any, one: Result | Failure | None, assignment: str) -> Mark:
    """The row with the mark in the gradebook, or with the reason why it does not count."""
    how = how_to_grade(assignment, row.student)
    row = replace(row, missing=one.why) if isinstance(one, Failure) else replace(row, result=one)
    if submission is None:
        return replace(row, missing=row.missing or f"graded, but not in the gradebook; {how}")
    row = replace(row, points=float(submission.max_score))
    lines = tuple(_lines(submission))
    if other := row.result and _other(row.result, lines):
        row = replace(row, missing=f"the gradebook has other points for {other}; {how}")
    if row.missing:
        return row
    hours = round(submission.total_seconds_late / 3600, 1)
    row = replace(row, lines=lines, late=how_many(hours, "hour") if hours > 0 else "")
    if none := [line.name for line in lines if line.score is None]:
        return replace(row, missing=f"still to be marked: {', '.join(none)}; use formgrader")
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


def _other(result: Result, lines: Sequence[MarkLine]) -> str:
    """The first question for which the gradebook has other points than the result; or ""."""
    for line in lines:
        if line.automatic != (
            0.0 if result.rejected else result.earned.get(line.name, line.automatic)
        ):
            return line.name
    return ""


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
    results, bundle = Results(course, assignment), _released(course, assignment)
    handed_in = set(students(course, assignment))
    if student is None:
        yield from misnamed(course, assignment)
    for name in sorted(handed_in | set(results.students())):
        if student in {None, name}:
            submission = Submission.of(course, assignment, name) if name in handed_in else None
            yield for_student(name, _current_result, results, name, submission, bundle)


def _current_result(
    results: Results, student: str, submission: Submission | None, bundle: Bundle | None
) -> Result:
    assignment = results.folder.name
    how = how_to_grade(assignment, student)
    try:
        result = results.read(student)
    except LabkitError as error:
        raise LabkitError(f"{error}; {how}") from None
    if result is None:
        raise LabkitError(f"handed in but not graded; {how}")
    if submission and digest(submission.read()[0]) != result.hashes["submission"]:
        raise LabkitError(f"handed in again but not graded since; {how}")
    asked = {q["name"]: q["points"] for q in bundle.data["questions"]} if bundle else result.asked
    if submission and not result.rejected and result.asked != asked:
        raise LabkitError(f"graded before the last release; {how}")
    return result


def how_to_grade(assignment: str, student: str) -> str:
    """What to type to grade a student's submission and record the result."""
    return f"type: labkit grade {assignment} --student {shlex.quote(student)}"
