r"""Energy: where it goes in a run, and functions that a stable loop makes fall.

Work is torque times the mean of the speeds before and after: with the torque constant from tick to
tick, as in torque control, that is exact up to the physics engine's own error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import Array, as_array, as_gains, locked
from .log import Log
from .metrics import joint_error, joint_speed_error, model_of
from .model import Model
from .robot import JOINTS


@dataclass(frozen=True, eq=False)
class Balance:
    """The energy of an arm during a run, all in [J] and zero at the start.

    Attributes:
        t: Time, shape (N,) in [s].
        kinetic: Change of the kinetic energy, shape (N,).
        potential: Change of the potential energy, shape (N,).
        work: What the motors have put in, or taken out, shape (N,).
        friction: What viscous friction has taken, shape (N,).
        throughput: All that passed through the motors, in and out, a number.
    """

    t: Array
    kinetic: Array
    potential: Array
    work: Array
    friction: Array
    throughput: float

    @property
    def residual(self) -> Array:
        """Energy that nothing here accounts for, shape (N,): dry friction, pushes, integration."""
        return np.asarray(self.kinetic + self.potential + self.friction - self.work)


def energy_balance(log: Log, model: Model | None = None) -> Balance:
    """Follow the energy through a run.

    Args:
        log: The run.
        model: Of the arm that made it; None makes one.
    """
    model = model or model_of(log)
    dt, mean = np.diff(log.t)[:, None], 0.5 * (log.dq[1:] + log.dq[:-1])
    flow = log.tau[:-1] * mean * dt
    loss = np.array(log.plant.viscous) * mean**2 * dt
    pairs = zip(log.q, log.dq, strict=True)
    kinetic = np.array([model.kinetic_energy(q, dq) for q, dq in pairs])
    potential = np.array([model.potential_energy(q) for q in log.q])
    return Balance(
        t=log.t,
        kinetic=locked(kinetic - kinetic[0]),
        potential=locked(potential - potential[0]),
        work=_sum(flow),
        friction=_sum(loss),
        throughput=float(np.abs(flow.sum(axis=1)).sum()),
    )


def lyapunov(log: Log, Kp: Any, *, inertia: Any = None, model: Model | None = None) -> Array:
    r"""The energy of the error, :math:`V = \tfrac12 \dot e^T M \dot e + \tfrac12 e^T K_p e`.

    For the augmented PD law :math:`\dot V = -\dot e^T K_d\,\dot e` (MLS, Proposition 4.10).  It is
    only semidefinite: V may stand still for a moment where the error's speed is zero.

    Args:
        log: A run after joint angles.
        Kp: Gains, shape (7,) or one number.
        inertia: M, shape (7, 7); None is the arm's own M(q); the identity is what computed torque
            makes of the arm.
        model: Of the arm that made the log; None makes one.

    Returns:
        Shape (N,), in [J] where the inertia is the arm's own.

    Raises:
        TypeMismatch: The run did not follow joint angles.
    """
    e, de = joint_error(log), joint_speed_error(log)
    Kp = as_gains(Kp, JOINTS, "Kp")
    if inertia is None:
        model = model or model_of(log)
        M = np.array([model.mass_matrix(q) for q in log.q])
    else:
        M = np.array([as_array(inertia, (JOINTS, JOINTS), "inertia")] * len(e))
    return np.asarray(0.5 * np.einsum("ki,kij,kj->k", de, M, de) + 0.5 * (e * e) @ Kp)


def _sum(flow: Array) -> Array:
    return locked(np.concatenate([[0.0], np.cumsum(flow.sum(axis=1))]))
