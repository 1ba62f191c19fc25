"""Figures of the feedback page as SVG text, in the colours of the page, light or dark.

Any numbers can be drawn: those that are not finite are left out, and no difference of two numbers
is taken that could leave the range of floating point.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from math import ceil, floor, isfinite, log10

WIDTH, HEIGHT = 460, 200
LEFT, RIGHT, TOP, BOTTOM = 52, 18, 14, 38
LEAST = 1e-300
"""Of an axis; what spreads less is drawn as if it were equal."""


def curve(
    t: Sequence[float], y: Sequence[float], labels: tuple[str, str], alt: str, limit: float | None
) -> str:
    """A curve over time.

    Args:
        t: Times.
        y: Values, none negative.
        labels: Of both axes.
        alt: The figure in words.
        limit: Drawn as a dashed line, where there is one.
    """
    axes = _Axes(t, [0.0, 1e-9, *y, limit or 0.0])
    drawn = [pair for pair in zip(t, y, strict=True) if all(map(isfinite, pair))]
    points = " ".join(axes.point(a, b) for a, b in drawn)
    parts = [*axes.drawn(labels), f'<polyline class="yours" points="{points}"/>']
    if limit is not None and isfinite(limit):
        ends = " ".join(axes.point(a, limit) for a in axes.across)
        parts.append(f'<polyline class="limit" points="{ends}"/>')
    return _figure(parts, alt)


def side_by_side(expected: Sequence[float], given: Sequence[float], alt: str) -> str:
    """The numbers of an answer, crosses, beside those expected, rings."""
    axes = _Axes([0.5, len(expected) + 0.5], [0.0, *expected, *given])
    parts = [*axes.drawn(("number in the answer", ""), whole=True)]
    for k, (wanted, came) in enumerate(zip(expected, given, strict=True), start=1):
        if not (isfinite(wanted) and isfinite(came)):
            continue
        x, ring, cross = axes.x(k), axes.y(wanted), axes.y(came)
        parts += [
            f'<line class="grid" x1="{x:.1f}" y1="{ring:.1f}" x2="{x:.1f}" y2="{cross:.1f}"/>',
            f'<circle class="wanted" cx="{x:.1f}" cy="{ring:.1f}" r="5"/>',
            f'<path class="yours" d="M{x - 4:.1f} {cross - 4:.1f}l8 8m0 -8l-8 8"/>',
        ]
    return _figure(parts, alt)


class _Axes:
    """Where numbers lie in the picture; either axis goes from its least number to its largest."""

    def __init__(self, across: Sequence[float], up: Sequence[float]) -> None:
        self.across, self.up = _range(across), _range(up)

    def x(self, value: float) -> float:
        return LEFT + _share(value, self.across) * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        return HEIGHT - BOTTOM - _share(value, self.up) * (HEIGHT - TOP - BOTTOM)

    def point(self, across: float, up: float) -> str:
        return f"{self.x(across):.1f},{self.y(up):.1f}"

    def drawn(self, labels: tuple[str, str], *, whole: bool = False) -> Iterator[str]:
        right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
        for value in _ticks(self.up, 4):
            y = self.y(value)
            yield f'<line class="grid" x1="{LEFT}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}"/>'
            yield f'<text x="{LEFT - 6}" y="{y + 4:.1f}" class="end">{value:g}</text>'
        for value in _ticks(self.across, 6, least=1.0 if whole else 0.0):
            x = self.x(value)
            yield f'<text x="{x:.1f}" y="{bottom + 16}" class="middle">{value:g}</text>'
        yield f'<text x="{right}" y="{HEIGHT - 4}" class="end">{escape(labels[0])}</text>'
        yield f'<text x="4" y="{TOP - 3}">{escape(labels[1])}</text>'


def _range(numbers: Sequence[float]) -> tuple[float, float]:
    """The least and the largest number that is finite, apart enough to lie on an axis."""
    finite = [x for x in numbers if isfinite(x)] or [0.0]
    low, high = min(finite), max(finite)
    size = max(abs(low), abs(high))
    if high / 2 - low / 2 > max(LEAST, 1e-12 * size):
        return low, high
    return (min(low, 0.0), max(high, 0.0)) if size > LEAST else (0.0, 1.0)


def _share(value: float, axis: tuple[float, float]) -> float:
    """Where a number lies on an axis, 0 at its start and 1 at its end."""
    low, high = axis
    return (value / 2 - low / 2) / (high / 2 - low / 2)


def _ticks(axis: tuple[float, float], most: int, least: float = 0.0) -> list[float]:
    """Round numbers on an axis, at least so far apart."""
    low, high = axis
    rough = max(high / most - low / most, least)
    power = 10.0 ** floor(log10(rough))
    step = next(k * power for k in (1, 2, 5, 10) if k * power >= rough)
    return [k * step for k in range(ceil(low / step - 1e-9), floor(high / step + 1e-9) + 1)]


def _figure(parts: Sequence[str], alt: str) -> str:
    head = f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(alt)}">'
    return "\n".join([head, *parts, "</svg>"])
