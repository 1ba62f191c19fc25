"""Hidden cases of notebook 06."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from labkit import Sample, se3
from labkit.course import Call
from labkit.course.authoring.problem import call
from labkit.shapes import Array
from labkit.tags.tag import tag_corners

Random = np.random.Generator
K = np.array([[515.0, 0.0, 319.5], [0.0, 515.0, 239.5], [0.0, 0.0, 1.0]])


def seen(distance: float, tilt: float, azimuth: float, spin: float, x: float = 0.0) -> Array:
    """The pose `T_cm` of a tag in front of the camera, which it faces except for a tilt."""
    facing = np.diag([1.0, -1.0, -1.0])  # the tag's z looks back at the camera
    axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    R = se3.rotation(tilt * axis) @ facing @ se3.rotation(np.array([0.0, 0.0, spin]))
    return se3.pose(R, np.array([x, 0.1 * x, distance]))


def pixels_of(T_cm: Array, size: float) -> Array:
    """The pixels of its corners, shape (4, 2) in [px]."""
    points = tag_corners(size) @ T_cm[:3, :3].T + T_cm[:3, 3]
    image = points @ K.T
    return np.asarray(image[:, :2] / image[:, 2:])


def oblique(random: Random) -> Iterator[Call]:
    """Tags seen obliquely, near and far."""
    for tilt in random.uniform(0.5, 1.0, 4):
        azimuth, spin = random.uniform(-3.0, 3.0, 2)
        T = seen(random.uniform(0.4, 1.2), tilt, azimuth, spin, x=0.1)
        size = random.uniform(0.05, 0.2)
        yield call(pixels_of(T, size), K, size)


def nearly_frontal(random: Random) -> Iterator[Call]:
    """Tags that nearly face the camera."""
    for tilt in random.uniform(0.2, 0.35, 2):
        T = seen(random.uniform(0.4, 0.8), tilt, *random.uniform(-3.0, 3.0, 2))
        yield call(pixels_of(T, 0.1), K, 0.1)


def scattered(
    random: Random, count: int, bias: Any, spread: float, T: Array | None = None
) -> tuple[Array, Array]:
    """Estimates with an offset and a spread, and the truth."""
    truth = seen(0.7, 0.3, 0.5, 0.2) if T is None else T
    estimates = []
    for noise in random.normal(0.0, spread, (count, 6)):
        e = np.asarray(bias) + noise
        R = se3.rotation(-e[3:]) @ truth[:3, :3]
        estimates.append(se3.pose(R, truth[:3, 3] - e[:3]))
    return np.array(estimates), truth


def offsets(random: Random) -> Iterator[Call]:
    """Offsets with little noise."""
    yield call(*scattered(random, 8, random.uniform(-0.01, 0.01, 6), 1e-4))


def noises(random: Random) -> Iterator[Call]:
    """Noise with little offset, and both."""
    yield call(*scattered(random, 9, np.zeros(6), 0.003))
    yield call(*scattered(random, 12, random.uniform(-0.02, 0.02, 6), 0.004))


def _sample(random: Random, speed: float, push: float, n: int = 3) -> Sample:
    return Sample(
        random.uniform(-0.5, 0.5, n),
        random.uniform(-speed, speed, n),
        random.uniform(-push, push, n),
    )


def blends_from_rest(random: Random) -> Iterator[Call]:
    """Blends from rest to rest in one second."""
    a, b = _sample(random, 0.0, 0.0), _sample(random, 0.0, 0.0)
    for t in random.uniform(0.1, 0.9, 3):
        yield call(float(t), a, b, 1.0)


def _both_in_motion(random: Random) -> Iterator[tuple[Sample, Sample, float]]:
    """Start, goal and duration for a point, seven joints and a number; goals steady or turning."""
    for T in random.uniform(0.3, 3.0, 3):
        a, b = _sample(random, 0.3, 0.5), _sample(random, 0.3, 0.0)
        yield a, b, float(T)
        yield a, b._replace(acceleration=random.uniform(-0.5, 0.5, 3)), float(T)
    for n in (7, 1):
        yield _sample(random, 0.3, 0.5, n), _sample(random, 0.3, 0.5, n), 1.0


def blends_in_motion(random: Random) -> Iterator[Call]:
    """Blends of other durations with motion at both ends."""
    for a, b, T in _both_in_motion(random):
        for x in random.uniform(0.1, 0.9, 2):  # not 1, as at the end itself both are right
            yield call(float(x * T), a, b, T)
        if not b.acceleration.any():
            yield from (call(x * T, a, b, T) for x in (0.0, 1.0))


def blends_after_the_end(random: Random) -> Iterator[Call]:
    """The same blends after their end."""
    for a, b, T in _both_in_motion(random):
        yield call(1.5 * T, a, b, T)


def believed(random: Random) -> tuple[Array, Array]:
    """A mean and a covariance."""
    A = random.normal(0.0, 0.05, (6, 6))
    return random.uniform(-0.3, 0.3, 6), A @ A.T + 1e-4 * np.eye(6)


def ages(random: Random) -> Iterator[Call]:
    """Other ages and noises."""
    for age in random.uniform(0.02, 0.6, 4):
        yield call(*believed(random), float(age), float(random.uniform(0.001, 0.1)))


def no_age(random: Random) -> Iterator[Call]:
    """An age of zero, which changes nothing."""
    yield call(*believed(random), 0.0, 0.01)
