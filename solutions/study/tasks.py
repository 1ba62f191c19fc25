r"""The report's tasks, each composed of parts from `trajectory` and `paths`.

A line is ``Trajectory(PosePath(Line), Quintic)``, a circle is the same with `Circle`, and the
square is a `Chain` of four lines, so that the tip stops at each corner, and position, velocity and
acceleration are continuous.  Every task ends with a second of `Hold`, in which a controller may
settle.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from labkit.model import Model
from labkit.paths import Circle, Line, Polyline, Quintic
from labkit.robot import robot
from labkit.shapes import Array, as_array, as_vector, locked
from labkit.trajectory import Chain, Hold, PosePath, Target, Trajectory

Side = Literal["left", "right"]

V_MAX = 0.2
"""The tip's largest speed, in [m/s]; the report's mean speed."""
A_MAX = 0.5
"""The tip's largest acceleration, in [m/s^2]."""
OFFSET = 0.01
"""The standard deviation of each joint's start angle from that of the task, in [rad]."""
HOLD = 1.0
"""How long the tip stays at the end, in [s]."""


@dataclass(frozen=True, eq=False)
class Task:
    """A motion of the tip, and the joint angles at its start.

    Attributes:
        name: Its name in tables and figures.
        target: Poses of the tip over time.
        q0: Joint angles at its start, shape (7,) in [rad].
        side: The arm, "left" or "right".
        samples: The number of places along each path at which joint angles are computed.
    """

    name: str
    target: Any
    q0: Array
    side: Side = "left"
    samples: int = 101

    @property
    def duration(self) -> float:
        """The duration in [s]."""
        return float(self.target.duration)

    def start(self, seed: int) -> Array:
        """The start for a seed, about 10 mm off the path, so that only feedback removes the error.

        Returns:
            Joint angles, shape (7,) in [rad]; the same for every controller.
        """
        off = np.random.default_rng([seed, 20190201]).standard_normal(7)  # the month of the report
        return self.q0 + OFFSET * off

    @cached_property
    def joints(self) -> Target:
        """The motion as joint angles."""
        model = Model(self.side)
        joints: Target = model.joint_trajectory(self.target, self.q0, samples=self.samples)
        return joints


def ready_pose(side: Side = "left") -> Array:
    """The tip's pose `T_wt` where the tasks begin, gripper straight down, shape (4, 4)."""
    return Model(side).pose(robot(side).ready)


def smooth(paths: Iterable[Any], R_wt: Any, *, v_max: float = V_MAX, a_max: float = A_MAX) -> Chain:
    """Follow paths of the tip one after another, at rest between them, and hold at the end.

    Args:
        paths: Paths with a `length`, in order, each starting where the one before ended.
        R_wt: The constant orientation of the tip, shape (3, 3).
        v_max: Largest speed of the tip, in [m/s].
        a_max: Largest acceleration along the path, in [m/s^2].

    Returns:
        A `Chain` of quintic trajectories and a `Hold`, of poses.
    """
    parts: list[Any] = [
        Trajectory(PosePath(path, R_wt), Quintic.within(path.length, v_max, a_max))
        for path in paths
    ]
    last = parts[-1]
    return Chain([*parts, Hold(last.path(1.0).pose, HOLD)])


def line(
    goal: Any = (0.10, -0.15, 0.10),
    *,
    v_max: float = V_MAX,
    a_max: float = A_MAX,
) -> Task:
    """A straight line (report, section 2.1).

    Args:
        goal: The end relative to the start, shape (3,) in [m].
        v_max: Largest speed, in [m/s].
        a_max: Largest acceleration, in [m/s^2].
    """
    p, R_wt = _start()
    path = Line(p, p + as_array(goal, (3,), "goal"))
    return Task("line", smooth([path], R_wt, v_max=v_max, a_max=a_max), _q0())


def circle(centre: Any = (0.0, -0.10, 0.0)) -> Task:
    """A level circle (report, section 2.2).

    Args:
        centre: A point on its axis, relative to the start, shape (3,) in [m].
    """
    p, R_wt = _start()
    return Task("circle", smooth([Circle(p, p + as_array(centre, (3,), "centre"))], R_wt), _q0())


def square(goals: Any = ((0.15, 0.0, 0.0), (0.15, -0.15, 0.0), (0.0, -0.15, 0.0))) -> Task:
    """The report's square (section 2.3), from the start to three goals and back.

    Args:
        goals: The other corners relative to the start, shape (k, 3) in [m].
    """
    p, R_wt = _start()
    corners = Polyline(np.array([p, *(p + as_vector(g, 3, "goal") for g in goals), p]))
    return Task("square", smooth(corners.lines, R_wt), _q0())


def _start() -> tuple[Array, Array]:
    """Position and orientation of the left tip at the start of the tasks."""
    T_wt = ready_pose()
    return T_wt[:3, 3], T_wt[:3, :3]


def _q0() -> Array:
    return locked(np.array(robot("left").ready))
