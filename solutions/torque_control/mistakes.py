"""Mistakes that people make in notebook 04."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

import labkit as lk

from . import answers as right


def always_carries(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """Adds the weight although the arm carries it already."""
    return right.augmented_pd(state, target, model, kp=kp, kd=kd, arm_compensates=False)


def model_at_the_target(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """M, C and g at the target, not at the arm's state."""
    there = lk.State(state.t, target.position, state.dq)
    at_rest = target._replace(position=target.position)
    tau = right.augmented_pd(there, at_rest, model, kp=kp, kd=kd, arm_compensates=arm_compensates)
    return lk.JointTorque(tau.value + kp * (target.position - state.q))


@dataclass(frozen=True)
class AugmentedLaw:
    """The augmented law with one slip.

    Attributes:
        switch: Whether the gravity switch is inverted.
        swapped: Whether kp and kd are exchanged.
        at_target: Whether C is taken at the target's speed.
    """

    switch: bool = False
    swapped: bool = False
    at_target: bool = False

    def __call__(
        self,
        state: lk.State,
        target: lk.Sample,
        model: lk.Model,
        *,
        kp: Any,
        kd: Any,
        arm_compensates: bool,
    ) -> lk.JointTorque:
        """The torque."""
        q, dq_d = state.q, target.velocity
        if self.swapped:
            kp, kd = kd, kp
        flag = arm_compensates != self.switch
        tau = right.augmented_pd(state, target, model, kp=kp, kd=kd, arm_compensates=flag).value
        if self.at_target:
            tau = tau + (model.coriolis(q, dq_d) - model.coriolis(q, state.dq)) @ dq_d
        return lk.JointTorque(tau)


@dataclass(frozen=True)
class ComputedLaw:
    """Computed torque with one slip.

    Attributes:
        power: Power of M; -1 is its inverse.
        swapped: Whether kp and kd are exchanged.
    """

    power: int = 1
    swapped: bool = False

    def __call__(
        self,
        state: lk.State,
        target: lk.Sample,
        model: lk.Model,
        *,
        kp: Any,
        kd: Any,
        arm_compensates: bool,
    ) -> lk.JointTorque:
        """The torque."""
        q, dq = state.q, state.dq
        kp, kd = (kd, kp) if self.swapped else (kp, kd)
        C = model.coriolis(q, dq) @ dq
        a = target.acceleration + kp * (target.position - q)
        a = a + kd * (target.velocity - dq)
        tau = np.linalg.matrix_power(model.mass_matrix(q), self.power) @ a + C
        return lk.JointTorque(tau if arm_compensates else tau + model.gravity(q))


def gains_outside(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """The gains outside M, so that every joint responds differently."""
    q, dq = state.q, state.dq
    tau = right.computed_torque(
        state, target, model, kp=0.0, kd=0.0, arm_compensates=arm_compensates
    ).value
    return lk.JointTorque(tau + kp * (target.position - q) + kd * (target.velocity - dq))


def everything_at_the_target(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """M, C and g at the target's angles and speeds."""
    q, dq = target.position, target.velocity
    ddq = target.acceleration + kp * (q - state.q) + kd * (dq - state.dq)
    tau = model.mass_matrix(q) @ ddq + model.coriolis(q, dq) @ dq
    return lk.JointTorque(tau if arm_compensates else tau + model.gravity(q))


def augmented_terms(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms of the augmented law, and those that are taken for them."""
    M, C = model.mass_matrix(state.q), model.coriolis(state.q, state.dq)
    J, free = model.tip_jacobian(state.q), not arm_compensates
    e, de = target.position - state.q, target.velocity - state.dq
    law = {
        "the part of the target's acceleration": M @ target.acceleration,
        "the Coriolis part": C @ target.velocity,
    }
    law |= {"the spring `kp e`": kp * e, "the damper `kd ė`": kd * de}
    others = {
        "`C` times the arm's own speed": C @ state.dq,
        "`kd` times the arm's own speed": kd * state.dq,
        "`kp e` inside M": M @ (kp * e),
        "the weight at the target's angles": model.gravity(target.position) * free,
        "the report's gravity": 0.981 * M @ J[2] * free,
    }
    others |= {"`kd ė` inside M": M @ (kd * de), "`kd e`": kd * e, "`kp ė`": kp * de}
    return _with_weight(law, others, model.gravity(state.q), arm_compensates)


def computed_terms(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms of computed torque, and those that are taken for them."""
    M, C = model.mass_matrix(state.q), model.coriolis(state.q, state.dq)
    e, de = target.position - state.q, target.velocity - state.dq
    law = {
        "the part of the target's acceleration": M @ target.acceleration,
        "the spring `kp e`": M @ (kp * e),
        "the damper `kd ė`": M @ (kd * de),
    }
    law |= {"the Coriolis torque": C @ state.dq}
    others = {
        "`C` times the target's speed": C @ target.velocity,
        "`kd` times the arm's own speed": M @ (kd * state.dq),
        "`kp e` outside M": kp * e,
    }
    others |= {"`kd ė` outside M": kd * de, "`kd e`": M @ (kd * e), "`kp ė`": M @ (kp * de)}
    return _with_weight(law, others, model.gravity(state.q), arm_compensates)


def _with_weight(
    law: dict[str, Any], others: dict[str, Any], g: Any, arm_compensates: bool
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms, with the weight where the law has it and where it does not."""
    law["the weight where the arm does not carry it"] = g * (not arm_compensates)
    others["the weight where the arm carries it"] = g * arm_compensates
    return law, others


def not_a_step(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """The matrix of the differential equation."""
    return np.array([[0.0, 1.0], [-kp / inertia, -kd / inertia]])


def on_its_side(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """The transposed matrix."""
    return right.sampled_joint(inertia, kp, kd, dt).T


def times_inertia(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """Multiplies with the inertia instead of dividing."""
    return right.sampled_joint(1.0 / inertia, kp, kd, dt)


def gains_of_the_other(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """Kp on the speed and kd on the angle."""
    return right.sampled_joint(inertia, kd, kp, dt)


def half_forgotten(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """The damper moves the speed within the step, but not the angle."""
    A = np.array(right.sampled_joint(inertia, kp, kd, dt))
    A[0, 1] = dt
    return A


def implicit_step(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """Backward Euler, which is stable for all gains."""
    return np.linalg.inv(np.eye(2) - dt * not_a_step(inertia, kp, kd, dt))


def euler_step(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """I + A dt, in which the angle moves with the old speed."""
    return np.array([[1.0, dt], [-kp * dt / inertia, 1.0 - kd * dt / inertia]])


def torque_never_held(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """The exponential of the loop in continuous time, which is stable for all gains."""
    from scipy.linalg import expm

    return expm(dt * np.array([[0.0, 1.0], [-kp / inertia, -kd / inertia]]))


def new_speed_first(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """Semi-implicit Euler, in which the angle moves with the new speed."""
    drive = np.array([-kp * dt / inertia, 1.0 - kd * dt / inertia])
    return np.array([[1.0 + dt * drive[0], dt * drive[1]], drive])


def pushes_away(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """The torque with the wrong sign."""
    return right.sampled_joint(inertia, -kp, -kd, dt)


def without_inertia(inertia: float, kp: float, kd: float, dt: float) -> Any:
    """Takes torque for acceleration."""
    return right.sampled_joint(1.0, kp, kd, dt)


@dataclass(frozen=True)
class Swings:
    """Gains with which every joint swings at the same frequency.

    Attributes:
        w: The angular frequency in [rad/s].
        zeta: The damping ratio.
    """

    w: float = 12.0
    zeta: float = 1.0

    def __call__(self, model: lk.Model) -> tuple[Any, Any]:
        """The gains."""
        inertia = np.diag(model.mass_matrix(model.robot.ready))
        return self.w**2 * inertia, 2.0 * self.zeta * self.w * inertia


def same_for_every_joint(model: lk.Model) -> Any:
    """The gains of computed torque, as if every joint had inertia 1."""
    return 144.0, 24.0


def pair_turned_round(model: lk.Model) -> Any:
    """Returns (kd, kp), hardly a spring but a very strong damper."""
    kp, kd = Swings()(model)
    return kd, kp


class Terms(NamedTuple):
    """The terms of a torque law; g is zero if the arm compensates for gravity."""

    M: Any
    C: Any
    g: Any
    e: Any
    de: Any
    kp: Any
    kd: Any
    state: lk.State
    target: lk.Sample
    model: lk.Model

    @property
    def motion(self) -> Any:
        """M ddq_d + C dq_d."""
        return self.M @ self.target.acceleration + self.C @ self.target.velocity

    @property
    def wish(self) -> Any:
        """The acceleration with which the error decays."""
        return self.target.acceleration + self.kp * self.e + self.kd * self.de

    @property
    def drift(self) -> Any:
        """C dq."""
        return self.C @ self.state.dq

    @property
    def pull(self) -> Any:
        """Springs and dampers."""
        return self.kp * self.e + self.kd * self.de


@dataclass(frozen=True)
class TorqueBy:
    """A law of the model's terms.

    Attributes:
        law: The torque, given `Terms`.
    """

    law: Callable[[Terms], Any]

    def __call__(
        self,
        state: lk.State,
        target: lk.Sample,
        model: lk.Model,
        *,
        kp: Any,
        kd: Any,
        arm_compensates: bool,
    ) -> lk.JointTorque:
        """The torque."""
        q, dq = state.q, state.dq
        g = model.gravity(q) * (not arm_compensates)
        M, C = model.mass_matrix(q), model.coriolis(q, dq)
        e, de = target.position - q, target.velocity - dq
        return lk.JointTorque(self.law(Terms(M, C, g, e, de, kp, kd, state, target, model)))


@dataclass(frozen=True)
class Stepped:
    """One period with another free motion.

    Attributes:
        free: The free motion, given dt.
    """

    free: Callable[[float], Any]

    def __call__(self, inertia: float, kp: float, kd: float, dt: float) -> Any:
        """The matrix."""
        return np.asarray(self.free(dt)) - np.outer([dt**2 / 2.0 / inertia, dt / inertia], [kp, kd])


def as_printed(
    state: lk.State, target: lk.Sample, model: lk.Model, *, kp: Any, kd: Any, arm_compensates: bool
) -> lk.JointTorque:
    """Equation 18 as it is printed, with the report's gravity."""
    q, dq = state.q, state.dq
    M, J = model.mass_matrix(q), model.tip_jacobian(q)
    tau = right.augmented_pd(state, target, model, kp=kp, kd=kd, arm_compensates=True).value
    tau = tau + model.coriolis(q, dq) @ (dq - target.velocity)
    return lk.JointTorque(tau + M @ J.T @ [0.0, 0.0, 0.981, 0.0, 0.0, 0.0])


def compares_the_whole_run(log: lk.Log) -> str:
    """The law that fits the whole run, also before the mistake entered."""
    off = {x: np.abs(log.command - lk.course.commanded(log, x)).max() for x in "abcdefgh"}
    return min(off, key=lambda x: off[x])
