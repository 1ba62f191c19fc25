"""The balance of energy in a run, for tests of physical laws of the arm and its controllers.

Work is torque times the mean of the speeds before and after.  If the torque is constant from tick
to tick, as in torque control, this is exact up to the error of the physics engine.
"""

from typing import NamedTuple

import numpy as np

from labkit.metrics import joint_error, model_of


class Balance(NamedTuple):
    """Energies during a run, zero at the start, each of shape (N,) in [J]."""

    kinetic: np.ndarray
    friction: np.ndarray
    residual: np.ndarray
    """The energy that neither the motors' work nor viscous friction explains."""
    throughput: float
    """The sum of all energy that passed through the motors, in both directions."""


def energy_balance(log):
    """The energies during a run."""
    model = model_of(log)
    dt, mean = np.diff(log.t)[:, None], 0.5 * (log.dq[1:] + log.dq[:-1])
    flow = log.tau[:-1] * mean * dt
    kinetic = np.array([model.kinetic_energy(q, dq) for q, dq in zip(log.q, log.dq, strict=True)])
    potential = np.array([model.potential_energy(q) for q in log.q])
    kinetic, potential = kinetic - kinetic[0], potential - potential[0]
    work, friction = summed(flow), summed(np.array(log.plant.viscous) * mean**2 * dt)
    residual = kinetic + potential + friction - work
    return Balance(kinetic, friction, residual, float(np.abs(flow.sum(axis=1)).sum()))


def lyapunov(log, Kp, inertia=None):
    """Energy of the error, V = de^T M de / 2 + e^T Kp e / 2 (MLS, Proposition 4.10), shape (N,)."""
    e, de = joint_error(log), log.target.velocity - log.dq
    model = model_of(log)
    M = np.array([model.mass_matrix(q) if inertia is None else inertia for q in log.q])
    return 0.5 * np.einsum("ki,kij,kj->k", de, M, de) + 0.5 * (e * e) @ Kp


def summed(flow):
    """The integral of a power up to each tick, starting from zero."""
    return np.concatenate([[0.0], np.cumsum(flow.sum(axis=1))])
