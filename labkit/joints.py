r"""The joints: what motors do for each type of command, and the torques in one physics step.

A step of :math:`\Delta t` takes the speeds of joints with inertia M and rotors
:math:`A = \mathrm{diag}(a)` from :math:`\dot q` to

.. math:: \dot q^+ = u + G\,y, \qquad u = \dot q + G\,(\tau - h), \qquad G = \Delta t\,(M + A)^{-1}

where :math:`\tau` does not depend on the outcome of the step and y does: a motor holds its speed
within its torque limit, dry friction holds the speed at zero, and the stops end the range.
`joint_torques` finds y exactly, in the same manner for every physics engine.
"""

from __future__ import annotations

from functools import cache
from math import inf
from operator import le, lt
from typing import Any, NamedTuple

import numpy as np

from .control import Command, JointPosition, JointTorque, JointVelocity
from .errors import LabkitError
from .model import Model
from .plant import Plant
from .shapes import Array

LOW, SLIP_UP, STICK, SLIP_DOWN, HIGH = range(1, 6)
"""The state of a joint, from its lower stop to its upper stop.

Between the stops, a joint slower than its target receives the full bound as an upward torque
(``SLIP_UP``), a faster one receives it downwards (``SLIP_DOWN``), and one at its target speed is
held there (``STICK``)."""

QUICK = 50.0
"""A joint too far from a stop to reach it at this speed, in [rad/s], ignores it in this step."""

_ROUNDING = 1e-14  # of a speed, in [rad/s]
_TOGETHER = 20  # rounds that change every wrong joint; later rounds change one each
_ROUNDS = 200


def joint_torques(
    G: Array,
    u: Array,
    target: Array,
    bound: Array,
    slowest: Array,
    fastest: Array,
    guess: list[int],
) -> tuple[Array, list[int]]:
    """Torques y that bring the speeds ``u + G @ y`` to their targets, as far as the bounds allow.

    A joint slower than its target receives ``bound``, a faster one ``-bound``, and one at its
    target any torque between them.  No joint ends slower than ``slowest`` or faster than
    ``fastest``, whatever torque that takes.  As a function of speed, the torque is thus a falling
    staircase, so there is exactly one solution.  A joint's state says on which step it is, and so
    what is prescribed for it, the speed or the torque; the other one is solved for:

    =============  ================  ==============================================
    state          prescribed        the joint leaves it when
    =============  ================  ==============================================
    ``LOW``        speed, slowest    the torque is below bound
    ``SLIP_UP``    torque, bound     the speed is above target or below slowest
    ``STICK``      speed, target     the torque is above bound or below -bound
    ``SLIP_DOWN``  torque, -bound    the speed is below target or above fastest
    ``HIGH``       speed, fastest    the torque is above -bound
    =============  ================  ==============================================

    Args:
        G: Change of the speeds per torque, symmetric and positive definite, shape (n, n).
        u: Speeds without y, shape (n,) in [rad/s].
        target: Speeds to hold, shape (n,) in [rad/s].
        bound: Largest torque to hold them, shape (n,) in [N m].
        slowest: Speeds that end the step at the lower stops, shape (n,) in [rad/s].
        fastest: Speeds that end the step at the upper stops, shape (n,) in [rad/s].
        guess: First guess of each joint's state, from `LOW` to `HIGH`; best is its previous state.

    Returns:
        The torques, shape (n,) in [N m], and the state of each joint.

    Raises:
        LabkitError: No solution was found; the inertias of no known arm come near to this.
    """
    end, unit = np.full(len(u), inf), np.eye(len(u))
    goal = np.minimum(np.maximum(target, slowest), fastest)
    stairs = np.array([end, slowest, bound, goal, -bound, fastest, -end]).T.tolist()
    states = list(guess)
    for count in range(_ROUNDS):
        wanted = np.array([stair[k] for stair, k in zip(stairs, states, strict=True)])
        of_speed = np.array([k in (LOW, STICK, HIGH) for k in states])
        rows = np.where(of_speed[:, None], G, unit)
        y = _gesv()(rows, np.where(of_speed, wanted - u, wanted))[2]
        v, wrong = u + G @ y, False
        for i, (k, torque, speed) in enumerate(zip(states, y.tolist(), v.tolist(), strict=True)):
            before, after = stairs[i][k - 1], stairs[i][k + 1]
            if k in (LOW, STICK, HIGH):
                move = (torque < after) - (torque > before)
            else:
                move = (speed > after + _ROUNDING) - (speed < before - _ROUNDING)
            if move:
                states[i] += move
                wrong = True
                if count >= _TOGETHER:
                    break
        if not wrong:
            return y, states
    raise LabkitError(
        f"the joints' torques were not found in {_ROUNDS} rounds: the inertias in G differ by "
        f"a factor of {np.linalg.cond(G):.1g}; check those of the robot, or take a smaller dt"
    )


@cache
def _gesv() -> Any:
    """LAPACK's solver for small systems, which is slow to import."""
    from scipy.linalg.lapack import dgesv

    return dgesv


class JointStep(NamedTuple):
    """The torques and accelerations of the joints in a physics step, vectors of shape (n,).

    Attributes:
        held: The torque within the drive's bound that holds its speeds, in [N m].
        tau: Total torque on the joints, including friction, stops and forces on the tip, in [N m].
        ddq: The accelerations that it causes, in [rad/s^2]; None if they were not computed.
    """

    held: Array
    tau: Array
    ddq: Array | None


class Drive(NamedTuple):
    """What the motors do in a physics step.

    Attributes:
        tau: Prescribed torque, shape (n,) in [N m].
        speed: Speeds that are held in addition, shape (n,) in [rad/s].
        bound: Largest torque of motors or dry friction that holds them, shape (n,) in [N m].
        holds: Whether any bound is greater than 0.
    """

    tau: Array
    speed: Array
    bound: Array
    holds: bool = True


BRAKING = 0.5
"""Share of the torque left after gravity with which the position mode plans to brake."""


class TipForce(NamedTuple):
    r"""A force on the tip in a physics step, :math:`f = f_0 - D v`, v at the end of the step.

    Attributes:
        wrench: Force at the tip's origin in [N] and moment in [N m], world axes, shape (6,).
        damping: D, symmetric, shape (3, 3) in [N s/m].
        outwards: Direction in which a face pushes without ever pulling, shape (3,); None may pull.
    """

    wrench: Array
    damping: Array
    outwards: Array | None = None

    def pushes(self, v: Array) -> bool:
        """Whether the force on a tip with velocity ``v``, shape (3,) in [m/s], is possible."""
        if self.outwards is None:
            return True
        return float(self.outwards @ (self.wrench[:3] - self.damping @ v)) >= 0.0


class Joints:
    """The joints of one arm, physics step by physics step."""

    def __init__(self, model: Model, dt: float) -> None:
        """Make the joints of ``model`` and its plant, with steps of ``dt`` [s]."""
        self._dynamics, self._dt, robot = model.dynamics, dt, model.robot
        viscous = model.plant.each("viscous", robot.n)
        self._viscous = viscous if viscous.any() else None
        self._nothing, self._unit = robot.zeros, np.eye(robot.n)
        self._lower, self._upper = robot.lower, robot.upper
        self._low, self._high = (
            (robot.lower + QUICK * dt).tolist(),
            (robot.upper - QUICK * dt).tolist(),
        )
        self.reset()

    def reset(self) -> None:
        """Forget the states of the joints."""
        self._set_states([STICK] * len(self._lower))

    def _set_states(self, states: list[int]) -> None:
        """Store the states: which are held, and in which direction the others are pushed."""
        self._states = states
        self._sticking = states.count(STICK) == len(states)
        signs = [float(STICK - k) for k in states]
        self._signs, self._sign = signs, np.array(signs)
        self._held = np.array([k == STICK for k in states])
        self._any_held = STICK in states
        self._rows = self._held[:, None]
        self._clear_of_stops = LOW not in states and HIGH not in states

    def solve(self, q: Array, dq: Array, drive: Drive, touches: list[TipForce]) -> JointStep:
        """Compute the torques and accelerations of the joints in this step.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            drive: What the motors do.
            touches: The forces on the tip.

        Returns:
            The torques and accelerations.
        """
        tau = drive.tau if self._viscous is None else drive.tau - self._viscous * dq
        angles = q.tolist()
        if not touches and all(map(lt, self._low, angles)) and all(map(lt, angles, self._high)):
            if not drive.holds:
                return JointStep(self._nothing, tau, None)
            if self._sticking:  # held by their motors: common, and cheap to compute
                a = (drive.speed - dq) / self._dt
                needed = self._dynamics.inverse_dynamics(q, dq, a)
                y = needed - tau
                if all(map(le, map(abs, y.tolist()), drive.bound.tolist())):
                    return JointStep(y, needed, a)
            if self._clear_of_stops:
                return self._slide(q, dq, drive, tau)
        return self._solve(q, dq, drive, touches, tau)

    def _slide(self, q: Array, dq: Array, drive: Drive, tau: Array) -> JointStep:
        """Solve a step far from the stops, assuming first that all joints keep their states."""
        y, wanted = self._sign * drive.bound, (drive.speed - dq) / self._dt
        if self._any_held:
            a, inverse = self._dynamics.free_motion(q, dq, tau + y)
            rows = np.where(self._rows, inverse, self._unit)
            holding = _gesv()(rows, np.where(self._held, wanted - a, 0.0))[2]
            y, a = y + holding, a + inverse.dot(holding)
        else:
            a = self._dynamics.acceleration(q, dq, tau + y)
        slack = _ROUNDING / self._dt
        for sign, torque, most, made, meant in zip(
            self._signs, y.tolist(), drive.bound.tolist(), a.tolist(), wanted.tolist(), strict=True
        ):
            if (meant - made) * sign < -slack if sign else not -most <= torque <= most:
                return self._solve(q, dq, drive, [], tau)
        return JointStep(y, tau + y, a)

    def _solve(
        self, q: Array, dq: Array, drive: Drive, touches: list[TipForce], tau: Array
    ) -> JointStep:
        """Solve a step with stops and forces on the tip."""
        model, dt = self._dynamics, self._dt
        h, J = model.bias(q, dq), model.tip_jacobian(q)
        D = J[:3].T @ sum((touch.damping for touch in touches), np.zeros((3, 3))) @ J[:3]
        G = np.asarray(np.linalg.inv(model.mass_matrix(q) / dt + D))
        push = tau + J.T @ sum((touch.wrench for touch in touches), np.zeros(6)) - D @ dq
        stops = (self._lower - q) / dt, (self._upper - q) / dt
        u = dq + G @ (push - h)
        y, states = joint_torques(G, u, drive.speed, drive.bound, *stops, self._states)
        change = G @ (push - h + y)
        v = J[:3] @ (dq + change)
        kept = [touch for touch in touches if touch.pushes(v)]
        if len(kept) < len(touches):  # the tip has left the other things
            return self._solve(q, dq, drive, kept, tau)
        self._set_states(states)
        held = np.minimum(np.maximum(y, -drive.bound), drive.bound)
        return JointStep(held, push - D @ change + y, change / dt)


class Motors:
    """The motors of one arm, with limits of speed and torque.

    Attributes:
        kind: Type of the current command, which is the mode of the motors.
        saturated: Whether a limit has cut the current command at any time.
    """

    kind: type = type(None)
    saturated = False

    def __init__(self, dt: float, plant: Plant, own: Model) -> None:
        """Make the motors of an arm.

        Args:
            dt: The physics step, in [s].
            plant: Lag, dry friction and gravity compensation.
            own: The arm's model of itself, which includes its own weight but not its payload.
        """
        self._dt, self._plant, self._own = dt, plant, own
        self._share = min(1.0, dt / plant.velocity_lag) if plant.velocity_lag else 1.0
        self._effort, self._speed = own.robot.effort.tolist(), own.robot.speed.tolist()
        self._nothing = own.robot.zeros
        self._stiction = plant.each("stiction", own.robot.n)
        self._sticks = bool(self._stiction.any())

    def follow(self, command: Command) -> None:
        """Follow a command, clipped to the limits, from the next physics step on."""
        self._wanted, self.saturated = command.value, False
        if type(command) is JointTorque:
            self._wanted, self.saturated = _cut(command.value, self._effort)
        elif type(command) is JointVelocity:
            self._wanted, self.saturated = _cut(command.value, self._speed)
        if type(command) is not self.kind:
            self.kind = type(command)
            self._lagged: Array | None = None
        self._fresh = True

    def drive(self, q: Array, dq: Array) -> Drive:
        """What the motors do in the next physics step.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
        """
        if self.kind is JointTorque:
            total = self._wanted
            if self._plant.gravity_compensation:  # the arm carries its own weight
                total, cut = _cut(total + self._own.dynamics.gravity(q), self._effort)
                self.saturated |= cut
            return Drive(total, self._nothing, self._stiction, self._sticks)
        if self.kind is JointPosition:
            speed = self._approach(q)
        elif self._plant.velocity_lag:
            before = dq if self._lagged is None else self._lagged
            self._lagged = speed = before + (self._wanted - before) * self._share
        else:
            speed = self._wanted
        self._fresh = False
        return Drive(self._nothing, speed, self._own.robot.effort)

    def _approach(self, q: Array) -> Array:
        """Speeds towards the commanded angles from which the motors can still brake in time.

        Braking evenly from v takes v^2 / 2a (Lynch & Park, section 9.2.2).
        """
        if self._fresh:
            M, g = self._own.mass_matrix(q), self._own.gravity(q)
            spare = np.maximum(self._own.robot.effort - np.abs(g), 0.0)  # too weak: zero
            self._braking = BRAKING * spare / M.diagonal()
        gain = min(self._plant.position_gain or np.inf, 1.0 / self._dt)
        gap = self._wanted - q
        stops = np.sqrt(2.0 * self._braking * np.abs(gap))
        allowed, cut = _cut(np.clip(gain * gap, -stops, stops), self._speed)
        self.saturated |= cut
        return allowed


def _cut(x: Array, limit: list[float]) -> tuple[Array, bool]:
    """``x`` within ±limit, and whether that changed it."""
    if all(map(le, map(abs, x.tolist()), limit)):
        return x, False
    return np.clip(x, np.negative(limit), limit), True
