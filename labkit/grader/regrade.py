"""Regrade: whose mark changes after a test has changed, known before anything is written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from ..course.bundle import Bundle
from ..course.layout import Course
from ..errors import LabkitError
from .batch import GradeOptions, grade_aside
from .each import Failed, for_student
from .results import Result, Results
from .submission import Submission


@dataclass(frozen=True)
class Move:
    """A mark before and after.

    Attributes:
        before: The result that counts now, if there is one.
        after: The new one.
    """

    before: Result | None
    after: Result

    @property
    def by(self) -> float:
        """How far the mark moves."""
        return round(self.after.score - (self.before.score if self.before else 0.0), 4)

    def __str__(self) -> str:
        if self.before is None:
            return f"{self.after.student}: new, {self.after.score:g} of {self.after.points:g}"
        each = {q.verdict.name: q.verdict.earned for q in self.before.questions}
        parts = [
            f"{v.name} {each.get(v.name, 0.0):g} -> {v.earned:g}"
            for v in (q.verdict for q in self.after.questions)
            if v.earned != each.get(v.name, 0.0)
        ]
        says = f" ({'; '.join(parts)})" if parts else ""
        return (
            f"{self.after.student}: {self.before.score:g} -> {self.after.score:g}, "
            f"{self.by:+g}{says}"
        )


def moves(
    course: Course, assignment: str, students: Sequence[str], options: GradeOptions
) -> Iterator[Move | LabkitError]:
    """Grade aside, and compare with the results that count; nothing of the course is changed."""
    bundle, now = Bundle.of(course, assignment), Results(course, assignment)
    submissions = [Submission.of(course, assignment, student) for student in students]
    for result in grade_aside(course, bundle, submissions, options):
        if isinstance(result, LabkitError):
            yield result
        else:
            yield Move(now.get(result.student), result)


def accept(
    course: Course, assignment: str, moved: Sequence[Move], *, lower: bool
) -> list[Result | Failed]:
    """Let new results count; the old ones are kept beside them.

    Args:
        course: The course.
        assignment: Which.
        moved: What `moves` found.
        lower: Whether marks may fall; otherwise those keep their old result.

    Returns:
        Those that count now; and for whom the new one could not be written.
    """
    results = Results(course, assignment)

    def keep(result: Result) -> Result:
        results.keep(result)
        return result

    accepted = [move.after for move in moved if lower or move.by >= 0]
    return [for_student(result.student, partial(keep, result)) for result in accepted]


def summary(moved: Sequence[Move]) -> Iterator[str]:
    """Whose mark moves and how many there are, a sentence each."""
    for move in sorted(moved, key=lambda m: m.by):
        if move.by or move.before is None:
            yield str(move)
    changed = sum(bool(m.by) for m in moved)
    yield f"{changed} of {len(moved)} marks move, {sum(m.by < 0 for m in moved)} of them down"
    before = {m.before.points for m in moved if m.before} - {m.after.points for m in moved}
    if before:
        full = ", ".join(f"{points:g}" for points in sorted(before))
        yield f"full marks were {full} and are {moved[0].after.points:g} now"
