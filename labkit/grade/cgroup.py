"""Memory and processes of a whole sandbox, where the kernel lets us count them together."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

MEMORY = 3 * 2**30  # bytes, of a sandbox: what is loaded, one submission and its folder in memory
PROCESSES = 100

_ROOT = Path("/sys/fs/cgroup")


@dataclass(frozen=True)
class Group:
    """One control group, or its halves under the older interface.

    Attributes:
        folders: Where it is.
        says: What it counts.
    """

    folders: tuple[Path, ...]
    says: str

    @classmethod
    def make(cls, name: str) -> Group | None:
        """A group of that name, or None where we may not make one."""
        settings: dict[str, tuple[tuple[Path, str, int], ...]] = {
            "memory": (
                (_ROOT / name, "memory.max", MEMORY),
                (_ROOT / "memory" / name, "memory.limit_in_bytes", MEMORY),
            ),
            "processes": (
                (_ROOT / name, "pids.max", PROCESSES),
                (_ROOT / "pids" / name, "pids.max", PROCESSES),
            ),
            "processor": (  # one core, so that nobody's neighbours starve
                (_ROOT / name, "cpu.max", 100_000),
                (_ROOT / "cpu" / name, "cpu.cfs_quota_us", 100_000),
            ),
        }
        folders: list[Path] = []
        counted: list[str] = []
        for what, ways in settings.items():
            for folder, file, value in ways:
                if what not in counted and _set(folder, file, value):
                    folders.append(folder)
                    counted.append(what)
        return (
            cls(tuple(dict.fromkeys(folders)), f"cgroup for {', '.join(counted)}")
            if folders
            else None
        )

    def enter(self) -> None:
        """Put this process into the group; all that it starts stays there."""
        for folder in self.folders:
            (folder / "cgroup.procs").write_text(str(os.getpid()))

    def remove(self) -> None:
        """Remove the empty group."""
        for folder in self.folders:
            with suppress(OSError):
                folder.rmdir()


def _sweep(above: Path) -> None:
    """Remove groups that workers left when they were killed."""
    for folder in above.glob("labkit-*-*"):
        if not Path("/proc", folder.name.split("-")[1]).exists():
            with suppress(OSError):  # something still runs in it
                folder.rmdir()


def _set(folder: Path, file: str, value: int) -> bool:
    if not folder.parent.joinpath("cgroup.procs").exists():
        return False
    _sweep(folder.parent)
    try:
        folder.mkdir(exist_ok=True)
        (folder / file).write_text(str(value))
    except OSError:
        with suppress(OSError):
            folder.rmdir()
        return False
    return True
