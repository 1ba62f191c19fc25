"""Averages and filters, against their laws."""

import numpy as np
import pytest

from labkit import se3
from labkit.errors import NotFinite, OutOfRange, ShapeError
from labkit.vision.estimation import (
    Estimate,
    average_pose,
    first_estimate,
    low_pass,
    update,
)


def test_the_average_of_poses_around_a_pose_is_that_pose():
    """Turns of equal size to opposite sides cancel, wherever the pose points."""
    T = se3.pose(se3.rotation(np.array([3.0, 0.3, -0.2])), np.array([1.0, 2.0, 3.0]))
    for V in np.eye(6):
        both = [T @ se3.exp(0.3 * V), T @ se3.exp(-0.3 * V)]
        found = average_pose(both)
        np.testing.assert_allclose(found[:3, :3], T[:3, :3], atol=1e-12)
    np.testing.assert_allclose(average_pose([T]), T, atol=1e-12)


def test_what_is_no_row_of_poses_has_no_average():
    with pytest.raises(ShapeError, match=r"poses has shape .4, 4., expected .1, 4, 4."):
        average_pose(np.eye(4))
    with pytest.raises(OutOfRange, match=r"poses.1.'s last row is"):
        average_pose([np.eye(4), np.ones((4, 4))])
    with pytest.raises(NotFinite, match="poses holds nan"):
        average_pose(np.full((2, 4, 4), np.nan))


def test_averaging_helps_by_the_root_of_the_number():
    random = np.random.default_rng(0)
    spread = []
    for _ in range(400):
        poses = [se3.exp(0.01 * random.standard_normal(6)) for _ in range(16)]
        spread.append(se3.log(average_pose(poses)))
    np.testing.assert_allclose(np.std(spread, axis=0), 0.01 / 4.0, rtol=0.12)


def test_rotations_that_point_everywhere_have_no_average():
    poses = [se3.pose(se3.rotation(np.pi * axis), np.zeros(3)) for axis in np.eye(3)]
    with pytest.raises(OutOfRange, match="no middle"):
        average_pose([np.eye(4), *poses])


@pytest.mark.parametrize("share", [0.1, 0.4, 1.0])
def test_a_low_pass_helps_by_the_expected_amount(share):
    noise = np.random.default_rng(1).standard_normal((40000, 3))
    quiet = low_pass(noise, share)[200:]
    np.testing.assert_allclose(quiet.std(axis=0), np.sqrt(share / (2.0 - share)), rtol=0.06)


def test_a_low_pass_lags_behind_what_moves():
    """By (1 - a)/a readings at a constant speed: the price of its calm."""
    ramp = np.arange(500.0)
    assert ramp[-1] - low_pass(ramp, 0.25)[-1] == pytest.approx(3.0)


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
    first = first_estimate(2.0, [1.0, 2.0, 3.0], 1e-6 * np.eye(3), speed=0.2)
    np.testing.assert_array_equal(first.mean, [1, 2, 3, 0, 0, 0])
    np.testing.assert_allclose(np.diag(first.covariance), [1e-6] * 3 + [0.04] * 3)


def test_a_filter_that_overshoots_is_refused():
    with pytest.raises(OutOfRange, match="overshoots"):
        low_pass([1.0, 2.0], 1.5)
