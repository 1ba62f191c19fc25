"""What people write in notebook 06 instead."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from labkit import Sample, se3
from labkit.arrays import Array

from ..tag_following import blend, predict
from ..tags import sensor_quality, tag_corners, tag_pose

BORDER = 1.25  # an AprilTag 36h11 with its white border is ten cells wide, eight without


def counter_clockwise(size: float) -> Array:
    """The other way round: the tag comes out mirrored, seen from behind."""
    corners: Array = tag_corners(size)[[1, 0, 3, 2]]
    return corners


def border_counted(size: float) -> Array:
    """Takes the white border into the size."""
    return tag_corners(BORDER * size)


def from_a_corner(size: float) -> Array:
    """Puts the origin into a corner instead of the middle."""
    return np.add(tag_corners(size), [size / 2.0, -size / 2.0, 0.0])


def camera_in_the_tag(pixels: Any, K: Any, size: float) -> Array:
    """The inverse: where the camera is in the tag's frame."""
    return se3.inverse(tag_pose(pixels, K, size))


def border_in_the_pose(pixels: Any, K: Any, size: float) -> Array:
    """The size with the border: everything 1.25 times too far away."""
    return tag_pose(pixels, K, BORDER * size)


def vector_as_euler_angles(pixels: Any, K: Any, size: float) -> Array:
    """Reads the rotation vector as roll, pitch and yaw."""
    T = np.array(tag_pose(pixels, K, size))
    x, y, z = se3.rotation_log(T[:3, :3])
    turns = ([0.0, 0.0, z], [0.0, y, 0.0], [x, 0.0, 0.0])
    Rz, Ry, Rx = (se3.rotation(np.array(turn)) for turn in turns)
    T[:3, :3] = Rz @ Ry @ Rx
    return T


def the_worse_answer(pixels: Any, K: Any, size: float) -> Array:
    """The other of the two poses."""
    _, turns, places, errors = cv2.solvePnPGeneric(
        tag_corners(size),
        np.asarray(pixels, dtype=float),
        np.array(K),
        None,
        flags=cv2.SOLVEPNP_IPPE_SQUARE,
    )
    worse = int(np.argmax(np.ravel(errors)))
    return se3.pose(cv2.Rodrigues(turns[worse])[0], np.ravel(places[worse]))


def spread_about_zero(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """The covariance about zero: a constant offset counts as spread."""
    bias, covariance = sensor_quality(estimates, truth)
    n = len(estimates)
    return bias, (covariance * (n - 1) + n * np.outer(bias, bias)) / n


def the_other_sign(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Estimate minus truth."""
    bias, covariance = sensor_quality(estimates, truth)
    return -bias, covariance


def _euler(R: Array) -> Array:
    return np.array(
        [
            np.arctan2(R[2, 1], R[2, 2]),
            np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2])),
            np.arctan2(R[1, 0], R[0, 0]),
        ]
    )


def euler_subtracted(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Subtracts Euler angles: a tag that faces the camera stands at their branch cut."""
    errors = np.array(
        [
            np.concatenate([truth[:3, 3] - T[:3, 3], _euler(truth[:3, :3]) - _euler(T[:3, :3])])
            for T in estimates
        ]
    )
    return errors.mean(axis=0), np.cov(errors.T)


def restarts_at_rest(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """Begins every blend at rest, as the report's algorithm does: the velocity jumps."""
    still = np.zeros_like(reference.velocity)
    return blend(t, Sample(reference.position, still, still), goal, duration)


def rates_not_scaled(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """Solves in x = t/T with the rates of t: they come out T times too small, or too large."""
    T = duration
    a = Sample(reference.position, reference.velocity / T, reference.acceleration / T**2)
    b = Sample(goal.position, goal.velocity / T, goal.acceleration / T**2)
    return blend(t, a, b, T) if t < T else blend(t, reference, goal, T)


def stops_at_the_goal(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """Arrives at rest, although the goal moves on."""
    still = np.zeros_like(goal.velocity)
    return blend(t, reference, Sample(goal.position, still, still), duration)


def without_the_bend(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """A cubic: position and velocity fit, the acceleration jumps."""
    T = duration
    if t >= T:
        return blend(t, reference, goal, T)
    p0, v0, p1, v1 = reference.position, reference.velocity, goal.position, goal.velocity
    c2 = (3 * (p1 - p0) - (2 * v0 + v1) * T) / T**2
    c3 = (2 * (p0 - p1) + (v0 + v1) * T) / T**3
    return Sample(
        p0 + v0 * t + c2 * t**2 + c3 * t**3, v0 + 2 * c2 * t + 3 * c3 * t**2, 2 * c2 + 6 * c3 * t
    )


def ignores_the_age(
    mean: Any, covariance: Any, age: float, accel_noise: float
) -> tuple[Array, Array]:
    """Takes the old picture for now."""
    return np.array(mean), np.array(covariance)


def noise_without_time(
    mean: Any, covariance: Any, age: float, accel_noise: float
) -> tuple[Array, Array]:
    """Adds the same noise whatever the time step: two half steps are not one step."""
    F = np.kron([[1.0, age], [0.0, 1.0]], np.eye(3))
    return F @ mean, F @ covariance @ F.T + accel_noise * np.eye(6)


def certain_for_ever(
    mean: Any, covariance: Any, age: float, accel_noise: float
) -> tuple[Array, Array]:
    """Moves the mean and leaves the covariance."""
    return predict(mean, covariance, age, accel_noise)[0], np.array(covariance)


def noise_on_the_diagonal(
    mean: Any, covariance: Any, age: float, accel_noise: float
) -> tuple[Array, Array]:
    """Forgets that a push changes position and velocity together."""
    F = np.kron([[1.0, age], [0.0, 1.0]], np.eye(3))
    Q = accel_noise * np.kron(np.diag([age**3 / 3.0, age]), np.eye(3))
    return F @ mean, F @ covariance @ F.T + Q
