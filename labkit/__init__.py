"""A small laboratory for robot control: Baxter's arm or your own, and the course built on it.

It has three nouns and a verb: an `Arm`, a `Trajectory`, a controller (any function of a state and
a target), and `run`.  Everything that a notebook needs is available as ``lk.something``.
"""

# ruff: noqa: F405  # `tags` lists the names that are loaded lazily
from __future__ import annotations

import platform
import sys
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from . import control, dynamics, metrics, se3
from .arm import Arm
from .control import JointPosition, JointTorque, JointVelocity, State
from .errors import LabkitError
from .log import Log
from .model import Model
from .paths import BangBang, Circle, Cubic, Line, Polyline, Quintic, Trapezoid
from .plant import BAXTER, IDEAL, Plant
from .robot import Robot, robot
from .run import run
from .scene import Push, Spring, Table, Wall
from .trajectory import Chain, Hold, PosePath, PoseSample, Sample, Trajectory
from .world import World

if TYPE_CHECKING:
    from . import course as course
    from . import plotting, replay
    from . import tags as tags
    from .course import hand_in as hand_in
    from .course import my_arm as my_arm
    from .course import my_bug as my_bug
    from .course import progress as progress
    from .course import restore as restore
    from .replay import live
    from .tags import *  # noqa: F403

__version__ = "0.3.0"

__all__ = [
    "BAXTER", "IDEAL", "Arm", "BangBang", "Camera", "Chain", "Circle", "Cubic", "Hold",
    "Intrinsics", "JointPosition", "JointTorque", "JointVelocity", "LabkitError", "Line", "Log",
    "Model", "Plant", "Polyline", "PosePath", "PoseSample", "Push", "Quintic", "Robot", "Sample",
    "Spring", "State", "Table", "Tag", "TagStream", "TagTarget", "Trajectory", "Trapezoid", "Wall",
    "World", "detect_tags", "live", "looking_at", "metrics", "plotting", "ready", "replay", "robot",
    "run", "se3",
]  # fmt: skip


_FROM = {"live": "replay"} | dict.fromkeys(
    ("hand_in", "my_arm", "my_bug", "progress", "restore"), "course"
)

if not TYPE_CHECKING:  # else every misspelt name would pass a type checker

    def __getattr__(name: str) -> Any:
        """Load a name on first use, because OpenCV, Matplotlib and IPython are slow to import."""
        whole = name in ("course", "plotting", "replay", "tags")
        if not whole and name not in __all__ and name not in _FROM:
            raise AttributeError(f"module 'labkit' has no attribute {name!r}")
        try:
            module = import_module(f".{name if whole else _FROM.get(name, 'tags')}", __name__)
        except ModuleNotFoundError as missing:
            say = f"lk.{name} needs {missing.name}; type: pip install 'labkit[notebook]'"
            raise LabkitError(say) from missing
        return module if whole else getattr(module, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def ready() -> None:
    """Move the simulated arm once and print a line that confirms it.

    Raises:
        LabkitError: The arm did not reach its goal.
    """
    from .run import run  # not `lk.run`, which a user may have replaced

    with Arm() as arm:
        start = arm.robot.neutral
        goal = start + 0.1 * (np.arange(arm.robot.n) == 0)
        log = run(arm, Trajectory(Line(start, goal), Quintic(0.5)), control.feedforward)
        a, b = (arm.model.pose(q)[:3, 3] for q in (log.q[0], log.q[-1]))
    off = abs(log.q[-1] - goal).max()
    if off > 0.01:
        raise LabkitError(f"the arm ended {off:.3f} rad from where it was sent; reinstall labkit")
    made_by = (arm.world.engine, "pin" if dynamics.chosen() == "pinocchio" else "mujoco")
    engines = ", ".join(f"{name} {version(name)}" for name in dict.fromkeys(made_by))
    print(  # short enough for one line of a notebook beside its file browser
        f"labkit {__version__}: the arm moved {1e3 * np.linalg.norm(b - a):.0f} mm; Python "
        f"{platform.python_version()}, {sys.platform} {platform.machine()}, {engines}"
    )
