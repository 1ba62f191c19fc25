"""The controllers that are given: to hold still, and to follow blindly.  The rest is the course."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .commands import JointPosition, JointVelocity, State
from .errors import ControllerError
from .motion import Sample


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
