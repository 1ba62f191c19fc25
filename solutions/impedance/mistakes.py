"""Mistakes that people make in notebook 05."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import labkit as lk

from . import answers as right


def spring_pushes_away(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """The spring with the other sign."""
    return right.msd(state, target, force, m=m, b=b, k=-k)


def force_twice(state: Any, target: Any, force: float, *, m: float, b: float, k: float) -> float:
    """The external force twice, with the springs and again outside (the report's eq. 19)."""
    return right.msd(state, target, force, m=m, b=b, k=k) + force


def hand_pushed_back(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """Takes the force on the mass for the force by the mass."""
    return right.msd(state, target, -force, m=m, b=b, k=k)


def damps_all_motion(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """A damper against the fixed world, not against the target's velocity."""
    return right.msd(state, target, force, m=m, b=b, k=k) - b * float(target[1]) / m


def forgets_the_targets_acceleration(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """No feed-forward of acceleration, so the mass always lags."""
    return right.msd(state, (*target[:2], 0.0), force, m=m, b=b, k=k)


def force_not_acceleration(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """Returns a force instead of an acceleration."""
    return m * right.msd(state, target, force, m=m, b=b, k=k)


def spring_to_the_origin(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """A spring to the origin and a damper to the target."""
    return right.msd(state, (0.0, *target[1:]), force, m=m, b=b, k=k)


def energy_for_force(
    state: Any, target: Any, force: float, *, m: float, b: float, k: float
) -> float:
    """The energy of the spring instead of its force."""
    energy = 0.5 * k * float(target[0] - state[0]) ** 2
    return right.msd(state, target, force + energy, m=m, b=b, k=0.0)


@dataclass(frozen=True)
class OneMass:
    """The mass with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        spring: Factor of the spring.
        damper: Factor of the damper.
        force: Factor of the hand's force.
        feed: Factor of the target's acceleration.
        per_mass: Factor of the target's acceleration, divided by the mass.
        follows: Factor of all that belongs to the target.
        power: Power of the mass in the denominator.
        swapped: Whether stiffness and damping are exchanged.
    """

    spring: float = 1.0
    damper: float = 1.0
    force: float = 1.0
    feed: float = 1.0
    per_mass: float = 0.0
    follows: float = 1.0
    power: float = 1.0
    swapped: bool = False

    def __call__(
        self, state: Any, target: Any, force: float, *, m: float, b: float, k: float
    ) -> float:
        """The acceleration."""
        (x, dx), (x_d, dx_d, ddx_d) = state, (self.follows * part for part in target)
        b, k = (k, b) if self.swapped else (b, k)
        pull = self.spring * k * (x_d - x) + self.damper * b * (dx_d - dx)
        total = self.force * force + pull + self.per_mass * ddx_d
        return float(self.feed * ddx_d + total / m**self.power)


def inverse_of_the_wrong(M: Any, J: Any) -> Any:
    """The inverse of J M J^T."""
    return np.linalg.inv(J @ M @ J.T)


def each_axis_alone(M: Any, J: Any) -> Any:
    """Only the diagonal of the right matrix."""
    return np.diag(np.diag(right.operational_inertia(M, J)))


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


@dataclass(frozen=True)
class WithTorque:
    """The right law plus a torque that follows from the state."""

    torque: Callable[[lk.State], np.ndarray]

    def __call__(
        self,
        state: lk.State,
        target: lk.PoseSample,
        model: lk.Model,
        *,
        stiffness: Any,
        damping: Any,
    ) -> lk.JointTorque:
        """The torque."""
        tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
        return lk.JointTorque(tau.value + self.torque(state))


def plus_in_front(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """The spring with the plus sign of the report (eq. 21), which pushes away."""
    return right.workspace_impedance(state, target, model, stiffness=-stiffness, damping=damping)


def joint_inertia_for_tip(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """M J^T times the target's acceleration, as the report's program had it."""
    q, dq = state.q, state.dq
    still = target._replace(dtwist=np.zeros(6))
    tau = right.workspace_impedance(state, still, model, stiffness=stiffness, damping=damping).value
    drift = model.operational_inertia(q) @ model.tip_jacobian_rate(q, dq) @ dq
    feed = model.mass_matrix(q) @ model.tip_jacobian(q).T @ target.dtwist
    return lk.JointTorque(tau + model.tip_jacobian(q).T @ drift + feed)


def no_drift(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """Forgets that the tip accelerates even at constant joint speeds."""
    q, dq = state.q, state.dq
    tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
    drift = model.operational_inertia(q) @ model.tip_jacobian_rate(q, dq) @ dq
    return lk.JointTorque(tau.value + model.tip_jacobian(q).T @ drift)


def weightless(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """No gravity."""
    tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
    return lk.JointTorque(tau.value - model.gravity(state.q))


def body_jacobian(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """A wrench in world axes through the Jacobian of the tool's axes."""
    q, dq = state.q, state.dq
    tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
    e, de = (
        lk.se3.pose_error(target.pose, model.pose(q)),
        target.twist - model.tip_jacobian(q) @ dq,
    )
    wrench = damping * de + stiffness * e
    return lk.JointTorque(
        tau.value + (model.body_jacobian(q) - model.tip_jacobian(q)).T @ np.asarray(wrench)
    )


def euler_subtraction(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """The orientation error as a difference of roll, pitch and yaw."""
    T = model.pose(state.q)
    wrong = _euler(target.pose) - _euler(T)
    correct = lk.se3.pose_error(target.pose, T)[3:]
    tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
    K = stiffness * np.ones(6)
    return lk.JointTorque(
        tau.value + model.tip_jacobian(state.q)[3:].T @ (K[3:] * (wrong - correct))
    )


def _euler(T: Any) -> Any:
    R = T[:3, :3]
    return np.array(
        [
            np.arctan2(R[2, 1], R[2, 2]),
            np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2])),
            np.arctan2(R[1, 0], R[0, 0]),
        ]
    )


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


def brakes_the_motion(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """A damper against the fixed world, not against the target's velocity."""
    tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
    pull = damping * np.asarray(target.twist)
    return lk.JointTorque(tau.value - model.tip_jacobian(state.q).T @ pull)


def brakes_behind_speeds(
    state: lk.State, target: lk.PoseSample, model: lk.Model, *, stiffness: Any, damping: Any
) -> lk.JointTorque:
    """A damper of the elbow behind I - pinv(J) J, the projector for speeds, so the tip feels it."""
    tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
    J = model.tip_jacobian(state.q)
    return lk.JointTorque(tau.value - 2.0 * (state.dq - np.linalg.pinv(J) @ (J @ state.dq)))


@dataclass(frozen=True)
class AlongTheTool:
    """The impedance with springs along the tool's axes.

    Attributes:
        dampers: Whether the dampers are along the tool's axes, too.
    """

    dampers: bool = False

    def __call__(
        self,
        state: lk.State,
        target: lk.PoseSample,
        model: lk.Model,
        *,
        stiffness: Any,
        damping: Any,
    ) -> lk.JointTorque:
        """The torque."""
        q, T_wt = state.q, model.pose(state.q)
        R = np.kron(np.eye(2), T_wt[:3, :3])
        J, e = model.tip_jacobian(q), lk.se3.pose_error(target.pose, T_wt)
        de = target.twist - J @ state.dq
        more = R @ (stiffness * (R.T @ e)) - stiffness * e
        more = more + self.dampers * (R @ (damping * (R.T @ de)) - damping * de)
        tau = right.workspace_impedance(state, target, model, stiffness=stiffness, damping=damping)
        return lk.JointTorque(tau.value + J.T @ more)


@dataclass(frozen=True)
class TipLaw:
    """The impedance with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        e: Factor of the error.
        turn: Factor of the orientation error.
        de: Factor of the error of the twist.
        feed: Factor of the target's acceleration.
        drift: Factor of the acceleration J' dq.
        coriolis: Factor of C.
        weight: Factor of g.
        power: Power of the tip's inertia.
        swapped: Whether stiffness and damping are exchanged.
        pinv: Whether the pseudo-inverse replaces the transpose.
        body: Whether the Jacobian is that of the tool's axes.
        place_in_tool: Whether the error of position is in the tool's axes.
        turn_in_tool: Whether the error of orientation is in the tool's axes.
    """

    e: float = 1.0
    turn: float = 1.0
    de: float = 1.0
    feed: float = 1.0
    drift: float = 1.0
    coriolis: float = 1.0
    weight: float = 1.0
    power: int = 1
    swapped: bool = False
    pinv: bool = False
    body: bool = False
    place_in_tool: bool = False
    turn_in_tool: bool = False

    def __call__(
        self,
        state: lk.State,
        target: lk.PoseSample,
        model: lk.Model,
        *,
        stiffness: Any,
        damping: Any,
    ) -> lk.JointTorque:
        """The torque."""
        q, dq, T_wt = state.q, state.dq, model.pose(state.q)
        K, D = (damping, stiffness) if self.swapped else (stiffness, damping)
        J = (model.body_jacobian if self.body else model.tip_jacobian)(q)
        R_tw, inertia = T_wt[:3, :3].T, model.operational_inertia(q)
        e = self.e * lk.se3.pose_error(target.pose, T_wt)
        place = R_tw @ e[:3] if self.place_in_tool else e[:3]
        turn = R_tw @ e[3:] if self.turn_in_tool else e[3:]
        e = np.concatenate([place, self.turn * turn])
        de = self.de * (target.twist - J @ dq)
        a = self.feed * target.dtwist - self.drift * model.tip_jacobian_rate(q, dq) @ dq
        F = np.linalg.matrix_power(inertia, self.power) @ a + D * de + K * e
        tau = (np.linalg.pinv(J) if self.pinv else J.T) @ F
        tau = tau + self.coriolis * model.coriolis(q, dq) @ dq + self.weight * model.gravity(q)
        return lk.JointTorque(tau)


@dataclass(frozen=True)
class ShapedLaw:
    """The shaped impedance with weighted terms; 1 is right, 0 omits a term, -1 reverses it.

    Attributes:
        e: Factor of the errors of pose and twist.
        inside: Factor of the wrench that accelerates the tip.
        outside: Factor of the hand's share of the force.
        feed: Factor of the target's acceleration.
        drift: Factor of the acceleration J' dq.
        coriolis: Factor of C.
        weight: Factor of g.
        pinv: Whether the pseudo-inverse replaces the transpose.
        for_own: Whether the desired inertia replaces the arm's own.
    """

    e: float = 1.0
    inside: float = 1.0
    outside: float = 1.0
    feed: float = 1.0
    drift: float = 1.0
    coriolis: float = 1.0
    weight: float = 1.0
    pinv: bool = False
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
        pull = self.e * (pull + damping * (target.twist - J @ dq))
        a = self.feed * target.dtwist - self.drift * model.tip_jacobian_rate(q, dq) @ dq
        a = a + np.linalg.solve(inertia, pull + self.inside * np.asarray(wrench))
        own = inertia if self.for_own else model.operational_inertia(q)
        F = own @ a - self.outside * np.asarray(wrench)
        tau = (np.linalg.pinv(J) if self.pinv else J.T) @ F
        return lk.JointTorque(
            tau + self.coriolis * model.coriolis(q, dq) @ dq + self.weight * model.gravity(q)
        )


def force_added_plainly(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """The measured wrench added to the law, as if to help the hand."""
    tau = force_forgotten(
        state, target, wrench, model, inertia=inertia, stiffness=stiffness, damping=damping
    )
    return lk.JointTorque(tau.value + model.tip_jacobian(state.q).T @ wrench)


def wrench_of_the_robot(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """Takes the wrench on the arm for the one by the arm."""
    return right.shaped_impedance(
        state,
        target,
        -np.asarray(wrench),
        model,
        inertia=inertia,
        stiffness=stiffness,
        damping=damping,
    )


def force_forgotten(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """Another inertia without measuring anything."""
    return right.shaped_impedance(
        state, target, np.zeros(6), model, inertia=inertia, stiffness=stiffness, damping=damping
    )


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


def the_reports_equation(
    state: lk.State,
    target: lk.PoseSample,
    wrench: Any,
    model: lk.Model,
    *,
    inertia: Any,
    stiffness: Any,
    damping: Any,
) -> lk.JointTorque:
    """The report's equation 19, with the wrench outside and again inside as an acceleration."""
    tau = force_forgotten(
        state, target, wrench, model, inertia=inertia, stiffness=stiffness, damping=damping
    )
    inside = model.operational_inertia(state.q) @ wrench
    return lk.JointTorque(tau.value + model.tip_jacobian(state.q).T @ (wrench + inside))


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


def element_by_element(force: Any, displacement: Any) -> Any:
    """Force over displacement in each axis."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.diag(np.nanmean(np.asarray(force) / np.asarray(displacement), axis=0))


def through_the_origin(force: Any, displacement: Any) -> Any:
    """A fit without an offset."""
    return np.linalg.lstsq(np.asarray(displacement), np.asarray(force), rcond=None)[0].T


def compliance(force: Any, displacement: Any) -> Any:
    """Metres per newton instead of newtons per metre."""
    return np.linalg.inv(right.apparent_stiffness(force, displacement))


def transposed(force: Any, displacement: Any) -> Any:
    """The result of `lstsq` as it is, whose rows are the columns of K."""
    return right.apparent_stiffness(force, displacement).T


def other_regression(force: Any, displacement: Any) -> Any:
    """Fits the displacement to the force and inverts, although the noise is in the force."""
    return np.linalg.inv(right.apparent_stiffness(displacement, force))


def arm_against_hand(force: Any, displacement: Any) -> Any:
    """The force by the arm, which makes the stiffness negative."""
    return -right.apparent_stiffness(force, displacement)


def transposed_through_the_origin(force: Any, displacement: Any) -> Any:
    """The result of `lstsq` without an offset, as it is."""
    return through_the_origin(force, displacement).T


def regression_of_the_displacement(force: Any, displacement: Any) -> Any:
    """Fits the displacement to the force, in metres per newton."""
    return right.apparent_stiffness(displacement, force)


def diagonal_of_the_fit(force: Any, displacement: Any) -> Any:
    """The stiffness along each axis alone."""
    return np.diag(np.diag(right.apparent_stiffness(force, displacement)))


def made_symmetric(force: Any, displacement: Any) -> Any:
    """The mean of the fit and its transpose, although a measured K need not be symmetric."""
    K = right.apparent_stiffness(force, displacement)
    return (K + K.T) / 2.0


def in_millimetres(force: Any, displacement: Any) -> Any:
    """Newtons per millimetre."""
    return right.apparent_stiffness(force, displacement) / 1e3


def axis_by_axis_fit(force: Any, displacement: Any) -> Any:
    """A line for each axis by itself."""
    F, x = np.asarray(force), np.asarray(displacement)
    return np.diag([np.polyfit(x[:, k], F[:, k], 1)[0] for k in range(3)])


@dataclass(frozen=True)
class TipTerms:
    """Another torque from the terms of the impedance.

    Attributes:
        law: The torque, given J, the tip's inertia, the desired acceleration, D de, K e, C dq, g,
            model, state and target.
    """

    law: Callable[..., Any]

    def __call__(
        self,
        state: lk.State,
        target: lk.PoseSample,
        model: lk.Model,
        *,
        stiffness: Any,
        damping: Any,
    ) -> lk.JointTorque:
        """The torque."""
        q, dq = state.q, state.dq
        J, e = model.tip_jacobian(q), lk.se3.pose_error(target.pose, model.pose(q))
        a = target.dtwist - model.tip_jacobian_rate(q, dq) @ dq
        De, Ke = damping * (target.twist - J @ dq), stiffness * e
        L, C, g = model.operational_inertia(q), model.coriolis(q, dq) @ dq, model.gravity(q)
        return lk.JointTorque(self.law(J, L, a, De, Ke, C, g, model.mass_matrix(q)))


@dataclass(frozen=True)
class ShapedTerms:
    """Another torque from the terms of the shaped impedance.

    Attributes:
        law: The torque, given J, the tip's inertia, the desired one, the desired acceleration, J'
            dq, D de, K e, the wrench, C dq and g.
        tool: Which errors are in the tool's axes: 1 for the orientation, 2 for both.
    """

    law: Callable[..., Any]
    tool: int = 0

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
        J, e = model.tip_jacobian(q), lk.se3.pose_error(target.pose, model.pose(q))
        R_tw = model.pose(q)[:3, :3].T
        place = R_tw @ e[:3] if self.tool == 2 else e[:3]
        e = np.concatenate([place, R_tw @ e[3:] if self.tool else e[3:]])
        drift = model.tip_jacobian_rate(q, dq) @ dq
        De, Ke = damping * (target.twist - J @ dq), stiffness * e
        L, C, g = model.operational_inertia(q), model.coriolis(q, dq) @ dq, model.gravity(q)
        F = np.asarray(wrench)
        return lk.JointTorque(self.law(J, L, inertia, target.dtwist, drift, De, Ke, F, C, g))


def shaped(J: Any, L: Any, M: Any, a: Any, drift: Any, P: Any, F: Any, C: Any, g: Any) -> Any:
    """The right torque, given the pull P = D de + K e."""
    return J.T @ (L @ (a + np.linalg.inv(M) @ (P + F) - drift) - F) + C + g


@dataclass(frozen=True)
class FitOf:
    """Another fit.

    Attributes:
        of: K, given force and displacement, each of shape (n, 3).
    """

    of: Callable[[Any, Any], Any]

    def __call__(self, force: Any, displacement: Any) -> Any:
        """The matrix."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.of(np.asarray(force), np.asarray(displacement)))


def solved(x: Any, F: Any) -> Any:
    """K of F = K x, without an offset."""
    return np.linalg.lstsq(x, F, rcond=None)[0].T


def about(x: Any) -> Any:
    """The values minus their mean."""
    return x - x.mean(axis=0)


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


def root(A: Any) -> Any:
    """The symmetric root."""
    w, V = np.linalg.eigh(A)
    return V * np.sqrt(w) @ V.T


@dataclass(frozen=True)
class Hanging:
    """Another sum of the forces on the mass.

    Attributes:
        of: The acceleration, given the forces of hand, damper and spring, the mass and the
            target's acceleration.
    """

    of: Callable[..., float]

    def __call__(
        self, state: Any, target: Any, force: float, *, m: float, b: float, k: float
    ) -> float:
        """The acceleration."""
        (x, dx), (x_d, dx_d, ddx_d) = state, target
        return float(self.of(force, b * (dx_d - dx), k * (x_d - x), m, ddx_d))
