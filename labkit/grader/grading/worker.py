"""A worker process, which grades one submission after another in a sandbox that it keeps."""

from __future__ import annotations

import atexit
import signal
import threading
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TypeVar

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..grade import grade, rejection
from ..plan import imports
from ..results import Result
from ..sandbox.cgroup import MEMORY, limit_memory
from ..sandbox.launch import Sandbox, SandboxLost
from ..sandbox.limits import Limits, slowness
from ..sandbox.mounts import Isolation, NoIsolation
from ..submission import Submission

T = TypeVar("T")
TRIES = 2
"""How often a worker tries a submission if its sandbox is lost.

If the worker itself dies, `executor.TRIES` gives the submission to another worker, so a submission
is tried four times at most.
"""


@dataclass(frozen=True)
class Task:
    """A submission to be graded.

    Attributes:
        course: The course, which the sandbox hides.
        submission: The student's files.
        bundle_hash: The hash of the release that the submission is compared with.
        isolated: Whether its code runs in a sandbox.
        limits: What it may use on a fast machine.
    """

    course: Course
    submission: Submission
    bundle_hash: str
    isolated: bool
    limits: Limits


_busy = threading.Lock()
_sandboxes: dict[tuple[Course, bool], Sandbox] = {}
"""The sandbox of this process, if it has one."""


def grade_submission(task: Task) -> Result:
    """Grade one submission in this worker.

    The kernel ends a worker that takes longer than `Limits.worker`, whatever it is doing.

    Raises:
        NoIsolation: No sandbox can be made on this machine.
        LabkitError: The sandbox was lost in every attempt, memory ran out, or the grader failed.
    """
    with _busy, warnings.catch_warnings():
        _limit_once()
        warnings.simplefilter("ignore")  # the verdict reports numbers that overflow
        limits = task.limits.scaled(slowness())
        signal.setitimer(signal.ITIMER_REAL, limits.worker)
        try:
            return Result.read(_grade(task, limits).text())  # as its file will be read
        except NoIsolation:
            raise
        except MemoryError:
            why = f"judging it takes more than {MEMORY >> 20} MB of memory; look at it yourself"
        except LabkitError as error:
            why = str(error)
        except Exception as error:
            why = f"the grader failed: {type(error).__name__}: {error}"
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        raise LabkitError(why)


def _grade(task: Task, limits: Limits) -> Result:
    bundle = _bundle(task.course, task.submission.assignment, task.bundle_hash)
    student = task.submission.student
    data, note, why = task.submission.read()

    def once(sandbox: Sandbox) -> Result:
        if why:
            return rejection(why, student, bundle, sandbox.level)
        return grade(data, student, bundle, sandbox, limits, note)

    return in_sandbox(once, task.course, imports(bundle.data["cells"]), isolated=task.isolated)


def in_sandbox(
    do: Callable[[Sandbox], T], course: Course, loads: Sequence[str], *, isolated: bool = True
) -> T:
    """Call a function with this process's sandbox, and once more with a new one if it is lost.

    Args:
        do: The function.
        course: The course that the sandbox hides; each course needs a sandbox of its own.
        loads: Modules that the sandbox loads once, for all submissions.
        isolated: Whether the sandbox isolates the code in it.

    Raises:
        NoIsolation: No sandbox can be made on this machine.
        LabkitError: The sandbox was lost in every attempt.
    """
    lost = ""
    for _ in range(TRIES):
        try:
            return do(_sandbox(course, loads, isolated))
        except SandboxLost as error:
            lost = str(error)
            close_sandbox()
    raise LabkitError(
        f"its sandbox was lost {TRIES} times ({lost}); is there enough memory? Try again, "
        "or look at the submission yourself"
    )


def _sandbox(course: Course, loads: Sequence[str], isolated: bool) -> Sandbox:
    """The sandbox of this process, or a new one if that one hides another course."""
    key = course, isolated
    if key not in _sandboxes:
        close_sandbox()
        how = Isolation.BUBBLEWRAP if isolated else Isolation.NONE
        _sandboxes[key] = Sandbox(loads, [course.root], how)
    return _sandboxes[key]


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
