"""Where the energy of a run goes, for the tests that hold the arm and its controllers to laws.

Work is torque times the mean of the speeds before and after: with the torque constant from tick to
tick, as in torque control, that is exact up to the physics engine's own error.
"""

from typing import NamedTuple

import numpy as np

from labkit.metrics import joint_error, model_of


class Balance(NamedTuple):
    """Energies during a run, zero at the start, each of shape (N,) in [J]."""

    kinetic: np.ndarray
    friction: np.ndarray
    residual: np.ndarray
    """What neither the motors' work nor viscous friction accounts for."""
    throughput: float
    """All that passed through the motors, in and out."""


def energy_balance(log):
    """Follow the energy through a run."""
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
    """What has flowed up to each tick, from zero."""
    return np.concatenate([[0.0], np.cumsum(flow.sum(axis=1))])
