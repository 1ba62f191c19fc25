"""The filter, against its laws."""

import numpy as np

from labkit.tags.estimation import Estimate, first_estimate, update


def test_a_reading_moves_the_estimate_as_the_information_says():
    """P'^-1 = P^-1 + H^T R^-1 H, and the mean is weighed accordingly."""
    random = np.random.default_rng(2)
    A, B = random.standard_normal((6, 6)), random.standard_normal((3, 3))
    P, R = A @ A.T + np.eye(6), B @ B.T + np.eye(3)
    m, z, H = random.standard_normal(6), random.standard_normal(3), np.eye(3, 6)
    after = update(Estimate(1.0, m, P), z, R)
    information = np.linalg.inv(P) + H.T @ np.linalg.inv(R) @ H
    np.testing.assert_allclose(np.linalg.inv(after.covariance), information, rtol=1e-8)
    weighed = np.linalg.solve(information, np.linalg.inv(P) @ m + H.T @ np.linalg.inv(R) @ z)
    np.testing.assert_allclose(after.mean, weighed, rtol=1e-8)
    assert after.t == 1.0


def test_the_first_reading_says_nothing_about_the_speed():
    """The first speed is zero with the given deviation, and the place is the reading's."""
    first = first_estimate(2.0, [1.0, 2.0, 3.0], 1e-6 * np.eye(3), 0.2)
    np.testing.assert_array_equal(first.mean, [1, 2, 3, 0, 0, 0])
    np.testing.assert_allclose(np.diag(first.covariance), [1e-6] * 3 + [0.04] * 3)
