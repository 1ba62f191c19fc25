"""How marks are read from the gradebook, for every page and every table.

A mark comes from the gradebook, so it includes changes by hand, extra credit and deductions for
lateness.  If the gradebook has no mark, or one that differs from the result of grading, the reason
is given instead of a mark: nobody gets a 0 that they did not earn.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import DEFENCE, Course
from ...course.notebook import question_of
from ..clean import clean_line, clean_text, span
from ..collect import participants
from ..each import Failure, for_student
from ..grading.current_results import current_results, full_marks, how_to_grade
from ..grading.results import Result
from ..nbgrader.gradebook import apply_rules, open_gradebook
from ..roster import Student, read_roster
from ..submission import plain_name, students
from .mark import Mark, MarkLine


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
