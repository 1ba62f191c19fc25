"""Hidden cases of notebook 07."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from labkit.course import Call, Choice
from labkit.course.authoring.problem import call
from labkit.recordings import LINE, Trials, read_trials
from labkit.shapes import Array

Random = np.random.Generator

ON_THE_LINE = read_trials(LINE)
UNSEEN = read_trials(Path(__file__).with_name("trials.json"))
UNSEEN_LIMIT = 3.9
"""The largest error allowed on unseen cases, in [mm], met by gains of 12.4 to 38 without D."""
RESERVE = 1.3
"""This multiple of the chosen Kp must meet the limit, too, which leaves 12.4 to 29."""
LINE_LIMIT = 3.05
"""The largest error allowed on the line, in [mm]; gains that pass unseen cases leave up to 3.0."""
FAR = 1.8
"""This multiple of the chosen Kp must meet it, too; so no gains pass on the line of both arms."""


def stiffer(trials: Trials, factor: float) -> Trials:
    """The same trials where each Kp does what ``factor`` times Kp did.

    Gains per second have this effect on an arm that takes `factor` times as long for everything,
    its path included.  Beyond the recorded gains there are no trials, so the error counts as
    infinite there.
    """
    if factor == 1.0:
        return trials
    Kp = tuple(x / factor for x in trials.Kp)
    none = [None] * len(trials.Kd)
    return replace(
        trials, Kp=(*Kp, trials.Kp[-1]), rms_mm=tuple((*rows, none) for rows in trials.rms_mm)
    )


SLOW = 4.0
"""How much slower the arm is that a student may try, too slow for any gains to suit both arms."""


def loops(random: Random) -> Iterator[Call]:
    """Other gains, lags and delays, and a delay alone."""
    for _ in range(3):
        yield call(
            random.uniform(1.0, 20.0), random.uniform(0.01, 0.08), random.uniform(0.005, 0.03)
        )
    yield call(random.uniform(1.0, 20.0), 0.0, random.uniform(0.005, 0.03))


def lagging(random: Random) -> Iterator[Call]:
    """Other gains and lags, no delay."""
    for _ in range(2):
        yield call(random.uniform(1.0, 20.0), random.uniform(0.01, 0.08), 0.0)


def pure_integrators(random: Random) -> Iterator[Call]:
    """No lag and no delay."""
    yield call(random.uniform(1.0, 20.0), 0.0, 0.0)


def on_the_line() -> Iterator[Choice]:
    """The line of both arms that a student may try, with the chosen Kp and a multiple of it."""
    for arm, slow in (("first", 1.0), ("second, slower", SLOW)):
        line = stiffer(ON_THE_LINE, slow)
        for gains, times in (("the chosen Kp", 1.0), (f"{FAR:g} times the chosen Kp", FAR)):
            tried = stiffer(ON_THE_LINE, slow * times)
            judged = f"on the {arm} arm, with {gains}"
            yield Choice(line, {"worst_mm": LINE_LIMIT}, tried, judged)


def unseen_cases(random: Random) -> Iterator[Choice]:
    """Another path, twice the speed, a payload, an older state; five seeds each, on two arms."""
    yield from _unseen(random, 1.0)


def with_reserve(random: Random) -> Iterator[Choice]:
    """The unseen cases with a larger Kp than the chosen one."""
    yield from _unseen(random, RESERVE)


def _unseen(random: Random, reserve: float) -> Iterator[Choice]:
    """Cases of the arm whose line may be tried, and of one about a quarter as fast."""
    for slow in (1.0, random.uniform(3.6, 3.8)):
        line, unseen = stiffer(ON_THE_LINE, slow), stiffer(UNSEEN, slow * reserve)
        yield Choice(line, {"worst_mm": UNSEEN_LIMIT}, unseen)


def tables(random: Random) -> Iterator[Call]:
    """Three to six tasks with five seeds each, differences on both sides of the edge."""
    for n, edge in ((3, 4.30), (4, 3.18), (6, 2.57)):  # this number of standard errors decides
        for errors in (-1.4 * edge, 0.7 * edge, 1.4 * edge):
            yield call(*table(random, n, errors))


def table(random: Random, tasks: int, t: float, seeds: int = 5) -> tuple[Array, Array]:
    """The errors of two controllers whose difference over tasks is t standard errors."""
    level, noise = random.uniform(2.0, 15.0, (tasks, 1)), random.normal(0.0, 0.3, (2, tasks, seeds))
    d = random.normal(0.0, 1.0, (tasks, 1))
    d = d + t * d.std(ddof=1) / np.sqrt(tasks) - d.mean()
    noise = noise - noise.mean(axis=2, keepdims=True)
    spread = random.normal(0.0, 0.5, (1, seeds))  # what a seed has in common
    return level + d + noise[0] + spread, level + noise[1] + spread


def raises(random: Random) -> Iterator[Call]:
    """Other clear cases."""
    yield call(*table(random, 4, 6.0))
