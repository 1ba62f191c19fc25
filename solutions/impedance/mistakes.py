"""Mistakes that people make in notebook 05."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import labkit as lk

from . import answers as right


def inverse_of_the_wrong(M: Any, J: Any) -> Any:
    """The inverse of J M J^T."""
    return np.linalg.inv(J @ M @ J.T)


def numbers_turned_over(M: Any, J: Any) -> Any:
    """The reciprocal of each entry of the mobility."""
    return 1.0 / (J @ np.linalg.inv(M) @ J.T)


def j_m_jt(M: Any, J: Any) -> Any:
    """J M J^T, which is 6 by 6 and symmetric, as the right matrix is."""
    return J @ M @ J.T


def pseudo_inverses(M: Any, J: Any) -> Any:
    """With pseudo-inverses, which is right for six joints; with seven the elbow is fixed."""
    J_inv = np.linalg.pinv(J)
    return J_inv.T @ M @ J_inv


def mobility(M: Any, J: Any) -> Any:
    """The mobility, without the last inverse."""
    return J @ np.linalg.inv(M) @ J.T


def inverse_by_element(M: Any, J: Any) -> Any:
    """NumPy's 1 / M, entry by entry."""
    return np.linalg.inv(J @ (1.0 / np.asarray(M)) @ J.T)


def diagonal_only(M: Any, J: Any) -> Any:
    """The joints as if they were not coupled."""
    return right.operational_inertia(np.diag(np.diag(M)), J)


def plus_in_front(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """The spring with the plus sign of the report (eq. 21), which pushes away."""
    return right.workspace_impedance(state, target, model, stiffness=-stiffness, damping=damping)


def springs_inside(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """Computed torque at the tip, with the springs multiplied by the inertia."""
    q, dq = state.q, state.dq
    J = model.tip_jacobian(q)
    e, de = lk.se3.pose_error(target.pose, model.pose(q)), target.twist - J @ dq
    a = target.dtwist - model.tip_jacobian_rate(q, dq) @ dq + damping * de + stiffness * e
    return lk.JointTorque(
        J.T @ model.operational_inertia(q) @ a + model.coriolis(q, dq) @ dq + model.gravity(q)
    )


def inverse_for_transpose(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """The pseudo-inverse maps the force, as if it were a speed."""
    q, dq = state.q, state.dq
    J, e = model.tip_jacobian(q), lk.se3.pose_error(target.pose, model.pose(q))
    F = model.operational_inertia(q) @ (target.dtwist - model.tip_jacobian_rate(q, dq) @ dq)
    F = F + damping * (target.twist - J @ dq) + stiffness * e
    tau = np.linalg.pinv(J) @ F + model.coriolis(q, dq) @ dq
    return lk.JointTorque(tau + model.gravity(q))


def tip_terms(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms of the impedance at the tip, and those that are taken for them."""
    q, dq, T_wt = state.q, state.dq, model.pose(state.q)
    J, inertia = model.tip_jacobian(q), model.operational_inertia(q)
    e, V = lk.se3.pose_error(target.pose, T_wt), J @ dq
    position, turn = stiffness * [*e[:3], 0, 0, 0], stiffness * [0, 0, 0, *e[3:]]
    R_tw = T_wt[:3, :3].T
    place = stiffness * [*R_tw @ e[:3], 0, 0, 0]
    in_tool = stiffness * [0, 0, 0, *R_tw @ e[3:]]
    drift, De = model.tip_jacobian_rate(q, dq) @ dq, damping * (target.twist - V)
    law = {
        "the spring of the position": J.T @ position,
        "the spring of the turn": J.T @ turn,
        "the damper": J.T @ De,
    }
    law |= {
        "the part of the target's acceleration": J.T @ inertia @ target.dtwist,
        "the part of J̇ q̇": -J.T @ inertia @ drift,
    }
    law |= {"the Coriolis torque": model.coriolis(q, dq) @ dq, "the weight": model.gravity(q)}
    others = {
        "a damper of the tip's own speed": J.T @ (damping * V),
        "the spring of the turn in the tool's axes": J.T @ in_tool,
    }
    others["the spring of the position in the tool's axes"] = J.T @ place
    others |= {
        "the target's acceleration without Λ": J.T @ target.dtwist,
        "J̇ q̇ without Λ": -J.T @ drift,
    }
    others |= {
        "the damper inside Λ": J.T @ inertia @ De,
        "the springs inside Λ": J.T @ inertia @ (position + turn),
    }
    return law, others


@dataclass(frozen=True)
class ShapedLaw:
    """The shaped impedance with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        inside: Factor of the wrench that accelerates the tip.
        outside: Factor of the hand's share of the force.
        drift: Factor of the acceleration J' dq.
        for_own: Whether the desired inertia replaces the arm's own.
    """

    inside: float = 1.0
    outside: float = 1.0
    drift: float = 1.0
    for_own: bool = False

    def __call__(
        self,
        state: lk.State,
        target: lk.PoseSample,
        wrench: Any,
        model: lk.Model,
        *,
        inertia: Any,
        stiffness: Any,
        damping: Any,
    ) -> lk.JointTorque:
        """The torque."""
        q, dq = state.q, state.dq
        J = model.tip_jacobian(q)
        pull = stiffness * lk.se3.pose_error(target.pose, model.pose(q))
        pull = pull + damping * (target.twist - J @ dq)
        a = target.dtwist - self.drift * model.tip_jacobian_rate(q, dq) @ dq
        a = a + np.linalg.solve(inertia, pull + self.inside * np.asarray(wrench))
        own = inertia if self.for_own else model.operational_inertia(q)
        F = own @ a - self.outside * np.asarray(wrench)
        return lk.JointTorque(J.T @ F + model.coriolis(q, dq) @ dq + model.gravity(q))


def own_inertia(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """Keeps the arm's own inertia, ignoring the desired one."""
    return right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)


def hand_works_twice(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """The motors give the whole torque, to which the hand adds its own."""
    tau = right.shaped_impedance(
        state, target, wrench, model, inertia=inertia, stiffness=stiffness, damping=damping
    )
    return lk.JointTorque(tau.value + model.tip_jacobian(state.q).T @ wrench)


@dataclass(frozen=True)
class MassesOf:
    """Another matrix from M and J.

    Attributes:
        of: The matrix, given M and J.
    """

    of: Callable[[Any, Any], Any]

    def __call__(self, M: Any, J: Any) -> Any:
        """The matrix."""
        return np.asarray(self.of(np.asarray(M), np.asarray(J)))


def spring_terms(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The terms of the springs at the tip alone, and those that are taken for them."""
    law, others = tip_terms(state, target, model, stiffness=stiffness, damping=damping)
    kept = ("the spring of the position", "the spring of the turn", "the damper", "the weight")
    more = {k: v for k, v in law.items() if k not in kept}
    return {k: law[k] for k in kept}, {**more, **others}


def as_printed(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """Equation 21 as it is printed."""
    return right.tip_spring(state, target, model, stiffness=-stiffness, damping=damping)


def at_rest(arm: Any) -> float:
    """The torque of one pose at rest, friction and all."""
    model, ready = arm.model, arm.robot.ready
    m = np.diag(model.mass_matrix(ready))
    log = lk.run(arm, lk.Hold(ready, 2.0), lk.control.springs(100.0 * m, 20.0 * m))
    one = model.tip_jacobian(ready)[:3].T @ [0.0, 0.0, 9.81]
    return float(one @ log.command[-50:].mean(axis=0) / (one @ one))


@dataclass(frozen=True)
class JointSprings:
    """Another stiffness of the joints.

    Attributes:
        of: The matrix, given J, K, the elbow's spring and its direction n n^T.
    """

    of: Callable[[Any, Any, float, Any], Any]

    def __call__(self, J: Any, stiffness: Any, elbow: float) -> Any:
        """The matrix."""
        J, n = np.asarray(J), np.linalg.svd(J)[2][-1]
        return np.asarray(self.of(J, np.diag(stiffness), elbow, np.outer(n, n)))
