"""Answers of notebook 01: time scalings, the circle, their composition, and segments in a row."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np

import labkit as lk

Scaling = Callable[[float], tuple[float, float, float]]
Path = Callable[[float], lk.Sample]


def bang_bang(t: float, duration: float) -> tuple[float, float, float]:
    """Constant acceleration, then as much deceleration (the report's equations 2 to 4)."""
    if t < 0.0:
        return 0.0, 0.0, 0.0
    if t >= duration:
        return 1.0, 0.0, 0.0
    a = 4.0 / duration**2  # half the distance in half the time: a (T/2)^2 / 2 = 1/2
    if t < duration / 2.0:
        return a * t**2 / 2.0, a * t, a
    left = duration - t
    return 1.0 - a * left**2 / 2.0, a * left, -a


def duration_for(distance: float, v_max: float, a_max: float) -> float:
    """Ramps and cruise, within limits in metres (Lynch & Park, section 9.2.2)."""
    v = min(v_max, sqrt(distance * a_max))  # a short distance never reaches v_max
    return distance / v + v / a_max


def trapezoid(t: float, distance: float, v_max: float, a_max: float) -> tuple[float, float, float]:
    """Accelerate, cruise, brake, with limits in metres (Lynch & Park, section 9.2.2)."""
    v = min(v_max, sqrt(distance * a_max))  # a short distance never reaches v_max
    ramp = v / a_max
    duration = distance / v + ramp
    if t < 0.0:
        return 0.0, 0.0, 0.0
    if t >= duration:
        return 1.0, 0.0, 0.0
    if t < ramp:
        way, speed, acceleration = a_max * t**2 / 2.0, a_max * t, a_max
    elif t < duration - ramp:
        way, speed, acceleration = v * (t - ramp / 2.0), v, 0.0
    else:
        left = duration - t
        way, speed, acceleration = distance - a_max * left**2 / 2.0, a_max * left, -a_max
    return way / distance, speed / distance, acceleration / distance


def circle(s: float, start: Any, centre: Any) -> lk.Sample:
    """Once round the vertical axis through ``centre``, at the height of ``start``."""
    x, y = start[0] - centre[0], start[1] - centre[1]
    w = 2.0 * pi
    c, d = cos(w * s), sin(w * s)
    out = np.array([c * x - d * y, d * x + c * y, 0.0])
    on = np.array([-out[1], out[0], 0.0])
    axis = np.array([centre[0], centre[1], start[2]])
    return lk.Sample(axis + out, w * on, -w * w * out)


def compose(path: Path, scaling: Scaling, t: float) -> lk.Sample:
    """The path on its schedule, by the chain rule (Lynch & Park, section 9.1)."""
    s, ds, dds = scaling(t)
    x, dx, ddx = path(s)
    return lk.Sample(x, dx * ds, ddx * ds**2 + dx * dds)


def segment_at(durations: Sequence[float], t: float) -> tuple[int, float]:
    """Which segment is on at time ``t``, and for how long it has been."""
    starts = [0.0]
    for duration in durations[:-1]:
        starts.append(starts[-1] + duration)
    index = max(0, bisect_right(starts, t) - 1)
    return index, t - starts[index]
