"""The commands as they are typed, each in a process of its own, and what they said.

The processes are forked from one that has loaded everything, and what they grade is graded by one
worker that outlives them, whose sandbox is there already: both save seconds each.
"""

from __future__ import annotations

import os
import pkgutil
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from functools import cache
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Thread
from typing import Any

import psutil

import labkit
from labkit.grader.grading import batch
from labkit.grader.grading.executor import LocalExecutor

IDLE = 60.0
"""Seconds in which a command, what it started and the worker compute next to nothing, and none of
them waits for a processor: it hangs, on a machine as busy as any."""
_AT_WORK = (psutil.STATUS_RUNNING, psutil.STATUS_DISK_SLEEP)
MOST_MEMORY = 4 * 2**30
MOST_COMPUTING = 900
"""Bytes and seconds of a processor for each process: guards against what never ends."""


@dataclass(frozen=True)
class Ended:
    """How a command ended.

    Attributes:
        words: What was typed.
        code: The exit code; None where it hung and was ended.
        out: What it wrote to stdout.
        err: What it wrote to stderr.
    """

    words: tuple[str, ...]
    code: int | None
    out: bytes
    err: bytes

    @property
    def text(self) -> str:
        """Both streams; what is no UTF-8 stays as it is."""
        return (self.out + self.err).decode("utf-8", "surrogateescape")


def typed(folder: Path, *words: str) -> Ended:
    """Type a command of labkit's or nbgrader's in a folder."""
    context = get_context("forkserver")
    context.set_forkserver_preload(_modules())
    with tempfile.TemporaryDirectory() as aside:
        out, err = Path(aside, "out"), Path(aside, "err")
        ours, theirs = Pipe()
        asked = words, str(folder), str(out), str(err), theirs
        process = context.Process(target=_run, args=asked)
        process.start()
        theirs.close()
        Thread(target=_grade_for, args=(ours,), daemon=True).start()
        ended = _wait(process)
        code = process.exitcode if ended else None
        process.close()
        return Ended(words, code, out.read_bytes(), err.read_bytes())


@cache
def worker() -> LocalExecutor:
    """The worker that outlives commands and tests."""
    return LocalExecutor(1)


def _grade_for(command: Connection) -> None:
    """Have the worker do what a command asks for, until the command ends."""
    with command, suppress(EOFError, OSError):
        while True:
            function, args = command.recv()
            done = worker().submit(function, *args)
            command.send((done.exception(), None if done.exception() else done.result()))


class _Kept(ThreadPoolExecutor):
    """Has the calls done by the worker that is kept, at the other end of a line."""

    def __init__(self, line: Connection) -> None:
        super().__init__(1)
        self.line = line

    def submit(self, function: Callable[..., Any], /, *args: Any, **_: Any) -> Future[Any]:
        return super().submit(self._ask, function, args)

    def _ask(self, function: Callable[..., Any], args: tuple[Any, ...]) -> Any:
        self.line.send((function, args))
        error, result = self.line.recv()
        if error is not None:
            raise error
        return result


def _modules() -> list[str]:
    found = [m.name for m in pkgutil.walk_packages(labkit.__path__, "labkit.")]
    nbgrader = ["apps.nbgraderapp", "apps.autogradeapp", "converters", "plugins"]
    return [*found, *(f"nbgrader.{name}" for name in nbgrader), "psutil", "pytest"]


def _run(words: tuple[str, ...], folder: str, out: str, err: str, line: Connection) -> None:
    for number, path in ((1, out), (2, err)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
    sys.stdout.reconfigure(encoding="utf-8", errors="strict")
    sys.stderr.reconfigure(encoding="utf-8", errors="backslashreplace", line_buffering=True)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_COMPUTING, MOST_COMPUTING))
    batch.executor = lambda *_: nullcontext(_Kept(line))
    os.chdir(folder)
    sys.argv = list(words)
    if words[0] == "labkit":
        from labkit.__main__ import main

        sys.exit(main(words[1:]))
    from nbgrader.apps.nbgraderapp import main as nbgrader

    sys.exit(nbgrader())


def _wait(process) -> bool:
    """Wait for its end; False where it had to be ended, for it hung."""
    spent, since = -1.0, time.monotonic()
    while True:
        process.join(1.0)
        if process.exitcode is not None:
            return True
        try:
            mine = psutil.Process(process.pid)
            family = psutil.Process().children(recursive=True)
            now = sum(sum(x.cpu_times()[:2]) for x in family)
            waits = all(x.status() not in _AT_WORK for x in family)
        except psutil.NoSuchProcess:
            continue
        if now > spent + 0.5 or not waits:
            spent, since = now, time.monotonic()
        elif time.monotonic() > since + IDLE:
            for one in (*mine.children(recursive=True), mine):
                one.kill()
            process.join()
            return False
