"""How much a submission may use, and how quick this machine is."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, replace
from functools import cache
from typing import Any


@dataclass(frozen=True)
class Limits:
    """What one submission may use; times in [s], sizes in [MiB].

    The times of cells and calls are processor time; on the clock they may take three times as long.

    Attributes:
        cell: For one cell.
        call: For one call of a function.
        question: For all of a question's calls, runs of the arm included.
        wall: For everything.
        memory: For each process, beside what was there before.
        files: In its own temporary folder, and for one file.
        output: Characters of text from the cells, in all.
        processes: At once.
        notebook: The largest file that is read; pictures in it are dropped unread.
    """

    cell: float = 10.0
    call: float = 5.0
    question: float = 60.0
    wall: float = 120.0
    memory: int = 1024
    files: int = 64
    output: int = 100_000
    processes: int = 32
    notebook: int = 200

    def scaled(self, factor: float) -> Limits:
        """The same with all times multiplied."""
        return replace(
            self,
            cell=self.cell * factor,
            call=self.call * factor,
            question=self.question * factor,
            wall=self.wall * factor,
        )

    def data(self) -> dict[str, Any]:
        """As JSON data."""
        return asdict(self)


@cache
def slowness() -> float:
    """How much slower this machine is than the one that the limits were made on, 1 to 8.

    A slow or busy machine gets more time, a quick one never less.
    """
    best = min(_loop() for _ in range(3))
    return min(8.0, max(1.0, round(best / 0.012, 1)))


def _loop() -> float:
    start = time.perf_counter()
    total = 0
    for k in range(200_000):
        total += k * k
    return time.perf_counter() - start
