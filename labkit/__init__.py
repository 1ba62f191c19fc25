"""A small laboratory for robot control: Baxter's arm, simulated, and what is needed to teach it.

Three nouns and a verb: an `Arm`, a `Trajectory`, a controller (any function of state and target),
and `run`.  Everything that a notebook needs is ``lk.something``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import errors, metrics, se3
from .arm import Arm
from .arrays import as_array
from .commands import Command, JointPosition, JointTorque, JointVelocity, State
from .errors import LabkitError
from .model import Link, Model, links
from .motion import Chain, Hold, PosePath, PoseSample, Sample, Trajectory
from .paths import Circle, Line, Polyline, Spline
from .plant import BAXTER, IDEAL, Plant
from .robot import robot
from .run import Controller, Log, run
from .scalings import BangBang, Cubic, Quintic, Trapezoid
from .scene import Push, Spring, Table, Wall
from .world import World

if TYPE_CHECKING:
    from . import check, plotting
    from .ready import ready

__version__ = "0.1.0"

_LATER = {"check": "", "plotting": "", "ready": "ready"}
"""Loaded when first asked for: drawing packages are slow to import."""


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'labkit' has no attribute {name!r}")
    module = import_module(f".{name}", __name__)
    value = getattr(module, _LATER[name]) if _LATER[name] else module
    globals()[name] = value
    return value


__all__ = [
    "BAXTER",
    "IDEAL",
    "Arm",
    "BangBang",
    "Chain",
    "Circle",
    "Command",
    "Controller",
    "Cubic",
    "Hold",
    "JointPosition",
    "JointTorque",
    "JointVelocity",
    "LabkitError",
    "Line",
    "Link",
    "Log",
    "Model",
    "Plant",
    "Polyline",
    "PosePath",
    "PoseSample",
    "Push",
    "Quintic",
    "Sample",
    "Spline",
    "Spring",
    "State",
    "Table",
    "Trajectory",
    "Trapezoid",
    "Wall",
    "World",
    "as_array",
    "check",
    "errors",
    "links",
    "metrics",
    "plotting",
    "ready",
    "robot",
    "run",
    "se3",
]
