"""Runs typed commands, each in a separate process, and keeps their output.

The processes are forked from one that has loaded everything, and a worker that outlives them, with
its sandbox, does their grading; each of the two saves seconds for each command.
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
"""A command hangs if for this many seconds it, its children and the worker hardly compute and none
of them waits for a processor; this holds on a busy machine too."""
_AT_WORK = (psutil.STATUS_RUNNING, psutil.STATUS_DISK_SLEEP)
MOST_MEMORY = 4 * 2**30
MOST_COMPUTING = 900
"""Limits of bytes and of processor seconds for each process, in case it never ends."""


@dataclass(frozen=True)
class Ended:
    """The end of a command.

    Attributes:
        words: The typed words.
        code: The exit code; None if the command hung and was killed.
        out: The output on stdout.
        err: The output on stderr.
    """

    words: tuple[str, ...]
    code: int | None
    out: bytes
    err: bytes

    @property
    def text(self) -> str:
        """Both streams; bytes that are not UTF-8 stay as they are."""
        return (self.out + self.err).decode("utf-8", "surrogateescape")


def typed(folder: Path, *words: str) -> Ended:
    """Run a command of labkit or of nbgrader in a folder, as if it were typed."""
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
    """Let the worker do what a command requests until the command ends."""
    with command, suppress(EOFError, OSError):
        while True:
            function, args = command.recv()
            done = worker().submit(function, *args)
            command.send((done.exception(), None if done.exception() else done.result()))


class _Kept(ThreadPoolExecutor):
    """Sends calls through a connection to the worker that is kept."""

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
    """Wait for the end of a process; return False if it hung and was killed."""
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
