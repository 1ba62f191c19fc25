"""The report's comparison, run honestly: ``make campaign``.

Eight methods follow every task, on the ideal arm and on Baxter's, with several seeds.  A seed
decides where the arm starts (about 10 mm off the path), the measurement noise and which ticks are
late.  With one seed every method starts at the same place, so differences can be taken in pairs.
The gains are in `gains`; `claims` judges what the report claimed about the outcome.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import cache
from typing import Any

import numpy as np

from labkit import (
    BAXTER,
    IDEAL,
    Arm,
    Hold,
    JointVelocity,
    Log,
    Model,
    Plant,
    Sample,
    State,
    Table,
    metrics,
    run,
)

from . import tasks
from .claims import Finding
from .gains import Candidate, all_controllers
from .grid import Row, cells, pick, table
from .joint_velocity import JointVelocityPD
from .tag_task import Chase, followed, sequential
from .tasks import Task

PLANTS = {
    "ideal": IDEAL,
    "baxter": BAXTER,
    "baxter without noise": replace(BAXTER, velocity_noise=0.0),
}
TASKS = ("line", "circle", "square", "tag")
FEED_FORWARD, BASELINE = "feed-forward only", "baseline"
FIVE = (
    "joint velocity",
    "workspace velocity",
    "joint torque",
    "joint impedance",
    "workspace impedance",
)
"""The order of the report: figures 4 to 7, 8 to 11, and so on."""
INTEGRAL = "computed torque with an integral"
CONTROLLERS = (*FIVE, INTEGRAL, FEED_FORWARD, BASELINE)


def grid(seeds: int, controllers: Sequence[str] = CONTROLLERS) -> list[dict[str, Any]]:
    """The cells of the campaign: 8 controllers, all tasks, 2 plants, the seeds."""
    return cells(controller=controllers, task=TASKS, plant=("ideal", "baxter"), seed=range(seeds))


@cache
def _chase(kind: str, seed: int) -> Chase:
    return sequential(seed) if kind == BASELINE else followed(seed)


def chase(controller: str, seed: int) -> Chase:
    """The tag task; for the baseline, which cannot follow a moving goal, as in the report."""
    return _chase(BASELINE if controller == BASELINE else "", seed)


@cache
def _path(name: str) -> Task:
    makers: dict[str, Callable[[], Task]]
    makers = {"line": tasks.line, "circle": tasks.circle, "square": tasks.square}
    return makers[name]()


def task_of(name: str, controller: str, seed: int) -> Task:
    """A task by name, made once, because its inverse kinematics takes a moment."""
    if name == "tag":
        return chase(controller, seed).task
    return _path(name)


@cache
def built_in(name: str) -> Any:
    """The schedule of the baseline along the path of a task, planned as MoveIt does."""
    from . import baseline  # needs an extra, only for these runs

    goal = _path(name)
    scene = baseline.PlanningScene(goal.side, (Table(),))
    return baseline.along(scene, Model(goal.side), goal.target, goal.q0)


def feed_forward(state: State, target: Sample) -> JointVelocity:
    """Command the speeds of the target and nothing else, that is, no feedback."""
    return JointVelocity(target.velocity)


def _tuned(controller: str, plant: Plant, side: Any) -> Candidate:
    if controller == FEED_FORWARD:
        return Candidate(feed_forward, 200.0, True)
    if controller == BASELINE:
        from . import baseline

        return Candidate(baseline.PositionServer(), baseline.RATE, True)
    knows = Plant(name=plant.name, armature=plant.armature)  # the rotors, and no payload
    return all_controllers(Model(side, knows), plant)[controller]


def joints(controller: str, task: str, seed: int) -> Any:
    """The joint angles for the target of a controller, as a function of time."""
    planned = controller == BASELINE and task != "tag"
    return built_in(task) if planned else task_of(task, controller, seed).joints


def perform(controller: str, task: str, plant: str, seed: int) -> Log:
    """One run of the campaign."""
    goal, arm_is = task_of(task, controller, seed), PLANTS[plant]
    tuned = _tuned(controller, arm_is, goal.side)
    target = joints(controller, task, seed) if tuned.joints else goal.target
    with Arm(goal.side, arm_is, seed, q0=goal.start(seed)) as arm:
        return replace(run(arm, target, tuned.controller, rate=tuned.rate), controller=controller)


def numbers(controller: str, task: str, plant: str, seed: int) -> Mapping[str, Any]:
    """The job of the campaign: make one run and return its numbers."""
    log = perform(controller, task, plant, seed)
    told = measured(log, joints(controller, task, seed))
    if task == "tag":
        late = log.t >= 2.0
        tips = metrics.tip_poses(log)[late, :3, 3]
        miss = chase(controller, seed).miss(log.t[late], tips)
        told["tag_rms_mm"] = 1e3 * metrics.rms(miss)
    return told


def measured(log: Log, wanted: Any) -> dict[str, Any]:
    """The numbers that describe a run.

    Args:
        log: The run.
        wanted: The joint angles for its target, as a function of time.

    Returns:
        The fields of `metrics.Summary`; the tracking error after the first second; the last error;
        the RMS error of the joints; and a digest of the motion, for a comparison bit by bit.
    """
    model = Model(log.robot, log.plant)
    e, late = metrics.tip_error(log, model), log.t >= 1.0
    off = np.array([wanted(t).position for t in log.t]) - log.q
    told = asdict(metrics.summary(log, model)) | {
        "late_rms_mm": 1e3 * metrics.rms(e[late, :3]),
        "late_max_mm": 1e3 * float(np.linalg.norm(e[late, :3], axis=1).max()),
        "late_rms_deg": float(np.degrees(metrics.rms(e[late, 3:]))),
        "end_mm": 1e3 * float(np.linalg.norm(e[-1, :3])),
        "rms_joint_deg": float(np.degrees(metrics.rms(off))),
        "digest": hashlib.sha256(log.q.tobytes() + log.tau.tobytes()).hexdigest()[:16],
    }
    return {key: None if value == math.inf else value for key, value in told.items()}


# Two more questions, about gains


def gain_grid(seeds: int) -> list[dict[str, Any]]:
    """Cells that ask whether larger gains converge faster."""
    return cells(Kp=(1.5, 3.0, 6.0, 12.0), plant=("ideal", "baxter"), seed=range(seeds))


def converge(Kp: float, plant: str, seed: int) -> Mapping[str, float]:
    """Joint velocity PD comes back to the ready pose: how long until a tenth of the error is left.

    Returns:
        "tenth_s" in [s], and "rest_mm": the RMS error of the tip in the last second.
    """
    goal = _path("line")
    with Arm(goal.side, PLANTS[plant], seed, q0=goal.start(seed)) as arm:
        log = run(arm, Hold(goal.q0, 4.0), JointVelocityPD(Kp))
    off = np.linalg.norm(metrics.joint_error(log), axis=1)
    e = metrics.tip_error(log)[log.t >= 3.0, :3]
    tenth = metrics.settling_time(log.t, off, 0.1 * float(off[0]))
    return {"tenth_s": tenth, "rest_mm": 1e3 * metrics.rms(e)}


def noise_grid(seeds: int) -> list[dict[str, Any]]:
    """Cells that ask what limits the derivative gain."""
    plants = ("baxter", "baxter without noise")
    return cells(Kd=(0.0, 0.1, 0.5, 1.0, 2.0, 3.0), plant=plants, seed=range(seeds))


def derivative(Kd: float, plant: str, seed: int) -> Mapping[str, float]:
    """Joint velocity PD on the line with a derivative gain.

    Returns:
        "late_rms_mm": the RMS error after the first second; "shake_mm_s": how much the tip's speed
        jitters in the last half second, when it should stand still.
    """
    goal = _path("line")
    with Arm(goal.side, PLANTS[plant], seed, q0=goal.start(seed)) as arm:
        log = run(arm, goal.joints, JointVelocityPD(3.0, Kd))
    still = log.t >= log.t[-1] - 0.5
    model = metrics.model_of(log)
    e, v = metrics.tip_error(log, model), metrics.tip_velocities(log, model)
    return {
        "late_rms_mm": 1e3 * metrics.rms(e[log.t >= 1.0, :3]),
        "shake_mm_s": 1e3 * metrics.rms(v[still]),
    }


TABLES = {
    "late_rms_mm": "RMS position error after the first second [mm]",
    "late_max_mm": "Largest position error after the first second [mm]",
    "late_rms_deg": "RMS orientation error after the first second [degrees]",
    "rms_mm": "RMS position error, the start included [mm]",
    "rms_velocity_mm_s": "RMS velocity error of the tip [mm/s]",
    "rms_joint_deg": "RMS joint error, all joints together [degrees]",
    "settling": "Time until the tip stays within 5 mm [s]",
    "effort": "RMS motor torque [N m]",
    "saturated": "Share of the ticks in which a limit cut the command",
    "duration": "Time for the task [s]",
}


def tables(rows: list[Row]) -> str:
    """The campaign in Markdown, with a table for each number and plant."""
    seeds = len({row["seed"] for row in rows})
    parts = [
        f"# Campaign, {seeds} seed{'s' * (seeds > 1)}\n\nMean over the seeds [least, largest]."
    ]
    for number, title in TABLES.items():
        for plant in dict.fromkeys(row["plant"] for row in rows):
            body = table(pick(rows, plant=plant), "controller", "task", number)
            parts.append(f"## {title}, {plant} arm\n\n{body}")
    if chased := pick(rows, task="tag"):
        title = "Distance from where the tag really put the tip, RMS after two seconds [mm]"
        parts.append(f"## {title}\n\n{table(chased, 'controller', 'plant', 'tag_rms_mm')}")
    return "\n\n".join(parts) + "\n"


def claims(judged: list[Finding]) -> str:
    """The verdicts in Markdown."""
    said = "\n".join(f"- {v}" for v in judged) or "One seed judges no claim; take two or more."
    return f"\n## What the report claimed\n\n{said}\n"
