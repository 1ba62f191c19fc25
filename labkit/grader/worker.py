"""A worker: a process of its own that grades one submission after another in its own sandbox.

It reads jobs and writes results as lines of JSON, so it may live on any machine.  When nobody
listens any more it ends, whatever it is at, and its sandbox with it.
"""

from __future__ import annotations

import json
import os
import queue
import resource
import sys
import threading
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..errors import LabkitError
from .grade import grade, rejection
from .plan import imports
from .results import Bundle, Result
from .sandbox.cgroup import WORKER, Group
from .sandbox.launch import Sandbox, SandboxLost
from .sandbox.limits import Limits, slowness
from .sandbox.mounts import NoIsolation
from .submission import Submission

TRIES = 2
MEMORY = 2**30  # bytes, beside what is loaded


class Desk:
    """What a worker keeps from one job to the next: its sandbox."""

    def __init__(self, *, isolated: bool) -> None:
        self.isolated = isolated
        self.sandbox: Sandbox | None = None
        self._hidden: list[str] = []

    def do(self, job: dict[str, Any]) -> Result:
        """Grade one submission; a sandbox that is lost is made again, once.

        Raises:
            NoIsolation: There is no sandbox on this machine.
            LabkitError: The sandbox was lost each time.
        """
        bundle = _bundle(job["bundle"], job["hash"])
        submission = Submission(job["student"], job["assignment"], Path(job["folder"]))
        limits = Limits(**job["limits"]).scaled(slowness())
        data, note, why = submission.read(limits.notebook)
        lost = ""
        for _ in range(TRIES):
            try:
                sandbox = self._sandbox(bundle, job["hidden"])
                if why:
                    return rejection(why, submission.student, bundle, sandbox.level)
                return grade(data, submission.student, bundle, sandbox, limits, note)
            except SandboxLost as error:
                lost = str(error)
                self.close()
        raise LabkitError(
            f"its sandbox was lost {TRIES} times ({lost}); is there memory enough? Grade again, "
            "or look at it yourself"
        )

    def _sandbox(self, bundle: Bundle, hidden: list[str]) -> Sandbox:
        """The sandbox there is, or a new one if another course is to be hidden."""
        if self.sandbox is not None and self._hidden != hidden:
            self.close()
        if self.sandbox is None:
            loads = imports(bundle.data["cells"])
            self.sandbox = Sandbox(loads, map(Path, hidden), isolated=self.isolated)
            self._hidden = hidden
        return self.sandbox

    def close(self) -> None:
        """End the sandbox."""
        sandbox, self.sandbox = self.sandbox, None
        if sandbox is not None:
            sandbox.close()


@lru_cache(maxsize=4)
def _bundle(path: str, key: str) -> Bundle:
    bundle = Bundle(json.loads(Path(path).read_text(encoding="utf-8")))
    if bundle.data["hash"] != key:
        raise ValueError(f"{path} was released again while it was graded")
    return bundle


def limit_memory() -> None:
    """Whatever a submission makes this process keep, it ends in a MemoryError of its own."""
    with open("/proc/self/status") as file:
        used = next(int(line.split()[1]) * 1024 for line in file if line.startswith("VmData"))
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (used + MEMORY, most))
    group = Group.make(f"{os.getpid()}-worker", WORKER)
    if group is not None:
        group.enter()


def main(*, isolated: bool) -> int:
    """Serve until stdin ends."""
    out = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)
    limit_memory()
    warnings.simplefilter("ignore")  # what a student's numbers overflow is in the verdict
    jobs: queue.SimpleQueue[str] = queue.SimpleQueue()
    idle = threading.Event()
    threading.Thread(target=_listen, args=(jobs, idle), daemon=True).start()
    desk = Desk(isolated=isolated)
    try:
        while line := jobs.get():
            answer = _answer(desk, json.loads(line))
            idle.set()
            print(json.dumps(answer), file=out, flush=True)
    finally:
        desk.close()
    return 0


def _answer(desk: Desk, job: dict[str, Any]) -> dict[str, str]:
    """A job's result, or what kept it from being made."""
    try:
        return {"result": desk.do(job).text()}
    except NoIsolation as error:
        return {"no isolation": str(error)}
    except LabkitError as error:
        return {"failed": str(error)}
    except MemoryError:
        return {"failed": f"judging it takes over {MEMORY >> 20} MB; look at it yourself"}
    except Exception as error:
        return {"failed": f"the grader failed: {type(error).__name__}: {error}"}


def _listen(jobs: queue.SimpleQueue[str], idle: threading.Event) -> None:
    """Take jobs from stdin; where it ends while one is under way, nobody waits for the answer."""
    idle.set()
    for line in sys.stdin:
        idle.clear()
        jobs.put(line)
    if not idle.is_set():
        os._exit(1)  # the kernel ends the sandbox, too
    jobs.put("")


if __name__ == "__main__":
    sys.exit(main(isolated="--no-isolation" not in sys.argv))
