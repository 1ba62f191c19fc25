"""Executors: many submissions graded at once, by processes of this machine or of a Dask cluster.

Both kinds are a `concurrent.futures.Executor` that calls `grade_submission` in a worker process,
which keeps its sandbox from one submission to the next.  What is pickled between grader and worker
is the grader's own; a student's answers reach the worker as JSON.
"""

from __future__ import annotations

import atexit
import os
import signal
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    as_completed,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any

from ..course.layout import Course
from ..errors import LabkitError
from .each import Failed, for_student
from .grade import grade, rejection
from .plan import imports
from .results import Bundle, Result
from .sandbox.cgroup import MEMORY, limit_memory, sweep
from .sandbox.launch import Sandbox, SandboxLost
from .sandbox.limits import Limits, slowness
from .sandbox.mounts import NoIsolation
from .submission import Submission

TRIES = 2
"""How often a submission is tried whose worker or whose sandbox dies."""


@dataclass(frozen=True)
class Task:
    """One submission to be graded.

    Attributes:
        course: Where it belongs; hidden from the sandbox.
        submission: The student's files.
        bundle: The hash of the release that it is held against.
        isolated: Whether its code runs in a sandbox.
        limits: What it may use on a quick machine.
    """

    course: Course
    submission: Submission
    bundle: str
    isolated: bool
    limits: Limits


def grade_all(
    tasks: Sequence[Task], workers: int, dask: str | None = None
) -> Iterator[Result | Failed]:
    """Grade submissions, and yield each result, or why there is none, as it is finished.

    Args:
        tasks: What to grade.
        workers: How many processes of this machine; a cluster uses all of its own.
        dask: Address of a Dask scheduler whose workers see the course's folder, or None.

    Raises:
        NoIsolation: There is no sandbox to be had.
        LabkitError: There is no such scheduler.
    """
    with executor(workers, dask) as pool:
        students = {pool.submit(grade_submission, x): x.submission.student for x in tasks}
        for future in as_completed(students):
            yield for_student(students[future], future.result, of_all=(NoIsolation,))


@contextmanager
def executor(workers: int, dask: str | None = None) -> Iterator[Executor]:
    """An executor for a block; where the block is left early, what still runs is ended."""
    with ExitStack() as stack:
        if dask is None:
            pool: Executor = LocalExecutor(workers)
            if "PYTHONSAFEPATH" not in os.environ:  # workers import nothing that lies in the
                os.environ["PYTHONSAFEPATH"] = "1"  # working folder, perhaps a submission's
                stack.callback(os.environ.pop, "PYTHONSAFEPATH", None)
        else:
            client = stack.enter_context(dask_client(dask))
            client.run_on_scheduler(_allow_one_failure)
            pool = client.get_executor(pure=False)
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False)
            raise
        pool.shutdown()


class LocalExecutor(Executor):
    """Processes of this machine, each in a pool of its own, so that a death concerns one task.

    Args:
        workers: How many processes; each starts when it is first needed.
    """

    def __init__(self, workers: int) -> None:
        self._threads = ThreadPoolExecutor(workers)
        self._idle: SimpleQueue[ProcessPoolExecutor | None] = SimpleQueue()
        for _ in range(workers):
            self._idle.put(None)
        self._end, self._open = Pipe(duplex=False)

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call a function in one of the processes, and again, once, if that process dies."""
        return self._threads.submit(self._call, partial(function, *args, **kwargs))

    def _call(self, task: Callable[[], Any]) -> Any:
        for _ in range(TRIES):
            pool = self._idle.get()
            try:
                pool = pool or self._start()
                return pool.submit(task).result()
            except BrokenProcessPool:
                pool = None
            finally:
                self._idle.put(pool)
        raise LabkitError(
            f"its worker died {TRIES} times, or had to be ended because it took too long; "
            "look at the submission yourself"
        )

    def _start(self) -> ProcessPoolExecutor:
        if self._open.closed:
            raise BrokenProcessPool("the executor was shut down")
        return ProcessPoolExecutor(1, get_context("spawn"), _begin_worker, (self._end,))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes: when they have done what was submitted, or at once."""
        self._threads.shutdown(wait, cancel_futures=cancel_futures or not wait)
        while wait and not self._idle.empty():
            pool = self._idle.get()
            if pool is not None:
                pool.shutdown()
        self._open.close()
        sweep()


def _begin_worker(end: Connection) -> None:
    """Runs first in a process of a `LocalExecutor`."""
    os.setsid()  # Ctrl-C is for the grader, which ends its workers
    os.dup2(2, 1)  # the grader's output has its own format
    threading.Thread(target=_end_with_executor, args=(end,), daemon=True).start()


def _end_with_executor(end: Connection) -> None:
    """End this process, and the kernel its sandbox, when the executor or its process has ended."""
    with suppress(EOFError, OSError):
        end.recv()
    os._exit(1)


def dask_client(address: str) -> Any:
    """A client of a Dask scheduler, to be closed after use.

    Args:
        address: Such as ``tcp://127.0.0.1:8786``; use loopback or TLS.

    Raises:
        LabkitError: distributed is missing, or nothing answers there.
    """
    try:
        from distributed import Client
        from distributed.comm.addressing import resolve_address
    except ImportError:
        raise LabkitError("Dask is missing; type: pip install 'labkit[cluster]'") from None
    try:
        resolve_address(address)  # a client takes 20 s to give up on what is not an address
        return Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise LabkitError(f"no Dask scheduler at {address}: {error}") from None


def _allow_one_failure(dask_scheduler: Any) -> None:
    """Runs in the scheduler: a task may take one worker down; by default it takes four."""
    dask_scheduler.allowed_failures = TRIES - 1


_busy = threading.Lock()
_sandboxes: dict[tuple[Course, bool], Sandbox] = {}
"""This worker's sandbox, if it has one."""


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
    bundle = _bundle(task.course, task.submission.assignment, task.bundle)
    student = task.submission.student
    data, note, why = task.submission.read(limits.notebook)
    lost = ""
    for _ in range(TRIES):
        try:
            sandbox = _sandbox(task, bundle)
            if why:
                return rejection(why, student, bundle, sandbox.level)
            return grade(data, student, bundle, sandbox, limits, note)
        except SandboxLost as error:
            lost = str(error)
            close_sandbox()
    raise LabkitError(
        f"its sandbox was lost {TRIES} times ({lost}); is there enough memory? Grade again, "
        "or look at the submission yourself"
    )


def _sandbox(task: Task, bundle: Bundle) -> Sandbox:
    """The sandbox there is, or a new one if it is to hide another course."""
    key = task.course, task.isolated
    if key not in _sandboxes:
        close_sandbox()
        loads = imports(bundle.data["cells"])
        _sandboxes[key] = Sandbox(loads, [task.course.root], isolated=task.isolated)
    return _sandboxes[key]


@atexit.register
def close_sandbox() -> None:
    """End this worker's sandbox."""
    while _sandboxes:
        _sandboxes.popitem()[1].close()


@lru_cache(maxsize=4)
def _bundle(course: Course, assignment: str, key: str) -> Bundle:
    bundle = Bundle.of(course, assignment)
    if bundle.data["hash"] != key:
        raise LabkitError(f"{assignment} was released again while it was graded; grade again")
    return bundle


_limit_once = cache(limit_memory)
