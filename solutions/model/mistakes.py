"""What people write in notebook 02 instead."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array

from .answers import coriolis, gravity, mass_matrix, power_balance


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


def axis_for_velocity(axes: Any, origins: Any, tip: Any) -> Array:
    """The columns of joints that slide instead of turning."""
    return np.vstack([np.transpose(axes), np.zeros((3, 7))])


def inertia_not_turned(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """The links' inertia left in their own axes."""
    return mass_matrix(masses, inertias, [np.eye(3)] * 7, com_jacobians)


def inertia_turned_back(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """R^T I R where R I R^T belongs."""
    return mass_matrix(masses, inertias, np.transpose(rotations, (0, 2, 1)), com_jacobians)


def points_only(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """Links without rotational inertia, as if they were points."""
    return mass_matrix(masses, 0.0 * np.asarray(inertias), rotations, com_jacobians)


def half_of_it(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """Takes the one half of the kinetic energy into the matrix."""
    return 0.5 * mass_matrix(masses, inertias, rotations, com_jacobians)


def falls_faster(masses: Any, com_jacobians: Any) -> Array:
    """The torque of gravity, not the one that holds against it."""
    return -gravity(masses, com_jacobians)


def all_at_the_hand(masses: Any, com_jacobians: Any) -> Array:
    """The whole weight at the last link."""
    return np.asarray(9.81 * np.sum(masses) * com_jacobians[-1][2])


def only_the_hand(masses: Any, com_jacobians: Any) -> Array:
    """Only the last link has weight: the report's formula sees nothing but the tip."""
    return np.asarray(9.81 * masses[-1] * com_jacobians[-1][2])


def a_tenth(masses: Any, com_jacobians: Any) -> Array:
    """The 0.981 of the report."""
    return 0.1 * gravity(masses, com_jacobians)


def _slopes(mass_matrix: Callable[[Any], Array], q: Any) -> Array:
    h = 1e-5
    slopes = [(mass_matrix(q + d) - mass_matrix(q - d)) / (2.0 * h) for d in h * np.eye(7)]
    return np.stack(slopes, axis=2)


def half_the_rate(mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
    """Mdot / 2: then Mdot - 2 C is zero, and zero is skew."""
    return np.asarray(0.5 * _slopes(mass_matrix, q) @ dq)


def not_skew(mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
    """The right C dq from Lagrange's equation, but a matrix for which Mdot - 2 C is not skew."""
    dM = _slopes(mass_matrix, q)
    return np.asarray(dM @ dq - 0.5 * (dM.transpose(2, 1, 0) @ dq))


def without_the_half(mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
    """Christoffel's symbols without their one half."""
    return 2.0 * coriolis(mass_matrix, q, dq)


def signs_mixed(mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
    """The minus at the wrong one of the three terms: the transpose."""
    return coriolis(mass_matrix, q, dq).T


def kinetic_only(log: lk.Log, model: lk.Model) -> Array:
    """Forgets the potential energy."""
    energy = [model.kinetic_energy(q, dq) for q, dq in zip(log.q, log.dq, strict=True)]
    return np.asarray(np.gradient(energy, log.t) - np.sum(log.tau * log.dq, axis=1))


def commanded_torque(log: lk.Log, model: lk.Model) -> Array:
    """The torque that was asked for, not the one that the motors gave."""
    return np.asarray(power_balance(log, model) + np.sum((log.tau - log.command) * log.dq, axis=1))


def motors_minus_energy(log: lk.Log, model: lk.Model) -> Array:
    """The difference the other way round."""
    return -power_balance(log, model)


def absolute(log: lk.Log, model: lk.Model) -> Array:
    """The difference without its sign."""
    return np.abs(power_balance(log, model))


def friction_alone(log: lk.Log, model: lk.Model) -> Array:
    """What friction takes, by its formula."""
    return np.asarray(-np.sum(np.asarray(log.plant.viscous) * log.dq**2, axis=1))


def steps_not_seconds(log: lk.Log, model: lk.Model) -> Array:
    """The growth per row, not per second."""
    power = np.sum(log.tau * log.dq, axis=1)
    dt = float(log.t[1] - log.t[0])
    return np.asarray((power_balance(log, model) + power) * dt - power)


def without_the_last_joint(log: lk.Log, model: lk.Model) -> Array:
    """The motors' power without the last one's."""
    return np.asarray(power_balance(log, model) + log.tau[:, 6] * log.dq[:, 6])


def arm_of_the_tip(axes: Any, origins: Any, tip: Any) -> Array:
    """Every axis taken as if it went through the world's origin."""
    return _columns(axes, np.broadcast_to(tip, (7, 3)))


def rows_swapped(masses: Any, inertias: Any, rotations: Any, com_jacobians: Any) -> Array:
    """Takes the angular rows for the velocity of the centre of mass."""
    return mass_matrix(masses, inertias, rotations, np.roll(com_jacobians, 3, axis=1))


def without_g(masses: Any, com_jacobians: Any) -> Array:
    """Kilograms for newtons."""
    return gravity(masses, com_jacobians) / 9.81


def all_signs_plus(mass_matrix: Callable[[Any], Array], q: Any, dq: Any) -> Array:
    """The third slope of Christoffel's symbols added, not taken off."""
    D = _slopes(mass_matrix, q)
    return np.asarray(
        0.5 * sum(np.einsum(e, D, dq) for e in ("ijk,k->ij", "ikj,k->ij", "jki,k->ij"))
    )
