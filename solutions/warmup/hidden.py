"""Hidden cases of notebook 00."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import Call
from labkit.course.authoring.problem import call

Random = np.random.Generator
DOWN = np.diag([1.0, -1.0, -1.0])


def state(random: Random) -> lk.State:
    """Any state of the joints."""
    return lk.State(0.7, random.uniform(-1.0, 1.0, 7), random.uniform(-0.5, 0.5, 7))


def sample(random: Random) -> lk.Sample:
    """Any sample of a joint trajectory."""
    return lk.Sample(*(random.uniform(-1.0, 1.0, 7) for _ in range(3)))


def pose(random: Random) -> Any:
    """Any pose within reach."""
    return lk.se3.pose(lk.se3.rotation(random.uniform(-1.6, 1.6, 3)), random.uniform(-0.8, 0.8, 3))


def errors(random: Random) -> Iterator[Call]:
    """Any targets and states."""
    for _ in range(3):
        yield call(sample(random), state(random))
    wrist = random.uniform(2.6, 3.0) * np.eye(7)[random.choice((4, 6))]
    yield call(sample(random)._replace(position=wrist), state(random)._replace(q=-wrist))


def chains_of_shifts(random: Random) -> Iterator[Call]:
    """A camera at the tip, and frames that are only shifted."""
    wt, cm = (lk.se3.pose(np.eye(3), x) for x in random.uniform(-0.8, 0.8, (2, 3)))
    yield call(wt, np.eye(4), cm)


def chains(random: Random) -> Iterator[Call]:
    """Any poses."""
    for _ in range(3):
        yield call(pose(random), pose(random), pose(random))


def turns_about_z(random: Random) -> Iterator[Call]:
    """A level tool turned about the vertical, and an orientation without error."""
    for angle in random.uniform(0.1, 0.6, 2):
        start = random.uniform(-1.0, 1.0)
        yield call(*(lk.se3.rotation([0.0, 0.0, a]) for a in (start + angle, start)))
    there = np.diag(random.choice([[-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]))
    yield call(there, there)


def _tilt(random: Random, axis: int, least: float, most: float) -> Call:
    """A gripper that points down, with any yaw, tilted by an angle between least and most."""
    angle = random.uniform(least, most) * random.choice((-1.0, 1.0))
    down = lk.se3.rotation([0.0, 0.0, random.uniform(-1.5, 1.5)]) @ DOWN
    return call(down, down @ lk.se3.rotation(angle * np.eye(3)[axis]))


def rolls(random: Random) -> Iterator[Call]:
    """A gripper that points down, rolled; at 0.1 rad a tangent is off by eight tolerances."""
    for _ in range(2):
        yield _tilt(random, 0, 0.1, 0.3)


def pitches(random: Random) -> Iterator[Call]:
    """A gripper that points down, pitched, once beyond 90 degrees."""
    for least, most in ((0.1, 0.3), (1.7, 2.6)):
        yield _tilt(random, 1, least, most)


def big_turns(random: Random) -> Iterator[Call]:
    """Turns of up to 160 degrees between any orientations."""
    for angle in random.uniform(1.2, 2.8, 4):
        axis = random.standard_normal(3)
        R = lk.se3.rotation(random.uniform(-1.5, 1.5, 3))
        yield call(lk.se3.rotation(angle * axis / np.linalg.norm(axis)) @ R, R)
