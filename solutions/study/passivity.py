r"""Passivity of a sampled spring and damper, and the limit at which contact becomes unstable.

A mass with physical damping b has a spring K and a damper B that a computer makes from samples at
intervals T, with the velocity from a backward difference: :math:`H(z) = K + B (z - 1)/(T z)`.
It is passive, and so stable in contact with any passive object, if and only if, for all
:math:`0 \le \theta \le \pi` (Colgate & Schenkel 1997),

.. math:: b > \frac{T}{2}\,\frac{1}{1 - \cos\theta}\,
   \operatorname{Re}\left[(1 - e^{-j\theta})\,H(e^{j\theta})\right] = \frac{KT}{2} - B\cos\theta

whose strictest case is :math:`b > KT/2 + |B|`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import expm

from labkit.shapes import Array


def least_damping(K: float, B: float, T: float, angles: int = 2001) -> float:
    """The physical damping that passivity needs, by the general condition, in [N s/m].

    Args:
        K: Stiffness of the sampled spring, in [N/m].
        B: Damping of the sampled damper, in [N s/m].
        T: Time between samples, in [s].
        angles: The number of frequencies, up to half of the sampling rate.
    """
    theta = np.linspace(1e-4, np.pi, angles)
    z = np.exp(1j * theta)
    H = K + B * (z - 1.0) / (T * z)
    bound = 0.5 * T * np.real((1.0 - 1.0 / z) * H) / (1.0 - np.cos(theta))
    return float(bound.max())


def loop(mass: float, b: float, K: float, B: float, T: float, wall: float = 0.0) -> Array:
    """The step of one sample for a mass with sampled spring and damper, against a real spring.

    Args:
        mass: The mass in [kg].
        b: Physical damping, in [N s/m].
        K: Sampled stiffness, in [N/m].
        B: Sampled damping, in [N s/m].
        T: Time between samples, in [s].
        wall: Stiffness of the real spring with which the mass stays in contact, in [N/m].

    Returns:
        The matrix that advances (x, v, previous x) by one sample, shape (3, 3).
    """
    A = np.array([[0.0, 1.0, 0.0], [-wall / mass, -b / mass, 1.0 / mass], [0.0, 0.0, 0.0]])
    held = expm(A * T)  # exact, as the force is held
    force = np.array([-K - B / T, 0.0, B / T])
    step = np.zeros((3, 3))
    step[:2, :2] = held[:2, :2]
    step[:2] += np.outer(held[:2, 2], force)
    step[2, 0] = 1.0
    return step


def is_stable(step: Any) -> bool:
    """Whether a disturbance decays, that is, all eigenvalues are inside the unit circle."""
    return bool(np.abs(np.linalg.eigvals(step)).max() < 1.0)


def stiffest(mass: float, b: float, B: float, T: float, wall: float = 0.0) -> float:
    """The largest K for which the loop is stable, found by bisection, in [N/m]."""
    low, high = 0.0, 1e7
    for _ in range(60):
        K = 0.5 * (low + high)
        low, high = (K, high) if is_stable(loop(mass, b, K, B, T, wall)) else (low, K)
    return low
