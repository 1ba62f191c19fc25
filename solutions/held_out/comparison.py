"""Hidden cases of notebook 07."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import labkit as lk
from labkit.check import Call, Choice
from labkit.grade.problem import call
from labkit.recordings import LINE, read_trials

Random = np.random.Generator
MODEL = lk.Model("left")

ON_THE_LINE = read_trials(LINE)
UNSEEN = Path(__file__).with_name("trials.json")
UNSEEN_LIMIT = 3.9
"""Worst error allowed on unseen cases, in [mm]: gains of 14 to 34 reach it, soft and tight ones do
not."""


def drawn_log(random: Random, rows: int, error: Any, *, moving: bool) -> lk.Log:
    """A short log whose tip misses its target by a given error, (3,) in [m].

    An arm that moves is tilted as well, which is no error of position.
    """
    q0 = MODEL.robot.ready
    q = q0 + (random.uniform(-0.2, 0.2, (rows, 7)) if moving else np.zeros((rows, 7)))
    T_wd = np.array([MODEL.pose(x) for x in q])
    T_wd[:, :3, 3] += error
    if moving:
        T_wd[:, :3, :3] @= lk.se3.rotation([0.1, -0.2, 0.05])
    t, zero = np.linspace(0.0, 0.005 * rows, rows), np.zeros((rows, 7))
    return lk.Log(
        t=t,
        q=q,
        dq=zero,
        tau=zero,
        command=zero,
        target=lk.PoseSample(T_wd, np.zeros((rows, 6)), np.zeros((rows, 6))),
        measured=lk.State(t, q, zero),  # type: ignore[arg-type]
        saturated=np.zeros(rows, dtype=bool),
        command_type=lk.JointVelocity,
        controller="drawn",
        plant=lk.IDEAL,
        side="left",
    )


def still_logs(random: Random) -> Iterator[Call]:
    """An arm at rest beside its target."""
    yield call(drawn_log(random, 4, random.uniform(-0.02, 0.02, 3), moving=False), MODEL)


def moving_logs(random: Random) -> Iterator[Call]:
    """An arm that moves, with an error that does not."""
    for _ in range(2):
        yield call(drawn_log(random, 6, random.uniform(-0.02, 0.02, 3), moving=True), MODEL)


def uneven_logs(random: Random) -> Iterator[Call]:
    """An arm that moves, with errors that change from row to row."""
    for _ in range(2):
        yield call(drawn_log(random, 7, random.uniform(-0.02, 0.02, (7, 3)), moving=True), MODEL)


def loops(random: Random) -> Iterator[Call]:
    """Other gains, lags and delays."""
    for _ in range(3):
        yield call(
            random.uniform(1.0, 20.0), random.uniform(0.01, 0.08), random.uniform(0.005, 0.03)
        )


def pure_integrators(random: Random) -> Iterator[Call]:
    """No lag and no delay."""
    yield call(random.uniform(1.0, 20.0), 0.0, 0.0)


def margins(random: Random) -> Iterator[Call]:
    """Other lags, delays and margins."""
    for _ in range(5):
        yield call(
            random.uniform(0.01, 0.08), random.uniform(0.005, 0.05), random.uniform(30.0, 75.0)
        )


def no_delay(random: Random) -> Iterator[Call]:
    """A lag alone."""
    yield call(random.uniform(0.01, 0.08), 0.0, random.uniform(30.0, 75.0))


def unseen_cases(random: Random) -> Iterator[Choice]:
    """Another path, twice the speed, a payload, an older state; five seeds each."""
    yield Choice(ON_THE_LINE, {"worst_mm": UNSEEN_LIMIT}, read_trials(UNSEEN))


def _pairs(random: Random, n: int, shift: float) -> tuple[list[float], list[float]]:
    seeds = random.uniform(1.0, 9.0, n)
    noise = random.normal(0.0, 0.2, (2, n))
    return (seeds + noise[0]).tolist(), (seeds + shift + noise[1]).tolist()


def pairs(random: Random) -> Iterator[Call]:
    """Other seeds, other numbers of them."""
    for n in (2, 3, 5, 10):
        yield call(*_pairs(random, n, random.uniform(-1.0, 1.0)))


def tables(random: Random) -> Iterator[Call]:
    """Tables with claims of every kind."""
    for _ in range(3):
        table = {}
        for k, shift in enumerate(random.permutation([-1.5, 0.0, 1.5, 0.0, 0.8])):
            a, b = _pairs(random, 5, 0.0)
            noise = random.normal(0.0, 0.6, 5)
            table[f"claim {k}"] = [
                [x + float(shift) for x in a],
                [y + z for y, z in zip(b, noise, strict=True)],
            ]
        yield call(table)
    yield call({f"claim {k}": _apart(random, t) for k, t in enumerate((-4.0, -2.6, 2.6, 4.0))})


def _apart(random: Random, t: float) -> list[list[float]]:
    """Two rows of five whose difference is t standard errors; 2.78 are needed to decide."""
    seeds, noise = random.uniform(1.0, 9.0, 5), random.normal(0.0, 0.5, 5)
    shift = t * noise.std(ddof=1) / np.sqrt(5.0) - noise.mean()
    return [(seeds + noise + shift).tolist(), seeds.tolist()]
