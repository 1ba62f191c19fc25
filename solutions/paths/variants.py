"""Right answers to notebook 01 in other forms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import labkit as lk

from .answers import Path, Scaling


def bang_bang_list(t: float, duration: float) -> Any:
    """A list, by clipping the time and mirroring the second half."""
    x = float(np.clip(t / duration, 0.0, 1.0))
    inside = 0.0 <= t < duration
    if x < 0.5:
        return [2 * x * x, 4 * x / duration * inside, 4 / duration**2 * inside]
    y = 1 - x
    return [1 - 2 * y * y, 4 * y / duration * inside, -4 / duration**2 * inside]


def bang_bang_array(t: float, duration: float) -> Any:
    """An array, with numpy.select."""
    x = t / duration
    masks = [x < 0, x < 0.5, x < 1]
    s = np.select(masks, [0.0, 2 * x**2, 1 - 2 * (1 - x) ** 2], 1.0)
    ds = np.select(masks, [0.0, 4 * x, 4 * (1 - x)], 0.0) / duration
    dds = np.select(masks, [0.0, 4.0, -4.0], 0.0) / duration**2
    return np.array([s, ds, dds])


def duration_by_cases(distance: float, v_max: float, a_max: float) -> Any:
    """Trapezoid or triangle, each by its own formula."""
    if distance < v_max**2 / a_max:
        return 2 * np.sqrt(distance / a_max)
    cruise = (distance - v_max**2 / a_max) / v_max
    return np.array(2 * v_max / a_max + cruise)


def trapezoid_by_phases(t: float, distance: float, v_max: float, a_max: float) -> Any:
    """Clips the time into the three phases and adds them up."""
    v = min(v_max, (distance * a_max) ** 0.5)
    ramp, cruise = v / a_max, distance / v - v / a_max
    t1 = min(max(t, 0.0), ramp)
    t2 = min(max(t - ramp, 0.0), cruise)
    t3 = min(max(t - ramp - cruise, 0.0), ramp)
    way = a_max * t1**2 / 2 + v * t2 + v * t3 - a_max * t3**2 / 2
    if t < 0 or t >= 2 * ramp + cruise:
        return way / distance, 0.0, 0.0
    speed = a_max * t1 - a_max * t3
    push = a_max if t < ramp else (0.0 if t < ramp + cruise else -a_max)
    return way / distance, speed / distance, push / distance


def circle_by_rotation(s: float, start: Any, centre: Any) -> Any:
    """Turns the spoke with rotation matrices."""
    p, c = np.asarray(start, float), np.asarray(centre, float)
    spoke = np.array([p[0] - c[0], p[1] - c[1], 0.0])
    R = lk.se3.rotation([0.0, 0.0, 2 * np.pi * s])
    W = 2 * np.pi * lk.se3.hat([0.0, 0.0, 1.0])
    out = R @ spoke
    return lk.Sample(np.array([c[0], c[1], p[2]]) + out, W @ out, W @ W @ out)


def circle_tuple(s: float, start: Any, centre: Any) -> Any:
    """Polar coordinates, as a tuple of lists."""
    r = np.hypot(start[0] - centre[0], start[1] - centre[1])
    a = np.arctan2(start[1] - centre[1], start[0] - centre[0]) + 2 * np.pi * s
    w = 2 * np.pi
    return (
        [centre[0] + r * np.cos(a), centre[1] + r * np.sin(a), start[2]],
        [-w * r * np.sin(a), w * r * np.cos(a), 0],
        [-w * w * r * np.cos(a), -w * w * r * np.sin(a), 0],
    )


def compose_matrix(path: Path, scaling: Scaling, t: float) -> Any:
    """The chain rule as one matrix product."""
    s, ds, dds = scaling(t)
    return lk.Sample(*(np.array([[1, 0, 0], [0, ds, 0], [0, dds, ds**2]]) @ np.array(path(s))))


def segment_by_searchsorted(durations: Sequence[float], t: float) -> Any:
    """With numpy's cumulative sums."""
    starts = np.concatenate([[0.0], np.cumsum(durations)[:-1]])
    k = max(int(np.searchsorted(starts, t, side="right")) - 1, 0)
    return [k, t - starts[k]]


def segment_by_walking(durations: Sequence[float], t: float) -> Any:
    """Walks along the segments until one ends later."""
    begun = 0.0
    for k, duration in enumerate(durations):
        if t < begun + duration or k == len(durations) - 1:
            return k, t - begun
        begun += duration
    raise AssertionError
