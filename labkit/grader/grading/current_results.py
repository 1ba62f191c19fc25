"""The result that currently counts for each student, or why none does."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import DEFENCE, Course
from ...errors import LabkitError
from ..each import Failure, for_student
from ..submission import Submission, digest, is_name, misnamed, plain_name, students
from .results import Result, Results


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
