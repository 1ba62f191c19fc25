"""Right answers to notebook 06 in other forms."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from scipy.interpolate import BPoly
from scipy.linalg import expm

from labkit import Sample, se3


def corners_list(size: float) -> Any:
    """Nested lists."""
    return [[x * size / 2, y * size / 2, 0] for x, y in ((-1, 1), (1, 1), (1, -1), (-1, -1))]


def pose_by_iteration(pixels: Any, K: Any, size: float) -> Any:
    """IPPE as the initial guess, then least squares."""
    corners = np.array(corners_list(size), dtype=float)
    pixels, K = np.array(pixels), np.array(K)
    _, turn, place = cv2.solvePnP(corners, pixels, K, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    turn, place = cv2.solvePnPRefineLM(corners, pixels, K, None, turn, place)
    T = np.eye(4)
    T[:3, :3], T[:3, 3:] = cv2.Rodrigues(turn)[0], place
    return T.tolist()


def quality_by_loops(estimates: Any, truth: Any) -> Any:
    """Sums written out, returned as a list of two."""
    e = np.stack(
        [
            np.r_[(truth - T)[:3, 3], se3.orientation_error(truth[:3, :3], T[:3, :3])]
            for T in estimates
        ]
    )
    mean = e.sum(axis=0) / len(e)
    return [mean, sum(np.outer(x - mean, x - mean) for x in e) / (len(e) - 1)]


def blend_by_bernstein(t: float, reference: Sample, goal: Sample, duration: float) -> Any:
    """With scipy's polynomials from derivatives."""
    if t >= duration:
        late = t - duration
        still = np.zeros_like(goal.velocity)
        return goal.position + goal.velocity * late, goal.velocity, still
    curve = BPoly.from_derivatives([0.0, duration], [list(reference), list(goal)])
    return curve(t), curve(t, nu=1), curve(t, nu=2)


def predict_by_exponential(mean: Any, covariance: Any, age: float, accel_noise: float) -> Any:
    """Van Loan's matrix exponential."""
    A = np.kron([[0.0, 1.0], [0.0, 0.0]], np.eye(3))
    G = np.kron(np.diag([0.0, accel_noise]), np.eye(3))
    big = expm(np.block([[-A, G], [np.zeros((6, 6)), A.T]]) * age)
    F = big[6:, 6:].T
    return [F @ mean, F @ covariance @ F.T + F @ big[:6, 6:]]
