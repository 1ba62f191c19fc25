"""Mistakes that people make in notebook 02."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array

from .answers import mass_matrix, power_balance


def _columns(axes: Any, arms: Any) -> Array:
    return np.vstack([np.cross(axes, arms).T, np.transpose(axes)])


def arm_from_the_base(axes: Any, origins: Any, tip: Any) -> Array:
    """The moment arm from the world's origin: that is the spatial Jacobian."""
    return _columns(axes, -np.asarray(origins))


def product_reversed(axes: Any, origins: Any, tip: Any) -> Array:
    """(p_tip - p) x z: the linear rows with the other sign."""
    return _columns(axes, np.asarray(origins) - tip)


def turns_first(axes: Any, origins: Any, tip: Any) -> Array:
    """Rows (w, v) in a course that writes (v, w)."""
    J = _columns(axes, tip - np.asarray(origins))
    return np.vstack([J[3:], J[:3]])


def half_of_it(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """Takes the one half of the kinetic energy into the matrix."""
    return 0.5 * mass_matrix(masses, inertias, rotations, com_jacobians)


def _slopes(mass_matrix: Callable[[Any], Array], q: Any) -> Array:
    h = 1e-5
    slopes = [(mass_matrix(q + d) - mass_matrix(q - d)) / (2.0 * h) for d in h * np.eye(7)]
    return np.stack(slopes, axis=2)


def commanded_torque(log: lk.Log, model: lk.Model) -> Array:
    """The commanded torque, not the one that the motors gave."""
    return np.asarray(power_balance(log, model) + np.sum((log.tau - log.command) * log.dq, axis=1))


def motors_minus_energy(log: lk.Log, model: lk.Model) -> Array:
    """The difference with the other sign."""
    return -power_balance(log, model)


def steps_not_seconds(log: lk.Log, model: lk.Model) -> Array:
    """The growth per row, not per second."""
    power = np.sum(log.tau * log.dq, axis=1)
    dt = float(log.t[1] - log.t[0])
    return np.asarray((power_balance(log, model) + power) * dt - power)


def arm_of_the_tip(axes: Any, origins: Any, tip: Any) -> Array:
    """Every axis taken as if it went through the world's origin."""
    return _columns(axes, np.broadcast_to(tip, (7, 3)))


def rows_swapped(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """Takes the angular rows for the velocity of the centre of mass."""
    return mass_matrix(masses, inertias, rotations, np.roll(com_jacobians, 3, axis=1))


def unit_arms(axes: Any, origins: Any, tip: Any) -> Array:
    """The moment arms scaled to length 1."""
    arms = tip - np.asarray(origins)
    return _columns(axes, arms / np.linalg.norm(arms, axis=1)[:, None])


@dataclass(frozen=True)
class Kinetic:
    """The mass matrix with weighted terms.

    Attributes:
        inertia: The inertia in the world's axes, given that in the link's and R.
        mass: Whether the inertia is multiplied with the mass.
        linear: Factor of the linear part.
    """

    inertia: Callable[[Array, Array], Array] = lambda I_l, R: R @ I_l @ R.T
    mass: bool = False
    linear: float = 1.0

    def __call__(self, masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
        """The matrix."""
        M = np.zeros((7, 7))
        for m, I_l, R, J in zip(masses, inertias, rotations, com_jacobians, strict=True):
            turn = J[3:].T @ self.inertia(np.asarray(I_l), np.asarray(R)) @ J[3:]
            M += self.linear * m * J[:3].T @ J[:3] + turn * (m if self.mass else 1.0)
        return M


def last_link_only(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """The last link instead of the sum over all."""
    return mass_matrix(masses[-1:], inertias[-1:], rotations[-1:], com_jacobians[-1:])


def beside_left_out(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """Only the diagonal."""
    return np.diag(np.diag(mass_matrix(masses, inertias, rotations, com_jacobians)))


@dataclass(frozen=True)
class Weights:
    """Gravity with another torque for each link.

    Attributes:
        torque: The torques that hold a link, given its mass, all masses, its Jacobian and g.
        last: The link before which the sum ends.
    """

    torque: Callable[[float, Any, Array, Array], Array]
    last: int | None = None

    def __call__(self, masses: Any, com_jacobians: Any, g_w: Any) -> Array:
        """The torques."""
        links = list(zip(masses, com_jacobians, strict=True))[: self.last]
        return np.asarray(sum(self.torque(m, masses, np.asarray(J), g_w) for m, J in links))


def all_at_the_hand(masses: Any, com_jacobians: Any, g_w: Any) -> Array:
    """The whole weight at the last link."""
    return np.asarray(-np.sum(masses) * com_jacobians[-1][:3].T @ g_w)


@dataclass(frozen=True)
class Slopes:
    """Christoffel's symbols with other terms.

    Attributes:
        terms: Weights of dM_ij/dq_k, dM_ik/dq_j and dM_jk/dq_i.
        along: The index of the speed that multiplies them, k, j or i.
    """

    terms: tuple[float, float, float] = (1.0, 1.0, -1.0)
    along: str = "k"

    def __call__(self, mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
        """The matrix."""
        D = _slopes(mass_matrix, q)
        a, b, c = self.terms
        gamma = 0.5 * (a * D + b * D.transpose(0, 2, 1) + c * D.transpose(2, 1, 0))
        return np.asarray(np.einsum(f"ijk,{self.along}->ij", gamma, dq))


@dataclass(frozen=True)
class Balance:
    """The power balance with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        kinetic: Factor of the kinetic energy.
        potential: Factor of the potential energy.
        power: Factor of the motors' power.
        by: The factor of the torques, given the log.
    """

    kinetic: float = 1.0
    potential: float = 1.0
    power: float = 1.0
    by: Callable[[lk.Log], Array] = lambda log: log.dq

    def __call__(self, log: lk.Log, model: lk.Model) -> Array:
        """The balance."""
        energy = np.array(
            [
                self.kinetic * model.kinetic_energy(q, dq)
                + self.potential * model.potential_energy(q)
                for q, dq in zip(log.q, log.dq, strict=True)
            ]
        )
        power = np.sum(log.tau * self.by(log), axis=1)
        return np.asarray(np.gradient(energy, log.t) - self.power * power)


def sizes_of_power(log: lk.Log, model: lk.Model) -> Array:
    """The powers of the joints without their signs."""
    lost = np.abs(log.tau * log.dq) - log.tau * log.dq
    return np.asarray(power_balance(log, model) - lost.sum(axis=1))
