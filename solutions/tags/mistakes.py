"""Mistakes that people make in notebook 06."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import BangBang, Line, Sample, Trajectory, se3
from labkit.servo import Bend, Memory
from labkit.shapes import Array
from labkit.tags.tag import tag_corners

from .answers import sensor_quality, servo_smooth
from .following import blend, carry_forward


@dataclass(frozen=True)
class Chosen:
    """The pose of a tag with another projection, choice or error.

    Attributes:
        scale: Factor of the square's size.
        project: The pixels of the corners in the camera's frame, shape (4, 3), given K.
        pose: What is projected, given a candidate.
        error: The error, given the distances of the corners in [px], shape (4, 2).
        best: The choice, given the errors.
    """

    scale: float = 1.0
    project: Callable[[Array, Array], Array] = lambda p, K: (p @ K.T)[:, :2] / p[:, 2:]
    pose: Callable[[Array], Array] = lambda T: T
    error: Callable[[Array], Any] = lambda off: np.sqrt(np.mean(np.sum(off**2, axis=1)))
    best: Callable[[Any], Any] = np.argmin

    def __call__(self, candidates: Any, pixels: Any, K: Any, size: float) -> tuple[Array, float]:
        """The candidate and its error."""
        corners, errors = tag_corners(self.scale * size), []
        for T in map(self.pose, np.asarray(candidates)):
            image = self.project(corners @ T[:3, :3].T + T[:3, 3], np.asarray(K))
            errors.append(float(self.error(image - pixels)))
        best = int(self.best(errors))
        return candidates[best], errors[best]


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


def blend_terms(
    t: float, reference: Sample, goal: Sample, duration: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    """What each of its six conditions adds to a blend, and what is taken for one of them."""
    still = Sample(*(0.0 * x for x in goal))
    law = {}
    for name, x, y in zip(Sample._fields, reference, goal, strict=True):
        law[f"the reference's {name}"] = blend(t, still._replace(**{name: x}), still, duration)
        law[f"the goal's {name}"] = blend(t, still, still._replace(**{name: y}), duration)
    ways = [still._replace(position=duration * x.velocity) for x in (reference, goal)]
    on = ("the way of the reference's velocity", "the way of the goal's velocity")
    return law, {name: blend(t, still, way, duration) for name, way in zip(on, ways, strict=True)}


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


def covariance_not_moved(
    mean: Any, covariance: Any, age: float, accel_noise: float
) -> tuple[Array, Array]:
    """The mean is carried forward, the covariance only grows by Q."""
    Q = carry_forward(mean, np.zeros((6, 6)), age, accel_noise)[1]
    return np.kron([[1.0, age], [0.0, 1.0]], np.eye(3)) @ mean, covariance + Q


@dataclass(frozen=True)
class Stepping:
    """Algorithm 1 with another rule.

    Attributes:
        goal: The goal, given hand, t, stamp, T_tc, T_cm and T_mg.
        start: Where the new line begins, given memory, t, hand and goal.
        due: Whether it looks, given the seconds since the last look and `every`.
        far: Whether the goal has moved, given the distance and `moved`.
        unseen: The memory if there is no tag, given the old one and t.
        near: The memory if the goal has not moved, given the old one, t and the goal.
        lasts: How long the line takes, given `seconds` and the distance.
        seen: Changes the memory with the new line.
    """

    goal: Callable[..., Any] = lambda hand, t, s, T_tc, T_cm, T_mg: hand(s) @ T_tc @ T_cm @ T_mg
    start: Callable[..., Any] = lambda memory, t, hand, goal: memory.line(t - memory.began)[0]
    due: Callable[[float, float], bool] = lambda wait, every: wait >= every
    far: Callable[[float, float], bool] = lambda d, moved: d > moved
    unseen: Callable[..., Memory] = lambda memory, t: memory._replace(looked=t)
    near: Callable[..., Memory] = lambda memory, t, goal: memory._replace(looked=t)
    lasts: Callable[[float, float], float] = lambda seconds, d: seconds
    seen: Callable[[Memory], Memory] = lambda memory: memory

    def __call__(
        self, t: float, memory: Any, sighting: Any, hand: Any, T_tc: Any, T_mg: Any,
        *, every: float, moved: float, seconds: float,
    ) -> Any:  # fmt: skip
        """The memory."""
        if not self.due(t - memory.looked, every):
            return memory
        if sighting is None:
            return self.unseen(memory, t)
        goal = np.array(self.goal(hand, t, sighting[0], T_tc, sighting[1], T_mg))
        if not self.far(float(np.linalg.norm(goal[:3, 3] - memory.goal[:3, 3])), moved):
            return self.near(memory, t, goal)
        here = self.start(memory, t, hand, goal)
        lasts = self.lasts(seconds, float(np.linalg.norm(goal[:3, 3] - here)))
        line = Trajectory(Line(here, goal[:3, 3]), BangBang(lasts))
        return self.seen(Memory(goal, line, t, t))


@dataclass(frozen=True)
class Smoothing:
    """The smooth servo with another rule.

    Attributes:
        hand_at: The time of the hand, given t and the stamp.
        stamps: The stamps in use, given those of the sightings and t.
        velocity: Factor of the tag's velocity.
        start: Factors of the reference's velocity and acceleration.
        place: Where the blend begins, given memory and the present place.
        ahead: Factor of `ahead` in the goal's place.
        end: Factor of the goal's velocity at the end.
        patience: Factor of `patience`.
        rest: What happens without news, given memory, the present sample, t and `ahead`.
    """

    hand_at: Callable[[float, float], float] = lambda t, s: s
    stamps: Callable[[Array, float], Array] = lambda s, t: s
    velocity: float = 1.0
    start: tuple[float, float] = (1.0, 1.0)
    place: Callable[[Memory, Array], Array] = lambda memory, p: p
    ahead: float = 1.0
    end: float = 1.0
    patience: float = 1.0
    rest: Callable[..., Memory] | None = None

    def __call__(
        self, t: float, memory: Any, sightings: Any, hand: Any, T_tc: Any, T_mg: Any,
        *, ahead: float, patience: float,
    ) -> Any:  # fmt: skip
        """The memory."""
        p, v, a = memory.line(t - memory.began)
        if not sightings or t - sightings[-1][0] > self.patience * patience:
            if self.rest is not None:
                return self.rest(memory, Sample(p, v, a), t, ahead)
            return servo_smooth(t, memory, (), hand, T_tc, T_mg, ahead=ahead, patience=patience)
        goals = np.array([hand(self.hand_at(t, s)) @ T_tc @ T @ T_mg for s, T in sightings])
        times = self.stamps(np.array([s for s, _ in sightings]), t)
        speed, place = np.zeros(3), goals[-1, :3, 3]
        if len(goals) > 1:
            speed, place = np.polyfit(times - times[-1], goals[:, :3, 3], 1)
        speed = self.velocity * speed
        goal = np.array(goals[-1])
        goal[:3, 3] = place + (t + self.ahead * ahead - times[-1]) * speed
        start = Sample(self.place(memory, p), self.start[0] * v, self.start[1] * a)
        end = Sample(goal[:3, 3], self.end * speed, 0.0 * speed)
        return Memory(goal, Bend(start, end, ahead), t, t)


def more_often(
    t: float, memory: Any, sightings: Any, hand: Any, T_tc: Any, T_mg: Any, **options: Any
) -> Any:
    """Algorithm 1 at each call, with a line from rest."""
    seen = sightings[-1] if sightings else None
    return Stepping()(
        t, memory, seen, hand, T_tc, T_mg, every=0.0, moved=0.0, seconds=options["ahead"]
    )
