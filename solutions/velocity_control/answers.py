"""Answers of notebook 03: controllers that command joint speeds, as plain functions.

The laws are those of the classes `JointVelocityPD` and `WorkspaceVelocityPD`, which the book and
the campaign use; here gains and model are arguments, and nothing is checked or watched.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def joint_velocity_pd(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """Feed-forward, and a pull towards the target (Lynch & Park, section 11.3)."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(target.velocity + kp * e + kd * de)


def what_shows(run: str) -> str:
    """The term that spoils a run of equation 17, and the run of 16 in which the tilt stays."""
    return {"H": "a", "P": "-", "F": "a", "tilt": "h"}[run]


def decay_rate(kp: float, kd: float) -> float:
    """Of de/dt = -(kp e + kd de/dt): the speed that is commanded is the speed that is damped."""
    return kp / (1.0 + kd)


def damped_inverse(J: Any, damping: float) -> Array:
    """Small joint speeds are worth a small error of the tip (Siciliano, section 3.5.2)."""
    return np.asarray(J.T @ np.linalg.inv(J @ J.T + damping * np.eye(len(J))))


def workspace_velocity_pd(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """The tip's twist wanted, and the joint speeds that make it (Lynch & Park, section 11.3.3)."""
    T_wt = model.pose(state.q)
    turn = lk.se3.rotation_log(target.pose[:3, :3] @ T_wt[:3, :3].T)
    e = np.concatenate([target.pose[:3, 3] - T_wt[:3, 3], turn])
    J = model.tip_jacobian(state.q)
    return lk.JointVelocity(damped_inverse(J, damping) @ (target.twist + kp * e))


def find_lag(arm: lk.Arm) -> float:
    """How far the angle of a joint stays behind, in steady motion, over its speed."""

    def steps(state: lk.State, target: lk.Sample) -> lk.JointVelocity:
        return lk.JointVelocity(0.4 * np.eye(7)[0])

    log = lk.run(arm, lk.Hold(arm.robot.ready, 1.0), steps)
    behind = log.t - (log.q - log.q[0])[:, 0] / 0.4
    return float(np.mean(behind[log.t > 0.5]))


def posture_velocity(J: Any, dq_wish: Any) -> Array:
    """What of a wish the tip does not feel (Siciliano, section 3.5.1)."""
    return np.asarray(dq_wish - np.linalg.pinv(J) @ (J @ dq_wish))
