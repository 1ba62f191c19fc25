"""The report's Algorithm 1, unchanged: look, plan a line to the tag, follow it, look again.

Each look-up blocks the loop, and each new line starts from rest while the arm is moving; both make
the arm jerk.  The algorithm is here for comparison with `TagFollower`, not as a model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import (
    BangBang,
    JointTorque,
    JointVelocity,
    Line,
    PosePath,
    PoseSample,
    State,
    Trajectory,
    se3,
)
from labkit.control import Command, Controller
from labkit.errors import ControllerError
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


def stalled(controller: Controller, busy: Callable[[], bool], timeout: float = 0.2) -> Controller:
    """Wrap a controller whose loop blocks, so that it is called only when it is not busy.

    While it is busy, the arm obeys the last command until the command timeout, and then stops.

    Args:
        controller: The controller.
        busy: Returns whether the loop is blocked now.
        timeout: The arm's command timeout, in [s].
    """
    last: list[Any] = []  # when the controller was last called, and its command

    def stalled(state: State, target: Any) -> Command:
        if not (busy() and last):
            command: Command = controller(state, target)
            if isinstance(command, JointTorque):
                raise ControllerError(
                    "a torque controller cannot wait for a look-up: nothing would hold the arm; "
                    "use one that commands speeds, or look beside the loop"
                )
            last[:] = [state.t, command]
            return command
        since, latest = last
        command = latest
        if state.t - since <= timeout or not isinstance(command, JointVelocity):
            return command
        return JointVelocity(0.0 * state.q)

    stalled.__name__ = f"stalled {getattr(controller, '__name__', type(controller).__name__)}"
    return stalled
