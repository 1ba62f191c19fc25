"""The gain explorer, whose runs on a grid the build tool records once, each in a small file."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics
from labkit.replay import Motion
from solutions.study.joint_velocity import JointVelocityPD
from solutions.study.workspace_velocity import WorkspaceVelocityPD

from .embed import Dial, Explorer, explorer_html, run_files

SEED = 4
CONTROLLERS = ("joint velocity PD", "workspace velocity PD")
TASKS = ("line", "circle")
KP = (0.0, 1.0, 3.0, 8.0, 20.0)
KD = (0.0, 0.3, 0.6)
LATENCY = (4.0, 30.0, 60.0)  # ms
PAYLOAD = (0.0, 1.0)  # kg
SECONDS = 2.5
RATE = 15.0
"""Number of samples per second that are kept."""
NAME = "gains"

Point = tuple[int, int, int, int, int, int]
DIALS = (
    Dial("Controller", CONTROLLERS),
    Dial("Task", TASKS),
    Dial("Kp", KP, "1/s", 3.0),
    Dial("Kd", KD, "", 0.0),
    Dial("Latency", LATENCY, "ms", 4.0),
    Dial("Payload", PAYLOAD, "kg", 0.0),
)


def points() -> list[Point]:
    """All points of the grid."""
    return list(product(*(range(len(d.values)) for d in DIALS)))  # type: ignore[arg-type]


@cache
def _task(name: str) -> tuple[Any, Any]:
    model = lk.Model("left")
    q0 = model.robot.ready
    T_wt = model.pose(q0)
    start = T_wt[:3, 3]
    path: Any = (
        lk.Line(start, start + np.array((0.10, -0.15, 0.10)))
        if name == "line"
        else lk.Circle(start, start + np.array((0.0, -0.08, 0.0)))
    )
    target = lk.Trajectory(lk.PosePath(path, T_wt[:3, :3]), lk.Quintic(SECONDS))
    return target, model.joint_trajectory(target, q0)


def record(point: Point) -> lk.Log:
    """Run one point of the grid; the arm starts about a centimetre beside its path."""
    controller, task, kp, kd, latency, payload = (
        dial.values[k] for dial, k in zip(DIALS, point, strict=True)
    )
    plant = replace(
        lk.BAXTER,
        name="baxter",
        state_delay=1e-3 * float(latency),
        payload=float(payload),
    )
    poses, joints = _task(str(task))
    model = lk.Model("left")
    law: Any = JointVelocityPD(kp, kd)
    target = joints
    if controller == CONTROLLERS[1]:
        law, target = WorkspaceVelocityPD(model, kp, kd), poses
    q0 = lk.robot("left").ready + np.array((0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    with lk.Arm("left", plant, SEED, q0=q0) as arm:
        try:
            return lk.run(arm, target, law)
        except lk.errors.Diverged as error:
            return error.log


def seen(log: lk.Log) -> tuple[Motion, str]:
    """The motion that the explorer shows for a run, and a sentence about the run."""
    model = lk.Model("left")
    e = np.linalg.norm(metrics.tip_error(log, model)[:, :3], axis=1)
    T_wd = metrics.target_poses(log, model)
    title = "Baxter's left arm with the chosen gains"
    motion = Motion(
        "left", log.t, log.q, title=title, label="arm", target_position=T_wd[:, :3, 3],
        target_rotation=T_wd[:, :3, :3], path=T_wd[:: max(1, len(log) // 60), :3, 3], error=e,
    )  # fmt: skip
    rms, end = 1e3 * metrics.rms(e), 1e3 * e[-1]
    fact = f"RMS error {rms:.1f} mm, {1e3 * e.max():.1f} mm at most, {end:.1f} mm at the end."
    if log.t[-1] < SECONDS - 1e-6:
        fact += f" The run was stopped at {log.t[-1]:.2f} s: the arm ran away."
    return motion, fact


def make(point: Point) -> tuple[str, str, str]:
    """The file of one point: its name, its text and its sentence."""
    motion, fact = seen(record(point))
    explorer = Explorer(NAME, motion.title, DIALS, {point: motion})
    ((name, text),) = run_files(explorer, RATE).items()
    return name, text, fact


def _list(values: tuple[float, ...]) -> str:
    *most, last = (f"{x:g}" for x in values)
    return f"{', '.join(most)} and {last}"


def explorer(folder: str, poster: str) -> HTML:
    """The explorer, which loads its runs from book/static/runs, behind a picture of the arm."""
    facts = json.loads((Path(__file__).parents[1] / "static/runs/facts.json").read_text())
    runs = {tuple(map(int, key.split("-"))): None for key in facts}
    told = {tuple(map(int, key.split("-"))): text for key, text in facts.items()}
    grid = Explorer(NAME, "Gains of the velocity controllers", DIALS, runs, told)  # type: ignore[arg-type]
    caption = (
        f"{len(runs)} runs on the realistic arm, recorded when the book was made. Each starts "
        "about a centimetre beside its path; change one thing at a time. The dials stop where a "
        f"run was recorded: Kp at {_list(KP)} 1/s, Kd at {_list(KD)}, the latency at "
        f"{_list(LATENCY)} ms, the payload at {_list(PAYLOAD)} kg."
    )
    return HTML(explorer_html(grid, folder, caption=caption, poster=poster))
