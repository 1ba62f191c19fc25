"""Right answers to notebook 04 in other forms."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import expm

import labkit as lk


def augmented_by_newton_euler(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """By one pass of inverse dynamics, corrected for the speed in C."""
    q, dq = state.q, state.dq
    tau = model.inverse_dynamics(q, dq, target.acceleration)
    tau = tau + model.coriolis(q, dq) @ (target.velocity - dq)
    tau = tau + np.diag(kp * np.ones(7)) @ (target.position - q)
    tau = tau + np.diag(kd * np.ones(7)) @ (target.velocity - dq)
    return lk.JointTorque(tau - arm_compensates * model.gravity(q))


def augmented_in_a_list(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """Joint by joint, into a list."""
    M, C = model.mass_matrix(state.q), model.coriolis(state.q, state.dq)
    g = [0.0] * 7 if arm_compensates else model.gravity(state.q)
    kp, kd = np.broadcast_to(kp, 7), np.broadcast_to(kd, 7)
    tau: Any = []
    for i in range(7):
        one = g[i] + kp[i] * (target.position[i] - state.q[i])
        one += kd[i] * (target.velocity[i] - state.dq[i])
        for j in range(7):
            one += M[i, j] * target.acceleration[j] + C[i, j] * target.velocity[j]
        tau.append(one)
    return lk.JointTorque(tau)


def computed_by_newton_euler(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """By inverse dynamics, with the weight subtracted."""
    ddq = target.acceleration - kd * (state.dq - target.velocity)
    ddq = ddq - kp * (state.q - target.position)
    tau = model.inverse_dynamics(state.q, state.dq, ddq)
    return lk.JointTorque(tau - model.gravity(state.q) if arm_compensates else tau)


def computed_by_bias(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """With `Model.bias`, and the weight treated separately."""
    M, g = model.mass_matrix(state.q), model.gravity(state.q)
    e, de = target.position - state.q, target.velocity - state.dq
    tau = M.dot(target.acceleration + kd * de + kp * e) + model.bias(state.q, state.dq) - g
    return lk.JointTorque(tau + (0.0 if arm_compensates else 1.0) * g)


def held_by_exponential(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """The exponential with the held torque as a third state."""
    A = np.zeros((3, 3))
    A[0, 1] = 1.0
    A[1, 2] = 1.0 / inertia
    Phi = expm(A * dt)
    return Phi[:2, :2] - Phi[:2, 2:] @ np.array([[kp, kd]])


def held_in_lists(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """Four numbers in lists."""
    a = dt / inertia
    return [[1 - kp * a * dt / 2, dt - kd * a * dt / 2], [-kp * a, 1 - kd * a]]


class ByFrequency:
    """A callable object that makes every joint swing at the same frequency."""

    def __init__(self, w: float, zeta: float) -> None:
        self.w, self.zeta = w, zeta

    def __call__(self, model: lk.Model) -> Any:
        """Gains in lists."""
        m = np.diagonal(model.mass_matrix(model.robot.neutral))
        kp = [float(self.w**2 * x) for x in m]
        return kp, [float(2 * self.zeta * self.w * x) for x in m]


def by_hand(model: lk.Model) -> Any:
    """Seven numbers found by trying."""
    return (
        np.array([330.0, 300.0, 150.0, 120.0, 21.0, 18.0, 7.0]),
        np.array([55.0, 50.0, 25.0, 20.0, 3.5, 3.0, 1.2]),
    )


def bug_by_median(log: lk.Log) -> str:
    """By the median of the second half, from the last letter on."""
    half = slice(len(log) // 2 + 100, None)

    def off(letter: str) -> float:
        wrong = np.abs(log.command[half] - lk.course.commanded(log, letter)[half])
        return float(np.median(wrong.sum(axis=1)))

    return min("hgfedcba", key=off)
