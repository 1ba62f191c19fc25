"""The controllers that are given: hold still, follow blindly, springs.  The rest is the course."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .arrays import as_gains
from .commands import JointPosition, JointTorque, JointVelocity, State
from .errors import ControllerError
from .motion import Sample
from .robot import JOINTS


def hold(q: Any) -> Callable[[State, Any], JointPosition]:
    """A controller that asks for the joint angles ``q``, whatever the target: as stiff as it gets.

    Args:
        q: Shape (7,) in [rad].
    """
    command = JointPosition(q)

    def hold(state: State, target: Any) -> JointPosition:
        return command

    return hold


def feedforward(state: State, target: Sample) -> JointVelocity:
    """The target's own speeds and nothing else: what errors there are stay, and grow.

    Raises:
        ControllerError: The target is not one of joint angles.
    """
    if not isinstance(target, Sample) or target.velocity.shape != state.q.shape:
        raise ControllerError(
            "feedforward needs a target of joint angles; model.joint_trajectory(target, q0) "
            "makes one"
        )
    return JointVelocity(target.velocity)


def springs(kp: Any, kd: Any) -> Callable[[State, Sample], JointTorque]:
    """A spring and a damper at each joint and no model behind them, as in Rethink's own example.

    The arm must carry its own weight, or it sags.

    Args:
        kp: Stiffness, shape (7,) or one number, in [N m/rad].
        kd: Damping, shape (7,) or one number, in [N m s/rad].
    """
    stiffness, damping = as_gains(kp, JOINTS, "kp"), as_gains(kd, JOINTS, "kd")

    def springs(state: State, target: Sample) -> JointTorque:
        e, de = target.position - state.q, target.velocity - state.dq
        return JointTorque(stiffness * e + damping * de)

    return springs
