"""Mistakes that people make in notebook 03."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array

from .answers import damped_inverse


def adds_to_the_measured(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> Any:
    """The report's equation 17, which corrects the speed that the joint already has."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(state.dq + kp * e + kd * de)


def no_feedforward(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """Feedback only, which is always late."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(kp * e + kd * de)


def pushes_away(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """The error of the angles with the other sign."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(target.velocity - kp * e + kd * de)


def kp_on_all(state: lk.State, target: lk.Sample, *, kp: Any, kd: Any) -> lk.JointVelocity:
    """Multiplies the feed-forward by kp, too."""
    e, de = target.position - state.q, target.velocity - state.dq
    return lk.JointVelocity(kp * (target.velocity + e) + kd * de)


def joint_terms(
    state: lk.State, target: lk.Sample, *, kp: Any, kd: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms of the joint law, and those that are taken for them."""
    e, de = target.position - state.q, target.velocity - state.dq
    law = {
        "the target's speed": target.velocity,
        "`kp` times the error": kp * e,
        "`kd` times the rate of the error": kd * de,
    }
    others = {
        "the joints' own speed": state.dq,
        "`kd` times the joint's own speed": kd * state.dq,
        "the target's acceleration": target.acceleration,
    }
    return law, others | {
        "`kd` times the error": kd * e,
        "`kp` times the rate of the error": kp * de,
    }


def workspace_terms(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms of the workspace law, and those that are taken for them."""
    T_wt, V_d = model.pose(state.q), target.twist
    J = model.tip_jacobian(state.q)
    back = damped_inverse(J, damping)
    e = lk.se3.pose_error(target.pose, T_wt)
    in_tool = T_wt[:3, :3].T @ e[3:]
    position, turn = np.array([*e[:3], 0, 0, 0]), np.array([0, 0, 0, *e[3:]])
    law = {
        "the target's linear velocity": back @ [*V_d[:3], 0, 0, 0],
        "the target's angular velocity": back @ [0, 0, 0, *V_d[3:]],
    }
    law |= {
        "the error of the position": back @ (kp * position),
        "the error of the turn": back @ (kp * turn),
    }
    others = {
        "the joints' own speed": state.dq,
        "the tip's own twist": back @ (J @ state.dq),
        "the target's twist times `kp`": back @ (kp * V_d),
    }
    others |= {
        "the error of the position without `kp`": back @ position,
        "the error of the turn without `kp`": back @ turn,
    }
    others["the error of the turn in the tool's axes"] = back @ (kp * np.array([0, 0, 0, *in_tool]))
    return law, others


def damping_everywhere(J: Any, damping: float) -> Array:
    """Adds the damping to every entry of J J^T, without the identity."""
    return np.asarray(J.T @ np.linalg.inv(J @ J.T + damping))


def sine_of_the_turn(R_wd: Array, R_wt: Array) -> Array:
    """Half the sum of the axes' cross products: the sine of the angle, not the angle."""
    return np.asarray(0.5 * np.cross(R_wt.T, R_wd.T).sum(axis=0))


@dataclass(frozen=True)
class WorkspaceLaw:
    """The workspace law with another error, Jacobian or inverse.

    Attributes:
        turn: The error of orientation, given (R_wd, R_wt).
        inverse: The inverse of a Jacobian, given the damping.
        in_tool: Whether the Jacobian is the one in the tool's axes.
    """

    turn: Callable[[Array, Array], Array] = lk.se3.orientation_error
    inverse: Callable[[Array, float], Array] = damped_inverse
    in_tool: bool = False

    def __call__(
        self, state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
    ) -> lk.JointVelocity:
        """The command."""
        T_wt = model.pose(state.q)
        e_p = target.pose[:3, 3] - T_wt[:3, 3]
        e = np.concatenate([e_p, self.turn(target.pose[:3, :3], T_wt[:3, :3])])
        J = model.body_jacobian(state.q) if self.in_tool else model.tip_jacobian(state.q)
        return lk.JointVelocity(self.inverse(J, damping) @ (target.twist + kp * e))


def transpose_projector(J: Any, dq_wish: Any) -> Array:
    """I - J^T J, with the transpose instead of the inverse."""
    return np.asarray(dq_wish - J.T @ (J @ dq_wish))


def damped_projector(J: Any, dq_wish: Any) -> Array:
    """The projector from a damped inverse, with which the tip drifts."""
    return np.asarray(dq_wish - damped_inverse(J, 0.01) @ (J @ dq_wish))


def the_rest(J: Any, dq_wish: Any) -> Array:
    """The other part, which moves the tip."""
    return np.asarray(np.linalg.pinv(J) @ (J @ dq_wish))


@dataclass(frozen=True)
class Rate:
    """Another formula for the rate.

    Attributes:
        of: The rate, given kp and kd.
    """

    of: Callable[[float, float], float]

    def __call__(self, kp: float, kd: float) -> float:
        """The rate."""
        return float(self.of(kp, kd))


@dataclass(frozen=True)
class BySingularValues:
    """An inverse with other factors than s / (s^2 + damping).

    Attributes:
        factor: The factor, given s and the damping.
    """

    factor: Callable[[Array, float], Array]

    def __call__(self, J: Any, damping: float) -> Array:
        """The inverse."""
        U, s, Vt = np.linalg.svd(np.asarray(J), full_matrices=False)
        return np.asarray(Vt.T @ (self.factor(s, damping)[:, None] * U.T))


@dataclass(frozen=True)
class TwistLaw:
    """The workspace law with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        turn_first: Whether the orientation error comes before the position error.
        on_all: Whether kp multiplies the feed-forward, too.
    """

    turn_first: bool = False
    on_all: bool = False

    def __call__(
        self, state: lk.State, target: lk.PoseSample, model: lk.Model, *, kp: Any, damping: float
    ) -> lk.JointVelocity:
        """The command."""
        e = lk.se3.pose_error(target.pose, model.pose(state.q))
        e = np.roll(e, 3) if self.turn_first else e
        V = (kp * target.twist if self.on_all else target.twist) + kp * e
        return lk.JointVelocity(damped_inverse(model.tip_jacobian(state.q), damping) @ V)


def place_alone(J: Any, dq_wish: Any) -> Array:
    """Holds the position of the tip but not its orientation."""
    return np.asarray(dq_wish - np.linalg.pinv(J[:3]) @ (J[:3] @ dq_wish))


def a_column_of_v(J: Any, dq_wish: Any) -> Array:
    """The last column of V^T where its last row belongs."""
    n = np.linalg.svd(np.asarray(J))[2][:, -1]
    return np.asarray(n * (n @ dq_wish))


@dataclass(frozen=True)
class Lag:
    """A wrong reading of a step of the speed.

    Attributes:
        read: What is read from the log.
    """

    read: Callable[[lk.Log], Any]

    def __call__(self, arm: lk.Arm) -> float:
        """The lag."""
        command = lk.JointVelocity(STEP * np.eye(7)[0])
        return float(self.read(lk.run(arm, lk.Hold(arm.robot.ready, 1.0), lambda *_: command)))


STEP = 0.4
"""The speed of the step, in [rad/s]."""


def behind(log: lk.Log, q: Any) -> Array:
    """How far the first joint is behind in time, in [s], in the second half of a step."""
    return np.asarray((log.t - (q - q[0])[:, 0] / STEP)[log.t > 0.5])


def reaches(log: lk.Log, share: float) -> float:
    """When the speed reaches a share of the step, in [s]."""
    return float(log.t[np.argmax(log.dq[:, 0] >= share * STEP)])
