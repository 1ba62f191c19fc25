"""Grade a class: resume where the last run stopped, and report what many students failed."""

from __future__ import annotations

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
from .current_results import how_to_grade
from .executor import executor
from .grade import hashes
from .results import Result, Results
from .worker import Task, grade_submission

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
        recorded: Returns the points that the gradebook has for each question of a student;
            called if the student's result file is damaged.
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
    """A graded submission.

    Attributes:
        result: The result that counts.
        says: What became of the previous mark: "as before", "was 3", or "kept" and why; empty if
            there was none, or the submission was graded again and has the same mark.
    """

    result: Result
    says: str = ""


def grade_class(
    course: Course, assignment: str, who: Sequence[str], options: GradeOptions
) -> Iterator[GradedSubmission | Failure]:
    """Grade submissions, and write a result file for each.

    Args:
        course: The course.
        assignment: The name of the assignment.
        who: The students whose submissions are graded.
        options: How to grade.

    Yields:
        For each student the result, or why grading failed.

    Raises:
        LabkitError: The assignment was not released, or another run is under way.
        NoIsolation: No sandbox can be made here.
    """
    bundle, results = Bundle.of(course, assignment), Results(course, assignment)
    todo: list[Submission] = []
    with exclusive_run(results.folder):
        for student in who:
            submission = Submission.of(course, assignment, student)
            before = reusable(results, submission, bundle, options)
            ready = None if before else reusable(results.provisional, submission, bundle, options)
            if before is not None:
                yield GradedSubmission(before, "as before")
            elif ready is not None:
                yield for_student(student, partial(keep_unless_lower, results, ready, options))
            else:
                todo.append(submission)
        yield from _keep_each(results, grade_without_saving(course, bundle, todo, options), options)


def watch(
    course: Course, assignment: str, options: GradeOptions, pause: float = 1.0
) -> Iterator[GradedSubmission | Failure]:
    """Grade submissions as they arrive, in workers that keep running, until somebody stops it.

    The queue consists of the submissions that have no up-to-date result, so a run that is killed
    loses nothing, and a new release puts every submission back into the queue.  A submission
    whose grading failed is tried again when the student hands in something else, or when the
    assignment is released again.

    Args:
        course: The course.
        assignment: The name of the assignment.
        options: How to grade.
        pause: Seconds between two looks at ``submitted/``.

    Yields:
        For each student the result, or why grading failed.

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
                now = (*_fingerprint(submission.folder), bundle.data["hash"], bundle.arms)
                if looked.get(student) != now:
                    looked[student] = now
                    if reusable(results, submission, bundle, options) is None:
                        todo.append(submission)
            yield from _keep_each(results, _graded(pool, course, bundle, todo, options), options)
            if not todo:
                time.sleep(pause)


def _fingerprint(folder: Path) -> tuple[float, int]:
    """A value that changes when a student hands in something else."""
    found = [path.lstat() for path in folder.glob("*.ipynb")]
    return max((x.st_mtime for x in found), default=0.0), sum(x.st_size for x in found)


def grade_without_saving(
    course: Course, bundle: Bundle, submissions: Iterable[Submission], options: GradeOptions
) -> Iterator[Result | Failure]:
    """Grade submissions without storing their results.

    Yields:
        Each result as soon as it is finished, or why grading failed.

    Raises:
        NoIsolation: No sandbox can be made on this machine.
        LabkitError: There is no Dask scheduler at the address given.
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
        done, left = wait(left, PROGRESS_INTERVAL, FIRST_COMPLETED)
        for future in done:
            yield for_student(whose[future], future.result, of_all=(NoIsolation,))
        now, count = time.monotonic(), len(tasks) - len(left)
        if left and now >= said + PROGRESS_INTERVAL:
            said, minutes = now, (now - began) * len(left) / max(1, count) / 60
            rest = f", about {max(1, round(minutes))} min left" if count else ""
            options.tell(f"{count} of {len(tasks)} graded{rest}")


def _keep_each(
    results: Results, graded: Iterable[Result | Failure], options: GradeOptions
) -> Iterator[GradedSubmission | Failure]:
    for result in graded:
        if isinstance(result, Failure):
            yield result
        else:
            yield for_student(result.student, partial(keep_unless_lower, results, result, options))


def keep_unless_lower(results: Results, result: Result, options: GradeOptions) -> GradedSubmission:
    """Store a result, unless it lowers the mark of an unchanged submission without ``--lower``.

    Raises:
        LabkitError: The previous result cannot be read, and the gradebook has a higher mark.
    """
    before = results.get(result.student)
    if before is not None and not options.lower and result.falls_from(before):
        now = f"{result.score:g} of {result.points:g}"
        return GradedSubmission(before, f"kept; --lower lets the mark fall to {now}")
    if before is None and not options.lower and results.path(result.student).exists():
        _refuse_to_lower(result, options.recorded(result.student))
    results.keep(result)
    if before is None or (before.score, before.points) == (result.score, result.points):
        return GradedSubmission(result)
    full = f" of {before.points:g}" if before.points != result.points else ""
    return GradedSubmission(result, f"was {before.score:g}{full}")


def _refuse_to_lower(result: Result, recorded: Mapping[str, float]) -> None:
    """Refuse a lower mark than the gradebook's, which may be that of another submission."""
    now = {q.verdict.name: q.verdict.earned for q in result.questions}
    both = [name for name in recorded if name in now or result.rejected]
    had, has = sum(recorded[x] for x in both), sum(now.get(x, 0.0) for x in both)
    if had > has + 0.01:
        raise LabkitError(
            f"the previous result cannot be read, and the gradebook has {had:g} for what now earns "
            f"{has:g}; if {has:g} is to count, "
            f"{how_to_grade(result.assignment, result.student)} --lower"
        )


def cannot_be_graded(results: Iterable[Result]) -> Iterator[str]:
    """A sentence that names who handed in a file that cannot be graded, if anybody did."""
    if names := sorted(result.student for result in results if result.rejected):
        yield (
            f"these students handed in a file that cannot be graded: {', '.join(names)}; ask each "
            "for a new one, unless attempts/ holds another of theirs that can count; give an "
            "extension if it would be late"
        )


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


def reusable(
    results: Results, submission: Submission, bundle: Bundle, options: GradeOptions
) -> Result | None:
    """The stored result, if the same submission, release and engine led to it; not ``again``."""
    before = None if options.again else results.get(submission.student)
    if before is None or (options.isolated and before.isolation.startswith("none")):
        return None
    data, _, _ = submission.read()
    return before if before.hashes == hashes(data, bundle.of_student(submission.student)) else None
