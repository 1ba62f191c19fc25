"""Answers of notebook 04: torque laws, what was wrong in runs, gains, the sampled joint."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def augmented_pd(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """What the motion takes, and a spring and a damper at each joint (MLS eq. 4.53)."""
    q, dq = state.q, state.dq
    e, de = target.position - q, target.velocity - dq
    tau = model.mass_matrix(q) @ target.acceleration + model.coriolis(q, dq) @ target.velocity
    tau = tau + kp * e + kd * de
    if not arm_compensates:
        tau = tau + model.gravity(q)
    return lk.JointTorque(tau)


def computed_torque(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """The torque for the acceleration that lets the error die out (MLS eq. 4.49)."""
    q, dq = state.q, state.dq
    ddq = target.acceleration + kp * (target.position - q) + kd * (target.velocity - dq)
    tau = model.mass_matrix(q) @ ddq + model.coriolis(q, dq) @ dq
    if not arm_compensates:
        tau = tau + model.gravity(q)
    return lk.JointTorque(tau)


def sampled_joint(inertia: float, kp: float, kd: float, dt: float) -> Array:
    """One period of a joint whose torque stands still meanwhile, exactly."""
    free = np.array([[1.0, dt], [0.0, 1.0]])
    kick = np.array([dt**2 / 2.0, dt]) / inertia
    return np.asarray(free - np.outer(kick, [kp, kd]))


def choose_gains(model: lk.Model) -> tuple[Array, Array]:
    """Springs and dampers that make every joint swing at 1.9 Hz, critically damped."""
    inertia = np.diag(model.mass_matrix(model.robot.ready))
    w = 2.0 * np.pi * 1.9
    return w**2 * inertia, 2.0 * w * inertia


def what_shows(term: str) -> str:
    """For each term of equation 18 "-" if it is right, else the runs that show its mistake."""
    return {"a": "-", "b": "none", "c": "-", "d": "HPF"}[term]


def find_bug(log: lk.Log) -> str:
    """The mistake whose law commands what a run commanded at its end."""
    late = len(log) * 2 // 3
    off = {
        letter: np.abs(log.command - lk.course.commanded(log, letter))[late:].max()
        for letter in "abcdefgh"
    }
    return min(off, key=lambda letter: off[letter])
