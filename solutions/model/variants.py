"""Right answers to notebook 02 in other forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import labkit as lk


def jacobian_by_rows(axes: Any, origins: Any, tip: Any) -> Any:
    """All cross products at once."""
    return np.vstack([np.cross(axes, tip - np.asarray(origins)).T, np.transpose(axes)])


def jacobian_by_hat(axes: Any, origins: Any, tip: Any) -> Any:
    """With skew matrices, a list of lists."""
    J = np.zeros((6, 7))
    for k in range(7):
        J[:3, k] = lk.se3.hat(axes[k]) @ (tip - origins[k])
        J[3:, k] = axes[k]
    return J.tolist()


def mass_matrix_vectorised(m: Any, inertias: Any, R: Any, J: Any) -> Any:
    """Sums over all links in two lines."""
    world = R @ inertias @ np.transpose(R, (0, 2, 1))
    linear = np.einsum("l,lai,laj->ij", m, J[:, :3], J[:, :3])
    return linear + np.einsum("lai,lab,lbj->ij", J[:, 3:], world, J[:, 3:])


class MassMatrix:
    """A callable object: turns the Jacobians into the links' axes instead of the inertias."""

    def __call__(self, m: Any, inertias: Any, R: Any, J: Any) -> Any:
        """Link by link."""
        total = 0.0
        for k in range(7):
            w = R[k].T @ J[k][3:]
            total = total + m[k] * J[k][:3].T @ J[k][:3] + w.T @ inertias[k] @ w
        return total


def gravity_joint_by_joint(m: Any, J: Any, g_w: Any) -> Any:
    """The slope of each height against g, joint by joint."""
    return [sum(-m[k] * (g_w @ J[k][:3, j]) for k in range(7)) for j in range(7)]


def gravity_by_einsum(m: Any, J: Any, g_w: Any) -> Any:
    """One sum over links and axes."""
    return -np.einsum("l,lij,i->j", m, np.asarray(J)[:, :3], g_w)


def coriolis_in_loops(mass_matrix: Callable[[Any], Any], q: Any, dq: Any) -> Any:
    """Christoffel's symbols as the book writes them, with a step of its own."""
    h, n = 1e-4, 7
    dM = [
        (mass_matrix(q + h * np.eye(n)[k]) - mass_matrix(q - h * np.eye(n)[k])) / (2 * h)
        for k in range(n)
    ]
    C = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            for k in range(n):
                C[i, j] += 0.5 * (dM[k][i, j] + dM[j][i, k] - dM[i][j, k]) * dq[k]
    return C


def balance_in_loops(log: Any, model: Any) -> Any:
    """Central differences by hand."""
    e = [
        0.5 * d @ model.mass_matrix(q) @ d + model.potential_energy(q)
        for q, d in zip(log.q, log.dq, strict=True)
    ]
    n = len(e)
    out = []
    for k in range(n):
        a, b = max(k - 1, 0), min(k + 1, n - 1)
        out.append((e[b] - e[a]) / (log.t[b] - log.t[a]) - log.tau[k] @ log.dq[k])
    return out


def balance_from_theory(log: Any, model: Any) -> Any:
    """Differences of higher order at the ends."""
    e = [
        model.kinetic_energy(q, d) + model.potential_energy(q)
        for q, d in zip(log.q, log.dq, strict=True)
    ]
    return np.gradient(e, log.t, edge_order=2) - np.einsum("ij,ij->i", log.tau, log.dq)
