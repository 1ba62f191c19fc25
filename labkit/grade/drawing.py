"""Figures of the feedback page as SVG text, in the colours of the page, light or dark."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from math import ceil, floor, log10

WIDTH, HEIGHT = 460, 200
LEFT, RIGHT, TOP, BOTTOM = 52, 18, 14, 38


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
    axes = _Axes((t[0], t[-1]), (0.0, max([*y, limit or 0.0, 1e-9])))
    points = " ".join(axes.point(a, b) for a, b in zip(t, y, strict=True))
    parts = [*axes.drawn(labels), f'<polyline class="yours" points="{points}"/>']
    if limit is not None:
        ends = " ".join(axes.point(a, limit) for a in (t[0], t[-1]))
        parts.append(f'<polyline class="limit" points="{ends}"/>')
    return _figure(parts, alt)


def side_by_side(expected: Sequence[float], given: Sequence[float], alt: str) -> str:
    """The numbers of an answer, crosses, beside those expected, rings."""
    low, high = min(0.0, *expected, *given), max(0.0, *expected, *given)
    axes = _Axes((0.5, len(expected) + 0.5), (low, high if high > low else low + 1.0))
    parts = [*axes.drawn(("number in the answer", ""), whole=True)]
    for k, (wanted, came) in enumerate(zip(expected, given, strict=True), start=1):
        x, ring, cross = axes.x(k), axes.y(wanted), axes.y(came)
        parts += [
            f'<line class="grid" x1="{x:.1f}" y1="{ring:.1f}" x2="{x:.1f}" y2="{cross:.1f}"/>',
            f'<circle class="wanted" cx="{x:.1f}" cy="{ring:.1f}" r="5"/>',
            f'<path class="yours" d="M{x - 4:.1f} {cross - 4:.1f}l8 8m0 -8l-8 8"/>',
        ]
    return _figure(parts, alt)


class _Axes:
    """Where numbers lie in the picture."""

    def __init__(self, across: tuple[float, float], up: tuple[float, float]) -> None:
        self.across, self.up = across, up

    def x(self, value: float) -> float:
        low, high = self.across
        return LEFT + (value - low) / (high - low) * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        low, high = self.up
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)

    def point(self, across: float, up: float) -> str:
        return f"{self.x(across):.1f},{self.y(up):.1f}"

    def drawn(self, labels: tuple[str, str], *, whole: bool = False) -> Iterator[str]:
        right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
        for value in _ticks(*self.up, 4):
            y = self.y(value)
            yield f'<line class="grid" x1="{LEFT}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}"/>'
            yield f'<text x="{LEFT - 6}" y="{y + 4:.1f}" class="end">{value:g}</text>'
        for value in _ticks(*self.across, 6):
            if whole and value % 1.0:
                continue
            x = self.x(value)
            yield f'<text x="{x:.1f}" y="{bottom + 16}" class="middle">{value:g}</text>'
        yield f'<text x="{right}" y="{HEIGHT - 4}" class="end">{escape(labels[0])}</text>'
        yield f'<text x="4" y="{TOP - 3}">{escape(labels[1])}</text>'


def _ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers from one end to the other."""
    rough = (high - low) / most
    power = 10.0 ** floor(log10(rough))
    step = next(k * power for k in (1, 2, 5, 10) if k * power >= rough)
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _figure(parts: Sequence[str], alt: str) -> str:
    head = f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(alt)}">'
    return "\n".join([head, *parts, "</svg>"])
