"""A worker process, which grades one submission after another in a sandbox that it keeps."""

from __future__ import annotations

import atexit
import signal
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TypeVar

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..errors import LabkitError
from .grade import grade, rejection
from .plan import imports
from .results import Result
from .sandbox.launch import Isolation, Sandbox, SandboxLost
from .sandbox.limits import Limits, limit_memory, slowness
from .submission import Submission

T = TypeVar("T")
TRIES = 2
"""How often a worker tries a submission if its sandbox is lost."""


@dataclass(frozen=True)
class Task:
    """A submission to be graded.

    Attributes:
        course: The course, which the sandbox hides.
        submission: The student's files.
        bundle_hash: The hash of the release that the submission is compared with.
        isolation: What isolates its code.
        limits: What it may use on a fast machine.
    """

    course: Course
    submission: Submission
    bundle_hash: str
    isolation: Isolation
    limits: Limits


_sandboxes: dict[tuple[Course, Isolation], Sandbox] = {}
"""The sandbox of this process, if it has one."""


def grade_submission(task: Task) -> Result:
    """Grade one submission in this worker.

    The kernel ends a worker that takes longer than `Limits.worker`, whatever it is doing.

    Raises:
        NoIsolation: No sandbox can be made on this machine.
        LabkitError: The sandbox was lost in every attempt, memory ran out, or the grader failed.
    """
    with warnings.catch_warnings():
        _limit_once()
        warnings.simplefilter("ignore")  # the verdict reports numbers that overflow
        limits = task.limits.scaled(slowness())
        signal.setitimer(signal.ITIMER_REAL, limits.worker)
        try:
            return Result.read(_grade(task, limits).text())  # as its file will be read
        except LabkitError:
            raise
        except Exception as error:  # too little memory, too
            raise LabkitError(f"the grader failed: {type(error).__name__}: {error}") from None
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)


def _grade(task: Task, limits: Limits) -> Result:
    bundle = _bundle(task.course, task.submission.assignment, task.bundle_hash)
    student = task.submission.student
    data, note, why = task.submission.read()

    def once(sandbox: Sandbox) -> Result:
        if why:
            return rejection(why, student, bundle, sandbox.level)
        return grade(data, student, bundle, sandbox, limits, note)

    return in_sandbox(once, task.course, imports(bundle.data["cells"]), task.isolation)


def in_sandbox(
    do: Callable[[Sandbox], T], course: Course, loads: Sequence[str], isolation: Isolation
) -> T:
    """Call a function with this process's sandbox, and once more with a new one if it is lost.

    Args:
        do: The function.
        course: The course that the sandbox hides; each course needs a sandbox of its own.
        loads: Modules that the sandbox loads once, for all submissions.
        isolation: What isolates the code in it.

    Raises:
        NoIsolation: No sandbox can be made on this machine.
        LabkitError: The sandbox was lost in every attempt.
    """
    key, lost = (course, isolation), ""
    for _ in range(TRIES):
        try:
            if key not in _sandboxes:
                close_sandbox()
                _sandboxes[key] = Sandbox(loads, [course.root], isolation)
            return do(_sandboxes[key])
        except SandboxLost as error:
            lost = str(error)
            close_sandbox()
    raise LabkitError(f"its sandbox was lost {TRIES} times ({lost}); is there enough memory?")


@atexit.register
def close_sandbox() -> None:
    """End this process's sandbox."""
    while _sandboxes:
        _sandboxes.popitem()[1].close()


@lru_cache(maxsize=4)
def _bundle(course: Course, assignment: str, key: str) -> Bundle:
    """The bundle with a given hash."""
    bundle = Bundle.of(course, assignment)
    if bundle.data["hash"] != key:
        raise LabkitError(f"{assignment} was released again while it was being graded; grade again")
    return bundle


_limit_once = cache(limit_memory)
