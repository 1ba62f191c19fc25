"""Hidden cases of notebook 04."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import Bug, Call, Loop, Tuned
from labkit.course.authoring.problem import call
from labkit.course.question import Case

from .answers import choose_gains

Random = np.random.Generator


def _angles(random: Random, model: lk.Model) -> Any:
    robot = model.robot
    spread = 0.3 * np.minimum(robot.ready - robot.lower, robot.upper - robot.ready)
    return robot.ready + random.uniform(-1.0, 1.0, 7) * spread


def _model(random: Random) -> lk.Model:
    return lk.Model(random.choice(["left", "right"]), lk.BAXTER)


def _law(
    random: Random, *, ddq: float, speed: float, wanted: float, compensates: bool | None
) -> Call:
    """A state and a target near it, with given acceleration [rad/s^2] and speeds [rad/s]."""
    model = _model(random)
    q = _angles(random, model)
    e = random.uniform(0.03, 0.15, 7) * random.choice([-1.0, 1.0], 7)
    state = lk.State(float(random.uniform(0.0, 5.0)), q, speed * random.uniform(-1.0, 1.0, 7))
    target = lk.Sample(
        q + e, wanted * random.uniform(-1.0, 1.0, 7), ddq * random.uniform(-1.0, 1.0, 7)
    )
    kp, kd = random.uniform(5.0, 200.0, 7), random.uniform(1.0, 40.0, 7)
    flag = bool(random.integers(2)) if compensates is None else compensates
    return call(state, target, model, kp=kp, kd=kd, arm_compensates=flag)


def at_rest(random: Random) -> Iterator[Call]:
    """At rest, off the target, with an arm that compensates for gravity."""
    for _ in range(2):
        yield _law(random, ddq=0.0, speed=0.0, wanted=0.0, compensates=True)


def weight(random: Random) -> Iterator[Call]:
    """At rest, with the switch both ways."""
    for flag in (False, True, False):
        yield _law(random, ddq=0.0, speed=0.0, wanted=0.0, compensates=flag)


def speeding_up(random: Random) -> Iterator[Call]:
    """A target that begins to move."""
    for _ in range(3):
        yield _law(random, ddq=3.0, speed=0.0, wanted=0.0, compensates=True)


def moving(random: Random) -> Iterator[Call]:
    """An arm and a target with different speeds."""
    for _ in range(3):
        yield _law(random, ddq=0.0, speed=1.5, wanted=1.5, compensates=True)


def all_at_once(random: Random) -> Iterator[Call]:
    """All terms at the same time."""
    for _ in range(5):
        yield _law(random, ddq=3.0, speed=1.5, wanted=1.5, compensates=None)


def _tour(random: Random, side: Any) -> tuple[lk.Model, Any]:
    """A circle of the tip at a random place, as joint angles."""
    model = lk.Model(side, lk.BAXTER)
    q0 = model.robot.ready
    p = model.pose(q0)[:3, 3]
    inwards = -1.0 if side == "left" else 1.0
    centre = p + [random.uniform(-0.03, 0.03), inwards * random.uniform(0.08, 0.11), -0.2]
    schedule = lk.Quintic(random.uniform(3.6, 4.4))
    return model, model.joint_trajectory(
        lk.Trajectory(lk.Circle(p, centre), schedule), q0, samples=33
    )


def _off(random: Random, q: Any, most: float) -> Any:
    return q + most * random.choice([-1.0, 1.0], 7)


def augmented_runs(random: Random) -> Iterator[Case]:
    """From an offset, the other arm too."""
    side: Any = random.choice(["left", "right"])
    model = lk.Model(side, lk.Plant(armature=0.05))
    _, tour = _tour(random, side)
    given = {"model": model, "kp": 60.0, "kd": 15.0, "arm_compensates": False}
    q0 = _off(random, model.robot.ready, 0.06)
    yield Loop(tour, given, side, model.plant, q0=q0, settle=2.0, expected={"rms_mm": 5.0})


def computed_runs(random: Random) -> Iterator[Case]:
    """From an offset, the other arm too."""
    side: Any = random.choice(["left", "right"])
    model = lk.Model(side, lk.Plant(armature=0.05))
    _, tour = _tour(random, side)
    given = {"model": model, "kp": 100.0, "kd": 20.0, "arm_compensates": False}
    q0 = _off(random, model.robot.ready, 0.06)
    yield Loop(tour, given, side, model.plant, q0=q0, settle=1.0, expected={"rms_mm": 0.3})


def joints(random: Random) -> Iterator[Call]:
    """Other joints, heavy and light."""
    for _ in range(4):
        m, w = 10.0 ** random.uniform(-3.0, 0.5), random.uniform(3.0, 40.0)
        yield call(m, m * w * w, m * 2.0 * w * random.uniform(0.3, 1.5), 0.005)


def slow_samples(random: Random) -> Iterator[Call]:
    """Sampling rates at which a joint is barely stable, or unstable."""
    for _ in range(4):
        m, w = 10.0 ** random.uniform(-3.0, 0.5), random.uniform(20.0, 80.0)
        yield call(m, m * w * w, m * 2.0 * w, random.uniform(0.01, 0.04))


def tuned(random: Random, side: Any, payload: float) -> Tuned:
    """A tour with twice the errors of the answer's gains as limits, three times for the speed."""
    model, tour = _tour(random, side)
    loop = Loop(
        tour, side=side, plant=replace(lk.BAXTER, payload=payload), seed=int(random.integers(1000))
    )
    left = loop.measured(Tuned((model,), loop).ask(choose_gains))
    limits = {
        "rms_mm": round(2.0 * left["rms_mm"], 1),
        "rms_velocity_mm_s": round(2.8 * left["rms_velocity_mm_s"]),
    }
    return Tuned((model,), loop, limits)


AT_REST = {"max_mm": 60.0, "rms_velocity_mm_s": 6.0}
"""Limits for an arm released 0.1 rad off in every joint, from 0.8 s later on.

Dry friction leaves right answers up to 20 mm off; the speed shows whether there is a damper.
"""


def back(model: lk.Model, off: Any) -> Loop:
    """The return to a pose from an offset ``off``, (7,) in [rad]."""
    q = model.robot.ready
    return Loop(
        lk.Hold(q, 2.0), side=model.robot.name, plant=lk.BAXTER, q0=q + off, settle=0.8, seed=1
    )


def returns(random: Random) -> Iterator[Case]:
    """Returns from another side, with either arm."""
    model = _model(random)
    q = model.robot.ready + random.uniform(-0.15, 0.15, 7)
    off = 0.1 * random.choice([-1.0, 1.0], 7)
    loop = replace(back(model, off), target=lk.Hold(q, 2.0), q0=q + off)
    yield Tuned((model,), loop, AT_REST)


def quick_tours(random: Random) -> Iterator[Case]:
    """A faster tour of either arm."""
    yield tuned(random, random.choice(["left", "right"]), 0.0)


def loaded_tours(random: Random) -> Iterator[Case]:
    """Tours with a payload in the gripper."""
    yield tuned(random, random.choice(["left", "right"]), random.uniform(0.7, 1.0))


def terms_of_18(random: Random) -> Iterator[Call]:
    """The terms whose verdict is not told."""
    yield from map(call, "bcd")


def rotors(factor: float, side: Any = "left") -> lk.Model:
    """A Baxter arm with other rotors."""
    scaled = tuple(factor * x for x in lk.BAXTER.armature)
    return lk.Model(side, replace(lk.BAXTER, name="other rotors", armature=scaled))


def other_rotors(random: Random) -> Iterator[Call]:
    """Arms with lighter and heavier rotors."""
    for least, most in ((0.2, 0.4), (2.5, 4.0)):
        side = random.choice(["left", "right"])
        yield call(rotors(float(random.uniform(least, most)), side))


def bugs(random: Random) -> Iterator[Call]:
    """Runs with any mistake."""
    yield from (call(Bug.drawn(random)) for _ in range(4))
