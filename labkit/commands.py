"""What a controller sees and says: the state of the joints, and a command for them.

The type of a command carries its unit and its mode, so a torque cannot be taken for a speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .arrays import Array, as_vector, locked
from .robot import JOINTS

NOTHING = locked(np.zeros(JOINTS))
"""No torque, or no speed."""


class State(NamedTuple):
    """The joints as the arm reports them.

    Attributes:
        t: When it was measured, in [s] of the simulation's clock.
        q: Joint angles, shape (7,) in [rad], read-only.
        dq: Joint speeds, shape (7,) in [rad/s], read-only.
        tau_ext: What the world outside puts on the joints, as the arm estimates it from its torque
            sensors, shape (7,) in [N m], read-only; `Model.tip_wrench` makes it a wrench.
    """

    t: float
    q: Array
    dq: Array
    tau_ext: Array = NOTHING


@dataclass(frozen=True, eq=False)
class _ForJoints:
    value: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", as_vector(self.value, JOINTS, type(self).__name__))


class JointPosition(_ForJoints):
    """Go to these joint angles, as fast as speed and torque allow.

    Attributes:
        value: Joint angles, shape (7,) in [rad].
    """


class JointVelocity(_ForJoints):
    """Turn the joints at these speeds.

    Attributes:
        value: Joint speeds, shape (7,) in [rad/s].
    """


class JointTorque(_ForJoints):
    """Drive the joints with these torques, on top of the arm's own gravity compensation, if any.

    Attributes:
        value: Joint torques, shape (7,) in [N m].
    """


Command = JointPosition | JointVelocity | JointTorque
COMMANDS = (JointPosition, JointVelocity, JointTorque)


def still() -> JointVelocity:
    """The command that stops the arm where it is."""
    return JointVelocity(NOTHING)
