"""The questions of the course that the grader's tests run on."""

from __future__ import annotations

import numpy as np

import labkit as lk
from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

DOWN, UP = ([1.0, 0.0, 0.5], [0.5, 0.0, 0.5]), ([0.0, 2.0, 1.0], [0.0, 0.0, 1.0])


def bang_bang(t, duration):
    """The right answer to bang_bang."""
    if t < 0.0:
        return 0.0, 0.0, 0.0
    if t >= duration:
        return 1.0, 0.0, 0.0
    a, left = 4.0 / duration**2, duration - t
    if t < duration / 2.0:
        return a * t**2 / 2.0, a * t, a
    return 1.0 - a * left**2 / 2.0, a * left, -a


def by_the_share(t, duration):
    """A right answer in other words."""
    x = min(max(t / duration, 0.0), 1.0)
    s = 2.0 * x * x if x < 0.5 else 1.0 - 2.0 * (1.0 - x) ** 2
    a = 4.0 / duration**2 * (0.0 <= t < duration)
    return s, 4.0 * min(x, 1.0 - x) / duration, a if x < 0.5 else -a


def goes_on(t, duration):
    """A known mistake: no rest outside the motion."""
    a, left = 4.0 / duration**2, duration - t
    if t < duration / 2.0:
        return a * t**2 / 2.0, a * t, a
    return 1.0 - a * left**2 / 2.0, a * left, -a


def half_as_fast(t, duration):
    """A known mistake: half of the acceleration."""
    return tuple(x / 2.0 for x in bang_bang(t, duration))


def circle(s, start, centre):
    """The right answer to circle."""
    start, centre = np.array(start), np.array(centre)
    x, y, _ = start - centre
    c, d, w = np.cos(2.0 * np.pi * s), np.sin(2.0 * np.pi * s), 2.0 * np.pi
    r, n = (
        np.array([c * x - d * y, d * x + c * y, 0.0]),
        np.array([-d * x - c * y, c * x - d * y, 0.0]),
    )
    return lk.Sample(centre + r, w * n, -w * w * r)


def backwards(s, start, centre):
    """A known mistake: the other way round."""
    found = circle(-s, start, centre)
    return lk.Sample(found.position, -found.velocity, found.acceleration)


def length(points):
    """The right answer to length."""
    total = 0.0
    for k in range(len(points) - 1):
        x, y = points[k + 1][0] - points[k][0], points[k + 1][1] - points[k][1]
        total = total + float(np.hypot(x, y))
    return total


def of_the_ends(points):
    """A known mistake: the distance of the ends."""
    return length([points[0], points[-1]])


def _polylines(random):
    for _ in range(3):
        yield call(random.uniform(-1.0, 1.0, (4, 2)).tolist())


def _times(random):
    for T in random.uniform(0.5, 8.0, 4):
        yield call(random.uniform(0.1, 0.9) * T, T)
        yield call(-T, T)
        yield call(2.0 * T, T)


def _circles(random):
    for s in random.uniform(0.0, 1.0, 4):
        yield call(s, random.uniform(-1.0, 1.0, 3).tolist(), random.uniform(2.0, 3.0, 3).tolist())


PROBLEMS = (
    Problem(
        "bang_bang",
        3,
        "Return `(s, ds, dds)` at time `t`.",
        bang_bang,
        (
            Trial("the first half", (call(0.5, 2.0),), weight=0.0),
            Trial(
                "the whole motion",
                (call(1.5, 2.0), call(0.3, 4.0), call(-1.0, 2.0), call(3.0, 2.0)),
                _times,
                "other durations",
            ),
        ),
        Close(parts=("s", "ds", "dds")),
        withheld=("labkit.BangBang",),
        outcomes=("motion",),
        hints=("Draw the acceleration.", "It is 4 / T².", "Mirror the first half."),
        wrong=(
            Wrong("no rest", "Outside the motion the reference is at rest.", goes_on, "Rest."),
            Wrong("half as fast", "The acceleration is 4 / T², not 2 / T².", half_as_fast),
        ),
        variants=(by_the_share,),
    ),
    Problem(
        "circle",
        4,
        "Return the `lk.Sample` of a level circle.",
        circle,
        (
            Trial("where it begins", (call(0.0, *UP),), weight=0.0),
            Trial("on its way", (call(0.25, *UP), call(0.6, *DOWN)), _circles, "other circles"),
        ),
        withheld=("labkit.Circle",),
        hints=("Use cos and sin.", "Turn start - centre.", "Differentiate twice."),
        wrong=(Wrong("backwards", "It runs against the clock.", backwards),),
    ),
    Problem(
        "length",
        2,
        "Return the length of a polyline in the plane.",
        length,
        (
            Trial("one line", (call([[0.0, 0.0], [3.0, 4.0]]),), weight=0.0),
            Trial(
                "some lines", (call([[0.0, 0.0], [3.0, 4.0], [3.0, 0.0]]),), _polylines, "others"
            ),
        ),
        hints=("Add the parts.", "Use hypot.", "Go through pairs."),
        wrong=(Wrong("the ends", "Every corner counts.", of_the_ends),),
    ),
)
