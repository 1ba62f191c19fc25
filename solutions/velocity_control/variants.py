"""Right answers to notebook 03 in other forms."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk


def joint_in_a_loop(state: Any, target: Any, *, kp: Any, kd: Any) -> Any:
    """Joint by joint."""
    kp, kd = np.broadcast_to(kp, 7), np.broadcast_to(kd, 7)
    x, v, _ = target
    return lk.JointVelocity(
        np.array(
            [v[j] + kp[j] * (x[j] - state.q[j]) + kd[j] * (v[j] - state.dq[j]) for j in range(7)]
        )
    )


def joint_with_matrices(state: Any, target: Any, *, kp: Any, kd: Any) -> Any:
    """Gains as diagonal matrices."""
    Kp, Kd = (np.diag(np.broadcast_to(k, 7)) for k in (kp, kd))
    return lk.JointVelocity(
        (np.eye(7) + Kd) @ target.velocity - Kd @ state.dq + Kp @ (target.position - state.q)
    )


def joint_mended(state: Any, target: Any, *, kp: Any, kd: Any) -> Any:
    """Equation 17 with its first term taken off again and the target's speed added."""
    c = state.dq + kp * (target.position - state.q) + kd * (target.velocity - state.dq)
    return lk.JointVelocity(c - (state.dq - target.velocity))


def rate_from_the_root(kp: Any, kd: Any) -> Any:
    """The root of (1 + kd) s + kp."""
    return -np.roots([1.0 + kd, kp])[0]


def inverse_the_other_way(J: Any, damping: Any) -> Any:
    """With a 7 by 7 matrix; without damping, the pseudo-inverse."""
    if damping == 0.0:
        return np.linalg.pinv(J)
    return np.linalg.solve(J.T @ J + damping * np.eye(7), J.T)


def inverse_by_svd(J: Any, damping: Any) -> Any:
    """From the singular values."""
    U, s, Vt = np.linalg.svd(J, full_matrices=False)
    return Vt.T @ np.diag(s / (s**2 + damping)) @ U.T


class WorkspacePD:
    """A callable object that solves instead of inverting."""

    def __call__(self, state: Any, target: Any, model: Any, *, kp: Any, damping: Any) -> Any:
        """The command."""
        J, T = model.tip_jacobian(state.q), model.pose(state.q)
        e = np.zeros(6)
        e[:3] = target.pose[:3, 3] - T[:3, 3]
        e[3:] = T[:3, :3] @ lk.se3.rotation_log(T[:3, :3].T @ target.pose[:3, :3])
        twist = target.twist + np.broadcast_to(kp, 6) * e
        return lk.JointVelocity(J.T @ np.linalg.solve(J @ J.T + damping * np.eye(6), twist))


def workspace_in_tool_axes(state: Any, target: Any, model: Any, *, kp: Any, damping: Any) -> Any:
    """Everything in the tool's axes."""
    T, J_b = model.pose(state.q), model.body_jacobian(state.q)
    R = T[:3, :3]
    e = np.concatenate(
        [target.pose[:3, 3] - T[:3, 3], lk.se3.orientation_error(target.pose[:3, :3], R)]
    )
    twist = target.twist + kp * e
    twist_b = np.concatenate([R.T @ twist[:3], R.T @ twist[3:]])
    return lk.JointVelocity(J_b.T @ np.linalg.inv(J_b @ J_b.T + damping * np.eye(6)) @ twist_b)


def _step(arm: Any, speed: float, joint: int) -> lk.Log:
    """One joint at a constant speed from the first tick on."""
    command = lk.JointVelocity(speed * np.eye(7)[joint])
    return lk.run(arm, lk.Hold(arm.robot.ready, 0.6), lambda state, target: command)


def lag_by_63_percent(arm: Any) -> Any:
    """The first tick with 63 % of the speed, of a wrist joint."""
    log = _step(arm, -0.5, 4)
    return log.t[np.argmax(-log.dq[:, 4] >= (1 - np.exp(-1)) * 0.5)]


def lag_by_logarithm(arm: Any) -> Any:
    """The slope of the logarithm of what is missing."""
    log = _step(arm, 0.4, 0)
    left = 1 - log.dq[:, 0] / 0.4
    some = (left > 0.2) & (left < 0.95)
    return -1 / np.polyfit(log.t[some], np.log(left[some]), 1)[0]


def posture_by_projector(J: Any, dq_wish: Any) -> Any:
    """With the projector spelled out."""
    return (np.eye(7) - np.linalg.pinv(J) @ J) @ dq_wish


def posture_by_null_vector(J: Any, dq_wish: Any) -> Any:
    """Along the null vector of the Jacobian."""
    n = np.linalg.svd(J)[2][-1]
    return n * (n @ dq_wish)


def posture_by_least_squares(J: Any, dq_wish: Any) -> Any:
    """Subtracts the smallest joint speeds with the same motion of the tip."""
    return list(dq_wish - np.linalg.lstsq(J, J @ dq_wish, rcond=None)[0])
