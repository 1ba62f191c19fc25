"""Paths: geometry alone, a curve in s from 0 to 1 with its exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, factorial, pi, sin
from typing import Any

import numpy as np

from .arrays import Array, as_number, as_numbers, lock_vectors, locked
from .errors import OutOfRange, ShapeError
from .motion import Sample


@dataclass(frozen=True, eq=False)
class Line:
    """The straight segment from ``start`` to ``goal``.

    Attributes:
        start: Point or joint angles, shape (n,) in [m] or [rad].
        goal: The same at the other end.
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

    It keeps the start's height, so its radius is the distance in the plane, and it returns exactly.

    Attributes:
        start: Where it begins and ends, shape (3,) in [m].
        centre: A point on its axis, shape (3,) in [m]; its height does not matter.
        turns: How many times round, counter-clockwise seen from above; negative is clockwise.
    """

    start: Array
    centre: Array
    turns: float = 1.0

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "start", "centre")
        as_number(self.turns, "turns")
        if self.radius < 1e-9:
            x, y = self.centre[:2]
            raise OutOfRange(
                f"the start lies on the circle's axis (x = {x:g}, y = {y:g}), so the circle has no "
                "radius; move the start or the centre sideways"
            )

    @cached_property
    def _spoke(self) -> Array:
        return (self.start - self.centre)[:2]

    @property
    def radius(self) -> float:
        """Its radius, in [m]."""
        return float(np.linalg.norm(self._spoke))

    @property
    def length(self) -> float:
        """How far the tip travels, in [m]."""
        return abs(2.0 * pi * self.turns) * self.radius

    def __call__(self, s: float) -> Sample:
        """Value and derivatives with respect to s."""
        rate = 2.0 * pi * self.turns
        # A whole number of turns ends exactly where it began.
        c, d = (1.0, 0.0) if s == 1.0 and self.turns % 1 == 0 else (cos(rate * s), sin(rate * s))
        (x, y), (cx, cy, _) = self._spoke, self.centre
        out, on = (c * x - d * y, d * x + c * y), (-d * x - c * y, c * x - d * y)
        return Sample(
            np.array([cx + out[0], cy + out[1], self.start[2]]),
            np.array([rate * on[0], rate * on[1], 0.0]),
            np.array([-rate * rate * out[0], -rate * rate * out[1], 0.0]),
        )


@dataclass(frozen=True, eq=False)
class Polyline:
    """Straight segments from point to point, s proportional to the way gone.

    The corners are sharp: followed on one time scaling, the velocity jumps there.  To stop at each
    corner, give every one of `lines` a schedule of its own and join them with a `Chain`.

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
        """The segments that have a length, and the way gone at their ends, as shares of it all."""
        way = np.cumsum([0.0, *(line.length for line in self.lines)])
        ends = way / way[-1]
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
    """The smooth curve through given values: a quintic spline, four times differentiable.

    Attributes:
        s: Where the values stand, rising from 0 to 1, shape (k,).
        values: The values there, shape (k, n).
    """

    def __init__(self, s: Any, values: Any) -> None:
        """Interpolate ``values`` at ``s``; needs at least six of them.

        Raises:
            OutOfRange: There are fewer, or ``s`` does not rise.
            ShapeError: There are not as many values as places.
        """
        from scipy.interpolate import make_interp_spline  # a slow import, seldom needed

        self.s = locked(as_numbers(s, "s"))
        self.values = locked(as_numbers(values, "values"))
        if self.s.ndim != 1 or self.s.size < 6 or np.diff(self.s).min() <= 0.0:
            raise OutOfRange("s must be at least six rising numbers")
        if self.values.ndim != 2 or len(self.values) != self.s.size:
            n = self.values.shape[-1] if self.values.ndim > 1 else 1
            raise ShapeError("values", (self.s.size, n), self.values.shape)
        spline = make_interp_spline(self.s, self.values, k=5)
        self._knots = np.unique(spline.t)[:-1]
        # Each piece as a polynomial, highest power first: scipy's own evaluation takes 30 us a time
        taylor = [spline(self._knots, nu=k) / factorial(k) for k in range(5, -1, -1)]
        self._pieces = np.ascontiguousarray(np.stack(taylor, axis=1))  # (pieces, 6, n)

    def __call__(self, s: float) -> Sample:
        """Value and derivatives with respect to s."""
        i = max(int(self._knots.searchsorted(s, side="right")) - 1, 0)
        x = s - self._knots[i]
        x2 = x * x
        x3 = x2 * x
        powers = np.array(
            [
                [x2 * x3, x2 * x2, x3, x2, x, 1.0],
                [5.0 * x2 * x2, 4.0 * x3, 3.0 * x2, 2.0 * x, 1.0, 0.0],
                [20.0 * x3, 12.0 * x2, 6.0 * x, 2.0, 0.0, 0.0],
            ]
        )
        return Sample(*(powers @ self._pieces[i]))  # (3, 6) @ (6, n)
