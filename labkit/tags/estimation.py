r"""Estimation: combining several noisy readings of a tag into a better one.

Source: the update of a Kalman filter, Thrun, Burgard & Fox, *Probabilistic Robotics*, section 3.2.
The prediction is what students write in notebook 06.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..shapes import Array, as_array, as_number, locked


class Estimate(NamedTuple):
    """An estimate of a position and its motion.

    Attributes:
        t: Time of the estimate, in [s].
        mean: Position [m] and velocity [m/s], and acceleration [m/s^2] if it is estimated too,
            shape (6,) or (9,).
        covariance: Covariance of the mean, shape (6, 6) or (9, 9).
    """

    t: float
    mean: Array
    covariance: Array


def first_estimate(t: float, position: Any, noise: Any, *spread: float) -> Estimate:
    """The estimate from a single reading of a position, with an unknown velocity.

    Args:
        t: When the picture was taken, in [s].
        position: The reading, shape (3,) in [m].
        noise: Covariance of the reading, shape (3, 3) in [m^2].
        *spread: Expected standard deviation of the velocity's coordinates, in [m/s], and of the
            acceleration's, in [m/s^2], if it is to be estimated too.
    """
    variances = [as_number(s, "spread", above=0.0) ** 2 for s in spread]
    covariance: Array = np.kron(np.diag([0.0, *variances]), np.eye(3)).astype(float)
    covariance[:3, :3] = as_array(noise, (3, 3), "noise")
    mean = np.concatenate([as_array(position, (3,), "position"), np.zeros(3 * len(spread))])
    return Estimate(t, locked(mean), locked(covariance))


def update(estimate: Estimate, position: Any, noise: Any) -> Estimate:
    r"""Update an estimate with a reading of the position at the same time.

    .. math::

        K &= P H^T (H P H^T + R)^{-1} \\
        m' &= m + K (z - H m) \\
        P' &= (I - KH) P (I - KH)^T + K R K^T

    Args:
        estimate: The estimate so far, predicted to the time of the picture.
        position: The reading z, shape (3,) in [m].
        noise: Covariance R of the reading, shape (3, 3) in [m^2].

    Returns:
        The improved estimate, for the same time.
    """
    z, R = as_array(position, (3,), "position"), as_array(noise, (3, 3), "noise")
    mean, P = estimate.mean, estimate.covariance
    K = np.linalg.solve(P[:3, :3] + R, P[:3, :]).T  # (n, 3); H selects the position
    keep = np.eye(len(mean))
    keep[:, :3] -= K
    covariance = keep @ P @ keep.T + K @ R @ K.T
    return Estimate(
        estimate.t, locked(mean + K @ (z - mean[:3])), locked(0.5 * (covariance + covariance.T))
    )
