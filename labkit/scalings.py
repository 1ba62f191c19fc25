r"""Time scalings s(t): how fast to go along a path (Lynch & Park, section 9.2).

Each rises from 0 at t = 0 to 1 at t = duration.  Before the start the answer is the start at rest,
from the end on it is the end at rest.  A duration of zero is allowed: already there.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import sqrt
from typing import ClassVar, Self

from .arrays import as_number

START, END = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class _Profile(ABC):
    """A fixed shape, stretched over a duration.

    Attributes:
        duration: How long it lasts, in [s], at least 0.
    """

    duration: float

    PEAK_SPEED: ClassVar[float]
    """max ds/dt times the duration."""
    PEAK_ACCELERATION: ClassVar[float]
    """max d2s/dt2 times the duration squared."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", as_number(self.duration, "duration", least=0.0))

    @classmethod
    def within(cls, distance: float, v_max: float, a_max: float) -> Self:
        """The quickest one for which a path of this length keeps both limits.

        Args:
            distance: Length of the path, in [m] or [rad].
            v_max: Largest speed, in [m/s] or [rad/s].
            a_max: Largest acceleration, in [m/s^2] or [rad/s^2].

        Returns:
            A time scaling; of zero duration where the distance is zero.
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
    """Constant acceleration, then as much deceleration: the report's equations 2 to 4, mended."""

    PEAK_SPEED = 2.0
    PEAK_ACCELERATION = 4.0

    def shape(self, x: float) -> tuple[float, float, float]:
        """Two parabolas."""
        if x < 0.5:
            return 2.0 * x * x, 4.0 * x, 4.0
        return 1.0 - 2.0 * (1.0 - x) ** 2, 4.0 * (1.0 - x), -4.0


@dataclass(frozen=True)
class Cubic(_Profile):
    """The third-order polynomial that starts and ends at rest (Lynch & Park, eq. 9.9)."""

    PEAK_SPEED = 1.5
    PEAK_ACCELERATION = 6.0

    def shape(self, x: float) -> tuple[float, float, float]:
        """3 x^2 - 2 x^3."""
        return x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x), 6.0 - 12.0 * x


@dataclass(frozen=True)
class Quintic(_Profile):
    """The fifth-order polynomial whose acceleration is zero at both ends too."""

    PEAK_SPEED = 1.875
    PEAK_ACCELERATION = 10.0 / sqrt(3.0)

    def shape(self, x: float) -> tuple[float, float, float]:
        """10 x^3 - 15 x^4 + 6 x^5."""
        y = 1.0 - x
        s = x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
        return s, 30.0 * x * x * y * y, 60.0 * x * y * (1.0 - 2.0 * x)


@dataclass(frozen=True)
class Trapezoid:
    """Accelerate, cruise, brake; a triangle where the way is too short to reach v_max.

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
        as_number(self.distance, "distance", least=0.0)
        as_number(self.v_max, "v_max", above=0.0)
        as_number(self.a_max, "a_max", above=0.0)

    @property
    def peak_speed(self) -> float:
        """The speed it reaches, in [m/s]: v_max, or the tip of the triangle."""
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
