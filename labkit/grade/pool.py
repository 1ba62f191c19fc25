"""Pools: several workers at once, on this machine or, through Dask, on many."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import labkit

from ..errors import LabkitError
from ..study.campaign import dask_client
from .sandbox import NoIsolation

Job = dict[str, Any]
TRIES = 3
"""How often a submission is given to a fresh worker, if the worker itself dies."""


class Died(LabkitError):
    """A worker ended while it graded."""


class Worker:
    """One worker process, started when it is first needed and again after it died."""

    def __init__(self, *, isolated: bool = True) -> None:
        self.isolated = isolated
        self.process: subprocess.Popen[str] | None = None

    def ask(self, job: Job) -> str:
        """The result of a job, as JSON.

        Raises:
            NoIsolation: The machine has no sandbox.
            LabkitError: The worker failed, whatever it was given.
        """
        for _ in range(TRIES):
            try:
                answer = self._ask(job)
            except (OSError, Died):
                self.close()
                continue
            if "no isolation" in answer:
                raise NoIsolation(answer["no isolation"])
            if "failed" in answer:
                raise LabkitError(f"{job['student']}: the grader failed: {answer['failed']}")
            return str(answer["result"])
        raise Died(f"{job['student']}: the worker died {TRIES} times; grade again to try once more")

    def close(self) -> None:
        """End the process."""
        process, self.process = self.process, None
        if process is None:
            return
        assert process.stdin is not None and process.stdout is not None
        with suppress(OSError):
            process.stdin.close()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()

    def _ask(self, job: Job) -> dict[str, Any]:
        if self.process is None:
            words = [sys.executable, "-m", "labkit.grade.worker"]
            here = str(Path(labkit.__file__).parent.parent)
            self.process = subprocess.Popen(
                words if self.isolated else [*words, "--no-isolation"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                start_new_session=True,  # an interrupt is for the main process, which then ends us
                env=dict(os.environ, PYTHONPATH=here),
            )
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(json.dumps(job) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise Died("the worker died")
        answer: dict[str, Any] = json.loads(line)
        return answer


Done = tuple[Job, str | LabkitError]


def locally(jobs: Sequence[Job], count: int, *, isolated: bool = True) -> Iterator[Done]:
    """Grade with workers of this machine, in the order in which they finish.

    Args:
        jobs: What to grade.
        count: How many workers.
        isolated: Whether they use sandboxes.

    Yields:
        Each job with its result as JSON, or with what failed.
    """
    waiting: queue.SimpleQueue[Job] = queue.SimpleQueue()
    done: queue.SimpleQueue[Done] = queue.SimpleQueue()
    for job in jobs:
        waiting.put(job)
    workers = [Worker(isolated=isolated) for _ in range(min(count, len(jobs)))]

    def serve(worker: Worker) -> None:
        with suppress(queue.Empty):
            while True:
                job = waiting.get_nowait()
                try:
                    done.put((job, worker.ask(job)))
                except LabkitError as error:
                    done.put((job, error))
                except Exception as error:
                    done.put(
                        (job, LabkitError(f"{job['student']}: {type(error).__name__}: {error}"))
                    )

    threads = [threading.Thread(target=serve, args=(w,), daemon=True) for w in workers]
    for thread in threads:
        thread.start()
    try:
        for _ in jobs:
            yield done.get()
    finally:
        for worker in workers:
            worker.close()


_here: list[Worker] = []
_lock = threading.Lock()


def on_dask(text: str) -> str:
    """One job in a Dask worker: JSON in, JSON out, so that nothing is unpickled from students."""
    job = json.loads(text)
    with _lock:
        if not _here:
            _here.append(Worker(isolated=job.pop("isolated")))
        job.pop("isolated", None)
        try:
            return json.dumps({"result": _here[0].ask(job)})
        except LabkitError as error:
            return json.dumps({"failed": str(error)})


def through_dask(jobs: Sequence[Job], address: str, *, isolated: bool = True) -> Iterator[Done]:
    """Grade with the workers of a Dask cluster; they must see the course's folder.

    Args:
        jobs: What to grade.
        address: Of the scheduler, such as "tcp://127.0.0.1:8786"; take loopback or TLS.
        isolated: Whether they use sandboxes.

    Yields:
        Each job with its result as JSON, or with what failed.

    Raises:
        LabkitError: distributed is missing, or nobody answers there.
    """
    with dask_client(address) as client:
        from distributed import as_completed

        texts = [json.dumps(job | {"isolated": isolated}) for job in jobs]
        futures = client.map(on_dask, texts, pure=False, retries=2)
        by_key = {future.key: job for future, job in zip(futures, jobs, strict=True)}
        for future in as_completed(futures, loop=client.loop):
            job = by_key[future.key]
            try:
                answer = json.loads(future.result())
            except Exception as error:
                yield job, LabkitError(f"{job['student']}: {type(error).__name__}: {error}")
                continue
            if "failed" in answer:
                yield job, LabkitError(answer["failed"])
            else:
                yield job, answer["result"]
