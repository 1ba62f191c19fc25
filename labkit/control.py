"""Control: the state that a controller sees, the commands it returns, and three ready controllers.

The type of a command determines its unit and its mode, so a torque cannot be mistaken for a speed.
A controller is any function ``controller(state, target) -> command``; `hold`, `feedforward` and
`springs` are provided, and students write the others in the course.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .errors import ControllerError
from .shapes import Array, as_gains, as_vector, locked
from .trajectory import Sample


class _State(NamedTuple):
    t: float
    q: Array
    dq: Array
    tau_ext: Array


class State(_State):
    """The joints as the arm reports them.

    Attributes:
        t: Time of the measurement, in [s] on the simulation's clock.
        q: Joint angles, shape (n,) in [rad].
        dq: Joint speeds, shape (n,) in [rad/s].
        tau_ext: External joint torque, as the arm estimates it from its torque sensors, shape (n,)
            in [N m]; `Model.tip_wrench` converts it to a wrench.  None means that there is none.
    """

    __slots__ = ()
    __array_ufunc__ = None  # otherwise NumPy would treat the tuple as an array

    def __new__(cls, t: float, q: Array, dq: Array, tau_ext: Array | None = None) -> State:
        """Make a state; the arrays are neither copied nor checked."""
        if tau_ext is None:
            tau_ext = locked(np.zeros(np.shape(q)))
        return super().__new__(cls, t, q, dq, tau_ext)


@dataclass(frozen=True, eq=False)
class _ForJoints:
    value: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", as_vector(self.value, None, type(self).__name__))


class JointPosition(_ForJoints):
    """Go to these joint angles, as fast as speed and torque allow.

    Attributes:
        value: Joint angles, shape (n,) in [rad].
    """


class JointVelocity(_ForJoints):
    """Turn the joints at these speeds.

    Attributes:
        value: Joint speeds, shape (n,) in [rad/s].
    """


class JointTorque(_ForJoints):
    """Drive the joints with these torques, on top of the arm's own gravity compensation, if any.

    Attributes:
        value: Joint torques, shape (n,) in [N m].
    """


Command = JointPosition | JointVelocity | JointTorque
COMMANDS = (JointPosition, JointVelocity, JointTorque)

Controller = Callable[[State, Any], Command]
"""Any function of the state and the target's sample; it need not inherit or register anything."""


def hold(q: Any) -> Callable[[State, Any], JointPosition]:
    """A controller that always commands the joint angles ``q``, as stiffly as the arm allows.

    Args:
        q: Shape (n,) in [rad].
    """
    command = JointPosition(q)

    def hold(state: State, target: Any) -> JointPosition:
        return command

    return hold


def feedforward(state: State, target: Sample) -> JointVelocity:
    """A controller that commands the target's own speeds, so any error remains, and may grow.

    Raises:
        ControllerError: The target does not consist of joint angles.
    """
    if not isinstance(target, Sample) or target.velocity.shape != state.q.shape:
        raise ControllerError(
            "feedforward needs a target of joint angles; model.joint_trajectory(target, q0) "
            "makes one"
        )
    return JointVelocity(target.velocity)


def springs(kp: Any, kd: Any) -> Callable[[State, Sample], JointTorque]:
    """A controller with a spring and a damper at each joint and no model, as in Rethink's example.

    The arm must compensate for gravity itself, or it sags.

    Args:
        kp: Stiffness, shape (n,) or one number, in [N m/rad].
        kd: Damping, shape (n,) or one number, in [N m s/rad].
    """
    stiffness, damping = as_gains(kp, None, "kp"), as_gains(kd, None, "kd")

    def springs(state: State, target: Sample) -> JointTorque:
        e, de = target.position - state.q, target.velocity - state.dq
        return JointTorque(stiffness * e + damping * de)

    return springs
