r"""Follow a tag with a continuous reference, made from readings that arrive late.

A Kalman filter for position, velocity and acceleration takes in old readings.  Its estimate is
predicted along the turn of the tag to where the tag will be.  Each reading bends the reference
towards that place by a polynomial of fifth order, which continues the reference's own position,
velocity and acceleration.  Between the two ends of a blend, with :math:`x = t/T`:

.. math:: p(t) = \sum_{k=0}^{5} c_k x^k

Lynch & Park, section 9.3 (polynomials through via points); Bar-Shalom, Li & Kirubarajan,
section 6.2.2 (continuous white-noise acceleration); Li & Jilkov 2003, "Survey of maneuvering target
tracking, part I", IEEE Trans. Aerospace and Electronic Systems 39(4) (planar turns).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import factorial
from typing import Any

import numpy as np

from labkit import PoseSample, Sample, se3
from labkit.shapes import Array, as_array, as_number, as_vector
from labkit.tags.stream import Estimate, Reading, first_estimate, update

_ENDS = np.linalg.inv(
    np.array(
        [
            [1, 0, 0, 0, 0, 0],
            [0, 1, 0, 0, 0, 0],
            [0, 0, 2, 0, 0, 0],
            [1, 1, 1, 1, 1, 1],
            [0, 1, 2, 3, 4, 5],
            [0, 0, 2, 6, 12, 20],
        ],
        dtype=float,
    )
)  # from value, first and second derivative at x = 0 and x = 1 to the coefficients


def carry_forward(mean: Any, covariance: Any, age: float, noise: float) -> tuple[Array, Array]:
    r"""Predict a motion by ``age`` seconds, if only white noise changes its highest derivative.

    For position and velocity, pushed by unknown accelerations:

    .. math:: F = \begin{bmatrix} I & \tau I \\ 0 & I \end{bmatrix}, \quad
       Q = q \begin{bmatrix} \tau^3/3\,I & \tau^2/2\,I \\ \tau^2/2\,I & \tau I \end{bmatrix}, \quad
       m' = F m, \quad P' = F P F^T + Q

    In general :math:`F_{ij} = \tau^{j-i}/(j-i)!` and :math:`Q = q\int_0^\tau f f^T ds`, where f(s)
    is the last column of F(s).

    Args:
        mean: Position [m] and velocity [m/s], or acceleration [m/s^2] too, shape (6,) or (9,).
        covariance: P, shape (6, 6) or (9, 9).
        age: tau, in [s].
        noise: q, the power of the noise of the acceleration, in [m^2/s^3], or, for a mean of nine
            numbers, of the jerk, in [m^2/s^5].

    Returns:
        The predicted mean and covariance.
    """
    mean = as_array(mean, (9,) if np.size(mean) == 9 else (6,), "mean")
    covariance = as_array(covariance, (len(mean), len(mean)), "covariance")
    tau, q = as_number(age, "age"), as_number(noise, "noise", least=0.0)
    order = range(len(mean) // 3)
    rows = [[tau ** (j - i) / factorial(j - i) if j >= i else 0.0 for j in order] for i in order]
    left = [order[-1] - i for i in order]  # how often the noise is integrated to reach each row
    noises = [
        [tau ** (a + b + 1) / (factorial(a) * factorial(b) * (a + b + 1)) for b in left]
        for a in left
    ]
    F, Q = np.kron(rows, np.eye(3)), q * np.kron(noises, np.eye(3))
    return F @ mean, F @ covariance @ F.T + Q


def turn_on(mean: Any, age: float) -> Array:
    r"""Predict a motion by ``age`` seconds, if its velocity continues to turn as it does now.

    A velocity that turns by :math:`\omega = |v\times a|/|v|^2` each second in the plane of v and a
    has :math:`\dot a = -\omega^2 v`, so

    .. math:: p' = p + \frac{\sin\omega\tau}{\omega}\,v + \frac{1-\cos\omega\tau}{\omega^2}\,a

    and v' and a' are its derivatives.  On a circle this is exact; without a turn it is constant
    acceleration.

    Args:
        mean: Position [m], velocity [m/s] and acceleration [m/s^2], shape (9,).
        age: tau, in [s].

    Returns:
        The predicted mean, shape (9,).
    """
    p, v, a = as_array(mean, (9,), "mean").reshape(3, 3)
    tau = as_number(age, "age")
    w = float(np.linalg.norm(np.cross(v, a))) / max(float(v @ v), 1e-12)
    c, s = np.cos(w * tau), tau * np.sinc(w * tau / np.pi)  # s is sin(w tau) / w
    bend = 0.5 * (tau * np.sinc(0.5 * w * tau / np.pi)) ** 2  # (1 - cos(w tau)) / w^2
    return np.concatenate([p + s * v + bend * a, c * v + s * a, c * a - w * w * s * v])


def blend(t: float, reference: Sample, goal: Sample, duration: float) -> Sample:
    """Blend from a moving reference to a moving goal, without a jump.

    Args:
        t: Time since the blend began, in [s]; after its end the goal's velocity goes on.
        reference: The reference when the blend began.
        goal: Position, velocity and acceleration at the end of the blend.
        duration: The duration of the blend, in [s].

    Returns:
        The reference at that time.
    """
    T = as_number(duration, "duration", above=0.0)
    if t >= T:
        after = t - T
        return Sample(goal.position + after * goal.velocity, goal.velocity, 0.0 * goal.velocity)
    scale = np.array([1.0, T, T * T])[:, None]
    coefficients = _ENDS @ np.vstack([np.array(reference) * scale, np.array(goal) * scale])
    x = t / T
    p = np.polynomial.polynomial.polyval(x, coefficients)
    first = coefficients[1:] * np.arange(1, 6)[:, None]
    second = first[1:] * np.arange(1, 5)[:, None]
    return Sample(
        p,
        np.polynomial.polynomial.polyval(x, first) / T,
        np.polynomial.polynomial.polyval(x, second) / T**2,
    )


@dataclass(eq=False)
class TagFollower:
    """Keeps the tip at a fixed offset from a tag; a follower for `labkit.tags.stream.TagTarget`.

    If the tag is no longer seen, its motion is predicted for `coast` seconds after the last
    picture; then the reference comes to rest and holds until the tag is seen again.

    Attributes:
        T_wt: Pose of the tip at the start, shape (4, 4); its orientation is kept.
        offset: The vector from the tag to the goal of the tip, world axes, shape (3,) in [m].
        horizon: The time until a blend meets the tag, in [s]; longer if `acceleration` requires it.
        coast: How long the last motion is predicted, in [s].
        acceleration: Largest acceleration of the reference, in [m/s^2].
        noise: The power of the noise of the tag's jerk, for `carry_forward`, in [m^2/s^5].
        spread: The initial standard deviations of speed [m/s] and acceleration [m/s^2].
    """

    T_wt: Any
    offset: Any
    horizon: float = 0.45
    coast: float = 0.7
    acceleration: float = 0.7
    noise: float = 0.0035
    spread: tuple[float, float] = (0.1, 0.2)
    estimate: Estimate | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.T_wt = se3.as_pose(self.T_wt, "T_wt")
        self.offset = as_vector(self.offset, 3, "offset")
        here = np.array(self.T_wt[:3, 3])
        self._from = self._to = Sample(here, np.zeros(3), np.zeros(3))
        self._began, self._lasts, self._at_rest = 0.0, self.horizon, True

    def __call__(self, t: float, readings: tuple[Reading, ...]) -> PoseSample:
        """The reference at time ``t`` [s], with the readings that have arrived since the last."""
        for reading in readings:
            self.learn(reading)
        known = self.estimate
        believed = known is not None and t - known.t <= self.coast
        ending = not self._at_rest and t - self._began > 0.8 * self._lasts
        if known is not None and (readings or (believed and ending)):
            p, v, a = turn_on(known.mean, t + self.horizon - known.t).reshape(3, 3)
            self._blend_to(t, lambda late: Sample(p + self.offset + late * v, v, a * (late == 0.0)))
            self._at_rest = False
        elif not (believed or self._at_rest):
            p, v, _ = self._reference(t)
            half, still = 0.5 * v, np.zeros(3)
            self._blend_to(t, lambda late: Sample(p + (self.horizon + late) * half, still, still))
            self._at_rest = True
        p, v, a = self._reference(t)
        T = np.array(self.T_wt)
        T[:3, 3] = p
        return PoseSample(T, np.concatenate([v, np.zeros(3)]), np.concatenate([a, np.zeros(3)]))

    def learn(self, reading: Reading) -> None:
        """Update the estimate with a reading, unless the reading is older than the estimate."""
        z, R = reading.T_wm[:3, 3], reading.covariance[:3, :3]
        if self.estimate is None:
            self.estimate = first_estimate(reading.stamp, z, R, *self.spread)
            return
        age = reading.stamp - self.estimate.t
        if age >= 0.0:
            then = carry_forward(self.estimate.mean, self.estimate.covariance, age, self.noise)
            self.estimate = update(Estimate(reading.stamp, *then), z, R)

    def _reference(self, t: float) -> Sample:
        return blend(t - self._began, self._from, self._to, self._lasts)

    def _blend_to(self, t: float, goal: Callable[[float], Sample]) -> None:
        """Start a new blend from the present reference, longer than the horizon if need be.

        Args:
            t: The present time, in [s].
            goal: The goal as a function of the seconds after the horizon.
        """
        here, duration = self._reference(t), self.horizon
        while _peak(here, goal(duration - self.horizon), duration) > self.acceleration:
            duration *= 1.2
            if duration > 20.0:
                break
        end = goal(duration - self.horizon)
        self._from, self._to, self._began, self._lasts = here, end, t, duration


def _peak(reference: Sample, goal: Sample, duration: float) -> float:
    """The largest acceleration of a blend after its start, which is given, in [m/s^2]."""
    times = np.linspace(0.0, duration, 9)[1:-1]
    return max(float(np.linalg.norm(blend(t, reference, goal, duration)[2])) for t in times)
