"""The report's Algorithm 1, unchanged: look, plan a line to the tag, follow it, look again.

Each new line starts from rest while the arm is moving, which makes the arm jerk.  The algorithm is
here for comparison with `TagFollower`, not as a model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import (
    BangBang,
    Line,
    PosePath,
    PoseSample,
    Trajectory,
    se3,
)
from labkit.shapes import as_vector
from labkit.tags.stream import Reading


@dataclass(eq=False)
class SequentialServoing:
    """A follower for `lk.TagTarget` that looks for the tag every 5 s, and waits for each look-up.

    Attributes:
        T_wt: The pose of the tip at the start, shape (4, 4); its orientation is kept.
        offset: The vector from the tag to the goal of the tip, world axes, shape (3,) in [m].
        duration: The duration of each line, in [s].
        moved: The distance in [m] that a tag must move before there is a new line.
    """

    T_wt: Any
    offset: Any
    duration: float = 6.0
    moved: float = 0.005

    def __post_init__(self) -> None:
        self.T_wt = se3.as_pose(self.T_wt, "T_wt")
        self.offset = as_vector(self.offset, 3, "offset")
        self._goal = np.array(self.T_wt[:3, 3])
        self._began, self._path = 0.0, self._line(self._goal, self._goal)

    def __call__(self, t: float, readings: tuple[Reading, ...]) -> PoseSample:
        """The point on the present line at time ``t`` [s]."""
        for reading in readings:
            goal = reading.T_wm[:3, 3] + self.offset
            if np.linalg.norm(goal - self._goal) > self.moved:
                here = self._path(t - self._began).pose[:3, 3]
                self._goal, self._began, self._path = goal, t, self._line(here, goal)
        sample: PoseSample = self._path(t - self._began)
        return sample

    def _line(self, start: Any, goal: Any) -> Trajectory:
        return Trajectory(PosePath(Line(start, goal), self.T_wt[:3, :3]), BangBang(self.duration))
