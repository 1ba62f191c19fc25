"""Processes that descend from this one, whoever their parents were: nothing may be left of them."""

from __future__ import annotations

import ctypes
import os
import signal
import time
from collections.abc import Collection
from contextlib import suppress
from multiprocessing import resource_tracker
from pathlib import Path

from labkit.grader.sandbox.limits import slowness

_ADOPTS = 36  # PR_SET_CHILD_SUBREAPER: orphans become this process's children, not init's
PATIENT = 60.0
"""A guard against waiting for ever, in [s] on a quick machine; nothing is measured by it."""


class Family:
    """What was started within a block; orphans stay in it.

    Attributes:
        before: Process ids and times of start of what ran already.
    """

    def __enter__(self) -> Family:
        ctypes.CDLL(None).prctl(_ADOPTS, 1, 0, 0, 0)
        resource_tracker.ensure_running()  # multiprocessing's own, which stays as long as we do
        self.before = set(descendants())
        return self

    def __exit__(self, *_: object) -> None:
        for pid, _ in self.now():
            with suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        self.left()
        ctypes.CDLL(None).prctl(_ADOPTS, 0, 0, 0, 0)

    def now(self) -> dict[tuple[int, int], str]:
        """What runs now: ids and times of start, with the words they were started with.

        What was there before may start more, as a browser does; that is not of this block.
        """
        return descendants(before=self.before)

    def left(self) -> list[str]:
        """What still runs once it had its time to end; dead children are buried."""
        until = time.monotonic() + PATIENT * slowness()
        while found := self.now():
            for pid, _ in found:
                with suppress(ChildProcessError):
                    os.waitpid(pid, os.WNOHANG)
            if time.monotonic() > until:
                return sorted(found.values())
            time.sleep(0.05)
        return []


def descendants(
    of: int = 0, before: Collection[tuple[int, int]] = ()
) -> dict[tuple[int, int], str]:
    """All that descend from a process, with the words they were started with.

    Args:
        of: Which process; by default this one.
        before: Processes that are left out, with all that they started.
    """
    of = of or os.getpid()
    parents: dict[int, tuple[int, int]] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError, ValueError):
            fields = (folder / "stat").read_text(errors="replace").rpartition(")")[2].split()
            parents[int(folder.name)] = int(fields[1]), int(fields[19])
    others = {pid for pid, start in before if parents.get(pid, (0, 0))[1] == start}
    family, size = {of}, 0
    while len(family) > size:
        size = len(family)
        family |= {pid for pid, (parent, _) in parents.items() if parent in family} - others
    return {(pid, parents[pid][1]): words(pid) for pid in family - {of} if pid in parents}


def words(pid: int) -> str:
    """How a process was started; empty for a dead one."""
    with suppress(OSError):
        return (
            Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        )
    return ""


def parent(pid: int) -> int:
    """The process that started it; 0 if it is gone."""
    with suppress(OSError, ValueError):
        text = Path(f"/proc/{pid}/stat").read_text(errors="replace")
        return int(text.rpartition(")")[2].split()[1])
    return 0
