"""Answers of notebook 02: Jacobian, matrices of the equations of motion, power balance."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def jacobian(axes: Any, origins: Any, tip: Any) -> Array:
    """Column by column what one joint does to the tip (Siciliano, section 3.1.3)."""
    columns = [
        np.concatenate([np.cross(z, tip - p), z]) for z, p in zip(axes, origins, strict=True)
    ]
    return np.column_stack(columns)


def mass_matrix(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """The kinetic energy of all links, as a quadratic form of the joint speeds (MLS eq. 4.19)."""
    M = np.zeros((7, 7))
    for m, I_l, R, J in zip(masses, inertias, rotations, com_jacobians, strict=True):
        M += m * J[:3].T @ J[:3] + J[3:].T @ (R @ I_l @ R.T) @ J[3:]
    return M


def gravity(masses: Any, com_jacobians: Any, g_w: Any) -> Array:
    """The slope of the potential energy: what must be held at every joint (MLS eq. 4.27)."""
    return np.asarray(-sum(m * J[:3].T @ g_w for m, J in zip(masses, com_jacobians, strict=True)))


def coriolis(mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
    """Christoffel's symbols from differences of M, times the speeds (MLS eq. 4.23)."""
    h = 1e-5
    slopes = [(mass_matrix(q + d) - mass_matrix(q - d)) / (2.0 * h) for d in h * np.eye(7)]
    dM = np.stack(slopes, axis=2)  # dM[i, j, k] is the slope of M_ij along q_k
    gamma = 0.5 * (dM + dM.transpose(0, 2, 1) - dM.transpose(2, 1, 0))
    return np.asarray(gamma @ dq)


def power_balance(log: lk.Log, model: lk.Model) -> Array:
    """The growth of the energy without what the motors put in."""
    pairs = list(zip(log.q, log.dq, strict=True))
    energy = [model.kinetic_energy(q, dq) + model.potential_energy(q) for q, dq in pairs]
    return np.asarray(np.gradient(energy, log.t) - np.sum(log.tau * log.dq, axis=1))
