"""What a submission may use, how much of its text is kept, and how fast this machine is."""

from __future__ import annotations

import json
import os
import resource
import signal
import timeit
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from uuid import uuid4

MAX_REPLY = 256_000
"""The size of the longest answer to a call, in bytes; the longest honest one has 1,600."""
MAX_VALUES = 10_000
"""How many numbers, texts, lists and objects an answer may have; honest ones have up to 80."""
MAX_TEXT = 1_000_000
"""How much of a student's text a result keeps, in bytes; all else may need as much again."""
MEMORY = 2 * 2**30
"""What the process that judges may use, in bytes."""
BOX = "/box"
"""The folder in memory that a process in bubblewrap has for itself, also as ``/tmp``."""
NOBODY = 63999
"""A user without any process."""
_TIMES = ("parse", "cell", "cells", "call", "question", "wall", "grace")
_CGROUPS = Path("/sys/fs/cgroup")
_OF_ALL = {
    "memory.max": 3 * 2**30,  # bytes: what is loaded, one submission and its folder in memory
    "pids.max": 100,
    "cpu.max": 100_000,  # us in 100 ms: one core, which leaves the others to other programs
}
"""What a whole sandbox may use, where cgroups (version 2) may be made."""


@dataclass(frozen=True)
class Limits:
    """What one submission may use, with times in [s] and sizes in [MiB].

    The times for one cell and for one call are processor time; code that waits instead is stopped
    after ``patience`` times as long.  All other times are wall time.

    Attributes:
        parse: The time for reading the file.
        cell: The time for one cell.
        cells: The time for all cells; once it is spent, each cell left has a twentieth of it.
        call: The time for one call of a function.
        question: The time for all calls of a question, without what the simulator needs.
        wall: The time for reading, all cells and all calls, without what the simulator needs.
        grace: The time that a process has to stop by itself before it is killed.
        patience: How many times longer code may wait than compute, for a busy machine.
        memory: The memory of each process, in addition to what was loaded before.
        files: The size of the temporary folder, and of one file.
        processes: The number of processes at the same time.
    """

    parse: float = 8.0
    cell: float = 4.0
    cells: float = 10.0
    call: float = 4.0
    question: float = 12.0
    wall: float = 18.0
    grace: float = 1.5
    patience: float = 2.5
    memory: int = 1024
    files: int = 64
    processes: int = 32

    @property
    def worker(self) -> float:
        """The time a worker may take for one submission, its own start and judging included."""
        return 5.0 * self.wall

    def scaled(self, factor: float) -> Limits:
        """The same limits with all times multiplied by a factor."""
        return replace(self, **{name: getattr(self, name) * factor for name in _TIMES})


class TextBudget:
    """How much of a student's text a result still has room for.

    Attributes:
        left: The room that is left, in bytes of JSON.
        cut: The number of texts that were shortened.
    """

    def __init__(self, left: int = MAX_TEXT) -> None:
        self.left, self.cut = left, 0

    def take(self, text: str) -> str:
        """Return the text, cut to the room that is left, and deduct its size."""
        if len(json.dumps(text)) > self.left:
            text = text[: self.left // 12]  # no character takes more than 12 bytes
            self.cut += 1
        self.left = max(0, self.left - len(json.dumps(text)))
        return text


def slowness() -> float:
    """How much slower this machine is than the one for which the limits were set, 1 to 3.

    A slow machine gets more time, and so does one with more work than processors.  A fast machine
    does not get less.  The bound holds what one submission can cost a worker to 54 s.
    """
    busy = os.getloadavg()[0] / (os.cpu_count() or 1)
    return min(3.0, max(1.0, round(_measured_slowness() * max(1.0, busy), 1)))


@cache
def _measured_slowness() -> float:
    """The slowness by the best of three attempts, as other work may disturb some."""
    loop = "for k in range(200_000): total = total + k * k"
    return max(1.0, min(timeit.repeat(loop, "total = 0", repeat=3, number=1)) / 0.012)


def limit_memory() -> None:
    """Limit the memory of this process, so that a submission can only cause a MemoryError."""
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, most))


def make_group() -> Path | None:
    """Make a cgroup that limits a whole sandbox; None where this process may not make one."""
    if not (_CGROUPS / "cgroup.controllers").exists():  # there is no version 2
        return None
    folder = _CGROUPS / f"labkit-{uuid4().hex}"
    try:
        folder.mkdir()
        for file, value in _OF_ALL.items():
            (folder / file).write_text(str(value))
    except OSError:
        remove_group(folder)
        return None
    return folder


def remove_group(folder: Path) -> None:
    """Remove a cgroup; the kernel keeps those with processes."""
    with suppress(OSError):
        folder.rmdir()


def kill_user(uid: int) -> None:
    """Kill all processes of a user, at once, so that none can fork meanwhile, nor kill this one."""
    with suppress(ProcessLookupError):
        os.setresuid(NOBODY, uid, 0)
        os.kill(-1, signal.SIGKILL)
    os.setresuid(0, 0, 0)
