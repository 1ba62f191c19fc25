"""Hidden cases of notebook 01."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import labkit as lk
from labkit.course import Call
from labkit.course.authoring.problem import call

Random = np.random.Generator


def bang_bang_first(random: Random) -> Iterator[Call]:
    """Times in the first half."""
    for T in random.uniform(0.5, 8.0, 3):
        yield call(random.uniform(0.05, 0.45) * T, T)


def bang_bang_second(random: Random) -> Iterator[Call]:
    """Times in the second half, one of them just after the middle."""
    for T in random.uniform(0.5, 8.0, 3):
        yield call(random.uniform(0.55, 0.95) * T, T)
        yield call(0.5 * T + 1e-3, T)


def bang_bang_outside(random: Random) -> Iterator[Call]:
    """Times before the start and after the end."""
    for T in random.uniform(0.5, 8.0, 2):
        yield call(-random.uniform(0.1, 2.0), T)
        yield call(T + random.uniform(0.1, 5.0), T)


def bang_bang_all(random: Random) -> Iterator[Call]:
    """A whole motion of another length."""
    T = random.uniform(0.5, 8.0)
    for x in np.linspace(-0.23, 1.27, 14):
        yield call(x * T, T)


def durations_long(random: Random) -> Iterator[Call]:
    """Distances long enough to cruise."""
    for share in random.uniform(1.5, 4.0, 2):
        v, a = random.uniform(0.1, 0.5), random.uniform(0.3, 2.0)
        yield call(share * v * v / a, v, a)


def durations_short(random: Random) -> Iterator[Call]:
    """Distances too short for v_max: with room for less than one ramp, and for more."""
    for share in (random.uniform(0.05, 0.4), random.uniform(0.6, 0.9)):
        v, a = random.uniform(0.5, 0.8), random.uniform(0.5, 2.0)
        yield call(share * v * v / a, v, a)


def trapezoid_long(random: Random) -> Iterator[Call]:
    """Distances long enough to cruise."""
    for _ in range(3):
        v, a = random.uniform(0.1, 0.5), random.uniform(0.3, 2.0)
        d = random.uniform(1.5, 4.0) * v * v / a
        T = d / v + v / a
        for x in random.uniform(0.02, 0.98, 3):
            yield call(x * T, d, v, a)


def trapezoid_short(random: Random) -> Iterator[Call]:
    """Distances too short for v_max: one centimetre, and one with room for a single ramp."""
    for share in (None, random.uniform(0.05, 0.4), random.uniform(0.6, 0.9)):
        v, a = random.uniform(0.5, 0.8), random.uniform(0.5, 2.0)
        d = 0.01 if share is None else share * v * v / a
        T = 2.0 * np.sqrt(d / a)
        for x in random.uniform(0.02, 0.98, 3):
            yield call(x * T, d, v, a)


def trapezoid_all(random: Random) -> Iterator[Call]:
    """Whole motions, long and short, with times before and after them."""
    for d in (random.uniform(0.4, 0.9), random.uniform(0.06, 0.09)):
        for t in np.linspace(-0.4, 6.0, 12):
            yield call(t, d, 0.25, 0.6)


def circle_flat(random: Random) -> Iterator[Call]:
    """Starts at angle zero, level with the centre."""
    for s in random.uniform(0.0, 1.0, 3):
        c = random.uniform((0.5, -0.3, 0.0), (0.8, 0.3, 0.3))
        yield call(s, c + (random.uniform(0.05, 0.3), 0.0, 0.0), c)


def circle_height(random: Random) -> Iterator[Call]:
    """A centre above or below the start."""
    for s in random.uniform(0.0, 1.0, 3):
        c = random.uniform((0.5, -0.3, 0.0), (0.8, 0.3, 0.3))
        yield call(s, c + (0.15, 0.0, random.choice((-1.0, 1.0)) * random.uniform(0.1, 0.3)), c)


def circle_yaw(random: Random) -> Iterator[Call]:
    """Starts at all angles around the centre."""
    for yaw in (2.3, -2.9, *random.uniform(-np.pi, np.pi, 2)):
        c = random.uniform((0.5, -0.3, 0.0), (0.8, 0.3, 0.3))
        r = random.uniform(0.05, 0.3)
        yield call(random.uniform(), c + (r * np.cos(yaw), r * np.sin(yaw), 0.0), c)


def circle_all(random: Random) -> Iterator[Call]:
    """Any start and centre, including the return to the start."""
    for s in (0.0, *random.uniform(0.0, 1.0, 4), 1.0):
        c = random.uniform((0.5, -0.3, 0.0), (0.8, 0.3, 0.3))
        yield call(s, c + random.uniform(-0.3, 0.3, 3), c)


def _line(random: Random) -> lk.Line:
    a, b = random.uniform((0.4, -0.3, 0.0), (0.9, 0.3, 0.4), (2, 3))
    return lk.Line(a, b)


def _circle(random: Random) -> lk.Circle:
    c = random.uniform((0.5, -0.3, 0.0), (0.8, 0.3, 0.3))
    return lk.Circle(c + (random.uniform(0.1, 0.3), random.uniform(-0.2, 0.2), 0.1), c)


def compose_steady(random: Random) -> Iterator[Call]:
    """A line at constant speed."""
    line = _line(random)
    schedule = lk.Trapezoid(line.length, 0.2, 1.0)
    yield call(line, schedule, 0.5 * schedule.duration)


def compose_line(random: Random) -> Iterator[Call]:
    """A line that speeds up or brakes."""
    for T in random.uniform(1.0, 6.0, 3):
        yield call(_line(random), lk.Quintic(T), random.uniform(0.1, 0.9) * T)


def compose_circle(random: Random) -> Iterator[Call]:
    """A circle at constant speed."""
    for _ in range(3):
        path = _circle(random)
        schedule = lk.Trapezoid(path.length, 0.3, 1.0)
        yield call(path, schedule, 0.5 * schedule.duration)


def compose_all(random: Random) -> Iterator[Call]:
    """Any path on any schedule, also before its start and after its end."""
    for path in (_line(random), _circle(random)):
        for T in random.uniform(1.0, 6.0, 2):
            for x in (-0.2, *random.uniform(0.0, 1.0, 3), 1.3):
                yield call(path, lk.Cubic(T), x * T)


def _durations(random: Random) -> list[float]:
    return [float(x) for x in random.uniform(0.3, 3.0, random.integers(2, 7))]


def segment_inside(random: Random) -> Iterator[Call]:
    """Times inside a segment."""
    for _ in range(3):
        durations = _durations(random)
        k = int(random.integers(1, len(durations)))
        yield call(durations, sum(durations[:k]) + 0.4 * durations[k])


def segment_ends(random: Random) -> Iterator[Call]:
    """The start and the end, and times before and after them."""
    durations = _durations(random)
    total = sum(durations)
    for t in (0.0, -0.5, total, total + random.uniform(0.1, 5.0)):
        yield call(durations, t)


def segment_joints(random: Random) -> Iterator[Call]:
    """The joints between segments, where the later one is active."""
    for durations in ([0.5, 1.0, 0.25, 2.0], [2.0, 0.5]):
        for k in range(1, len(durations)):
            yield call(durations, sum(durations[:k]))


def segment_all(random: Random) -> Iterator[Call]:
    """A whole tour, sampled."""
    durations = [0.25 * int(n) for n in random.integers(1, 8, 5)]
    for t in np.arange(-0.5, sum(durations) + 1.0, 0.25):
        yield call(durations, float(t))
