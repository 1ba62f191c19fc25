r"""Estimation: making one good reading out of several noisy ones.

Sources: averaging of rotations, Moakher 2002 (the nearest rotation to the mean of matrices);
Kalman filter, Thrun, Burgard & Fox, *Probabilistic Robotics*, section 3.2; constant velocity under
white acceleration, Bar-Shalom, Li & Kirubarajan, *Estimation with Applications*, section 6.2.2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import se3
from ..arrays import Array, as_array, as_number, as_numbers, locked
from ..errors import OutOfRange


def average_pose(poses: Any) -> Array:
    """The middle of several poses: the mean of the places, the nearest rotation to the mean of R.

    Args:
        poses: Shape (n, 4, 4), n at least 1.

    Returns:
        Shape (4, 4).

    Raises:
        OutOfRange: The rotations are spread so evenly that they have no middle.
    """
    mean = se3.as_poses(poses, "poses").mean(axis=0)
    U, s, Vt = np.linalg.svd(mean[:3, :3])
    mirror = np.sign(np.linalg.det(U @ Vt))
    if s[1] + mirror * s[2] < 1e-9:
        raise OutOfRange("these rotations point everywhere alike: they have no middle")
    return se3.pose(U @ np.diag([1.0, 1.0, mirror]) @ Vt, mean[:3, 3])


def low_pass(values: Any, share: float) -> Array:
    r"""A simple filter: each output goes a ``share`` of the way to the new value.

    :math:`y_k = y_{k-1} + a\,(x_k - y_{k-1})`.  White noise comes out with its standard deviation
    times :math:`\sqrt{a / (2 - a)}`; a value that moves at a constant speed comes out
    :math:`(1 - a)/a` readings late.

    Args:
        values: Shape (n, k), or (n,).
        share: a, above 0 and at most 1; 1 passes everything.

    Returns:
        The same shape; the first output is the first value.

    Raises:
        OutOfRange: The share is not above 0 and at most 1.
    """
    a = as_number(share, "share", above=0.0)
    if a > 1.0:
        raise OutOfRange(
            f"share is {a:g}; a filter that goes further than the new value overshoots"
        )
    filtered = np.atleast_1d(as_numbers(values, "values"))
    for k in range(1, len(filtered)):
        filtered[k] = filtered[k - 1] + a * (filtered[k] - filtered[k - 1])
    return filtered


class Estimate(NamedTuple):
    """Where something is and how it moves, as far as one knows.

    Attributes:
        t: At which time, in [s].
        mean: Position [m] and velocity [m/s], shape (6,).
        covariance: Of the mean, shape (6, 6).
    """

    t: float
    mean: Array
    covariance: Array


def first_estimate(t: float, position: Any, noise: Any, speed: float) -> Estimate:
    """What one reading of a position tells, the velocity being anything.

    Args:
        t: When the picture was taken, in [s].
        position: Shape (3,) in [m].
        noise: Its covariance, shape (3, 3) in [m^2].
        speed: Standard deviation of the velocity's coordinates that one expects, in [m/s].
    """
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = as_array(noise, (3, 3), "noise")
    covariance[3:, 3:] = as_number(speed, "speed", above=0.0) ** 2 * np.eye(3)
    mean = np.concatenate([as_array(position, (3,), "position"), np.zeros(3)])
    return Estimate(t, locked(mean), locked(covariance))


def update(estimate: Estimate, position: Any, noise: Any) -> Estimate:
    r"""Take in a reading of the position at the estimate's own time.

    .. math:: K = P H^T (H P H^T + R)^{-1}, \quad
       m' = m + K (z - H m), \quad P' = (I - KH) P (I - KH)^T + K R K^T

    Args:
        estimate: What is known so far, predicted to the time of the picture.
        position: z, shape (3,) in [m].
        noise: R, its covariance, shape (3, 3) in [m^2].

    Returns:
        The better estimate, at the same time.
    """
    z, R = as_array(position, (3,), "position"), as_array(noise, (3, 3), "noise")
    mean, P = estimate.mean, estimate.covariance
    K = np.linalg.solve(P[:3, :3] + R, P[:3, :]).T  # (6, 3); H picks the position
    keep = np.eye(6)
    keep[:, :3] -= K
    covariance = keep @ P @ keep.T + K @ R @ K.T
    return Estimate(
        estimate.t, locked(mean + K @ (z - mean[:3])), locked(0.5 * (covariance + covariance.T))
    )
