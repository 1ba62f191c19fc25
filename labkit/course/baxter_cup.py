"""The Baxter Cup: a tour and a moving tag, for any controller, with a load, noise and one push.

A seed draws the corners of the tour, the path of the tag, the load and the push.  While the arm
follows the tag, the controller knows only where the tag was in the last picture.  The seeds here
are public and for practice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np

from ..arm import Arm
from ..errors import Diverged
from ..log import Log
from ..model import Model
from ..paths import Circle, Line, Quintic
from ..plant import BAXTER
from ..run import Controller, run
from ..scene import Push
from ..shapes import Array
from ..trajectory import AnySample, Chain, PosePath, Target, Trajectory
from ..world import World

PUBLIC_SEEDS = (1, 2, 3)
BENCHMARKS = {
    "feed-forward only": (56.27, 61.89, 58.7),
    "joint impedance": (72.36, 56.67, 70.24),
    "joint torque": (25.19, 20.17, 25.62),
    "joint velocity": (31.77, 34.97, 32.91),
}
"""Scores of the course's own controllers on each public seed, in [mm].

`solutions.study.cup` measures them.
"""

CORNERS = 3
BOX = ((-0.02, 0.12), (-0.15, 0.05), (-0.05, 0.10))
"""The ranges of a tour's corners along x, y and z, relative to the ready tip, in [m]."""
SPEED, ACCELERATION = 0.3, 1.0
"""Limits of the tip on the tour, in [m/s] and [m/s^2]."""
LAP = 6.0
"""Duration of one lap of the tag, in [s]."""
PICTURES, AGE = 15.0, 0.08
"""Rate of the tag's pictures, in [Hz], and age of a picture once its tag is found, in [s]."""
LOAD, FORCE, PUSHED = (0.2, 0.8), 25.0, 0.3
"""Range of the load, in [kg]; force of the push, in [N], and its duration, in [s]."""


@dataclass(frozen=True)
class CupRun:
    """One run in the Baxter Cup.

    Attributes:
        seed: The seed from which the run was drawn.
        score: RMS distance of the tip from where it should have been, in [mm]; infinite if the
            arm diverged.
        log: The run; its target is the one that the controller was given.
    """

    seed: int
    score: float
    log: Log


def benchmarks() -> dict[str, float]:
    """The published benchmarks, in [mm], in ascending order."""
    means = {name: float(np.mean(scores)) for name, scores in BENCHMARKS.items()}
    return dict(sorted(means.items(), key=lambda pair: pair[1]))


def cup(make: Callable[[Model], Controller], workspace: bool = False) -> tuple[CupRun, ...]:
    """Run a controller on the public seeds and print its scores beside the benchmarks.

    Args:
        make: A function that takes the model, which does not include the load, and returns a new
            controller, which is a function of state and target.
        workspace: Whether the controller follows tip poses instead of joint angles.

    Returns:
        A run for each public seed.
    """
    runs = tuple(cup_run(make, seed, workspace) for seed in PUBLIC_SEEDS)
    mine = float(np.mean([one.score for one in runs]))
    published = benchmarks()
    for name, score in sorted((published | {"yours": mine}).items(), key=lambda pair: pair[1]):
        print(f"{score:8.1f} mm  {name}")
    print(
        f"{sum(mine < score for score in published.values())} of {len(published)} benchmarks beaten"
    )
    return runs


def cup_run(make: Callable[[Model], Controller], seed: int, workspace: bool = False) -> CupRun:
    """Run a controller on one seed, as `cup` does.

    Args:
        make: As for `cup`.
        seed: The seed from which the run is drawn.
        workspace: As for `cup`.
    """
    random = np.random.default_rng([seed, 2007])
    known = replace(BAXTER, name="cup")
    model = Model("left", known)
    ready = model.robot.ready
    tour, lap = _tour(model.pose(ready), random)
    wanted = Chain([*tour.parts, lap]) if workspace else model.joint_trajectory(
        Chain([*tour.parts, lap]), ready
    )  # fmt: skip
    plant = replace(known, payload=float(random.uniform(*LOAD)))
    direction = random.standard_normal(3)
    begins = float(random.uniform(0.1, 0.9)) * tour.duration
    push = Push(FORCE * direction / np.linalg.norm(direction), start=begins, duration=PUSHED)
    given = _sampled_and_delayed(wanted, tour.duration)
    with Arm("left", plant, seed, q0=ready, world=World(things=[push])) as arm:
        try:
            log = run(arm, given, make(model), 200.0, wanted.duration)
        except Diverged as error:
            return CupRun(seed, np.inf, cast(Log, error.log))
    tips = np.array([model.pose(q)[:3, 3] for q in log.q])
    apart = tips - np.array([_place(model, wanted(t)) for t in log.t])
    return CupRun(seed, 1e3 * float(np.sqrt((apart**2).sum(axis=1).mean())), log)


def _tour(T_wt: Array, random: np.random.Generator) -> tuple[Chain, Trajectory]:
    """The tour from corner to corner and back to the start, and the circle of the tag after it."""
    p, R = T_wt[:3, 3], T_wt[:3, :3]
    low, high = np.transpose(BOX)
    corners = [p, *(p + random.uniform(low, high, (CORNERS, 3))), p]
    lines = [Line(a, b) for a, b in pairwise(corners)]
    legs = [
        Trajectory(PosePath(line, R), Quintic.within(line.length, SPEED, ACCELERATION))
        for line in lines
    ]
    turn, radius = random.uniform(-np.pi, 0.0), random.uniform(0.05, 0.08)
    centre = p + radius * np.array([np.cos(turn), np.sin(turn), 0.0])
    return Chain(legs), Trajectory(PosePath(Circle(p, centre), R), Quintic(LAP))


def _sampled_and_delayed(wanted: Target, since: float) -> Target:
    """A target that is known exactly until `since`, and after that only from delayed pictures."""

    def given(t: float) -> AnySample:
        if t < since:
            return wanted(t)
        shown = max(since, np.floor((t - AGE) * PICTURES) / PICTURES)
        place, first, second = wanted(shown)
        return type(wanted(t))(place, 0.0 * first, 0.0 * second)

    return given


def _place(model: Model, sample: AnySample) -> Array:
    """The tip position that a sample demands, shape (3,) in [m]."""
    where = sample[0]
    T_wt = where if where.ndim == 2 else model.pose(where)
    place: Array = T_wt[:3, 3]
    return place
