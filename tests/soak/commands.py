"""The commands as they are typed, each in a process of its own, and what they said.

The processes are forked from one that has loaded everything, which saves seconds each.
"""

from __future__ import annotations

import os
import pkgutil
import resource
import sys
import tempfile
import time
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import psutil

import labkit

IDLE = 60.0
"""Seconds in which a command and all that it started compute next to nothing: it waits for ever."""
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
        process = context.Process(target=_run, args=(words, str(folder), str(out), str(err)))
        process.start()
        ended = _wait(process)
        code = process.exitcode if ended else None
        process.close()
        return Ended(words, code, out.read_bytes(), err.read_bytes())


def _modules() -> list[str]:
    found = [m.name for m in pkgutil.walk_packages(labkit.__path__, "labkit.")]
    nbgrader = ["apps.nbgraderapp", "apps.autogradeapp", "converters", "plugins"]
    return [*found, *(f"nbgrader.{name}" for name in nbgrader)]


def _run(words: tuple[str, ...], folder: str, out: str, err: str) -> None:
    for number, path in ((1, out), (2, err)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
    sys.stdout.reconfigure(encoding="utf-8", errors="strict")
    sys.stderr.reconfigure(encoding="utf-8", errors="backslashreplace", line_buffering=True)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_COMPUTING, MOST_COMPUTING))
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
            family = [psutil.Process(process.pid)]
            family += family[0].children(recursive=True)
            now = sum(sum(one.cpu_times()[:2]) for one in family)
        except psutil.NoSuchProcess:
            continue
        if now > spent + 0.5:
            spent, since = now, time.monotonic()
        elif time.monotonic() > since + IDLE:
            for one in family:
                one.kill()
            process.join()
            return False
