"""Grade a class: resume where the last run stopped, and report what many students failed."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass, field

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..course.verdict import Outcome
from .each import Failure, for_student
from .files import exclusive_run
from .grade import hashes
from .grading.executor import executor
from .grading.worker import Task, grade_submission
from .results import Result, Results
from .sandbox.limits import Limits
from .sandbox.mounts import NoIsolation
from .submission import Submission

FAILURE_RATE_ALERT = 0.3
"""If a larger share of the class fails a test, the run asks whether the test is to blame."""
MIN_ATTEMPTS = 5
"""With fewer attempts at a question than this, none of its tests is called into doubt."""
MIN_FAILURES = 3
"""With fewer failures of a test, such as two of one known mistake, the test is not doubted."""
PROGRESS_INTERVAL = 15.0
"""Seconds between two progress reports."""


@dataclass(frozen=True)
class GradeOptions:
    """How to grade.

    Attributes:
        jobs: How many workers run at the same time.
        isolated: False only if somebody typed ``--unsafe-no-isolation``.
        dask: The address of a Dask scheduler; None for this machine.
        again: Whether to grade a submission again although its result is up to date.
        lower: Whether the mark of an unchanged submission may fall.
        limits: What a submission may use on a fast machine.
        tell: Called every `PROGRESS_INTERVAL` seconds with a sentence that reports progress.
    """

    jobs: int = 1
    isolated: bool = True
    dask: str | None = None
    again: bool = False
    lower: bool = False
    limits: Limits = field(default_factory=Limits)
    tell: Callable[[str], object] = lambda _: None


@dataclass(frozen=True)
class GradedSubmission:
    """A graded submission.

    Attributes:
        now: The result of grading.
        before: The result that counted before; None if there was none.
        kept: Whether that one still counts, as the mark would have become lower.
    """

    now: Result
    before: Result | None = None
    kept: bool = False

    @property
    def result(self) -> Result:
        """The result that counts."""
        return self.before if self.before and self.kept else self.now

    @property
    def says(self) -> str:
        """What became of the previous mark; "" if there was none or it is the same."""
        now, before = self.now, self.before
        if before is now:
            return "as before"
        if self.kept:
            return f"kept; --lower lets the mark fall to {now.score:g} of {now.points:g}"
        if before is None or (before.score, before.points) == (now.score, now.points):
            return ""
        return f"was {before.score:g} of {before.points:g}"


def grade_class(
    course: Course,
    assignment: str,
    who: Sequence[str],
    options: GradeOptions,
    *,
    change: bool = True,
) -> Iterator[GradedSubmission | Failure]:
    """Grade submissions, and write a result file for each.

    Args:
        course: The course.
        assignment: The name of the assignment.
        who: The students whose submissions are graded.
        options: How to grade.
        change: False to write nothing.

    Yields:
        For each student the result, or why grading failed.

    Raises:
        LabkitError: The assignment was not released, or another run is under way.
        NoIsolation: No sandbox can be made here.
    """
    bundle, results = Bundle.of(course, assignment), Results(course, assignment)
    with exclusive_run(results.folder):
        todo: list[Submission] = []
        for submission in (Submission.of(course, assignment, student) for student in who):
            before = results.get(submission.student)
            if before and not options.again and _is_up_to_date(before, submission, bundle, options):
                yield GradedSubmission(before, before)
            else:
                todo.append(submission)
        for result in _graded(course, bundle, todo, options):
            if isinstance(result, Failure):
                yield result
                continue
            before = results.get(result.student)
            lower = before is not None and result.falls_from(before)
            one = GradedSubmission(result, before, kept=lower and not options.lower)
            keeps = change and not one.kept
            failed = for_student(result.student, results.keep, result) if keeps else None
            yield failed or one


def _graded(
    course: Course, bundle: Bundle, submissions: Sequence[Submission], options: GradeOptions
) -> Iterator[Result | Failure]:
    """Each result as soon as it is finished, or why grading failed."""
    key = bundle.data["hash"]
    with executor(options.jobs, options.dask) as pool:
        tasks = [Task(course, x, key, options.isolated, options.limits) for x in submissions]
        whose = {pool.submit(grade_submission, x): x.submission.student for x in tasks}
        began = said = time.monotonic()
        left = set(whose)
        while left:
            done, left = wait(left, PROGRESS_INTERVAL, FIRST_COMPLETED)
            for future in done:
                yield for_student(whose[future], future.result, of_all=(NoIsolation,))
            now, count = time.monotonic(), len(tasks) - len(left)
            if left and now >= said + PROGRESS_INTERVAL:
                said, minutes = now, (now - began) * len(left) / max(1, count) / 60
                rest = f", about {max(1, round(minutes))} min left" if count else ""
                options.tell(f"{count} of {len(tasks)} graded{rest}")


def _is_up_to_date(
    before: Result, submission: Submission, bundle: Bundle, options: GradeOptions
) -> bool:
    """Whether the same submission, release and engine led to a result, and a sandbox if asked."""
    data, _, _ = submission.read()
    isolated = not (options.isolated and before.isolation.startswith("none"))
    return isolated and before.hashes == hashes(data, bundle.of_student(submission.student))


def changes(found: Sequence[GradedSubmission]) -> Iterator[str]:
    """A sentence for each mark that a new release moves, and one that counts them."""
    moved = [x for x in found if x.before and (x.kept or x.now.score != x.before.score)]
    for one in moved:
        each = one.before.earned if one.before else {}
        parts = [
            f"{v.name} {each.get(v.name, 0.0):g} -> {v.earned:g}"
            for v in (q.verdict for q in one.now.questions)
            if v.earned != each.get(v.name, 0.0)
        ]
        only = "; only with --lower" if one.kept else ""
        was, now = one.before or one.now, one.now
        yield f"{now.student}: {was.score:g} -> {now.score:g} ({', '.join(parts)}){only}"
    had = sum(x.before is not None for x in found)
    yield f"{len(moved)} of {had} marks would change; {len(found) - had} new"


def common_failures(results: Sequence[Result], fewest: int = 1) -> Iterator[str]:
    """Name the questions with a test that many students fail, as the test may be to blame.

    Args:
        results: The results of the class.
        fewest: Counts of fewer students are not given.

    Yields:
        A sentence for each such question, about the test that most students fail.
    """
    graded = [r for r in results if not r.unanswered]
    failed: Counter[tuple[str, str]] = Counter()
    tried: Counter[str] = Counter()
    for result in graded:
        for question in result.questions:
            if question.verdict.outcome in (Outcome.NOT_ATTEMPTED, Outcome.NOT_COUNTED):
                continue
            tried[question.verdict.name] += 1
            for one in question.verdict.tests:
                failed[question.verdict.name, one.name] += one.outcome is not Outcome.RIGHT
    doubtful: dict[str, list[tuple[int, str]]] = {}
    for (name, test), count in failed.most_common():
        share = FAILURE_RATE_ALERT * tried[name]
        if count > share and count >= MIN_FAILURES and tried[name] >= MIN_ATTEMPTS:
            doubtful.setdefault(name, []).append((count, test))
    for name, ((count, test), *others) in doubtful.items():
        more = f", and many fail {len(others)} more of its tests" if others else ""
        students = f"<{fewest}" if count < fewest else count
        yield (
            f"{students} of {tried[name]} who tried {name} fail the test {test!r}{more}: "
            "is the cause the test, the text or the lecture?"
        )
