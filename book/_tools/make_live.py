"""Write the numbers for the book's live arm: `python book/_tools/make_live.py`.

Robot, plants, gains and tasks are defined in Python.  `book/live/numbers.js` is made from them, so
that no number has to be typed into the page's JavaScript.  A test fails if the file is out of date.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT)]
OUT = ROOT / "book/live/numbers.js"
HEAD = "// Made by book/_tools/make_live.py from labkit and solutions; do not edit it.\n"

import labkit as lk  # noqa: E402
from labkit import joints, scene  # noqa: E402
from labkit.run import RUNAWAY  # noqa: E402
from labkit.tags.drawing import Intrinsics  # noqa: E402
from labkit.tags.tag import Tag  # noqa: E402
from solutions.study import gains, tag_task, tasks  # noqa: E402
from solutions.study.baseline import server  # noqa: E402

NAMES = {
    "workspace velocity": "workspaceVelocity",
    "joint velocity": "jointVelocity",
    "joint torque": "jointTorque",
    "workspace impedance": "workspaceImpedance",
    "joint impedance": "jointImpedance",
}
"""The names of the five controllers in the page's JavaScript."""


def numbers() -> dict[str, Any]:
    """All numbers that the page needs, as plain data."""
    robot = lk.robot("left")
    return {
        "robot": robot_data(robot),
        "plants": {p.name: plant_data(p, robot.n) for p in (lk.IDEAL, lk.BAXTER)},
        "controllers": {p.name: controllers(p) for p in (lk.IDEAL, lk.BAXTER)},
        "constants": {
            "dt": 1e-3,
            "quick": joints.QUICK,
            "braking": joints.BRAKING,
            "runaway": RUNAWAY,
            "pad": {
                "radius": scene.TIP_RADIUS,
                "stiffness": scene.TIP_STIFFNESS,
                "damping": scene.TIP_DAMPING,
                "face": scene.FACE,
                "creep": scene.CREEP,
            },
            "wall": material(lk.Wall([0, 0, 0], [0, 0, 1])),
        },
        "task": {
            "speed": tasks.V_MAX,
            "acceleration": tasks.A_MAX,
            "rest": tasks.HOLD,
            **{name: geometry(name) for name in ("line", "circle", "square")},
        },
        "tag": tag_data(),
    }


def robot_data(robot: lk.Robot) -> dict[str, Any]:
    """The arm, as the model file that MuJoCo reads and as numbers of the same bodies."""
    T = robot.T_hand_tip
    return {
        "name": robot.name,
        "urdf": robot.urdf(),
        "bodies": robot.data()["bodies"],
        "tip": {"R": T[:3, :3].ravel().tolist(), "p": T[:3, 3].tolist()},
        "ready": robot.ready.tolist(),
    }


def plant_data(plant: lk.Plant, n: int) -> dict[str, Any]:
    """A plant, with n numbers for each property of the joints."""
    made = asdict(plant)
    del made["fits"]
    return {k: plant.each(k, n).tolist() if isinstance(v, tuple) else v for k, v in made.items()}


def controllers(plant: lk.Plant) -> dict[str, Any]:
    """The five controllers with their gains in the comparison on a plant, and Baxter's own."""
    found = {}
    for name, candidate in gains.course_controllers(lk.Model("left", plant), plant).items():
        law = candidate.controller
        kept = {k: plain(v) for k, v in vars(law).items() if k not in ("model", "watch")}
        if watch := getattr(law, "watch", None):
            kept["threshold"] = watch.threshold
        found[NAMES[name]] = {
            "gains": {k: v for k, v in kept.items() if v is not None},
            "rate": candidate.rate,
            "joints": candidate.joints,
        }
    return found | {"baxtersOwn": {"gains": {}, "rate": server.RATE, "joints": True}}


def material(wall: lk.Wall) -> dict[str, Any]:
    """The default size and material of a wall."""
    return {k: plain(getattr(wall, k)) for k in ("size", "stiffness", "damping", "friction")}


def geometry(name: str) -> Any:
    """The points that define a task, relative to the tip's ready position."""
    return getattr(tasks, name).__defaults__[0]


def tag_data() -> dict[str, Any]:
    """The tag's circle, the tip's position above it, and the camera's focal length in [px]."""
    return {
        "duration": tag_task.DURATION,
        "rate": tag_task.RATE,
        "lap": tag_task.LAP,
        "radius": tag_task.RADIUS,
        "offset": tag_task.OFFSET.tolist(),
        "size": Tag().size,
        "focal": Intrinsics().fx,
    }


def plain(value: Any) -> Any:
    """An array as a list, or as one number if all its elements are equal."""
    if isinstance(value, np.ndarray):
        return value.tolist() if value.size > 1 else value.item()
    return value


def text() -> str:
    """The JavaScript file with the numbers."""
    return HEAD + "".join(
        f"export const {name.upper()} = {json.dumps(value)};\n" for name, value in numbers().items()
    )


if __name__ == "__main__":
    OUT.write_text(text())
