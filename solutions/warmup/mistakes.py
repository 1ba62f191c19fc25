"""Mistakes that people make in notebook 00."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, hypot
from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def actual_minus_target(target: lk.Sample, state: lk.State) -> Array:
    """The error with the other sign."""
    return state.q - target.position


def a_column(target: lk.Sample, state: lk.State) -> Array:
    """Makes the target a column, so that the difference is a table of 49 numbers."""
    return target.position.reshape(7, 1) - state.q


def of_the_speeds(target: lk.Sample, state: lk.State) -> Array:
    """The error of the speeds."""
    return target.velocity - state.dq


def wrapped(target: lk.Sample, state: lk.State) -> Array:
    """The error wrapped into half a turn, as if joints had no stops."""
    return np.asarray((target.position - state.q + np.pi) % (2.0 * np.pi) - np.pi)


@dataclass(frozen=True)
class Chain:
    """Three poses, multiplied in a wrong manner.

    Attributes:
        product: What it computes from T_wt, T_tc and T_cm.
    """

    product: Callable[[Any, Any, Any], Any]

    def __call__(self, T_wt: Any, T_tc: Any, T_cm: Any) -> Array:
        """The product."""
        return np.asarray(self.product(T_wt, T_tc, T_cm))


def positions_added(T_wt: Any, T_tc: Any, T_cm: Any) -> Array:
    """The rotations multiplied, and the positions added, each in its own axes."""
    T = T_wt @ T_tc @ T_cm
    return lk.se3.pose(T[:3, :3], T_wt[:3, 3] + T_tc[:3, 3] + T_cm[:3, 3])


def _euler(R: Any) -> Array:
    """Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    return np.array(
        [
            atan2(R[2, 1], R[2, 2]),
            atan2(-R[2, 0], hypot(R[2, 1], R[2, 2])),
            atan2(R[1, 0], R[0, 0]),
        ]
    )


def euler_subtracted(R_wd: Any, R_wt: Any) -> Array:
    """Roll, pitch and yaw subtracted, as the lab's starter code did for years."""
    return _euler(R_wd) - _euler(R_wt)


def in_tool_axes(R_wd: Any, R_wt: Any) -> Array:
    """The right turn, in the axes of the tool."""
    return lk.se3.rotation_log(R_wt.T @ R_wd)


def from_wanted_to_actual(R_wd: Any, R_wt: Any) -> Array:
    """The rotation in the opposite direction."""
    return lk.se3.rotation_log(R_wt @ R_wd.T)


def sine_of_the_angle(R_wd: Any, R_wt: Any) -> Array:
    """Reads the skew part instead of the logarithm: right for small angles only."""
    return lk.se3.vee(R_wd @ R_wt.T)


def logarithms_subtracted(R_wd: Any, R_wt: Any) -> Array:
    """The rotation vectors of both orientations subtracted."""
    return lk.se3.rotation_log(R_wd) - lk.se3.rotation_log(R_wt)


def zero_by_zero(R_wd: Any, R_wt: Any) -> Array:
    """Angle over sine times the skew part, which is NaN if there is no rotation."""
    E = R_wd @ R_wt.T
    with np.errstate(invalid="ignore"):
        angle = np.arccos((np.trace(E) - 1.0) / 2.0)
        return np.asarray(angle / np.sin(angle) * lk.se3.vee(E))


def without_its_sign(target: lk.Sample, state: lk.State) -> Array:
    """The size of the error."""
    return np.abs(target.position - state.q)


@dataclass(frozen=True)
class TurnOf:
    """The right rotation with a vector of another length.

    Attributes:
        angle: Returns the length of the vector, given the angle; the axis is right.
    """

    angle: Callable[[float], float]

    def __call__(self, R_wd: Any, R_wt: Any) -> Array:
        """The vector."""
        turn = lk.se3.rotation_log(R_wd @ R_wt.T)
        angle = float(np.linalg.norm(turn))
        return turn / angle * self.angle(angle) if angle else turn
