"""The sensor: what averaging cures, and whether its errors are as large as it says."""

import numpy as np
import pytest

from labkit import se3
from solutions.study.sensing import Setup, consistency, random_poses, read


def test_averaging_helps_against_image_noise_by_the_expected_amount():
    """160 noisy pictures of a still tag: means of 16 spread 4 times less, about."""
    setup = Setup(optics={"noise": 15.0}, distance=0.8)
    T_cm = random_poses(setup, 1, np.random.default_rng(4))[0]
    seen = read(setup, [T_cm] * 160, seed=1)
    assert seen.found.all()
    depth = seen.estimate[:, 2, 3]
    one = depth.std()
    means = depth.reshape(10, 16).mean(axis=1)
    assert 0.1 < np.std(means) / one < 0.45  # 1/4, from ten means


@pytest.mark.parametrize(
    "dials",
    [
        {"optics": {"noise": 5.0}},
        {"optics": {"noise": 2.0}, "smear": 3.0},
        {"optics": {"noise": 2.0}, "distance": 2.0},
        {"cover": 0.1},
    ],
    ids=["noise", "a smear", "2 m", "a corner"],
)
def test_the_errors_are_as_large_as_the_detector_says(dials):
    """The mean of e' P^-1 e over a position's three components is between 1 and 6."""
    reported, nees = consistency(Setup(tilt=(0.26, 1.05), **dials), 40, seed=5)
    assert reported > 0.7
    assert 1.0 < nees < 6.0


def test_a_tag_square_to_the_camera_is_read_as_well_as_any():
    """Edges along the rows and columns of the picture, where plain sampling is worst."""
    straight = [se3.pose(np.diag([1, -1, -1.0]), np.array([0, 0, z])) for z in (0.5, 0.7, 0.9, 1.1)]
    error = read(Setup(), straight).error
    assert np.abs(error[:, 2]).max() < 1.5e-3
