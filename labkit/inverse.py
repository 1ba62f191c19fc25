"""Inverse kinematics: which joint angles put the tip at a pose or along a path, or why none do."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from . import se3
from .errors import LabkitWarning, TypeMismatch, Unreachable
from .paths import Spline
from .robot import Robot
from .shapes import Array
from .trajectory import Chain, Hold, PosePath, PoseSample, Sample, Trajectory

if TYPE_CHECKING:
    from .model import Model

_ITERATIONS = 200
_MEASURED = 0.1  # [rad]; a measured start may be beyond a limit, by noise or by a soft stop


def search(model: Model, T_wt: Any, q0: Any, posture: Any) -> Array:
    """Do what `Model.inverse_kinematics` promises, by Gauss-Newton steps on the pose error."""
    robot = model.robot
    if robot.n < 6:
        raise Unreachable(
            f"the {robot.n} joints of {robot.name} cannot put the tip at any pose, which takes "
            "six; give a target of joint angles"
        )
    T_wt = se3.as_pose(T_wt, "T_wt")
    q = np.clip(model.within_limits(q0, "q0", _MEASURED), robot.lower, robot.upper)
    near = q if posture is None else model.within_limits(posture, "posture", _MEASURED)
    nearest, least = q, np.inf
    for _ in range(_ITERATIONS):
        e = model.pose_error(T_wt, q)
        if e @ e < least:
            nearest, least = q, float(e @ e)
        J = model.tip_jacobian(q)
        damping = 1e-4 * min(1.0, float(e @ e))  # vanishes at the solution
        J_inv = J.T @ np.linalg.inv(J @ J.T + damping * np.eye(6))
        free = near - q
        free = free - J_inv @ (J @ free)
        step = J_inv @ e + free
        if e @ e < 1e-20 and free @ free < 1e-18:
            return q
        step *= min(1.0, 0.5 / float(np.abs(step).max()))
        moved = np.clip(q + step, robot.lower, robot.upper)
        if e @ e < 1e-20 and np.abs(moved - q).max() < 1e-9:  # the posture pulls into a limit
            return q
        q = moved
    e = model.pose_error(T_wt, q)
    if e @ e < 1e-18:
        return q
    place = ", ".join(f"{x:.3f}" for x in T_wt[:3, 3])
    raise Unreachable(f"the pose at ({place}) m {_reason(model, T_wt, nearest)}")


def _reason(model: Model, T_wt: Array, nearest: Array) -> str:
    """Why a search failed: the pose is too far away, or unknown; and how near it came."""
    robot, e = model.robot, model.pose_error(T_wt, nearest)
    mm, degrees = 1e3 * np.linalg.norm(e[:3]), np.degrees(np.linalg.norm(e[3:]))
    off = f"(nearest found: {mm:.3g} mm and {degrees:.3g} degrees off)"
    first, *links = [np.array(body["T_parent"])[:3, 3] for body in robot.bodies]
    reach = sum(map(np.linalg.norm, [*links, robot.T_hand_tip[:3, 3]]))  # of a stretched arm
    distance = np.linalg.norm(T_wt[:3, 3] - first)
    if distance > reach:
        return (
            f"cannot be reached: it is {distance:.3f} m from the first joint, and the arm is "
            f"{reach:.3f} m long {off}; bring it nearer"
        )
    return f"was not found from this q0 {off}; start from another q0, or change the orientation"


def joint_trajectory(model: Model, target: Any, q0: Any, samples: int) -> Any:
    """Do what `Model.joint_trajectory` promises."""
    q0 = model.within_limits(q0, "q0")
    if isinstance(target, Chain):
        parts, q = [], q0
        for part in target.parts:
            parts.append(_joint_trajectory(model, part, q, q0, samples))
            q = parts[-1](part.duration).position
        return Chain(parts)
    return _joint_trajectory(model, target, q0, q0, samples)


def _joint_trajectory(model: Model, target: Any, q: Array, posture: Array, samples: int) -> Any:
    if not isinstance(target, Trajectory | Hold):
        raise TypeMismatch(
            f"joint_trajectory takes a Trajectory, Chain or Hold, not {type(target).__name__}"
        )
    start, R_wt = target(0.0), model.pose(posture)[:3, :3]
    if isinstance(start, Sample) and start.position.size != 3:
        raise TypeMismatch(
            f"joint_trajectory takes poses or points of the tip, not {start.position.size} "
            "numbers; a target of joint angles can be followed as it is"
        )
    if isinstance(target, Hold):
        T_wt = start.pose if isinstance(start, PoseSample) else se3.pose(R_wt, start.position)
        return Hold(model.inverse_kinematics(T_wt, q, posture=posture), target.duration)
    if isinstance(start, Sample):
        target = Trajectory(PosePath(target.path, R_wt), target.scaling)
    grid = np.linspace(0.0, 1.0, samples)
    angles = np.empty((samples, model.robot.n))
    for k, s in enumerate(grid):
        try:
            q = model.inverse_kinematics(target.path(s).pose, q, posture=posture)
        except Unreachable as error:
            raise Unreachable(f"at s = {s:.2f} {error}") from None
        angles[k] = q
    jump = np.abs(np.diff(angles, axis=0)).max()
    if jump > 0.5:
        raise Unreachable(
            f"the joint angles jump by {jump:.2f} rad between two neighbouring poses: the path "
            "runs through a singularity; move it, or start from another q0"
        )
    joints = Trajectory(Spline(grid, angles), target.scaling)
    _warn_of_speed(joints, model.robot)
    return joints


def _warn_of_speed(trajectory: Any, robot: Robot) -> None:
    """Warn if a joint motion is faster than the arm, and say what duration is sufficient."""
    t = np.linspace(0.0, trajectory.duration, 201)
    share = np.abs([trajectory(x).velocity for x in t]) / robot.speed
    k, i = np.unravel_index(int(share.argmax()), share.shape)
    if share[k, i] > 1.0 + 1e-9:
        warnings.warn(
            f"too fast: at t = {t[k]:.2f} s joint {robot.joint_names[i]} should turn at "
            f"{share[k, i] * robot.speed[i]:.3g} rad/s, but its limit is {robot.speed[i]:g}; the "
            f"arm will lag unless the motion takes {share[k, i] * trajectory.duration:.3g} s",
            LabkitWarning,
            stacklevel=5,
        )
