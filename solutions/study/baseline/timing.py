"""Find the fastest schedule along a path within speed and acceleration limits (TOPP-RA).

Pham & Pham 2018, "A new approach to time-optimal path parameterization based on reachability
analysis".
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

import numpy as np
from toppra import algorithm, constraint
from toppra.interpolator import AbstractGeometricPath

from labkit.errors import OutOfRange
from labkit.paths import END, START
from labkit.quiet import quiet
from labkit.shapes import Array, as_array, as_number, as_vector, locked
from labkit.trajectory import Path, Sample, Trajectory


@dataclass(frozen=True, eq=False)
class JointLimits:
    """The limits of a schedule.

    Attributes:
        speed: Largest joint speeds, shape (7,) in [rad/s].
        acceleration: Largest joint accelerations, shape (7,) in [rad/s^2].
    """

    speed: Any
    acceleration: Any

    def __post_init__(self) -> None:
        for name in ("speed", "acceleration"):
            x = as_vector(getattr(self, name), 7, name)
            if x.min() <= 0.0:
                raise OutOfRange(f"{name} is {x.min():g} at a joint; it must be greater than 0")
            object.__setattr__(self, name, x)


MOVEIT = JointLimits(
    speed=(0.27, 0.27, 0.27, 0.27, 0.3, 0.3, 0.5),
    acceleration=(0.5,) * 7,
)
"""MoveIt's limits on Baxter, joint_limits.yaml of moveit_robots' baxter_moveit_config."""

HARDWARE = JointLimits(
    speed=(1.5, 1.5, 1.5, 1.5, 4.0, 4.0, 4.0),
    acceleration=(5.0,) * 7,
)
"""The arm's own speed limits; Rethink states no accelerations, so we take ten times MoveIt's."""


_NO_LIMIT = 1e3  # more than any arm needs
_PLACES = 801  # along a path, where the limits are checked


class Schedule:
    """A time scaling with given speeds at places along the path, and constant acceleration between.

    Attributes:
        s: Places along the path, from 0 to 1, shape (k,).
        speed: ds/dt there, shape (k,) in [1/s], zero at both ends.
        duration: The duration in [s].
    """

    def __init__(self, s: Any, speed: Any) -> None:
        """Take ``speed`` at the places ``s``.

        Raises:
            OutOfRange: The speed is zero over a whole interval, so the end is never reached.
        """
        self.s = locked(np.array(as_array(s, np.shape(s), "s")))
        self.speed = locked(np.array(as_array(speed, self.s.shape, "speed")))
        pace = self.speed[:-1] + self.speed[1:]
        if pace.min() <= 0.0:
            raise OutOfRange(
                f"the schedule stands still at s = {self.s[int(pace.argmin())]:.3f} and never ends"
            )
        spans = 2.0 * np.diff(self.s) / pace
        self._starts = np.concatenate([[0.0], np.cumsum(spans)]).tolist()
        self._acceleration = (np.diff(self.speed) / spans).tolist()
        self._s, self._speed = self.s.tolist(), self.speed.tolist()
        self.duration: float = self._starts[-1]

    def __call__(self, t: float) -> tuple[float, float, float]:
        """s, ds/dt and d2s/dt2 at time ``t`` [s]."""
        if t >= self.duration:
            return END
        if t < 0.0:
            return START
        i = bisect_right(self._starts, t) - 1
        x, v, a = t - self._starts[i], self._speed[i], self._acceleration[i]
        return self._s[i] + x * (v + 0.5 * a * x), v + a * x, a


def quickest(
    path: Path[Sample], limits: JointLimits = MOVEIT, *, ds_dt: float | None = None
) -> Trajectory:
    """The fastest trajectory along a path of joint angles, at rest at both ends.

    Args:
        path: Joint angles over s, samples of shape (7,) in [rad].
        limits: The limits on joint speeds and accelerations.
        ds_dt: A ceiling for ds/dt too, in [1/s]; None sets none.  (A tip that may not exceed v_max
            on a path of even pace and of this length has v_max / length.)

    Returns:
        The same path on a `Schedule`.

    Raises:
        ShapeError: The path is not one of joint angles.
        OutOfRange: No schedule keeps the limits; this happens only if the path has a jump.
    """
    as_array(path(0.0).position, (7,), "the path's position")
    places = np.linspace(0.0, 1.0, _PLACES)
    ceiling = _NO_LIMIT if ds_dt is None else as_number(ds_dt, "ds_dt", above=0.0)
    keep: list[Any] = [
        constraint.JointVelocityConstraint(_both_signs(limits.speed, ceiling)),
        constraint.JointAccelerationConstraint(_both_signs(limits.acceleration, _NO_LIMIT)),
    ]
    with quiet():  # toppra writes to the process's streams
        solver = algorithm.TOPPRA(keep, _Geometry(path), gridpoints=places)
        profile = solver.compute_parameterization(0.0, 0.0, return_data=True)[1]
    if profile is None or not np.isfinite(profile).all():
        raise OutOfRange(
            "no schedule along this path keeps the limits: its slope jumps somewhere; "
            "smooth the path or stop at its corners"
        )
    return Trajectory(path, Schedule(places, profile))


class _Geometry(AbstractGeometricPath):  # type: ignore[misc]
    """A labkit path in toppra's form, with s as an eighth joint whose speed can be limited."""

    def __init__(self, path: Path[Sample]) -> None:
        self._path = path

    def __call__(self, path_positions: Any, order: int = 0) -> Array:
        places = np.atleast_1d(path_positions)
        rows = np.array([self._path(s)[order] for s in places])
        s_itself = (places, np.ones_like(places), np.zeros_like(places))[order]
        rows = np.column_stack([rows, s_itself])
        return rows if np.ndim(path_positions) else rows[0]

    @property
    def dof(self) -> int:
        """Seven joints and s."""
        return 8

    @property
    def path_interval(self) -> Array:
        """The first and the last value of s."""
        return np.array([0.0, 1.0])


def _both_signs(limit: Array, of_s: float) -> Array:
    limit = np.append(limit, of_s)
    return np.column_stack([-limit, limit])
