"""Physics engines behind one protocol; only the module of an engine imports that engine."""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec

from ..errors import LabkitError, UnknownName
from ..plant import Plant
from ..robot import Robot
from .engine import Engine

ENGINES = {"pybullet": "PyBullet", "mujoco": "MuJoCo"}
"""The engines' modules and classes; the first one installed is the default."""


def installed() -> list[str]:
    """The engines that are installed."""
    return [name for name in ENGINES if find_spec(name)]


def chosen(name: str | None = None) -> str:
    """Check the name of an engine; None means that of LABKIT_ENGINE, or the first installed.

    Raises:
        UnknownName: There is no such engine.
        LabkitError: The engine is not installed.
    """
    name = name or os.environ.get("LABKIT_ENGINE") or next(iter(installed()), "mujoco")
    if name not in ENGINES:
        raise UnknownName("engine", name, ENGINES)
    if find_spec(name) is None:
        others = ", ".join(installed()) or "none"
        raise LabkitError(
            f"the engine {ENGINES[name]} is not installed here: pip install {name}, which needs a "
            f"compiler where there is no wheel of it; or take one that is installed: {others}"
        )
    return name


def new_arm(name: str, robot: Robot, plant: Plant, dt: float) -> Engine:
    """Make an arm in the engine ``name``, with steps of ``dt`` [s]."""
    made: Engine = getattr(import_module(f".{name}", __name__), ENGINES[name])(robot, plant, dt)
    return made
