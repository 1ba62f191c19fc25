"""Answers of notebook 05: inertia at the tip, springs at the tip and in the joints, a load."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def operational_inertia(M: Any, J: Any) -> Array:
    """The inertia felt at the tip (Khatib 1987): its inverse is how easily a wrench moves it."""
    return np.linalg.inv(J @ np.linalg.solve(M, J.T))


def workspace_impedance(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """A spring and a damper at the tip; the tip keeps the inertia that it has."""
    q, dq = state.q, state.dq
    J, inertia = model.tip_jacobian(q), model.operational_inertia(q)
    e = lk.se3.pose_error(target.pose, model.pose(q))
    de = target.twist - J @ dq
    motion = inertia @ (target.dtwist - model.tip_jacobian_rate(q, dq) @ dq)
    wrench = motion + damping * de + stiffness * e
    return lk.JointTorque(J.T @ wrench + model.coriolis(q, dq) @ dq + model.gravity(q))


def shaped_impedance(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """As `workspace_impedance`, with another inertia; for that the wrench must be known."""
    q, dq = state.q, state.dq
    J = model.tip_jacobian(q)
    e = lk.se3.pose_error(target.pose, model.pose(q))
    de = target.twist - J @ dq
    a = target.dtwist + np.linalg.solve(inertia, damping * de + stiffness * e + wrench)
    a = a - model.tip_jacobian_rate(q, dq) @ dq
    needed = model.operational_inertia(q) @ a - wrench  # the hand does its share of the work
    return lk.JointTorque(J.T @ needed + model.coriolis(q, dq) @ dq + model.gravity(q))


def tip_spring(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """Equation 21 mended, for a target at rest: the spring pulls towards the target."""
    J = model.tip_jacobian(state.q)
    e = lk.se3.pose_error(target.pose, model.pose(state.q))
    de = target.twist - J @ state.dq
    return lk.JointTorque(J.T @ (damping * de + stiffness * e) + model.gravity(state.q))


def joint_impedance(J: Any, stiffness: Any, elbow: float) -> Array:
    """The springs of the joints that feel at the tip like `stiffness`; the elbow has its own."""
    n = np.linalg.svd(J)[2][-1]
    return np.asarray(J.T @ np.diag(stiffness) @ J + elbow * np.outer(n, n))


def weigh(arm: Any) -> float:
    """What is in the gripper: the mean torque of slow swings, in which friction cancels."""
    model, ready = arm.model, np.array(arm.robot.ready)
    swing, period, swings = 0.1 * np.array([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0]), 2.0, 3
    w = 2.0 * np.pi / period

    def to_and_fro(t: float) -> lk.Sample:
        q, dq = ready + swing * np.sin(w * t), swing * w * np.cos(w * t)
        return lk.Sample(q, dq, -swing * w * w * np.sin(w * t))

    m = np.diag(model.mass_matrix(ready))
    law = lk.control.springs(100.0 * m, 20.0 * m)
    log = lk.run(arm, to_and_fro, law, 200.0, period * (swings + 0.5))
    late = log.t > 0.5 * period
    torque, q = log.command[late].mean(axis=0), log.q[late].mean(axis=0)
    one_kilogram = model.tip_jacobian(q)[:3].T @ [0.0, 0.0, 9.81]
    levers = [1, 3]  # of the joints that swing
    return float(one_kilogram[levers] @ torque[levers] / np.sum(one_kilogram[levers] ** 2))
