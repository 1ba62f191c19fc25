"""Hidden cases of notebook 02, and the recorded lifts that both kinds of case share."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import Call
from labkit.course.authoring.problem import call

Random = np.random.Generator
MODEL = lk.Model("left")
FRICTION = np.array([3.0, 3.0, 2.0, 2.0, 0.3, 0.3, 0.3])
ROUGH = lk.Plant(name="rough", armature=0.05, viscous=FRICTION)
"""A plant with friction, for the power balance to find."""
ROUGH_MODEL = lk.Model("left", ROUGH)

TIRED = 0.55
"""The share of their torque that hot motors have left, so that fast lifts reach the limits."""


def anywhere(random: Random) -> Any:
    """Joint angles within the limits."""
    return random.uniform(0.9 * MODEL.robot.lower, 0.9 * MODEL.robot.upper)


def joints(q: Any) -> Any:
    """Axes, origins and tip at ``q``, the arguments of `jacobian`."""
    parts = MODEL.links(q)
    axes, origins = (np.array([part.T_wl[:3, k] for part in parts]) for k in (2, 3))
    return axes, origins, MODEL.pose(q)[:3, 3]


def bodies(q: Any) -> Any:
    """Masses, inertias, rotations and Jacobians of the links, the arguments of `mass_matrix`."""
    parts = MODEL.links(q)
    return (
        np.array([part.mass for part in parts]),
        np.array([part.inertia for part in parts]),
        np.array([part.T_wl[:3, :3] for part in parts]),
        np.array([part.com_jacobian for part in parts]),
    )


def weights(q: Any, g_w: Any = (0.0, 0.0, -9.81)) -> Any:
    """Masses and Jacobians of the links and the acceleration of gravity, for `gravity`."""
    masses, _, _, jacobians = bodies(q)
    return masses, jacobians, np.array(g_w)


def jacobians(random: Random) -> Iterator[Call]:
    """Any poses."""
    for _ in range(4):
        yield call(*joints(anywhere(random)))


def points_of_mass(random: Random) -> Iterator[Call]:
    """Links without inertia of their own, in any pose."""
    masses, inertias, rotations, jacobians = bodies(anywhere(random))
    yield call(masses, 0.0 * inertias, rotations, jacobians)


def mass_matrices(random: Random) -> Iterator[Call]:
    """Any poses."""
    for _ in range(4):
        yield call(*bodies(anywhere(random)))


def gravities(random: Random) -> Iterator[Call]:
    """Any poses on a level floor."""
    yield call(*weights(anywhere(random)))


def tilted_gravities(random: Random) -> Iterator[Call]:
    """Any poses, with gravity in any direction and of any size."""
    for _ in range(4):
        g_w = random.standard_normal(3)
        g_w *= random.uniform(1.6, 9.9) / np.linalg.norm(g_w)
        yield call(*weights(anywhere(random), g_w))


def coriolis_any(random: Random) -> Iterator[Call]:
    """Any states."""
    for _ in range(2):
        yield call(MODEL.mass_matrix, anywhere(random), random.uniform(-1.0, 1.0, 7))


def lifts(random: Random) -> Iterator[Call]:
    """A lift of another height and speed, cut by the torque limits."""
    yield call(lift(random.uniform(0.5, 0.6), random.uniform(0.38, 0.44), 400.0), ROUGH_MODEL)


def gentle_lifts(random: Random) -> Iterator[Call]:
    """Slower lifts within the limits, one against a hand and one with its help."""
    for sign in (-1.0, 1.0):
        way, duration = random.uniform(0.3, 0.4), random.uniform(0.75, 0.85)
        hand = sign * random.uniform(8.0, 12.0)
        yield call(lift(way, duration, 400.0, hand), ROUGH_MODEL)


@cache
def lift(way: float, duration: float, kp: float, hand: float = 0.0, rows: int = 71) -> lk.Log:
    """A torque-controlled lift of the rough arm, computed from the equations of motion.

    Args:
        way: The angle by which shoulder and elbow turn, in [rad].
        duration: The duration of the motion in [s]; then the arm has the same time to settle.
        kp: Position gain, in [1/s^2].
        hand: The largest torque of a hand on the shoulder during the motion, in [N m].
        rows: The number of rows in the log.
    """
    q = q0 = ROUGH_MODEL.robot.ready
    turn = way * np.array([0.3, 1.0, 0.0, -1.2, 0.0, 0.2, 1.35])
    target = lk.Trajectory(lk.Line(q0, q0 + turn), lk.Quintic(duration))
    limits, dq, steps = TIRED * ROUGH_MODEL.robot.effort, np.zeros(7), 20
    dt = 2.0 * duration / (rows - 1) / steps

    def wanted(t: float, q: Any, dq: Any) -> Any:
        x = target(t)
        pull = x.acceleration + kp * (x.position - q) + 2.0 * np.sqrt(kp) * (x.velocity - dq)
        return ROUGH_MODEL.mass_matrix(q) @ pull + ROUGH_MODEL.bias(q, dq)

    def slope(t: float, y: Any) -> Any:
        q, dq = y
        tau = np.clip(wanted(t, q, dq), -limits, limits)
        push = hand * np.sin(np.pi * min(t / duration, 1.0)) ** 2
        force = tau + push * np.eye(7)[1] - FRICTION * dq - ROUGH_MODEL.bias(q, dq)
        return np.array([dq, np.linalg.solve(ROUGH_MODEL.mass_matrix(q), force)])

    table, y = [], np.array([q, dq])
    for k in range((rows - 1) * steps + 1):
        t = k * dt
        if k % steps == 0:
            table.append([t, *y[0], *y[1], *wanted(t, *y)])
        a = slope(t, y)
        b = slope(t + dt / 2.0, y + a * dt / 2.0)
        c = slope(t + dt / 2.0, y + b * dt / 2.0)
        y = y + (a + 2.0 * b + 2.0 * c + slope(t + dt, y + c * dt)) * dt / 6.0
    columns = np.round(table, 6)
    times, q, dq, command = columns[:, 0], columns[:, 1:8], columns[:, 8:15], columns[:, 15:]
    stacked = (np.round(part, 6) for part in zip(*map(target, times), strict=True))
    return lk.Log(
        t=times,
        q=q,
        dq=dq,
        tau=np.clip(command, -limits, limits),
        command=command,
        target=lk.Sample(*stacked),
        measured=lk.State(times, q, dq),  # type: ignore[arg-type]
        saturated=np.any(abs(command) > limits, axis=1),
        command_type=lk.JointTorque,
        controller="lift",
        plant=ROUGH,
        robot=lk.robot("left"),
    )
