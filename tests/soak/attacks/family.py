"""All descendants of this process, of which none may be left."""

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
"""The longest wait, in [s] on a fast machine; it only prevents waiting for ever."""


class Family:
    """The processes that were started within a block, with orphans.

    Attributes:
        before: The ids and starting times of the processes that ran before the block.
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
        """The running processes of the block: ids and starting times, with their commands.

        A process from before the block, such as a browser, may start others, which are left out.
        """
        return descendants(before=self.before)

    def left(self) -> list[str]:
        """The processes that still run after they had time to end; dead children are reaped."""
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
    """All descendants of a process, with their commands.

    Args:
        of: The number of the process; by default this one.
        before: Processes that are left out, with their descendants.
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
    """The command of a process; empty for a dead one."""
    with suppress(OSError):
        return (
            Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        )
    return ""
