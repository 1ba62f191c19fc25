"""Processes of this machine: the descendants of a process, and whether they have ended."""

from __future__ import annotations

import time
from pathlib import Path

GUARD = 120.0  # seconds after which a test is considered to hang


def _all() -> dict[int, tuple[int, str]]:
    """The parent and the starting time of each process; the time identifies reused numbers."""
    found = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if words[0] not in "ZX":
            found[int(folder.name)] = int(words[1]), words[19]
    return found


def running() -> set[int]:
    """All processes of this machine."""
    return set(_all())


def child(pid: int, word: str, but: set[int] = frozenset()) -> int:
    """Wait for a child of a process that has `word` in its command and is not in `but`."""
    until = time.monotonic() + GUARD
    while time.monotonic() < until:
        for one, (parent, _) in _all().items():
            if (
                parent == pid
                and one not in but
                and word.encode() in Path(f"/proc/{one}/cmdline").read_bytes()
            ):
                return one
        time.sleep(0.05)
    raise AssertionError(f"{pid} has no child {word}")


def below(pid: int, at_least: int) -> set[tuple[int, str]]:
    """A process and its descendants, as soon as there are at least `at_least`."""
    until = time.monotonic() + GUARD
    while time.monotonic() < until:
        known, family, size = _all(), {pid}, 0
        while len(family) > size:
            size = len(family)
            family |= {one for one, (parent, _) in known.items() if parent in family}
        if size >= at_least:
            return {(one, known[one][1]) for one in family if one in known}
        time.sleep(0.05)
    raise AssertionError(f"there are {size} processes below {pid}, not {at_least}")


def wait_until_gone(processes: set[tuple[int, str]]) -> None:
    """Wait until all these processes have ended."""
    until = time.monotonic() + GUARD
    while left := {(pid, start) for pid, (_, start) in _all().items()} & processes:
        assert time.monotonic() < until, f"still there: {left}"
        time.sleep(0.05)
