r"""Numbers from a log: how well the arm followed its target, and at what cost.

An error is always target minus actual.  A target of `Sample` with as many numbers as the arm has
joints is taken for joint angles; on an arm with three joints, let points be poses (`PosePath`).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from . import se3
from .errors import OutOfRange, TypeMismatch
from .log import Log
from .model import Model
from .shapes import Array, as_array, as_number, as_numbers
from .trajectory import PoseSample, Sample


def model_of(log: Log) -> Model:
    """The model of the arm that made a log."""
    return Model(log.robot, log.plant)


def joint_error(log: Log) -> Array:
    """Target minus actual joint angles, for a target of joint angles, shape (N, n) in [rad].

    Raises:
        TypeMismatch: The run followed something else.
    """
    return np.asarray(_joint_target(log).position - log.q)


def _joint_target(log: Log) -> Sample:
    target = log.target
    if isinstance(target, PoseSample):
        raise TypeMismatch(
            "this run followed poses, not joint angles: ask for tip_error(log), velocity_error(log)"
        )
    if target.position.shape != log.q.shape:
        raise TypeMismatch(
            f"this run followed points of {target.position.shape[1]} numbers, neither poses nor "
            "joint angles; PosePath(path, R_wt) makes poses of points"
        )
    return target


def tip_poses(log: Log, model: Model | None = None) -> Array:
    """Actual pose of the tip, `T_wt`, at each tick, shape (N, 4, 4)."""
    model = model or model_of(log)
    return np.array([model.pose(q) for q in log.q])


def target_poses(log: Log, model: Model | None = None) -> Array:
    """Desired pose of the tip, `T_wd`, at each tick, shape (N, 4, 4)."""
    if isinstance(log.target, PoseSample):
        return log.target.pose
    model = model or model_of(log)
    return np.array([model.pose(q) for q in _joint_target(log).position])


def tip_error(log: Log, model: Model | None = None) -> Array:
    """Pose error of the tip, target minus actual, world axes, shape (N, 6) in [m], then [rad]."""
    model = model or model_of(log)
    pairs = zip(target_poses(log, model), tip_poses(log, model), strict=True)
    return np.array([se3.pose_error(T_wd, T_wt) for T_wd, T_wt in pairs])


def felt_wrench(log: Log, model: Model | None = None) -> Array:
    """The wrench on the tip as estimated by the torque sensors, world axes, shape (N, 6).

    Force [N], then moment about the tip's origin [N m]; see `Model.tip_wrench` and `State.tau_ext`.
    """
    model = model or model_of(log)
    pairs = zip(log.measured.q, log.measured.tau_ext, strict=True)
    return np.array([model.tip_wrench(q, tau) for q, tau in pairs])


def rms(error: Any) -> float:
    """Root mean square of the length of a vector error, with one row for each instant.

    Args:
        error: Shape (N, n), or (N,).

    Returns:
        ``sqrt(mean(|e|^2))``, in the error's unit.

    Raises:
        OutOfRange: The error is empty.
    """
    return float(np.sqrt(np.mean(np.sum(_rows(error) ** 2, axis=1))))


def settling_time(t: Any, error: Any, tolerance: float) -> float:
    """The time after which the error stays within a tolerance.

    Args:
        t: Times, shape (N,) in [s].
        error: Shape (N, n), or (N,).
        tolerance: Largest length of a settled error, in the error's unit.

    Returns:
        The time since the first row, in [s]; infinite if the error is still outside at the end.

    Raises:
        OutOfRange: The error is empty.
        ShapeError: The numbers of times and errors differ.
    """
    e = _rows(error)
    t = as_array(t, (len(e),), "t")
    outside = np.flatnonzero(np.linalg.norm(e, axis=1) > tolerance)
    if not outside.size:
        return 0.0
    return float("inf") if outside[-1] == len(e) - 1 else float(t[outside[-1] + 1] - t[0])


def _rows(error: Any) -> Array:
    e = as_numbers(error, "error")
    if e.size == 0:
        raise OutOfRange("error is empty; it needs a row for each instant")
    return e.reshape(len(np.atleast_1d(e)), -1)


SETTLED = 5e-3
"""The tip has settled when its distance from the target is at most this, in [m]."""


def since(log: Log, t: float) -> Log:
    """The rows of a run from time ``t`` [s] on, with their times unchanged.

    Raises:
        OutOfRange: The run ends before ``t``.
    """
    first = int(np.searchsorted(log.t, as_number(t, "t") - 1e-9))
    if first == len(log):
        raise OutOfRange(f"t is {t:g} s, and this run ends at {log.t[-1]:g} s")
    cut: dict[str, Any] = {
        f.name: column[first:]
        for f in fields(log)
        if isinstance(column := getattr(log, f.name), np.ndarray)
    }
    target, measured = (type(x)(*(part[first:] for part in x)) for x in (log.target, log.measured))
    return replace(log, **cut, target=target, measured=measured)


@dataclass(frozen=True)
class Summary:
    """A run summarized in a few numbers.

    Attributes:
        rms_mm: RMS position error of the tip, in [mm].
        max_mm: Largest position error of the tip, in [mm].
        rms_deg: RMS orientation error of the tip, in [degrees].
        max_deg: Largest orientation error of the tip, in [degrees].
        rms_velocity_mm_s: RMS error of the tip's velocity, in [mm/s].
        settling: The time after which the tip stays within `SETTLED` of its target, in [s];
            infinite if the tip is outside at the end.
        effort: RMS length of the motor torque, in [N m].
        saturated: Share of the ticks in which a limit cut the command.
        duration: Time of the last tick, in [s].
    """

    rms_mm: float
    max_mm: float
    rms_deg: float
    max_deg: float
    rms_velocity_mm_s: float
    settling: float
    effort: float
    saturated: float
    duration: float

    def __str__(self) -> str:
        return (
            f"RMS {self.rms_mm:.3g} mm, max {self.max_mm:.3g} mm and {self.max_deg:.3g} degrees, "
            f"RMS torque {self.effort:.3g} N m, "
            f"command cut {100 * self.saturated:.0f} % of the time"
        )


def summary(log: Log, model: Model | None = None) -> Summary:
    """The usual numbers of a run."""
    model = model or model_of(log)
    e = tip_error(log, model)
    off, turned = (np.linalg.norm(part, axis=1) for part in (e[:, :3], e[:, 3:]))
    return Summary(
        rms_mm=1e3 * rms(e[:, :3]),
        max_mm=1e3 * float(off.max()),
        rms_deg=float(np.degrees(rms(turned))),
        max_deg=float(np.degrees(turned.max())),
        rms_velocity_mm_s=1e3 * rms(velocity_error(log, model)),
        settling=settling_time(log.t, off, SETTLED),
        effort=rms(log.tau),
        saturated=float(log.saturated.mean()),
        duration=float(log.t[-1]),
    )


def tip_velocities(log: Log, model: Model | None = None) -> Array:
    """Velocity of the tip's origin at each tick, world axes, shape (N, 3) in [m/s]."""
    return _tip_velocities(model or model_of(log), log.q, log.dq)


def velocity_error(log: Log, model: Model | None = None) -> Array:
    """Target minus actual velocity of the tip's origin, world axes, shape (N, 3) in [m/s]."""
    model = model or model_of(log)
    if isinstance(log.target, PoseSample):
        return log.target.twist[:, :3] - tip_velocities(log, model)
    target = _joint_target(log)
    return _tip_velocities(model, target.position, target.velocity) - tip_velocities(log, model)


def _tip_velocities(model: Model, q: Array, dq: Array) -> Array:
    pairs = zip(q, dq, strict=True)
    return np.array([model.tip_jacobian(angles)[:3] @ speeds for angles, speeds in pairs])
