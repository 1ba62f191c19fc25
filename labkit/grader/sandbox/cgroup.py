"""Limits that the kernel enforces on the process that judges and on groups of processes.

A limit on a group needs a control group, which not every machine lets us make.
"""

from __future__ import annotations

import os
import resource
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

SANDBOX: Mapping[str, int] = {
    "memory": 3 * 2**30,  # bytes: what is loaded, one submission and its folder in memory
    "processes": 100,
    "processor": 100_000,  # us in 100 ms: one core, which leaves the others to other programs
}
"""What a whole sandbox may use."""
WORKER: Mapping[str, int] = {"memory": 2 * 2**30}
"""What the process that judges may use; the sandbox has limits of its own."""

MEMORY = 2**30
"""What the process that judges may use in addition to what is loaded, in bytes."""

_ROOT = Path("/sys/fs/cgroup")
_FILES = {
    "memory": (("", "memory.max"), ("memory", "memory.limit_in_bytes")),
    "processes": (("", "pids.max"), ("pids", "pids.max")),
    "processor": (("", "cpu.max"), ("cpu", "cpu.cfs_quota_us")),
}
"""Where each limit is set, in cgroup v2 and in v1, which has a tree for each controller."""


@dataclass(frozen=True)
class Group:
    """A control group; in cgroup v1, one group for each controller.

    Attributes:
        folders: The folders of the group.
        description: What the group limits, in words.
    """

    folders: tuple[Path, ...]
    description: str

    @classmethod
    def make(cls, name: str, limits: Mapping[str, int]) -> Group | None:
        """A group with limits, or None if this process may not make one.

        Args:
            name: The id of this process, a hyphen, and a suffix that makes the name unique.
            limits: A table such as `SANDBOX`.
        """
        remove_stale_groups()
        folders: dict[Path, None] = {}
        counted: list[str] = []
        for what, value in limits.items():
            for tree, file in _FILES[what]:
                folder = _ROOT / tree / f"labkit-{name}"
                if what not in counted and _set(folder, file, value):
                    folders[folder] = None
                    counted.append(what)
        return cls(tuple(folders), f"cgroup for {', '.join(counted)}") if folders else None

    def enter(self) -> None:
        """Move this process into the group; the processes that it starts stay in it."""
        for folder in self.folders:
            (folder / "cgroup.procs").write_text(str(os.getpid()))

    def remove(self) -> None:
        """Remove the group, which must be empty."""
        for folder in self.folders:
            with suppress(OSError):
                folder.rmdir()


def limit_memory() -> None:
    """Limit the memory of this process, so that a submission can only cause a MemoryError."""
    with open("/proc/self/status") as file:
        used = next(int(line.split()[1]) * 1024 for line in file if line.startswith("VmData"))
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (used + MEMORY, most))
    group = Group.make(f"{os.getpid()}-worker", WORKER)
    if group is not None:
        group.enter()


def remove_stale_groups() -> None:
    """Remove groups whose makers have ended; the kernel keeps those with processes."""
    for tree in {tree for places in _FILES.values() for tree, _ in places}:
        for folder in (_ROOT / tree).glob("labkit-*-*"):
            if not Path("/proc", folder.name.split("-")[1]).exists():
                with suppress(OSError):
                    folder.rmdir()


def _set(folder: Path, file: str, value: int) -> bool:
    if not folder.parent.joinpath("cgroup.procs").exists():
        return False
    new = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
        (folder / file).write_text(str(value))
    except OSError:
        if new:
            with suppress(OSError):
                folder.rmdir()
        return False
    return True
