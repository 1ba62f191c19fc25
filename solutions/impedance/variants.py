"""Right answers to notebook 05 in other forms."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk


def inertia_by_inverse(M: Any, J: Any) -> Any:
    """With the inverse written out."""
    return np.linalg.inv(J @ np.linalg.inv(M) @ np.transpose(J))


def inertia_by_root(M: Any, J: Any) -> Any:
    """By the Cholesky factor, into lists."""
    W = np.linalg.solve(np.linalg.cholesky(M), np.asarray(J).T)
    return np.linalg.pinv(W.T @ W).tolist()


def terms(state: lk.State, model: lk.Model) -> Any:
    """Pose, Jacobian, drift, M, C dq and g."""
    q, dq = state.q, state.dq
    M, g = model.mass_matrix(q), model.gravity(q)
    T, J, drift = model.pose(q), model.tip_jacobian(q), model.tip_jacobian_rate(q, dq) @ dq
    return T, J, drift, M, model.bias(q, dq) - g, g


def impedance_by_terms(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> Any:
    """With diagonal matrices, and inverse dynamics of a joint acceleration."""
    T, J, drift, M, c, g = terms(state, model)
    K, D = np.diag(stiffness * np.ones(6)), np.diag(damping * np.ones(6))
    Minv = np.linalg.inv(M)
    L = np.linalg.inv(J @ Minv @ J.T)
    F = K @ lk.se3.pose_error(target.pose, T) + D @ (target.twist - J @ state.dq)
    ddq = Minv @ J.T @ (L @ (target.dtwist - drift) + F)
    return lk.JointTorque(M @ ddq + c + g)


def impedance_by_parts(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> Any:
    """Position and orientation separately, with the logarithm written out."""
    q, dq = state.q, state.dq
    T, J = model.pose(q), model.tip_jacobian(q)
    turn = lk.se3.rotation_log(target.pose[:3, :3] @ T[:3, :3].T)
    e = np.concatenate([target.pose[:3, 3] - T[:3, 3], turn])
    V = np.concatenate([J[:3] @ dq, J[3:] @ dq])
    F = stiffness * e - damping * (V - target.twist)
    F = F + model.operational_inertia(q) @ (target.dtwist - model.tip_jacobian_rate(q, dq) @ dq)
    return lk.JointTorque(model.bias(q, dq) + J.T @ F)


def impedance_by_khatib(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> Any:
    """By the tip's equation of motion, with its Coriolis term, transformed by J^T."""
    T, J, drift, M, c, g = terms(state, model)
    L = np.linalg.inv(J @ np.linalg.inv(M) @ J.T)
    mu = L @ (J @ np.linalg.solve(M, c) - drift)
    F = stiffness * lk.se3.pose_error(target.pose, T) + damping * (target.twist - J @ state.dq)
    return lk.JointTorque(J.T @ (L @ target.dtwist + mu + F) + g)


def impedance_by_pseudo_inverse(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> Any:
    """The smallest joint acceleration for that of the tip, times M; springs and dampers by J^T."""
    T, J, drift, M, c, g = terms(state, model)
    F = stiffness * lk.se3.pose_error(target.pose, T) + damping * (target.twist - J @ state.dq)
    ddq = np.linalg.pinv(J) @ (target.dtwist - drift)
    return lk.JointTorque(M @ ddq + J.T @ F + c + g)


def impedance_with_braked_elbow(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> Any:
    """With a damper in the null space, which the tip does not feel."""
    tau = impedance_by_parts(state, target, model, stiffness=stiffness, damping=damping).value
    J, M = model.tip_jacobian(state.q), model.mass_matrix(state.q)
    felt = J.T @ model.operational_inertia(state.q) @ J @ np.linalg.inv(M)
    return lk.JointTorque(tau - 2.0 * (np.eye(7) - felt) @ state.dq)


def shaped_by_pseudo_inverse(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> Any:
    """The smallest joint acceleration for that of the tip, times M, minus the hand's share."""
    T, J, drift, M, c, g = terms(state, model)
    F = stiffness * lk.se3.pose_error(target.pose, T) + damping * (target.twist - J @ state.dq)
    a = target.dtwist + np.linalg.solve(inertia, F + wrench) - drift
    return lk.JointTorque(M @ np.linalg.pinv(J) @ a - J.T @ wrench + c + g)


def shaped_by_factor(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> Any:
    """The textbook's form, with the factor (Lambda M_d^-1 - I) before the wrench."""
    T, J, drift, _, c, g = terms(state, model)
    L = model.operational_inertia(state.q)
    share = L @ np.linalg.inv(inertia)
    F = damping * (target.twist - J @ state.dq) + stiffness * lk.se3.pose_error(target.pose, T)
    tip = L @ (target.dtwist - drift) + share @ F + (share - np.eye(6)) @ wrench
    return lk.JointTorque(J.T @ tip + c + g)


def spring_by_parts(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> Any:
    """Diagonal matrices, the report's sign of the error."""
    T, J, _, _, _, g = terms(state, model)
    x = -lk.se3.pose_error(target.pose, T)
    F = -np.diag(damping) @ (J @ state.dq - target.twist) - np.diag(stiffness) @ x
    return lk.JointTorque(g + np.transpose(J) @ F)


def joint_springs_by_projector(J: Any, stiffness: Any, elbow: float) -> Any:
    """The projector onto what the tip does not feel, and lists."""
    J = np.asarray(J)
    n = np.eye(7) - np.linalg.pinv(J) @ J
    return ((J.T * stiffness) @ J + elbow * n).tolist()


def weigh_from_both_sides(arm: Any) -> float:
    """Holds after coming from above and from below, and takes the middle."""
    model, ready = arm.model, np.array(arm.robot.ready)
    m = np.diag(model.mass_matrix(ready))
    law = lk.control.springs(200.0 * m, 28.0 * m)
    way = 0.04 * np.array([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0])
    torques, places = [], []
    for sign in (1.0, -1.0):
        path = lk.Line(ready + sign * way, ready - sign * way)
        log = lk.run(arm, lk.Trajectory(path, lk.Quintic(3.0)), law)
        middle = (log.t > 1.0) & (log.t < 2.0)
        torques.append(log.command[middle].mean(axis=0))
        places.append(log.q[middle].mean(axis=0))
    one = model.tip_jacobian(np.mean(places, axis=0))[:3].T @ [0.0, 0.0, 9.81]
    return float((one @ np.mean(torques, axis=0)) / (one @ one))
