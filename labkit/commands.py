"""What a controller sees and says: the state of the joints, and a command for them.

The type of a command carries its unit and its mode, so a torque cannot be taken for a speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .arrays import Array, as_vector, locked

JOINTS = 7

_UNTOUCHED = locked(np.zeros(JOINTS))


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
    tau_ext: Array = _UNTOUCHED


@dataclass(frozen=True, eq=False)
class JointPosition:
    """Go to these joint angles, as fast as speed and torque allow.

    Attributes:
        value: Joint angles, shape (7,) in [rad].
    """

    value: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", as_vector(self.value, JOINTS, "JointPosition"))


@dataclass(frozen=True, eq=False)
class JointVelocity:
    """Turn the joints at these speeds.

    Attributes:
        value: Joint speeds, shape (7,) in [rad/s].
    """

    value: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", as_vector(self.value, JOINTS, "JointVelocity"))


@dataclass(frozen=True, eq=False)
class JointTorque:
    """Drive the joints with these torques, on top of the arm's own gravity compensation, if any.

    Attributes:
        value: Joint torques, shape (7,) in [N m].
    """

    value: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", as_vector(self.value, JOINTS, "JointTorque"))


Command = JointPosition | JointVelocity | JointTorque
COMMANDS = (JointPosition, JointVelocity, JointTorque)


def still() -> JointVelocity:
    """The command that stops the arm where it is."""
    return JointVelocity(np.zeros(JOINTS))
