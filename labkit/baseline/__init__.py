"""The built-in way, to compare with: plan, time, execute, as MoveIt and Rethink's server do.

Needs the extra ``labkit[baseline]`` (ompl, toppra); its recorded runs need nothing.
"""

from __future__ import annotations

try:
    import ompl as _ompl
    import toppra as _toppra
except ImportError as missing:
    raise ImportError(
        f"the baseline needs {missing.name}, which is not installed: pip install "
        '"labkit[baseline]"; without it, its recorded runs are there: lk.recorded'
    ) from missing

from .collision import Blocked, Box, Scene, table
from .planning import NoWay, along, first_hit, plan
from .server import RATE, PathTolerance, PositionServer, VelocityServer
from .timing import HARDWARE, MOVEIT, Limits, Schedule, quickest

__all__ = [
    "HARDWARE",
    "MOVEIT",
    "RATE",
    "Blocked",
    "Box",
    "Limits",
    "NoWay",
    "PathTolerance",
    "PositionServer",
    "Scene",
    "Schedule",
    "VelocityServer",
    "along",
    "first_hit",
    "plan",
    "quickest",
    "table",
]
