"""Rethink's joint trajectory action server, as two controllers.

The source is joint_trajectory_action.py of baxter_interface, with its cfg files.  The server
evaluates the trajectory a hundred times a second.  In position mode it sends that point to the arm.
In velocity mode it sends a speed proportional to the error, *without* feed-forward, so the arm
trails a moving target by the target's speed divided by kp.  The third mode is left out: its
inverse-dynamics feed-forward is inside the robot and not public.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit.control import JointPosition, JointVelocity, State
from labkit.errors import LabkitError
from labkit.shapes import Array, as_number
from labkit.trajectory import Sample

RATE = 100.0
"""How often the server sends a command, in [Hz]."""


class PathTolerance(LabkitError):
    """The arm strayed too far from its trajectory, and the server gave up."""


@dataclass(frozen=True)
class PositionServer:
    """Position mode, which sends the joint angles of the trajectory.

    Attributes:
        tolerance: Largest joint error before it gives up, in [rad]; Rethink's default.
    """

    tolerance: float = 0.2

    def __post_init__(self) -> None:
        as_number(self.tolerance, "tolerance", above=0.0)

    def __call__(self, state: State, target: Sample) -> JointPosition:
        """The command at this tick; the target's samples are joint angles.

        Raises:
            PathTolerance: The arm is further from its target than the tolerance.
        """
        _error(state, target, self.tolerance)
        return JointPosition(target.position)


@dataclass(frozen=True)
class VelocityServer:
    """Velocity mode, which sends speeds proportional to the error and nothing else.

    Attributes:
        kp: The gain in [1/s]; Rethink's default.
        tolerance: Largest joint error before it gives up, in [rad]; Rethink's default.
    """

    kp: float = 2.0
    tolerance: float = 0.2

    def __post_init__(self) -> None:
        as_number(self.kp, "kp", least=0.0)
        as_number(self.tolerance, "tolerance", above=0.0)

    def __call__(self, state: State, target: Sample) -> JointVelocity:
        """The command at this tick; the target's samples are joint angles.

        Raises:
            PathTolerance: The arm is further from its target than the tolerance.
        """
        return JointVelocity(self.kp * _error(state, target, self.tolerance))


def _error(state: State, target: Any, tolerance: float) -> Array:
    e: Array = target.position - state.q
    worst = int(np.argmax(np.abs(e)))
    if abs(e[worst]) >= tolerance:
        raise PathTolerance(
            f"joint {worst} is {abs(e[worst]):.2g} rad from its trajectory, the tolerance is "
            f"{tolerance:g} rad; start nearer, go slower or allow more"
        )
    return e
