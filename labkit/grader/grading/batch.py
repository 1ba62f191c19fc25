"""A batch: grade a class, resume where the last run stopped, say what the class has in common."""

from __future__ import annotations

import shlex
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.verdict import Outcome
from ...errors import LabkitError
from ..each import Failure, for_student
from ..lock import exclusive_run
from ..sandbox.limits import Limits
from ..sandbox.mounts import NoIsolation
from ..submission import Submission, students
from .executor import executor
from .grade import hashes
from .results import Result, Results
from .worker import Task, grade_submission

FAILURE_RATE_ALERT = 0.3
"""If more than this share of a class fails one test, the run asks whether the test is to blame."""
MIN_ATTEMPTS = 5
"""Nothing is concluded from fewer than these."""
MIN_FAILURES = 3
"""Fewer failures than this, such as two of one known mistake, do not cast doubt on a test."""
EVERY = 15.0
"""Seconds between two sentences on how far it is."""


@dataclass(frozen=True)
class GradeOptions:
    """How to grade.

    Attributes:
        jobs: Workers at once.
        isolated: False only if somebody typed ``--unsafe-no-isolation``.
        dask: Address of a scheduler, or None for this machine.
        again: Whether to grade again what has a result that is up to date.
        lower: Whether the mark of an unchanged submission may fall.
        limits: What a submission may use, on a quick machine.
        tell: Called every `EVERY` seconds with a sentence on how far it is.
        recorded: What the gradebook has for a student's questions; asked where a result is damaged.
    """

    jobs: int = 1
    isolated: bool = True
    dask: str | None = None
    again: bool = False
    lower: bool = False
    limits: Limits = field(default_factory=Limits)
    tell: Callable[[str], object] = lambda _: None
    recorded: Callable[[str], Mapping[str, float]] = lambda _: {}


@dataclass(frozen=True)
class GradedSubmission:
    """One submission, graded.

    Attributes:
        result: The one that counts.
        says: How it stands to the one before; empty if the mark is the same, or there was none.
    """

    result: Result
    says: str = ""


def grade_class(
    course: Course, assignment: str, who: Sequence[str], options: GradeOptions
) -> Iterator[GradedSubmission | Failure]:
    """Grade submissions, each into a result file of its own.

    Args:
        course: The course.
        assignment: Its name.
        who: Whose submissions.
        options: How to grade.

    Yields:
        Each result, or what failed.

    Raises:
        LabkitError: The assignment was not released, or another run is under way.
        NoIsolation: No sandbox can be made here.
    """
    bundle, results = Bundle.of(course, assignment), Results(course, assignment)
    todo: list[Submission] = []
    with exclusive_run(results.folder):
        for student in who:
            submission = Submission.of(course, assignment, student)
            before = None if options.again else still_good([results], submission, bundle, options)
            aside = None if before else still_good([results.aside], submission, bundle, options)
            if before is not None:
                yield GradedSubmission(before, "as before")
            elif aside is not None:
                yield for_student(student, partial(keep, results, aside, options))
            else:
                todo.append(submission)
        yield from _kept(results, grade_aside(course, bundle, todo, options), options)


def watch(
    course: Course, assignment: str, options: GradeOptions, pause: float = 1.0
) -> Iterator[GradedSubmission | Failure]:
    """Grade submissions as they come, in workers that stay warm, until somebody stops it.

    What is handed in and has no result of its own is the queue, so a run that is killed loses
    nothing.  A new release puts everybody back into it.  One whose grading failed is tried again
    once this student hands in something else, or the assignment is released again.

    Args:
        course: The course.
        assignment: Its name.
        options: How to grade.
        pause: Seconds between two looks at ``submitted/``.

    Yields:
        Each result, or what failed.

    Raises:
        LabkitError: The assignment was not released, or another run is under way.
        NoIsolation: No sandbox can be made here.
    """
    results, looked = Results(course, assignment), dict[str, tuple[object, ...]]()
    with exclusive_run(results.folder), executor(options.jobs, options.dask) as pool:
        while True:
            bundle = Bundle.of(course, assignment)
            todo: list[Submission] = []
            for student in students(course, assignment):
                submission = Submission.of(course, assignment, student)
                now = (*_look(submission.folder), bundle.data["hash"], bundle.arms)
                if looked.get(student) != now:
                    looked[student] = now
                    if still_good([results], submission, bundle, options) is None:
                        todo.append(submission)
            yield from _kept(results, _graded(pool, course, bundle, todo, options), options)
            if not todo:
                time.sleep(pause)


def _look(folder: Path) -> tuple[float, int]:
    """What changes when something else is handed in."""
    found = [path.lstat() for path in folder.glob("*.ipynb")]
    return max((x.st_mtime for x in found), default=0.0), sum(x.st_size for x in found)


def grade_aside(
    course: Course, bundle: Bundle, submissions: Iterable[Submission], options: GradeOptions
) -> Iterator[Result | Failure]:
    """Grade submissions and keep nothing of it.

    Yields:
        Each result as it is finished, or what failed.

    Raises:
        NoIsolation: No sandbox can be made here.
        LabkitError: There is no such Dask scheduler.
    """
    with executor(options.jobs, options.dask) as pool:
        yield from _graded(pool, course, bundle, submissions, options)


def _graded(
    pool: Executor,
    course: Course,
    bundle: Bundle,
    submissions: Iterable[Submission],
    options: GradeOptions,
) -> Iterator[Result | Failure]:
    key = bundle.data["hash"]
    tasks = [Task(course, x, key, options.isolated, options.limits) for x in submissions]
    whose = {pool.submit(grade_submission, x): x.submission.student for x in tasks}
    began = said = time.monotonic()
    left = set(whose)
    while left:
        done, left = wait(left, EVERY, FIRST_COMPLETED)
        for future in done:
            yield for_student(whose[future], future.result, of_all=(NoIsolation,))
        now, count = time.monotonic(), len(tasks) - len(left)
        if left and now >= said + EVERY:
            said, minutes = now, (now - began) * len(left) / max(1, count) / 60
            rest = f", about {max(1, round(minutes))} min left" if count else ""
            options.tell(f"{count} of {len(tasks)} graded{rest}")


def _kept(
    results: Results, graded: Iterable[Result | Failure], options: GradeOptions
) -> Iterator[GradedSubmission | Failure]:
    for result in graded:
        if isinstance(result, Failure):
            yield result
        else:
            yield for_student(result.student, partial(keep, results, result, options))


def keep(results: Results, result: Result, options: GradeOptions) -> GradedSubmission:
    """Store a result, unless it would lower the mark of an unchanged submission unasked.

    Raises:
        LabkitError: The result before cannot be read, and the gradebook has a higher mark.
    """
    before = results.get(result.student)
    if before is not None and not options.lower and result.falls_from(before):
        now = f"{result.score:g} of {result.points:g}"
        return GradedSubmission(before, f"kept; --lower lets it fall to {now}")
    if before is None and not options.lower and results.path(result.student).exists():
        _refuse_to_lower(result, options.recorded(result.student))
    results.keep(result)
    if before is None or (before.score, before.points) == (result.score, result.points):
        return GradedSubmission(result)
    full = f" of {before.points:g}" if before.points != result.points else ""
    return GradedSubmission(result, f"was {before.score:g}{full}")


def _refuse_to_lower(result: Result, recorded: Mapping[str, float]) -> None:
    """Compare with the gradebook; which submission its marks are of, nobody knows."""
    now = {q.verdict.name: q.verdict.earned for q in result.questions}
    both = [name for name in recorded if name in now or result.rejected]
    had, has = sum(recorded[x] for x in both), sum(now.get(x, 0.0) for x in both)
    if had > has + 0.01:
        raise LabkitError(
            f"the result before cannot be read, and the gradebook has {had:g} for what earns "
            f"{has:g} now; if that is to count, type: labkit grade {result.assignment} --student "
            f"{shlex.quote(result.student)} --lower"
        )


def common_failures(results: Sequence[Result]) -> Iterator[str]:
    """Name the questions with a test that many students fail: is the test to blame?

    Yields:
        One sentence for each such question, on the test that most students fail.
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
    loud: dict[str, list[tuple[int, str]]] = {}
    for (name, test), count in failed.most_common():
        share = FAILURE_RATE_ALERT * tried[name]
        if count > share and count >= MIN_FAILURES and tried[name] >= MIN_ATTEMPTS:
            loud.setdefault(name, []).append((count, test))
    for name, ((count, test), *others) in loud.items():
        more = f"; so it is with {len(others)} more of its tests" if others else ""
        yield (
            f"{count} of {tried[name]} who tried {name} fail the test {test!r}{more}: "
            "is it the test, the text or the lecture?"
        )


def still_good(
    places: Iterable[Results], submission: Submission, bundle: Bundle, options: GradeOptions
) -> Result | None:
    """A result before, if it came from these very contents."""
    for results in places:
        before = results.get(submission.student)
        if before is None or (options.isolated and before.isolation.startswith("none")):
            continue
        data, _, _ = submission.read()
        if before.hashes == hashes(data, bundle.of_student(submission.student)):
            return before
    return None
