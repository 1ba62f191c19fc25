"""Grade a class: resume where the last run stopped, and report what many students failed."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, field

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..course.verdict import Outcome
from .each import Failure, for_student
from .executor import executor
from .files import locked
from .grade import hashes
from .results import Result, Results
from .sandbox.launch import Isolation, NoIsolation
from .sandbox.limits import Limits
from .submission import Submission
from .worker import Task, grade_submission

FAILURE_RATE_ALERT = 0.3
"""If a larger share of those who tried fails a test, the run asks whether the test is to blame."""
MIN_FAILURES = 5
"""Fewer failures of a test are no pattern."""


@dataclass(frozen=True)
class GradeOptions:
    """How to grade.

    Attributes:
        jobs: How many workers run at the same time.
        isolation: What isolates the submissions.
        dask: The address of a Dask scheduler; None for this machine.
        again: Whether to grade a submission again although its result is up to date.
        limits: What a submission may use on a fast machine.
    """

    jobs: int = 1
    isolation: Isolation = Isolation.BUBBLEWRAP
    dask: str | None = None
    again: bool = False
    limits: Limits = field(default_factory=Limits)


@dataclass(frozen=True)
class GradedSubmission:
    """A graded submission.

    Attributes:
        result: The result of grading.
        before: The result that counted before; None if there was none.
    """

    result: Result
    before: Result | None = None

    @property
    def says(self) -> str:
        """What became of the previous mark; "" if there was none or it is the same."""
        now, before = self.result, self.before
        if before is now:
            return "as before"
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
    busy = f"another run is grading {assignment}; wait for it to end"
    with locked(results.folder / ".running", busy):
        todo: list[Submission] = []
        for submission in (Submission.of(course, assignment, student) for student in who):
            before = results.get(submission.student)
            if before and not options.again and _is_up_to_date(before, submission, bundle):
                yield GradedSubmission(before, before)
            else:
                todo.append(submission)
        for result in _graded(course, bundle, todo, options):
            if isinstance(result, Failure):
                yield result
                continue
            one = GradedSubmission(result, results.get(result.student))
            failed = for_student(result.student, results.keep, result) if change else None
            yield failed or one


def _graded(
    course: Course, bundle: Bundle, submissions: Sequence[Submission], options: GradeOptions
) -> Iterator[Result | Failure]:
    """Each result as soon as it is finished, or why grading failed."""
    with executor(options.jobs, options.dask) as pool:
        key = bundle.data["hash"]
        tasks = [Task(course, x, key, options.isolation, options.limits) for x in submissions]
        whose = {pool.submit(grade_submission, x): x.submission.student for x in tasks}
        for future in as_completed(whose):
            yield for_student(whose[future], future.result, of_all=(NoIsolation,))


def _is_up_to_date(before: Result, submission: Submission, bundle: Bundle) -> bool:
    """Whether the same submission, release and engine led to a result."""
    data, _, _ = submission.read()
    return before.hashes == hashes(data, bundle)


def changes(found: Sequence[GradedSubmission]) -> Iterator[str]:
    """A sentence for each mark that a new release moves, and one that counts them."""
    old = [(x, x.before) for x in found if x.before]
    moved = [(x.result, was) for x, was in old if x.result.score != was.score]
    for now, was in moved:
        parts = [
            f"{name} {was.earned.get(name, 0.0):g} -> {points:g}"
            for name, points in now.earned.items()
            if points != was.earned.get(name, 0.0)
        ]
        yield f"{now.student}: {was.score:g} -> {now.score:g} ({', '.join(parts)})"
    yield f"{len(moved)} of {len(old)} marks would change; {len(found) - len(old)} new"


def common_failures(results: Iterable[Result]) -> Iterator[str]:
    """A sentence for each question with a test that many fail, as the test may be to blame."""
    failed: dict[str, Counter[str]] = defaultdict(Counter)
    tried: Counter[str] = Counter()
    for verdict in (question.verdict for result in results for question in result.questions):
        if verdict.outcome not in (Outcome.NOT_ATTEMPTED, Outcome.NOT_COUNTED):
            tried[verdict.name] += 1
            failed[verdict.name].update(
                test.name for test in verdict.tests if test.outcome is not Outcome.RIGHT
            )
    for name, tests in failed.items():
        for test, count in tests.most_common(1):
            if count >= MIN_FAILURES and count > FAILURE_RATE_ALERT * tried[name]:
                yield (
                    f"{count} of {tried[name]} who tried {name} fail the test {test!r}: "
                    "is the cause the test, the text or the lecture?"
                )
