"""What people write in notebook 03 instead."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk
from labkit.arrays import Array

from ..velocity_control import damped_inverse
from .warmup import euler_subtracted, in_tool_axes


def pushes_away(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """The error with the other sign."""
    e, de = state.q - target.position, state.dq - target.velocity
    return lk.JointVelocity(target.velocity + kp * e + kd * de)


def adds_to_the_measured(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> Any:
    """The report's equation 17: a correction of the speed that the joint has already."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(state.dq + kp * e + kd * de)


def no_feedforward(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """Feedback alone: always late."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(kp * e + kd * de)


def damps_the_motion(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """Damps the speed itself, not its error."""
    e = target.position - state.q
    return lk.JointVelocity(target.velocity + kp * e - kd * state.dq)


def gains_swapped(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """Kp on the speeds, kd on the angles."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(target.velocity + kd * e + kp * de)


def faster_with_d(kp: float, kd: float) -> float:
    """D as a helper of P."""
    return kp * (1.0 + kd)


def second_order(kp: float, kd: float) -> float:
    """The frequency of a mass on a spring, which no mass is here."""
    return float(np.sqrt(kp))


def without_d(kp: float, kd: float) -> float:
    """D left out."""
    return kp


def transposed(J: Any, damping: float) -> Array:
    """The transpose for the inverse."""
    return np.array(J.T)


def undamped(J: Any, damping: float) -> Array:
    """The plain pseudo-inverse."""
    return np.asarray(J.T @ np.linalg.inv(J @ J.T))


def damping_squared(J: Any, damping: float) -> Array:
    """Squares a damping that is lambda squared already."""
    return damped_inverse(J, damping**2)


_MODEL = lk.Model("left")


def _pose(state: lk.State) -> Array:
    """Where the tip is."""
    return _MODEL.pose(state.q)


def _law(
    state: Any, target: Any, J: Any, turn: Any, kp: Any, damping: float, ff: float
) -> lk.JointVelocity:
    e = np.concatenate([target.pose[:3, 3] - _pose(state)[:3, 3], turn])
    return lk.JointVelocity(damped_inverse(J, damping) @ (ff * target.twist + kp * e))


def _turn(state: lk.State, target: lk.PoseSample) -> Array:
    return lk.se3.orientation_error(target.pose[:3, :3], _pose(state)[:3, :3])


def euler_error(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """Roll, pitch and yaw subtracted for the orientation."""
    turn = euler_subtracted(target.pose[:3, :3], _pose(state)[:3, :3])
    return _law(state, target, model.tip_jacobian(state.q), turn, kp, damping, 1.0)


def turn_in_tool_axes(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """The right turn in the tool's axes, with a Jacobian in the world's."""
    turn = in_tool_axes(target.pose[:3, :3], _pose(state)[:3, :3])
    return _law(state, target, model.tip_jacobian(state.q), turn, kp, damping, 1.0)


def body_jacobian(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """An error in world axes with the Jacobian of the tool's axes."""
    J = model.body_jacobian(state.q)
    return _law(state, target, J, _turn(state, target), kp, damping, 1.0)


def position_only(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """No orientation error at all: other teams of the report's year set its gains to zero."""
    return _law(state, target, model.tip_jacobian(state.q), np.zeros(3), kp, damping, 1.0)


def no_twist(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """No feed-forward."""
    J = model.tip_jacobian(state.q)
    return _law(state, target, J, _turn(state, target), kp, damping, 0.0)


def damping_ignored(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> lk.JointVelocity:
    """The plain pseudo-inverse, whatever the damping."""
    J = model.tip_jacobian(state.q)
    return _law(state, target, J, _turn(state, target), kp, 0.0, 1.0)


def transpose_projector(J: Any, dq_wish: Any) -> Array:
    """I - J^T J, with the transpose for the inverse."""
    return np.asarray(dq_wish - J.T @ (J @ dq_wish))


def damped_projector(J: Any, dq_wish: Any) -> Array:
    """The projector made of a damped inverse: the tip drifts."""
    return np.asarray(dq_wish - damped_inverse(J, 0.01) @ (J @ dq_wish))


def the_rest(J: Any, dq_wish: Any) -> Array:
    """The other half: what the tip does feel."""
    return np.asarray(np.linalg.pinv(J) @ (J @ dq_wish))


def all_of_it(J: Any, dq_wish: Any) -> Array:
    """The wish as it is."""
    return np.array(dq_wish)
