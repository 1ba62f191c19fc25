r"""Paths and time scalings: where to go, and when.

A path is pure geometry, a curve in s from 0 to 1 with its exact derivatives.  A time scaling s(t)
says how fast to follow it (Lynch & Park, section 9.2): it rises from 0 at t = 0 to 1 at
t = duration.  It returns the start at rest before the start, and the end at rest from the end on.
A duration of zero is allowed and means that the end has been reached already.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import cos, factorial, pi, sin, sqrt
from typing import Any, ClassVar, Self

import numpy as np

from .errors import OutOfRange, ShapeError
from .shapes import Array, as_number, as_numbers, lock_vectors, locked
from .trajectory import Sample


@dataclass(frozen=True, eq=False)
class Line:
    """The straight segment from ``start`` to ``goal``.

    Attributes:
        start: Point or joint angles, shape (n,) in [m] or [rad].
        goal: The same for the end.
    """

    start: Array
    goal: Array

    def __post_init__(self) -> None:
        lock_vectors(self, np.size(as_numbers(self.start, "start")), "start", "goal")

    @cached_property
    def _along(self) -> Array:
        return locked(self.goal - self.start)

    @cached_property
    def _still(self) -> Array:
        return locked(np.zeros(self.start.size))

    @property
    def length(self) -> float:
        """Its length, in [m] or [rad]."""
        return float(np.linalg.norm(self._along))

    def __call__(self, s: float) -> Sample:
        """Value and derivatives with respect to s."""
        return Sample(self.start + s * self._along, self._along, self._still)


@dataclass(frozen=True, eq=False)
class Circle:
    """The level circle through ``start`` about the vertical axis through ``centre``.

    It stays at the height of the start, and closes exactly.

    Attributes:
        start: Where it begins and ends, shape (3,) in [m].
        centre: A point on its axis, shape (3,) in [m], at any height.
        turns: Number of turns, counter-clockwise seen from above; negative is clockwise.
    """

    start: Array
    centre: Array
    turns: float = 1.0

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "start", "centre")
        object.__setattr__(self, "turns", as_number(self.turns, "turns"))
        if self.radius < 1e-9:
            raise OutOfRange(
                "the start lies on the circle's axis, so the circle has no radius; move the start "
                "or the centre sideways"
            )

    @cached_property
    def _parts(self) -> tuple[Array, Array, Array]:
        """The middle, the spoke to the start, and the spoke that is a quarter of a turn later."""
        x, y, _ = self.start - self.centre
        spoke, next_spoke = np.array([x, y, 0.0]), np.array([-y, x, 0.0])
        return self.start - spoke, spoke, next_spoke

    @property
    def radius(self) -> float:
        """Its radius, in [m]."""
        return float(np.linalg.norm(self._parts[1]))

    @property
    def length(self) -> float:
        """How far the tip travels, in [m]."""
        return abs(2.0 * pi * self.turns) * self.radius

    def __call__(self, s: float) -> Sample:
        """Value and derivatives with respect to s."""
        rate = 2.0 * pi * self.turns
        # A whole number of turns ends exactly where it began.
        c, d = (1.0, 0.0) if s == 1.0 and self.turns % 1 == 0 else (cos(rate * s), sin(rate * s))
        middle, spoke, next_spoke = self._parts
        out, on = c * spoke + d * next_spoke, c * next_spoke - d * spoke
        return Sample(middle + out, rate * on, -rate * rate * out)


@dataclass(frozen=True, eq=False)
class Polyline:
    """Straight segments from point to point, with s proportional to the distance covered.

    The corners are sharp, so the velocity jumps there under a single time scaling.  To stop at
    each corner, give each of `lines` its own time scaling and join the trajectories in a `Chain`.

    Attributes:
        points: The corners, shape (k, n), at least two.
    """

    points: Array

    def __post_init__(self) -> None:
        points = as_numbers(self.points, "points")
        if points.ndim != 2 or len(points) < 2:
            raise ShapeError("points", (max(2, len(np.atleast_1d(points))), 3), points.shape)
        object.__setattr__(self, "points", locked(points))
        if self.length == 0.0:
            raise OutOfRange("all points are the same, so the polyline has no length")

    @cached_property
    def lines(self) -> tuple[Line, ...]:
        """The segments, in order."""
        return tuple(Line(a, b) for a, b in zip(self.points[:-1], self.points[1:], strict=True))

    @cached_property
    def _pieces(self) -> tuple[list[Line], Array]:
        """The segments with a length, and their ends as shares of the whole length."""
        distance = np.cumsum([0.0, *(line.length for line in self.lines)])
        ends = distance / distance[-1]
        lines = [line for line, share in zip(self.lines, np.diff(ends), strict=True) if share > 0.0]
        return lines, np.unique(ends)

    @property
    def length(self) -> float:
        """Its length, in [m] or [rad]."""
        return sum(line.length for line in self.lines)

    def __call__(self, s: float) -> Sample:
        """Value and derivatives with respect to s; at a corner, those of the later segment."""
        lines, ends = self._pieces
        i = int(np.searchsorted(ends[1:-1], s, side="right"))
        share = float(ends[i + 1] - ends[i])
        x, dx, ddx = lines[i]((s - float(ends[i])) / share)
        return Sample(x, dx / share, ddx)


class Spline:
    """The smooth curve through given values, a quintic spline with four continuous derivatives.

    Attributes:
        s: Rising from 0 to 1, shape (k,).
        values: The values at each s, shape (k, n).
    """

    def __init__(self, s: Any, values: Any) -> None:
        """Interpolate at least six ``values`` at ``s``."""
        from scipy.interpolate import make_interp_spline  # slow to import and seldom needed

        self.s, self.values = locked(as_numbers(s, "s")), locked(as_numbers(values, "values"))
        spline = make_interp_spline(self.s, self.values, k=5)
        self._knots = np.unique(spline.t)[:-1]
        # Each piece is its Taylor polynomial, which takes half as long as SciPy's own evaluation.
        taylor = np.array([spline(self._knots, nu=k) for k in range(6)])
        taylor = np.concatenate([taylor, 0.0 * taylor[:2]])
        pieces = np.stack([taylor[k : k + 6] for k in range(3)])  # value and two derivatives
        self._pieces = np.ascontiguousarray(pieces.transpose(2, 0, 1, 3))

    def __call__(self, s: float) -> Sample:
        """Value and derivatives with respect to s."""
        i = max(int(self._knots.searchsorted(s, side="right")) - 1, 0)
        powers = (s - self._knots[i]) ** _POWERS / _FACTORIALS
        return Sample(*(powers @ self._pieces[i]))  # (6,) @ (3, 6, n)


_POWERS = np.arange(6)
_FACTORIALS = np.array([float(factorial(k)) for k in range(6)])


# Time scalings

START, END = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class _Profile(ABC):
    """A time scaling of fixed shape, stretched over a duration.

    Attributes:
        duration: How long it lasts, in [s], at least 0.
    """

    duration: float

    PEAK_SPEED: ClassVar[float]
    """Largest ds/dt times the duration."""
    PEAK_ACCELERATION: ClassVar[float]
    """Largest d2s/dt2 times the duration squared."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", as_number(self.duration, "duration", least=0.0))

    @classmethod
    def within(cls, distance: float, v_max: float, a_max: float) -> Self:
        """The fastest one that keeps both limits on a path of this length.

        Args:
            distance: Length of the path, in [m] or [rad].
            v_max: Largest speed, in [m/s] or [rad/s].
            a_max: Largest acceleration, in [m/s^2] or [rad/s^2].

        Returns:
            A time scaling, with zero duration if the distance is zero.
        """
        d = as_number(distance, "distance", least=0.0)
        v = as_number(v_max, "v_max", above=0.0)
        a = as_number(a_max, "a_max", above=0.0)
        return cls(max(cls.PEAK_SPEED * d / v, sqrt(cls.PEAK_ACCELERATION * d / a)))

    def __call__(self, t: float) -> tuple[float, float, float]:
        """s, ds/dt and d2s/dt2 at time ``t`` [s]."""
        T = self.duration
        if t >= T:
            return END
        if t < 0.0:
            return START
        s, ds, dds = self.shape(t / T)
        return s, ds / T, dds / (T * T)

    @abstractmethod
    def shape(self, x: float) -> tuple[float, float, float]:
        """Value and derivatives with respect to x = t / duration, for x in [0, 1)."""


@dataclass(frozen=True)
class BangBang(_Profile):
    """Constant acceleration, then equal deceleration, by the report's equations, corrected.

    Attributes:
        duration: How long it lasts, in [s], at least 0.
    """

    PEAK_SPEED = 2.0
    PEAK_ACCELERATION = 4.0

    def shape(self, x: float) -> tuple[float, float, float]:
        """Two parabolas."""
        if x < 0.5:
            return 2.0 * x * x, 4.0 * x, 4.0
        return 1.0 - 2.0 * (1.0 - x) ** 2, 4.0 * (1.0 - x), -4.0


@dataclass(frozen=True)
class Cubic(_Profile):
    """The third-order polynomial that starts and ends at rest (Lynch & Park, eq. 9.9).

    Attributes:
        duration: How long it lasts, in [s], at least 0.
    """

    PEAK_SPEED = 1.5
    PEAK_ACCELERATION = 6.0

    def shape(self, x: float) -> tuple[float, float, float]:
        """3 x^2 - 2 x^3."""
        return x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x), 6.0 - 12.0 * x


@dataclass(frozen=True)
class Quintic(_Profile):
    """The fifth-order polynomial that also has zero acceleration at both ends.

    Attributes:
        duration: How long it lasts, in [s], at least 0.
    """

    PEAK_SPEED = 1.875
    PEAK_ACCELERATION = 10.0 / sqrt(3.0)

    def shape(self, x: float) -> tuple[float, float, float]:
        """10 x^3 - 15 x^4 + 6 x^5."""
        y = 1.0 - x
        s = x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
        return s, 30.0 * x * x * y * y, 60.0 * x * y * (1.0 - 2.0 * x)


@dataclass(frozen=True)
class Trapezoid:
    """Accelerate, cruise and brake, without cruising if the path is too short to reach v_max.

    Lynch & Park, section 9.2.2.  The limits hold along the path, in metres, not in s.

    Attributes:
        distance: Length of the path, in [m] or [rad].
        v_max: Cruising speed, in [m/s] or [rad/s].
        a_max: Acceleration and deceleration, in [m/s^2] or [rad/s^2].
    """

    distance: float
    v_max: float
    a_max: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "distance", as_number(self.distance, "distance", least=0.0))
        for name in ("v_max", "a_max"):
            object.__setattr__(self, name, as_number(getattr(self, name), name, above=0.0))

    @property
    def peak_speed(self) -> float:
        """The highest speed reached, in [m/s] or [rad/s], v_max or less."""
        return min(self.v_max, sqrt(self.distance * self.a_max))

    @property
    def duration(self) -> float:
        """How long it lasts, in [s]."""
        v = self.peak_speed
        return 0.0 if self.distance == 0.0 else self.distance / v + v / self.a_max

    def __call__(self, t: float) -> tuple[float, float, float]:
        """s, ds/dt and d2s/dt2 at time ``t`` [s]."""
        T, d, a, v = self.duration, self.distance, self.a_max, self.peak_speed
        if t >= T:
            return END
        if t < 0.0:
            return START
        ramp = v / a
        if t < ramp:
            return 0.5 * a * t * t / d, a * t / d, a / d
        if t < T - ramp:
            return v * (t - 0.5 * ramp) / d, v / d, 0.0
        left = T - t
        return 1.0 - 0.5 * a * left * left / d, a * left / d, -a / d
