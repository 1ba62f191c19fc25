"""How much a submission may use, how much of its text is kept, and how fast this machine is."""

from __future__ import annotations

import json
import os
import time
from dataclasses import dataclass, replace
from functools import cache

REPLY = 256_000
"""The longest answer to one call, in bytes; the longest honest one has 1,600."""
VALUES = 10_000
"""How many numbers, texts, lists and objects an answer may have; the largest honest one has 80."""
TRICKS = 100
"""How many of the tricks in a notebook are named."""
TEXT = 1_000_000
"""How much of a student's text a result keeps, in bytes; the rest may be as large."""
_TIMES = ("parse", "cell", "cells", "call", "question", "wall", "grace")


@dataclass(frozen=True)
class Limits:
    """What one submission may use; times in [s], sizes in [MiB].

    The times of one cell and of one call are processor time; code that waits instead is stopped
    after ``patience`` times as long.  All other times are those of the clock.

    Attributes:
        parse: For reading the file.
        cell: For one cell.
        cells: For all cells together; once it is spent, each that is left has a twentieth of it.
        call: For one call of a function.
        question: For all calls of a question; runs of the arm count where the function is asked.
        wall: For all cells and calls.
        grace: How long a process has to stop by itself before it is killed.
        patience: How much longer waiting may take than computing, on a busy machine.
        memory: For each process, beside what was there before.
        files: In its own temporary folder, and for one file.
        output: Characters of text from the cells, in all.
        processes: At once.
    """

    parse: float = 15.0
    cell: float = 10.0
    cells: float = 20.0
    call: float = 2.0
    question: float = 12.0
    wall: float = 45.0
    grace: float = 1.5
    patience: float = 2.5
    memory: int = 1024
    files: int = 64
    output: int = 100_000
    processes: int = 32

    @property
    def worker(self) -> float:
        """How long a worker may take for one submission, its own start and judging included."""
        return 3.0 * (self.parse + self.wall)

    def scaled(self, factor: float) -> Limits:
        """The same with all times multiplied."""
        return replace(self, **{name: getattr(self, name) * factor for name in _TIMES})


class TextBudget:
    """How much of a student's text a result still has room for.

    Attributes:
        left: Bytes, as JSON.
        cut: How many texts were shortened.
    """

    def __init__(self, left: int = TEXT) -> None:
        self.left, self.cut = left, 0

    def take(self, text: str) -> str:
        """The text, or as much of it as there is room for."""
        size = len(json.dumps(text))
        if size > self.left:
            text = text[: self.left // 12]  # no character takes more than 12 bytes
            size = len(json.dumps(text))
            self.cut += 1
        self.left = max(0, self.left - size)
        return text


def slowness() -> float:
    """How much slower this machine is than the one that the limits were made on, 1 to 8.

    A slow machine gets more time, and so does one that has more to do than it has processors; a
    quick one never less.
    """
    busy = os.getloadavg()[0] / (os.cpu_count() or 1)
    return min(8.0, max(1.0, round(_slower() * max(1.0, busy), 1)))


@cache
def _slower() -> float:
    """By the best of three tries, as a busy machine disturbs some."""
    return max(1.0, min(_loop() for _ in range(3)) / 0.012)


def _loop() -> float:
    start = time.perf_counter()
    total = 0
    for k in range(200_000):
        total += k * k
    return time.perf_counter() - start
