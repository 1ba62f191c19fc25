"""Whose mark would change after a test has changed, known before anything is written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..each import Failure, for_student
from ..submission import Submission
from .batch import GradeOptions, grade_aside, still_good
from .results import Result, Results


@dataclass(frozen=True)
class Change:
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

    @property
    def falls(self) -> bool:
        """Whether it is lowered only with --lower."""
        return self.before is not None and self.after.falls_from(self.before)

    def __str__(self) -> str:
        if self.before is None:
            return f"{self.after.student}: new, {self.after.score:g} of {self.after.points:g}"
        each = {q.verdict.name: q.verdict.earned for q in self.before.questions}
        parts = [
            f"{v.name} {each.get(v.name, 0.0):g} -> {v.earned:g}"
            for v in (q.verdict for q in self.after.questions)
            if v.earned != each.get(v.name, 0.0)
        ]
        gone = [name for name in each if name not in self.after.asked]
        parts += [f"{name} {each[name]:g} -> not asked" for name in gone if each[name]]
        says = f" ({'; '.join(parts)})" if parts else ""
        was, now = self.before, self.after
        some = f"{was.score:g} -> {now.score:g}, {self.by:+g}"
        if was.points != now.points:
            some = f"{was.score:g} of {was.points:g} -> {now.score:g} of {now.points:g}"
        return f"{now.student}: {some}{says}"


def changes(
    course: Course, assignment: str, students: Sequence[str], options: GradeOptions
) -> Iterator[Change | Failure]:
    """Grade aside, and compare with the results that count; no mark is changed.

    What was graded is kept aside, so that `grade_class` need not do it again.

    Raises:
        LabkitError: The assignment's sources are newer than its release.
    """
    bundle, now = Bundle.of(course, assignment), Results(course, assignment)
    _refuse_unreleased(course, assignment)
    todo: list[Submission] = []
    for student in students:
        submission = Submission.of(course, assignment, student)
        done = still_good((now.aside, now), submission, bundle, options)
        if done is None:
            todo.append(submission)
        else:
            yield Change(now.get(student), done)
    for result in grade_aside(course, bundle, todo, options):
        if isinstance(result, Failure):
            yield result
        else:
            yield for_student(result.student, partial(_kept_aside, now, result))


def _kept_aside(now: Results, result: Result) -> Change:
    now.aside.keep(result)
    return Change(now.get(result.student), result)


def _refuse_unreleased(course: Course, assignment: str) -> None:
    """Refuse to compare with tests that were corrected since they were released."""
    released = (course.bundle / f"{assignment}.json").stat().st_mtime
    sources = sorted(course.notebook_source(assignment).parent.glob("*.py"))
    newer = [file.name for file in sources if file.stat().st_mtime > released]
    if newer:
        raise LabkitError(
            f"{', '.join(newer)} changed after {assignment} was released, so --diff would not try "
            f"the change; type: labkit release {assignment}, and correct what it refuses"
        )


def summary(found: Sequence[Change]) -> Iterator[str]:
    """Whose mark moves and how many there are, a sentence each."""
    for change in sorted(found, key=lambda m: m.by):
        if change.by or change.falls or change.before is None:
            yield str(change)
    changed = sum(bool(m.by) or m.falls for m in found)
    lower = sum(m.falls for m in found)
    would = f"{changed} of {len(found)} marks would change, {lower} of them only with --lower"
    yield would if changed else f"none of the {len(found)} marks would change"
    before = {m.before.points for m in found if m.before} - {m.after.points for m in found}
    if before:
        full = ", ".join(f"{points:g}" for points in sorted(before))
        yield f"full marks were {full} and are {found[0].after.points:g} now"
