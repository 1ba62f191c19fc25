"""A small laboratory for robot control: Baxter's arm, simulated, and what is needed to teach it.

Three nouns and a verb: an `Arm`, a `Trajectory`, a controller (any function of state and target),
and `run`.  Everything that a notebook needs is ``lk.something``.
"""

from __future__ import annotations

import platform
import sys
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from numpy.linalg import norm

from . import controllers, errors, metrics, se3
from .arm import Arm
from .commands import Command, JointPosition, JointTorque, JointVelocity, State
from .errors import LabkitError
from .log import Log
from .model import Link, Model, links
from .motion import Chain, Hold, PosePath, PoseSample, Sample, Trajectory
from .paths import Circle, Line, Polyline, Spline
from .plant import BAXTER, IDEAL, Plant
from .robot import robot
from .run import Controller, run
from .scalings import BangBang, Cubic, Quintic, Trapezoid
from .scene import Push, Spring, Table, Wall
from .world import World

if TYPE_CHECKING:
    from . import check, plotting, replay
    from .vision.board import Board
    from .vision.camera import Camera, looking_at
    from .vision.detection import detect_tags, find_tag
    from .vision.intrinsics import Intrinsics
    from .vision.looking import Following, Lookups, Reading
    from .vision.tags import Tag

__version__ = "0.1.0"

_LATER = {
    "Board": "vision.board",
    "Camera": "vision.camera",
    "Following": "vision.looking",
    "Intrinsics": "vision.intrinsics",
    "Lookups": "vision.looking",
    "Reading": "vision.looking",
    "Tag": "vision.tags",
    "check": "",
    "detect_tags": "vision.detection",
    "find_tag": "vision.detection",
    "looking_at": "vision.camera",
    "plotting": "",
    "replay": "",
}
"""Where to find what is loaded when first asked for; OpenCV and Matplotlib are slow to import."""


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'labkit' has no attribute {name!r}")
    module = import_module(f".{_LATER[name] or name}", __name__)
    value = getattr(module, name) if _LATER[name] else module
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*globals(), *_LATER]


def ready() -> None:
    """Move the simulated arm once and print one line that says so.

    Raises:
        LabkitError: The arm did not move as it should.
    """
    import psutil  # not needed where nobody asks

    with Arm() as arm:
        start, goal = (arm.robot.neutral + [x, 0, 0, 0, 0, 0, 0] for x in (0.0, 0.1))
        log = run(arm, Trajectory(Line(start, goal), Quintic(0.5)), controllers.feedforward)
        a, b = (arm.model.pose(q)[:3, 3] for q in (log.q[0], log.q[-1]))
    off = abs(log.q[-1] - goal).max()
    if off > 0.01:
        raise LabkitError(f"the arm ended {off:.3f} rad from where it was sent; reinstall labkit")
    engines = ", ".join(f"{name} {version(name)}" for name in ("pybullet", "pin"))
    free = psutil.virtual_memory().available / 2**30
    print(  # short enough for one line of a notebook beside its file browser
        f"labkit {__version__}: the arm moved {1e3 * norm(b - a):.0f} mm; Python "
        f"{platform.python_version()}, {sys.platform} {platform.machine()}, {engines}, "
        f"{free:.0f} GB free"
    )


__all__ = [
    "BAXTER",
    "IDEAL",
    "Arm",
    "BangBang",
    "Board",
    "Camera",
    "Chain",
    "Circle",
    "Command",
    "Controller",
    "Cubic",
    "Following",
    "Hold",
    "Intrinsics",
    "JointPosition",
    "JointTorque",
    "JointVelocity",
    "LabkitError",
    "Line",
    "Link",
    "Log",
    "Lookups",
    "Model",
    "Plant",
    "Polyline",
    "PosePath",
    "PoseSample",
    "Push",
    "Quintic",
    "Reading",
    "Sample",
    "Spline",
    "Spring",
    "State",
    "Table",
    "Tag",
    "Trajectory",
    "Trapezoid",
    "Wall",
    "World",
    "check",
    "controllers",
    "detect_tags",
    "errors",
    "find_tag",
    "links",
    "looking_at",
    "metrics",
    "plotting",
    "ready",
    "replay",
    "robot",
    "run",
    "se3",
]
