"""The built-in method, as a baseline: plan, time and execute as MoveIt and Rethink's server do.

The method needs the extra ``labkit[book]`` (ompl, toppra); its recorded runs do not.
"""

from __future__ import annotations

try:
    from .collision import Blocked, Box, PlanningScene
    from .planning import NoWay, along, first_hit, plan
    from .server import RATE, PathTolerance, PositionServer, VelocityServer
    from .timing import HARDWARE, MOVEIT, JointLimits, Schedule, quickest
except ModuleNotFoundError as missing:
    raise ModuleNotFoundError(
        f'the baseline needs {missing.name}, which is not installed: pip install "labkit[book]"'
        "; its recorded runs need nothing: labkit.recordings.names()",
        name=missing.name,
    ) from missing

__all__ = [
    "HARDWARE",
    "MOVEIT",
    "RATE",
    "Blocked",
    "Box",
    "JointLimits",
    "NoWay",
    "PathTolerance",
    "PlanningScene",
    "PositionServer",
    "Schedule",
    "VelocityServer",
    "along",
    "first_hit",
    "plan",
    "quickest",
]
