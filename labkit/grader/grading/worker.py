"""A worker process: grades one submission after another in a sandbox that it keeps."""

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
from ...course.own_arm import Arms
from ...errors import LabkitError
from ..sandbox.cgroup import MEMORY, limit_memory
from ..sandbox.launch import Sandbox, SandboxLost
from ..sandbox.limits import Limits, slowness
from ..sandbox.mounts import Isolation, NoIsolation
from ..submission import Submission
from .grade import grade, rejection
from .plan import imports
from .results import Result

T = TypeVar("T")
TRIES = 2
"""How often something is tried whose sandbox is lost.

The worker may die as well, and `executor.TRIES` gives the submission to another one, so it is tried
four times at most.
"""


@dataclass(frozen=True)
class Task:
    """One submission to be graded.

    Attributes:
        course: Where it belongs; hidden from the sandbox.
        submission: The student's files.
        bundle_hash: Of the release that it is held against.
        isolated: Whether its code runs in a sandbox.
        limits: What it may use on a quick machine.
    """

    course: Course
    submission: Submission
    bundle_hash: str
    isolated: bool
    limits: Limits


_busy = threading.Lock()
_sandboxes: dict[tuple[Course, bool], Sandbox] = {}
"""This process's sandbox, if it has one."""


def grade_submission(task: Task) -> Result:
    """Grade one submission in this worker.

    The kernel ends a worker that takes longer than `Limits.worker`, whatever it is doing.

    Raises:
        NoIsolation: There is no sandbox on this machine.
        LabkitError: The sandbox was lost each time, memory ran out, or the grader failed.
    """
    with _busy, warnings.catch_warnings():
        _limit_once()
        warnings.simplefilter("ignore")  # what a student's numbers overflow is in the verdict
        limits = task.limits.scaled(slowness())
        signal.setitimer(signal.ITIMER_REAL, limits.worker)
        try:
            return Result.read(_grade(task, limits).text())  # as its file will be read
        except NoIsolation:
            raise
        except MemoryError:
            why = f"judging it takes over {MEMORY >> 20} MB; look at it yourself"
        except LabkitError as error:
            why = str(error)
        except Exception as error:
            why = f"the grader failed: {type(error).__name__}: {error}"
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        raise LabkitError(why)


def _grade(task: Task, limits: Limits) -> Result:
    arms = Arms.of(task.course.root).text()
    bundle = _bundle(task.course, task.submission.assignment, task.bundle_hash, arms)
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
    """Do something in the sandbox that this process keeps; once more, in a new one, if it is lost.

    Args:
        do: What to do.
        course: What the sandbox hides; for another course there is another sandbox.
        loads: Modules to be loaded once for all.
        isolated: Whether code is kept apart there.

    Raises:
        NoIsolation: There is no sandbox on this machine.
        LabkitError: It was lost each time.
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
    """The sandbox there is, or a new one if it is to hide another course."""
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
def _bundle(course: Course, assignment: str, key: str, arms: str) -> Bundle:
    """The bundle with a hash; ``arms`` are those that it has, as they may be given out later."""
    bundle = Bundle.of(course, assignment)
    if bundle.data["hash"] != key:
        raise LabkitError(f"{assignment} was released again while it was graded; grade again")
    return bundle


_limit_once = cache(limit_memory)
