"""Answers of notebook 05: one mass, inertia at the tip, two impedances, stiffness from data."""

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
