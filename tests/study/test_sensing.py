"""The sensor's quality: bias and spread, what changes them, and what cures them."""

import numpy as np
import pytest

from labkit import se3
from labkit.errors import OutOfRange, UnknownName
from solutions.study.sensing import Readings, Setup, quality, random_poses, read, sweep


def readings(truth, estimate):
    n = len(truth)
    nothing = np.zeros(n)
    return Readings(
        np.array(truth), np.array(estimate), nothing + 2.0, nothing,
        np.zeros((n, 4, 2)), np.zeros((n, 6, 6)),
    )  # fmt: skip


def test_a_constant_offset_is_bias_and_noise_is_spread():
    """Truth minus estimate: an estimate 3 mm too far has a bias of -3 mm and no spread."""
    T, shift = np.eye(4), np.eye(4)
    shift[2, 3] = 0.003
    constant = quality(readings([T] * 5, [shift] * 5))
    np.testing.assert_allclose(constant.bias, [0, 0, -0.003, 0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(constant.spread, 0.0, atol=1e-12)
    up, down = np.eye(4), np.eye(4)
    up[0, 3], down[0, 3] = 0.002, -0.002
    noisy = quality(readings([T] * 4, [up, down, up, down]))
    np.testing.assert_allclose(noisy.bias, 0.0, atol=1e-15)
    assert noisy.spread[0] == pytest.approx(0.002 * np.sqrt(4 / 3))


def test_random_poses_are_as_the_setup_says():
    setup = Setup(distance=0.9, tilt=(0.2, 0.5))
    for T in random_poses(setup, 50, np.random.default_rng(0)):
        ray = T[:3, 3] / np.linalg.norm(T[:3, 3])
        assert np.linalg.norm(T[:3, 3]) == pytest.approx(0.9)
        assert 0.2 - 1e-9 <= np.arccos(-T[:3, 2] @ ray) <= 0.5 + 1e-9
    refused = {"tilt": (Setup(tilt=(0.0, 2.0)), 1), "distance": (Setup(distance=0.0), 1)}
    for name, (wrong, count) in (refused | {"count": (setup, 0)}).items():
        with pytest.raises(OutOfRange, match=f"{name} is"):
            random_poses(wrong, count, np.random.default_rng(0))


def worst(q):
    return float(np.linalg.norm(q.spread[:3]))


def test_distance_makes_it_worse_and_a_larger_tag_and_more_pixels_make_it_better():
    far = sweep("distance", [0.5, 1.4], count=25)
    assert worst(far[1.4]) > 3.0 * worst(far[0.5])
    size = sweep("size", [0.05, 0.15], Setup(distance=0.8), count=25)
    assert worst(size[0.05]) > 2.5 * worst(size[0.15])
    pixels = sweep("resolution", [0.5, 1.0], count=25)
    assert worst(pixels[0.5]) > 1.5 * worst(pixels[1.0])
    noise = sweep("noise", [0.0, 20.0], count=25)
    assert worst(noise[20.0]) > 1.5 * worst(noise[0.0])


def test_averaging_helps_against_image_noise_by_the_expected_amount():
    """160 noisy pictures of a still tag: means of 16 spread 4 times less, about."""
    setup = Setup(noise=15.0, distance=0.8)
    T_cm = random_poses(setup, 1, np.random.default_rng(4))[0]
    seen = read(setup, [T_cm] * 160, seed=1)
    assert seen.found.all()
    depth = seen.estimate[:, 2, 3]
    one = depth.std()
    means = depth.reshape(10, 16).mean(axis=1)
    assert 0.1 < np.std(means) / one < 0.45  # 1/4, from ten means


def test_the_detectors_covariance_is_of_the_size_of_its_errors():
    """The spread that the detector expects is within a factor of two of the spread it has."""
    setup = Setup()
    seen = read(setup, random_poses(setup, 80, np.random.default_rng(2)))
    expected = np.sqrt(np.einsum("nii->ni", seen.covariance)[:, :3].mean(axis=0))
    had = np.sqrt(np.mean(seen.error[:, :3] ** 2, axis=0))
    assert (had / expected > 0.5).all() and (had / expected < 2.0).all()


def test_a_tag_square_to_the_camera_is_read_as_well_as_any():
    """Edges along the rows and columns of the picture, where plain sampling is worst."""
    straight = [se3.pose(np.diag([1, -1, -1.0]), np.array([0, 0, z])) for z in (0.5, 0.7, 0.9, 1.1)]
    error = read(Setup(), straight).error
    assert np.abs(error[:, 2]).max() < 1.5e-3


def test_a_tag_too_far_away_is_counted_as_missed():
    setup = Setup(distance=9.0)
    missed = read(setup, random_poses(setup, 3, np.random.default_rng(0)))
    assert not missed.found.any()
    nothing = quality(missed)
    assert nothing.found == 0.0 and np.isnan(nothing.bias).all()


def test_an_unknown_dial_is_refused():
    with pytest.raises(UnknownName, match="no dial 'colour'"):
        sweep("colour", [1.0])
