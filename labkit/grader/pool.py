"""Pools: several workers at once, on this machine or, through Dask, on many."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from pathlib import Path
from typing import Any

import labkit

from ..errors import LabkitError
from .cluster import dask_client
from .sandbox.cgroup import sweep
from .sandbox.limits import Limits, slowness
from .sandbox.mounts import NoIsolation

Job = dict[str, Any]
Done = str | LabkitError
"""A result as JSON, or what failed."""
TRIES = 2
"""How often a submission is given to a fresh process, if the one that grades it dies."""


class Late(Exception):
    """A worker took so long that it was ended."""


class Worker:
    """One worker process, started when it is first needed and again after it died."""

    def __init__(self, *, isolated: bool = True) -> None:
        self.isolated = isolated
        self.process: subprocess.Popen[str] | None = None
        self.closed = False
        self._starting = threading.Lock()

    def ask(self, job: Job) -> str:
        """What the process says of a job, a line of JSON that `result_of` reads."""
        for _ in range(TRIES):
            try:
                return self._ask(job)
            except Late as late:
                self._end()
                return json.dumps({"failed": str(late)})
            except (OSError, EOFError):
                self._end()
                if self.closed:
                    break
        says = f"its worker died {TRIES} times; grade again to try once more"
        return json.dumps({"failed": says})

    def close(self) -> None:
        """End the process, for good, whatever it is at."""
        with self._starting:
            self.closed = True
        self._end()

    def _end(self) -> None:
        process, self.process = self.process, None
        if process is None:
            return
        assert process.stdin is not None and process.stdout is not None
        with suppress(OSError):
            process.stdin.close()  # the process sees it, and goes
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()
        sweep()

    def _ask(self, job: Job) -> str:
        process = self._started()
        assert process.stdin is not None and process.stdout is not None
        most = Limits(**job["limits"]).scaled(slowness()).worker
        late = threading.Event()

        def stop() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(most, stop)
        timer.start()
        try:
            process.stdin.write(json.dumps(job) + "\n")
            process.stdin.flush()
            line = process.stdout.readline()
        finally:
            timer.cancel()
        if line.endswith("\n"):
            return line
        if late.is_set():
            raise Late(f"its worker was ended after {most:g} s; look at it yourself")
        raise EOFError

    def _started(self) -> subprocess.Popen[str]:
        with self._starting:
            if self.closed:
                raise EOFError
            if self.process is None:
                # -P: no file of the working folder, a submission's perhaps, is imported
                words = [sys.executable, "-P", "-m", "labkit.grader.worker"]
                here = str(Path(labkit.__file__).parent.parent)
                self.process = subprocess.Popen(
                    words if self.isolated else [*words, "--no-isolation"],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    text=True,
                    start_new_session=True,  # an interrupt is for the main process, which ends us
                    env=dict(os.environ, PYTHONPATH=here),
                )
            return self.process


def result_of(job: Job, line: str) -> str:
    """The result in what a worker said, as JSON.

    Raises:
        NoIsolation: The machine has no sandbox.
        LabkitError: The worker failed.
    """
    answer = json.loads(line)
    if "no isolation" in answer:
        raise NoIsolation(answer["no isolation"])
    if "failed" in answer:
        raise LabkitError(f"{job['student']}: {answer['failed']}")
    return str(answer["result"])


def locally(jobs: Sequence[Job], count: int, *, isolated: bool = True) -> Iterator[Done]:
    """Grade with workers of this machine, in the order in which they finish.

    Args:
        jobs: What to grade.
        count: How many workers.
        isolated: Whether they use sandboxes.
    """
    workers = [Worker(isolated=isolated) for _ in range(count)]
    free: queue.SimpleQueue[Worker] = queue.SimpleQueue()
    for worker in workers:
        free.put(worker)

    def grade(job: Job) -> str:
        worker = free.get()
        try:
            return worker.ask(job)
        finally:
            free.put(worker)

    threads = ThreadPoolExecutor(count)
    try:
        futures = {threads.submit(grade, job): job for job in jobs}
        for future in as_completed(futures):
            yield _done(futures.pop(future), future.result)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        for worker in workers:
            worker.close()


def _done(job: Job, line: Callable[[], str]) -> Done:
    """Whatever happened to one submission, the others are graded."""
    try:
        return result_of(job, line())
    except LabkitError as error:
        return error
    except Exception as error:
        return LabkitError(f"{job['student']}: {type(error).__name__}: {error}")


_here: dict[bool, Worker] = {}
_lock = threading.Lock()


def on_dask(text: str, *, isolated: bool) -> str:
    """One job in a Dask worker: JSON in, JSON out, so that nothing is unpickled from students."""
    with _lock:
        if isolated not in _here:
            _here[isolated] = Worker(isolated=isolated)
        return _here[isolated].ask(json.loads(text))


def through_dask(jobs: Sequence[Job], address: str, *, isolated: bool = True) -> Iterator[Done]:
    """Grade with the workers of a Dask cluster; they must see the course's folder.

    Args:
        jobs: What to grade.
        address: Of the scheduler, such as ``tcp://127.0.0.1:8786``; take loopback or TLS.
        isolated: Whether they use sandboxes.

    Raises:
        LabkitError: distributed is missing, or nobody answers there.
    """
    with dask_client(address) as client:
        from distributed import as_completed as as_completed_there

        texts = [json.dumps(job) for job in jobs]
        futures = client.map(on_dask, texts, isolated=isolated, pure=False, retries=2)
        by_key = {future.key: job for future, job in zip(futures, jobs, strict=True)}
        for future in as_completed_there(futures, loop=client.loop):
            yield _done(by_key[future.key], future.result)
