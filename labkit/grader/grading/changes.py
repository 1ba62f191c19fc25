"""Show whose mark a changed test would move, before any mark is written."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..clean import how_many
from ..each import Failure, for_student
from ..submission import Submission
from .batch import GradeOptions, grade_without_saving, reusable
from .results import Result, Results


@dataclass(frozen=True)
class Change:
    """What a new release does to the mark of one student.

    Attributes:
        before: The result that counts now; None if there is none.
        after: The result with the new release.
    """

    before: Result | None
    after: Result

    @property
    def by(self) -> float:
        """The difference between the new score and the old one."""
        return round(self.after.score - (self.before.score if self.before else 0.0), 4)

    @property
    def moves(self) -> bool:
        """Whether a mark that counts now would become another; a first mark moves nothing."""
        return self.before is not None and (self.by != 0.0 or self.falls)

    @property
    def falls(self) -> bool:
        """Whether the new mark counts only with ``--lower``."""
        return self.before is not None and self.after.falls_from(self.before)

    def __str__(self) -> str:
        if self.before is None:
            return f"{self.after.student}: new, {self.after.score:g} of {self.after.points:g}"
        each = {q.verdict.name: q.verdict.earned for q in self.before.questions}
        same = self.falls or self.before.hashes["submission"] == self.after.hashes["submission"]
        parts = [] if same else ["handed in again"]
        parts += [
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
    """Grade submissions and compare with the results that count, without changing a mark.

    The new results are stored as provisional ones, so that `grade_class` need not grade again.

    Raises:
        LabkitError: The assignment's sources are newer than its release.
    """
    bundle, now = Bundle.of(course, assignment), Results(course, assignment)
    _refuse_unreleased(course, assignment)
    todo: list[Submission] = []
    for student in students:
        submission = Submission.of(course, assignment, student)
        done = reusable(now, submission, bundle, options)
        done = done or reusable(now.provisional, submission, bundle, options)
        if done is None:
            todo.append(submission)
        else:
            yield Change(now.get(student), done)
    for result in grade_without_saving(course, bundle, todo, options):
        if isinstance(result, Failure):
            yield result
        else:
            yield for_student(result.student, partial(_keep_provisionally, now, result))


def _keep_provisionally(now: Results, result: Result) -> Change:
    now.provisional.keep(result)
    return Change(now.get(result.student), result)


def _refuse_unreleased(course: Course, assignment: str) -> None:
    """Refuse to compare if the tests have been corrected since the assignment was released."""
    released = (course.bundle / f"{assignment}.json").stat().st_mtime
    sources = sorted(course.notebook_source(assignment).parent.glob("*.py"))
    newer = [file.name for file in sources if file.stat().st_mtime > released]
    if newer:
        raise LabkitError(
            f"{', '.join(newer)} changed after {assignment} was released, so --diff would not see "
            f"the change; type: labkit release {assignment}, and correct what it refuses"
        )


def summary(found: Sequence[Change]) -> Iterator[str]:
    """A sentence for each mark that moves, and one that counts them."""
    for change in sorted(found, key=lambda m: m.by):
        if change.moves or change.before is None:
            yield str(change)
    had, changed = sum(m.before is not None for m in found), sum(m.moves for m in found)
    lower = sum(m.falls for m in found)
    only = f", {lower} of them only with --lower" if lower else ", none of them needs --lower"
    new = f"; {len(found) - had} new" if len(found) > had else ""
    yield f"{changed} of {how_many(had, 'mark')} would change{only if changed else ''}{new}"
    before = {m.before.points for m in found if m.before} - {m.after.points for m in found}
    if before:
        full = ", ".join(f"{points:g}" for points in sorted(before))
        yield f"full marks were {full} and are {found[0].after.points:g} now"
