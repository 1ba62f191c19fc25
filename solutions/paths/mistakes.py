"""Mistakes that people make in notebook 01."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import atan2, cos, pi, sin, sqrt
from typing import Any

import numpy as np

import labkit as lk

from .answers import Path, Scaling, circle, trapezoid


def limits_on_s(
    t: float, distance: float, v_max: float, a_max: float
) -> tuple[float, float, float]:
    """Takes the limits as limits of s, so the length of the path does not matter."""
    return trapezoid(t, 1.0, v_max, a_max)


def radius_in_space(s: float, start: Any, centre: Any) -> lk.Sample:
    """The radius from the distance in space, as the report's equation 12 has it."""
    p, c = np.array(start, dtype=float), np.array(centre, dtype=float)
    r, yaw, w = float(np.linalg.norm(p - c)), atan2(p[1] - c[1], p[0] - c[0]), 2.0 * pi
    out = r * np.array([cos(w * s + yaw), sin(w * s + yaw), 0.0])
    on = np.array([-out[1], out[0], 0.0])
    return lk.Sample(np.array([c[0], c[1], p[2]]) + out, w * on, -w * w * out)


def height_of_the_centre(s: float, start: Any, centre: Any) -> lk.Sample:
    """Drops, or climbs, to the height of the centre at once."""
    x, dx, ddx = circle(s, start, centre)
    return lk.Sample(np.array([x[0], x[1], centre[2]]), dx, ddx)


def starts_at_angle_zero(s: float, start: Any, centre: Any) -> lk.Sample:
    """Forgets the angle of the start."""
    p, c = np.array(start, dtype=float), np.array(centre, dtype=float)
    r, w = float(np.hypot(*(p - c)[:2])), 2.0 * pi
    out = r * np.array([cos(w * s), sin(w * s), 0.0])
    on = np.array([-out[1], out[0], 0.0])
    return lk.Sample(np.array([c[0], c[1], p[2]]) + out, w * on, -w * w * out)


def velocity_from_angle_zero(s: float, start: Any, centre: Any) -> lk.Sample:
    """Forgets the angle of the start in the velocity alone."""
    x, _, ddx = circle(s, start, centre)
    return lk.Sample(x, starts_at_angle_zero(s, start, centre).velocity, ddx)


def rates_without_two_pi(s: float, start: Any, centre: Any) -> lk.Sample:
    """Derivatives with respect to the angle, without the inner derivative."""
    x, dx, ddx = circle(s, start, centre)
    return lk.Sample(x, dx / (2.0 * pi), ddx / (4.0 * pi**2))


def one_two_pi_in_the_acceleration(s: float, start: Any, centre: Any) -> lk.Sample:
    """The inner derivative comes out once in the second derivative too."""
    x, dx, ddx = circle(s, start, centre)
    return lk.Sample(x, dx, ddx / (2.0 * pi))


def drops_the_ramp(path: Path, scaling: Scaling, t: float) -> lk.Sample:
    """The acceleration without the term dx dds: half of the product rule."""
    s, ds, _ = scaling(t)
    x, dx, ddx = path(s)
    return lk.Sample(x, dx * ds, ddx * ds**2)


def forgets_the_square(path: Path, scaling: Scaling, t: float) -> lk.Sample:
    """The acceleration with ddx ds where ddx ds^2 belongs."""
    s, ds, dds = scaling(t)
    x, dx, ddx = path(s)
    return lk.Sample(x, dx * ds, ddx * ds + dx * dds)


def time_for_s(path: Path, scaling: Scaling, t: float) -> lk.Sample:
    """Evaluates the path at t instead of at s(t)."""
    _, ds, dds = scaling(t)
    x, dx, ddx = path(t)
    return lk.Sample(x, dx * ds, ddx * ds**2 + dx * dds)


def still_but_accelerated(t: float, duration: float) -> tuple[float, float, float]:
    """Holds t at the ends, and asks the formulas there: the acceleration stays on."""
    return Bang(before=False, after=False)(min(max(t, 0.0), duration), duration)


def way_for_s(t: float, distance: float, v_max: float, a_max: float) -> tuple[float, float, float]:
    """The distance in metres, never divided by the length of the path."""
    s, ds, dds = trapezoid(t, distance, v_max, a_max)
    return s * distance, ds * distance, dds * distance


def clockwise(s: float, start: Any, centre: Any) -> lk.Sample:
    """Goes round in the opposite direction."""
    x, dx, ddx = circle(-s, start, centre)
    return lk.Sample(x, -dx, ddx)


def accelerates_outwards(s: float, start: Any, centre: Any) -> lk.Sample:
    """The second derivative with the other sign."""
    x, dx, ddx = circle(s, start, centre)
    return lk.Sample(x, dx, -ddx)


def half_an_arctangent(s: float, start: Any, centre: Any) -> lk.Sample:
    """The arctangent of y / x, which takes a start behind the centre for one before it."""
    out = np.array(start, dtype=float) - centre
    return circle(s, [*(centre[:2] + (out if out[0] > 0.0 else -out)[:2]), start[2]], centre)


def schedule_twice(path: Path, scaling: Scaling, t: float) -> lk.Sample:
    """Pairs derivatives of the same order: ddx dds."""
    s, ds, dds = scaling(t)
    x, dx, ddx = path(s)
    return lk.Sample(x, dx * ds, ddx * dds)


@dataclass(frozen=True)
class Bang:
    """Bang-bang with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        ds: Factor of the speed while braking.
        dds: Factor of the acceleration while braking.
        before: Whether the motion rests before the start.
        after: Whether it rests after the end.
        end: The value at which it rests after the end.
        middle: When it begins to brake, given T.
        brake: (s, ds, dds) while braking, given t, T and a; None takes the right ones.
        size: T² times the acceleration.
    """

    ds: float = 1.0
    dds: float = 1.0
    before: bool = True
    after: bool = True
    end: float = 1.0
    middle: Callable[[float], float] = lambda T: T / 2.0
    brake: Callable[[float, float, float], tuple[float, float, float]] | None = None
    size: float = 4.0

    def __call__(self, t: float, duration: float) -> tuple[float, float, float]:
        """The motion at t."""
        T, a = duration, self.size / duration**2
        if t < 0.0 and self.before:
            return 0.0, 0.0, 0.0
        if t >= T and self.after:
            return self.end, 0.0, 0.0
        if t < self.middle(T):
            return a * t**2 / 2.0, a * t, a
        if self.brake:
            return self.brake(t, T, a)
        left = T - t
        return 1.0 - a * left**2 / 2.0, self.ds * a * left, -self.dds * a


def half_the_way_lost(t: float, T: float, a: float) -> tuple[float, float, float]:
    """Only the distance of the second half."""
    since = t - T / 2.0
    return a * T / 2.0 * since - a * since**2 / 2.0, a * (T - t), -a


@dataclass(frozen=True)
class Ramps:
    """The trapezoid with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        offset: Factor of half the ramp, by which the cruise is late.
        dds: Factor of the acceleration while braking.
        top: The top speed, given distance, v_max and a_max.
    """

    offset: float = 1.0
    dds: float = 1.0
    top: Callable[[float, float, float], float] = lambda d, v, a: min(v, sqrt(d * a))

    def __call__(
        self, t: float, distance: float, v_max: float, a_max: float
    ) -> tuple[float, float, float]:
        """The motion at t."""
        d, a = distance, a_max
        v = self.top(d, v_max, a)
        ramp = v / a
        left = d / v + ramp - t
        if t < 0.0:
            return 0.0, 0.0, 0.0
        if left <= 0.0:
            return 1.0, 0.0, 0.0
        if t < ramp:
            return a * t**2 / 2.0 / d, a * t / d, a / d
        if left > ramp:
            return v * (t - self.offset * ramp / 2.0) / d, v / d, 0.0
        return 1.0 - a * left**2 / 2.0 / d, a * left / d, -self.dds * a / d


@dataclass(frozen=True)
class Lasting:
    """A wrong duration of a trapezoid.

    Attributes:
        formula: The duration, given distance, v_max and a_max.
    """

    formula: Callable[[float, float, float], float]

    def __call__(self, distance: float, v_max: float, a_max: float) -> float:
        """The duration."""
        return self.formula(distance, v_max, a_max)


def argmax_of_ends(durations: Sequence[float], t: float) -> tuple[int, float]:
    """The first end after t by numpy's argmax, which is 0 where there is none."""
    ends = np.cumsum(durations)
    k = int(np.argmax(ends > t))
    return k, t - (ends[k] - durations[k])


def arctangent_of_x_over_y(s: float, start: Any, centre: Any) -> lk.Sample:
    """The angle of the start with x and y exchanged."""
    out = np.subtract(start, centre)[1::-1]
    return circle(s, [*(np.asarray(centre)[:2] + out), start[2]], centre)


@dataclass(frozen=True)
class Chained:
    """The chain rule with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        bend: Factor of ddx ds^2.
        along: Factor of dx dds.
        velocity: Power of ds in the velocity.
    """

    bend: float = 1.0
    along: float = 1.0
    velocity: float = 1.0

    def __call__(self, path: Path, scaling: Scaling, t: float) -> lk.Sample:
        """The sample at t."""
        s, ds, dds = scaling(t)
        x, dx, ddx = path(s)
        a = self.bend * ddx * ds**2 + self.along * dx * dds
        return lk.Sample(x, dx * ds**self.velocity, a)


@dataclass(frozen=True)
class Segments:
    """A sequence of segments with other rules at their ends.

    Attributes:
        joint: Whether the earlier segment is active where two meet.
        local: The local time, given t and the start and the duration of the segment.
        first: The index of the first segment.
    """

    joint: bool = False
    local: Callable[[float, float, float], float] = lambda t, begun, d: t - begun
    first: int = 0

    def __call__(self, durations: Sequence[float], t: float) -> Any:
        """The segment, and the time in it."""
        begun, last = 0.0, len(durations) - 1
        for k, d in enumerate(durations):
            if t < begun + d or (self.joint and t <= begun + d) or k == last:
                return k + self.first, self.local(t, begun, d)
            begun += d
