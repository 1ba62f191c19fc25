r"""The seventh joint: the null space of the tip's Jacobian, and its uses.

.. math:: \dot q = J^+ V + (I - J^+ J)\,z

No z moves the tip.  A posture, :math:`z = k\,(q_0 - q)`, keeps the elbow where it should be.
Without a posture the elbow drifts: when the tip repeats its path, the joints return to other angles
(Klein & Huang 1983).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from labkit import Model
from labkit.shapes import Array

from .singular import damped_inverse
from .workspace_velocity import WorkspaceVelocityPD

OUTWARDS = 0.1
"""How fast the tip is pulled while the elbow is nearly straight, in [m/s]."""
WORTH = np.repeat((1.0, WorkspaceVelocityPD.lever), 3)
"""The weight of each row of a twist, as in the controllers: a radian counts as much as a lever."""


def laps(model: Model, q0: Any, count: int = 6, pull: float = 0.0, radius: float = 0.12) -> Array:
    """Joint angles after each lap of the tip around an upright circle, shape (count + 1, n).

    Args:
        model: The model of the arm.
        q0: The joint angles at the start, shape (n,) in [rad].
        count: The number of laps, of five seconds each.
        pull: The gain k of the posture q0, in [1/s]; 0 for no posture.
        radius: The radius of the circle, in [m].
    """
    q, start, dt = np.array(q0), model.pose(q0), 0.02
    out, steps = [q], round(5.0 / dt)
    for _ in range(count):
        for k in range(steps):
            a = 2.0 * np.pi * (k + 0.5) / steps
            J = model.tip_jacobian(q)
            T_wd = np.array(start)
            b = 2.0 * np.pi * k / steps
            T_wd[:3, 3] += radius * np.array([0.0, np.sin(b), 1.0 - np.cos(b)])
            V = 5.0 * model.pose_error(T_wd, q)
            V[:3] += radius * 2.0 * np.pi / 5.0 * np.array([0.0, np.cos(a), np.sin(a)])
            z = pull * (np.asarray(q0) - q)
            q = q + dt * (z + np.linalg.pinv(J) @ (V - J @ z))
        out.append(q)
    return np.array(out)


def manipulability(model: Model, joints: Any, count: int = 60) -> tuple[Array, Array]:
    """Times and sqrt(det J J^T) along a trajectory of joint angles, shape (count,) each."""
    t = np.linspace(0.0, joints.duration, count)
    return t, np.array([model.manipulability(joints(float(x)).position) for x in t])


def stretched(model: Model, angles: Any, damping: float) -> tuple[Array, Array]:
    """Pull the tip outwards while the elbow is at the given angles.

    Args:
        model: The model of the arm.
        angles: The angles of the joint e1, shape (k,) in [rad].
        damping: The damping, lambda squared, in [m²].

    Returns:
        The speed of the fastest joint [rad/s] and the speed that the tip lacks [m/s], shape (k,)
        each.
    """
    fastest, missed = [], []
    for angle in angles:
        q = np.array(model.robot.ready)
        q[3] = angle
        J, p = model.tip_jacobian(q), model.pose(q)[:3, 3]
        V = np.concatenate([OUTWARDS * p / np.linalg.norm(p), np.zeros(3)])
        u = damped_inverse(WORTH[:, None] * J, damping) @ (WORTH * V)
        fastest.append(np.abs(u).max())
        missed.append(np.linalg.norm((V - J @ u)[:3]))
    return np.array(fastest), np.array(missed)
