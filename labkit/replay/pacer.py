"""The pacer, which keeps a live run in step with real time."""

from __future__ import annotations

import time
from collections import deque

FRAME = 1 / 30
"""Time between two pictures, in [s]."""

LATE = 0.1
"""A loop that is late by more than this, in [s], continues from there without catching up."""


class Pacer:
    """Keeps a run in step with real time, and measures how well."""

    def __init__(self) -> None:
        """Make a clock at zero."""
        self._began, self._pictures, self._move = 0.0, deque([(0.0, 0.0)], maxlen=30), 0

    def set(self, t: float) -> None:
        """Set the time of the run to ``t``, in [s]."""
        self._began = time.monotonic() - t

    def ahead(self, t: float) -> float:
        """How far a run at time ``t`` is ahead of real time, in [s]; negative if it is late."""
        ahead = self._began + t - time.monotonic()
        if ahead < -LATE:
            self.set(t)
        return ahead

    def begin(self, t: float) -> None:
        """Forget the pictures so far; the simulator is at ``t``."""
        self._pictures = deque([(time.monotonic(), t)], maxlen=30)

    def is_due(self, move: int) -> bool:
        """Whether another picture is due: the hand's ``move`` is new, or the last is old."""
        return move != self._move or time.monotonic() - self._pictures[-1][0] > FRAME

    def shown(self, t: float, move: int) -> None:
        """Note that a picture was shown with the simulator at ``t`` and the hand at ``move``."""
        self._move = move
        self._pictures.append((time.monotonic(), t))

    @property
    def pace(self) -> float | None:
        """Simulated seconds per real second, over the last pictures; None at the start."""
        (a, x), (b, y) = self._pictures[0], self._pictures[-1]
        return round((y - x) / (b - a), 3) if b > a else None
