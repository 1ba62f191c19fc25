"""Standing: the result that counts for each student, or why none does."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from functools import partial

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import CUP, DEFENCE, Course
from ...errors import LabkitError
from ..each import Failure, for_student
from ..submission import Submission, digest, is_name, misnamed, plain_name, students
from .results import Result, Results


def standing(
    course: Course, assignment: str, student: str | None = None
) -> Iterator[Result | Failure]:
    """The result of everybody who handed in or was graded.

    Args:
        course: The course.
        assignment: Which.
        student: Only this one.

    Yields:
        In order of name, the result; or why none counts and what to type: the submission is not
        graded, another one was handed in since, the release has other questions or points since,
        or the result file is damaged.
    """
    if assignment in {CUP, DEFENCE}:
        return  # marked by verbs of their own, and without a result
    results = Results(course, assignment)
    handed_in = set(students(course, assignment))
    released = _released(course, assignment)
    if student is None:
        yield from misnamed(course, assignment)
    for name in sorted(handed_in | set(results.students())):
        if not is_name(name):
            yield Failure(plain_name(name), f"a file in {results.folder} has this name; delete it")
        elif student in {None, name}:
            step = partial(_counts, course, results, name, name in handed_in, released)
            yield for_student(name, step)


def full_marks(course: Course, assignment: str) -> float:
    """What the release says there is to earn, with what a person gives; 0 without one."""
    if not (course.bundle / f"{assignment}.json").exists():
        return 0.0
    bundle = Bundle.of(course, assignment)
    return bundle.points + bundle.by_hand


def grade_again(assignment: str, student: str) -> str:
    """What to type, so that a student's result is made and recorded."""
    return f"type: labkit grade {assignment} --student {shlex.quote(student)}"


def _released(course: Course, assignment: str) -> Mapping[str, float] | None:
    """The points of each question as they were released last; None where nothing is released."""
    if not (course.bundle / f"{assignment}.json").exists():
        return None
    return {q["name"]: q["points"] for q in Bundle.of(course, assignment).data["questions"]}


def _counts(
    course: Course,
    results: Results,
    student: str,
    is_handed_in: bool,
    released: Mapping[str, float] | None,
) -> Result:
    assignment = results.folder.name
    remedy = grade_again(assignment, student)
    if not is_handed_in:
        remedy = f"nothing of theirs is in submitted/; restore {results.path(student)} or delete it"
    try:
        result = results.read(student)
    except LabkitError as error:
        raise LabkitError(f"{error}; {remedy}") from None
    if result is None:
        raise LabkitError(f"handed in and not graded; {remedy}")
    if is_handed_in:
        data, _, _ = Submission.of(course, assignment, student).read()
        if digest(data) != result.hashes["submission"]:
            raise LabkitError(f"handed in again and not graded since; {remedy}")
        if released is not None and not result.rejected and result.asked != released:
            raise LabkitError(
                f"{_changed(result.asked, released)}; type: labkit grade {assignment}, and with "
                "--lower if a mark is then kept"
            )
    return result


def _changed(graded: Mapping[str, float], released: Mapping[str, float]) -> str:
    """How the questions of a result differ from those of the release, in a sentence."""
    name = min(x for x in {*graded, *released} if graded.get(x) != released.get(x))
    was, now = (f"{x[name]:g} points" if name in x else "not asked" for x in (graded, released))
    return f"graded before the last release: {name} was {was} then and is {now} now"
