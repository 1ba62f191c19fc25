"""Limits that the kernel keeps: of the process that judges, and of groups of processes.

Groups are limited where the kernel lets us count their processes together.
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
    "processor": 100_000,  # us in 100 ms: one core, so that nobody's neighbours starve
}
"""What a whole sandbox may use."""
WORKER: Mapping[str, int] = {"memory": 2 * 2**30}
"""What the process that judges may use; its sandbox is counted apart."""

MEMORY = 2**30
"""What the process that judges may use beside what is loaded, in bytes."""

_ROOT = Path("/sys/fs/cgroup")
_FILES = {
    "memory": (("", "memory.max"), ("memory", "memory.limit_in_bytes")),
    "processes": (("", "pids.max"), ("pids", "pids.max")),
    "processor": (("", "cpu.max"), ("cpu", "cpu.cfs_quota_us")),
}
"""Where a limit is set, in the newer interface and in the older one, which has a tree for each."""


@dataclass(frozen=True)
class Group:
    """One control group, or its parts under the older interface.

    Attributes:
        folders: Where it is.
        says: What it counts.
    """

    folders: tuple[Path, ...]
    says: str

    @classmethod
    def make(cls, name: str, limits: Mapping[str, int]) -> Group | None:
        """A group with limits, or None where we may not make one.

        Args:
            name: The id of the process that makes it, a hyphen, and what else tells it apart.
            limits: As `SANDBOX`.
        """
        sweep()
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
        """Put this process into the group; all that it starts stays there."""
        for folder in self.folders:
            (folder / "cgroup.procs").write_text(str(os.getpid()))

    def remove(self) -> None:
        """Remove the empty group."""
        for folder in self.folders:
            with suppress(OSError):
                folder.rmdir()


def limit_memory() -> None:
    """Limit this process: whatever a submission makes it keep ends in a MemoryError of its own."""
    with open("/proc/self/status") as file:
        used = next(int(line.split()[1]) * 1024 for line in file if line.startswith("VmData"))
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (used + MEMORY, most))
    group = Group.make(f"{os.getpid()}-worker", WORKER)
    if group is not None:
        group.enter()


def sweep() -> None:
    """Remove groups whose makers are gone; one in which something still runs stays."""
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
