"""Mistakes that people make in notebook 06."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from labkit import Sample, se3
from labkit.shapes import Array

from .answers import sensor_quality, tag_corners, tag_pose
from .following import blend, carry_forward


@dataclass(frozen=True)
class Reordered:
    """The right corners, moved or in another order.

    Attributes:
        order: The order of the corners; (0, 1, 2, 3) is right.
        scale: Factors of x, y and z.
    """

    order: tuple[int, ...] = (0, 1, 2, 3)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def __call__(self, size: float) -> Array:
        """The corners."""
        return np.asarray(tag_corners(size)[list(self.order)] * np.array(self.scale))


@dataclass(frozen=True)
class PoseOf:
    """OpenCV with corners of another kind.

    Attributes:
        corners: Returns the corners, given the size of the square.
        scale: Factor of the size.
    """

    corners: Reordered = Reordered()
    scale: float = 1.0

    def __call__(self, pixels: Any, K: Any, size: float) -> Array:
        """The pose that fits the corners best."""
        _, turns, places, errors = cv2.solvePnPGeneric(
            self.corners(self.scale * size),
            np.asarray(pixels, dtype=float),
            np.array(K),
            None,
            flags=cv2.SOLVEPNP_IPPE,
        )
        best = int(np.argmin(np.ravel(errors)))
        return se3.pose(cv2.Rodrigues(turns[best])[0], np.ravel(places[best]))


def rotation_transposed(pixels: Any, K: Any, size: float) -> Array:
    """The rotation transposed, the translation left as it is."""
    T = tag_pose(pixels, K, size)
    return se3.pose(T[:3, :3].T, T[:3, 3])


def camera_in_the_tag(pixels: Any, K: Any, size: float) -> Array:
    """The inverse: where the camera is in the tag's frame."""
    return se3.inverse(tag_pose(pixels, K, size))


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


def the_other_sign(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Estimate minus truth."""
    bias, covariance = sensor_quality(estimates, truth)
    return -bias, covariance


def _quality(estimates: Any, truth: Any, error: Any) -> tuple[Array, Array]:
    errors = np.array([error(truth, T) for T in estimates])
    return errors.mean(axis=0), np.cov(errors.T)


def n_in_the_denominator(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """The covariance with n, numpy's habit in np.var."""
    bias, covariance = sensor_quality(estimates, truth)
    n = len(estimates)
    return bias, covariance * (n - 1) / n


def of_the_mean(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """The covariance of the mean, n times smaller."""
    bias, covariance = sensor_quality(estimates, truth)
    return bias, covariance / len(estimates)


def diagonal_only(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Only the variances."""
    bias, covariance = sensor_quality(estimates, truth)
    return bias, np.diag(np.diag(covariance))


def turn_in_tag_axes(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """R_estimate^T R_truth: the turn in the tag's axes."""

    def error(T_cm: Array, T: Array) -> Array:
        turn = se3.rotation_log(T[:3, :3].T @ T_cm[:3, :3])
        return np.concatenate([T_cm[:3, 3] - T[:3, 3], turn])

    return _quality(estimates, truth, error)


def turn_backwards(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """R_estimate R_truth^T: from the truth to the estimate."""

    def error(T_cm: Array, T: Array) -> Array:
        turn = se3.rotation_log(T[:3, :3] @ T_cm[:3, :3].T)
        return np.concatenate([T_cm[:3, 3] - T[:3, 3], turn])

    return _quality(estimates, truth, error)


def logarithms_subtracted(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """The difference of two rotation vectors."""

    def error(T_cm: Array, T: Array) -> Array:
        turn = se3.rotation_log(T_cm[:3, :3]) - se3.rotation_log(T[:3, :3])
        return np.concatenate([T_cm[:3, 3] - T[:3, 3], turn])

    return _quality(estimates, truth, error)


def turn_first(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Turn, then position."""
    return _quality(estimates, truth, lambda a, b: np.roll(se3.pose_error(a, b), 3))


def _euler(R: Array) -> Array:
    return np.array(
        [
            np.arctan2(R[2, 1], R[2, 2]),
            np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2])),
            np.arctan2(R[1, 0], R[0, 0]),
        ]
    )


def euler_subtracted(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Subtracts Euler angles: a tag that faces the camera is at their branch cut."""
    errors = np.array(
        [
            np.concatenate([truth[:3, 3] - T[:3, 3], _euler(truth[:3, :3]) - _euler(T[:3, :3])])
            for T in estimates
        ]
    )
    return errors.mean(axis=0), np.cov(errors.T)


@dataclass(frozen=True)
class Blended:
    """A blend that partly ignores the motion at its ends.

    Attributes:
        start: Factors of the reference's velocity and acceleration.
        end: Factors of the goal's velocity and acceleration.
    """

    start: tuple[float, float] = (1.0, 1.0)
    end: tuple[float, float] = (1.0, 1.0)

    def __call__(self, t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
        """The reference at time t."""
        if t > duration:
            return blend(t, reference, goal, duration)
        (p0, v0, a0), (p1, v1, a1) = reference, goal
        a = Sample(p0, self.start[0] * v0, self.start[1] * a0)
        b = Sample(p1, self.end[0] * v1, self.end[1] * a1)
        return blend(t, a, b, duration)


def never_ends(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """The polynomial goes on after its end."""
    T = duration
    (p0, v0, a0), (p1, v1, a1) = reference, goal
    rows = [[T**3, T**4, T**5], [3 * T**2, 4 * T**3, 5 * T**4], [6 * T, 12 * T**2, 20 * T**3]]
    c3, c4, c5 = np.linalg.solve(
        rows, [p1 - p0 - v0 * T - a0 * T**2 / 2, v1 - v0 - a0 * T, a1 - a0]
    )
    return Sample(
        p0 + v0 * t + a0 * t**2 / 2 + c3 * t**3 + c4 * t**4 + c5 * t**5,
        v0 + a0 * t + 3 * c3 * t**2 + 4 * c4 * t**3 + 5 * c5 * t**4,
        a0 + 6 * c3 * t + 12 * c4 * t**2 + 20 * c5 * t**3,
    )


def speeds_up_for_ever(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """After the end the goal's acceleration goes on."""
    x, late = blend(t, reference, goal, duration), t - duration
    if late <= 0.0:
        return x
    a = goal.acceleration
    return Sample(x.position + a * late**2 / 2, x.velocity + a * late, a)


def without_the_bend(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """A cubic, with which position and velocity are continuous but the acceleration jumps."""
    T = duration
    if t >= T:
        return blend(t, reference, goal, T)
    p0, v0, p1, v1 = reference.position, reference.velocity, goal.position, goal.velocity
    c2 = (3 * (p1 - p0) - (2 * v0 + v1) * T) / T**2
    c3 = (2 * (p0 - p1) + (v0 + v1) * T) / T**3
    return Sample(
        p0 + v0 * t + c2 * t**2 + c3 * t**3, v0 + 2 * c2 * t + 3 * c3 * t**2, 2 * c2 + 6 * c3 * t
    )


@dataclass(frozen=True)
class Predicted:
    """F m and F P F^T + Q with another Q.

    Attributes:
        Q: Powers of the age, and factors, in the three blocks of Q: position, mixed and velocity.
        power: Power of the noise.
    """

    Q: tuple[tuple[float, float], ...]
    power: float = 1.0

    def __call__(
        self, mean: Any, covariance: Any, age: float, accel_noise: float
    ) -> tuple[Array, Array]:
        """The belief then."""
        place, both, velocity = (factor * age**power for power, factor in self.Q)
        F = np.kron([[1.0, age], [0.0, 1.0]], np.eye(3))
        Q = accel_noise**self.power * np.kron([[place, both], [both, velocity]], np.eye(3))
        return F @ mean, F @ covariance @ F.T + Q


def back_in_time(mean: Any, covariance: Any, age: float, accel_noise: float) -> tuple[Array, Array]:
    """Predicts backwards in time."""
    F = np.kron([[1.0, -age], [0.0, 1.0]], np.eye(3))
    Q = carry_forward(mean, np.zeros((6, 6)), age, accel_noise)[1]
    return F @ mean, F @ covariance @ F.T + Q


def noise_on_the_diagonal(
    mean: Any, covariance: Any, age: float, accel_noise: float
) -> tuple[Array, Array]:
    """Forgets that a push changes position and velocity together."""
    F = np.kron([[1.0, age], [0.0, 1.0]], np.eye(3))
    Q = accel_noise * np.kron(np.diag([age**3 / 3.0, age]), np.eye(3))
    return F @ mean, F @ covariance @ F.T + Q


@dataclass(frozen=True)
class Seen:
    """The right pose for other pixels or another camera, or a function of it.

    Attributes:
        pixels: A function of the pixels.
        pose: A function of the pose.
    """

    pixels: Callable[[Array], Array] = lambda pixels: pixels
    pose: Callable[[Array], Array] = lambda T: T

    def __call__(self, pixels: Any, K: Any, size: float) -> Array:
        """The pose."""
        seen = np.ascontiguousarray(self.pixels(np.array(pixels, dtype=float)))
        return self.pose(tag_pose(seen, np.array(K), size))


@dataclass(frozen=True)
class Quality:
    """Mean and covariance of other errors, or other statistics of the right ones.

    Attributes:
        scale: Factors of position and orientation.
        spread: The second answer, given the errors.
    """

    scale: tuple[float, float] = (1.0, 1.0)
    spread: Callable[[Array], Any] = lambda e: np.cov(e.T)

    def __call__(self, estimates: Any, truth: Any) -> tuple[Array, Array]:
        """Mean and covariance."""
        errors = []
        for T in estimates:
            errors.append(np.repeat(self.scale, 3) * se3.pose_error(truth, T))
        e = np.array(errors)
        return e.mean(axis=0), np.asarray(self.spread(e))


@dataclass(frozen=True)
class Ends:
    """The blend with another rule after its end.

    Attributes:
        late: The sample after the end, given the goal, t and the duration.
    """

    late: Callable[[Sample, float, float], Sample]

    def __call__(self, t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
        """The sample at t."""
        if t > duration:
            return self.late(goal, t, duration)
        return blend(t, reference, goal, duration)


@dataclass(frozen=True)
class Carried:
    """The prediction with another F, mean or order.

    Attributes:
        F: The matrix F, shape (2, 2), given the age.
        mean: Whether the mean is predicted.
        noise: Factor of Q.
        order: The order of F P F^T and Q: "P F", "Q first" or "no F".
    """

    F: Callable[[float], Any] = lambda age: [[1.0, age], [0.0, 1.0]]
    mean: bool = True
    noise: float = 1.0
    order: str = ""

    def __call__(
        self, mean: Any, covariance: Any, age: float, accel_noise: float
    ) -> tuple[Array, Array]:
        """The belief then."""
        F, P = np.kron(self.F(age), np.eye(3)), np.asarray(covariance)
        Q = self.noise * carry_forward(mean, np.zeros((6, 6)), age, accel_noise)[1]
        P = {"Q first": F @ (P + Q) @ F.T, "no F": P + Q}.get(self.order, F @ P @ F.T + Q)
        return F @ mean if self.mean else np.array(mean), P
