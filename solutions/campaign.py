"""The comparison of the report, run honestly: ``python -m solutions.campaign``.

Every controller, with the gains stated here, on every task, on the ideal and on Baxter's plant,
over seeds.  A seed draws where the arm starts (about 10 mm off the path), the measurement noise and
the ticks that come late; the same seed means the same start for all controllers.
"""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from labkit import BAXTER, IDEAL, Arm, JointVelocity, Log, Model, Plant, Sample, State, run, tasks
from labkit import metrics as measure
from labkit.campaign import Meter, Row, cells, table, work_through
from labkit.tasks import Task

from .joint_velocity import JointVelocityPD

PLANTS = {"ideal": IDEAL, "baxter": BAXTER}
TASKS: dict[str, Callable[[], Task]] = {
    "line": tasks.line,
    "circle": tasks.circle,
    "square": tasks.square,
}


@dataclass(frozen=True)
class Way:
    """One way to make the arm follow a task.

    Attributes:
        follows: Which of a task's targets it takes: "poses" or "joints".
        rate: How often it is asked, in [Hz].
        make: Gives the controller for a plant; called once for each run.
    """

    follows: str
    rate: float
    make: Callable[[Model], Callable[[State, Any], Any]]


def feed_forward(state: State, target: Sample) -> JointVelocity:
    """The target's speeds and nothing else: what happens without looking."""
    return JointVelocity(target.velocity)


WAYS: dict[str, Way] = {
    "feed-forward only": Way("joints", 200.0, lambda model: feed_forward),
    "joint velocity PD": Way("joints", 200.0, lambda model: JointVelocityPD(Kp=5.0, Kd=0.0)),
}
BASELINE = "baseline (plan, time, position server)"


@cache
def task(name: str) -> Task:
    """A task by name; made once, for its inverse kinematics takes a moment."""
    return TASKS[name]()


def perform(controller: str, motion: str, plant: str, seed: int) -> Log:
    """One run of the campaign."""
    goal = task(motion)
    with Arm(goal.side, PLANTS[plant], seed, q0=goal.start(seed)) as arm:
        if controller == BASELINE:
            from labkit import baseline  # an extra, needed only here

            way = planned(motion)
            return run(arm, way, baseline.PositionServer(), rate=baseline.RATE)
        way_of = WAYS[controller]
        target = goal.joints if way_of.follows == "joints" else goal.target
        return run(arm, target, way_of.make(Model(goal.side, _known(arm.plant))), rate=way_of.rate)


@cache
def planned(motion: str) -> Any:
    """The baseline's own schedule along a task."""
    from labkit import baseline

    goal = task(motion)
    scene = baseline.Scene(goal.side, (baseline.table(),))
    return baseline.along(scene, Model(goal.side), goal.target, goal.q0)


def _known(plant: Plant) -> Plant:
    """What a controller's model is told of the plant: its rotors, not what it carries."""
    return Plant(name=plant.name, armature=plant.armature)


def numbers(controller: str, motion: str, plant: str, seed: int) -> Mapping[str, Any]:
    """The campaign's job: one run, in numbers."""
    log = perform(controller, motion, plant, seed)
    model = Model(log.side, log.plant)
    late = log.t >= 1.0
    e = measure.tip_error(log, model)
    joints = planned(motion) if controller == BASELINE else task(motion).joints
    wanted = np.array([joints(t).position for t in log.t])
    return asdict(measure.summary(log, model)) | {
        "late_rms_mm": 1e3 * measure.rms(e[late, :3]),
        "end_mm": 1e3 * float(np.linalg.norm(e[-1, :3])),
        "rms_joint_deg": float(np.degrees(measure.rms(wanted - log.q))),
        "ticks": len(log),
        "digest": hashlib.sha256(log.q.tobytes() + log.tau.tobytes()).hexdigest()[:16],
    }
