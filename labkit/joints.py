r"""The joints: what motors, dry friction and stops give in one physics step.

A step of :math:`\Delta t` takes the speeds of joints with inertia M and rotors
:math:`A = \mathrm{diag}(a)` from :math:`\dot q` to

.. math:: \dot q^+ = u + G\,y, \qquad u = \dot q + G\,(\tau - h), \qquad G = \Delta t\,(M + A)^{-1}

where :math:`\tau` is given whatever happens and y is what adapts: a motor that holds a speed as far
as its torque goes, dry friction that holds the speed zero, the stops at the ends of the range.
`joint_torques` finds y exactly, the same for every physics engine.
"""

from __future__ import annotations

from functools import cache
from math import inf
from operator import le, lt
from typing import Any, NamedTuple

import numpy as np

from .errors import LabkitError
from .model import Model
from .shapes import Array

LOW, SLIP_UP, STICK, SLIP_DOWN, HIGH = range(1, 6)
"""Where a joint stands, from its lower stop to its upper one.

Between the stops a joint that is slower than its target gets the whole bound as torque upwards
(``SLIP_UP``), one that is quicker gets it downwards (``SLIP_DOWN``), and one at its target speed is
held there (``STICK``)."""

QUICK = 50.0
"""A joint that could not reach a stop at this speed, in [rad/s], will not meet it in this step."""

_ROUNDING = 1e-14  # of a speed, in [rad/s]
_TOGETHER = 20  # rounds in which all joints move that are wrong; from then on one at a time
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
    """Torques y for which the speeds ``u + G @ y`` are the target's, as far as the bounds allow.

    A joint slower than its target is given ``bound``, a quicker one ``-bound``, one at its target
    anything between; none ends slower than ``slowest`` or quicker than ``fastest``, whatever torque
    that takes.  Torque over speed is thus a staircase, and it falls, so there is one solution.

    Args:
        G: What torques do to speeds, symmetric and positive definite, shape (n, n).
        u: Speeds without y, shape (n,) in [rad/s].
        target: Speeds to hold, shape (n,) in [rad/s].
        bound: The most torque for it, shape (n,) in [N m].
        slowest: Speeds that end at the lower stops, shape (n,) in [rad/s].
        fastest: Speeds that end at the upper stops, shape (n,) in [rad/s].
        guess: Where each joint may stand, from `LOW` to `HIGH`; best is where it stood last.

    Returns:
        The torques, shape (n,) in [N m], and where each joint stands.

    Raises:
        LabkitError: They were not found; the inertias of an arm never came near to that.
    """
    end, unit = np.full(len(u), inf), np.eye(len(u))
    goal = np.minimum(np.maximum(target, slowest), fastest)
    stairs = np.array([end, slowest, bound, goal, -bound, fastest, -end]).T.tolist()
    stands = list(guess)
    for count in range(_ROUNDS):
        given = np.array([stair[k] for stair, k in zip(stairs, stands, strict=True)])
        held = np.array([k % 2 == 1 for k in stands])  # the speed is given, else the torque
        rows = np.where(held[:, None], G, unit)
        y = _dgesv()(rows, np.where(held, given - u, given))[2]
        v, wrong = u + G @ y, False
        for i, (k, torque, speed) in enumerate(zip(stands, y.tolist(), v.tolist(), strict=True)):
            before, after = stairs[i][k - 1], stairs[i][k + 1]
            if k % 2:
                move = (torque < after) - (torque > before)
            else:
                move = (speed > after + _ROUNDING) - (speed < before - _ROUNDING)
            if move:
                stands[i] += move
                wrong = True
                if count >= _TOGETHER:
                    break
        if not wrong:
            return y, stands
    raise LabkitError(
        f"the joints' torques were not found in {_ROUNDS} rounds: the inertias in G differ by "
        f"a factor of {np.linalg.cond(G):.1g}; check those of the robot, or take a smaller dt"
    )


@cache
def _dgesv() -> Any:
    """LAPACK's solver: NumPy's own takes 6 us more; slow to import."""
    from scipy.linalg.lapack import dgesv

    return dgesv


class Given(NamedTuple):
    """What the joints give in a physics step, three vectors of shape (n,).

    Attributes:
        held: The torque within the drive's bound that holds its speeds, in [N m].
        tau: All torque on the joints, friction, stops and touches included, in [N m].
        ddq: The accelerations that it makes, in [rad/s^2]; None if nobody had to know them.
    """

    held: Array
    tau: Array
    ddq: Array | None


class Drive(NamedTuple):
    """What the motors do in a physics step.

    Attributes:
        tau: Torque that they give whatever happens, shape (n,) in [N m].
        speed: Speeds that are held beside it, shape (n,) in [rad/s].
        bound: The most torque that holds them, of motors or dry friction, shape (n,) in [N m].
    """

    tau: Array
    speed: Array
    bound: Array


class Touch(NamedTuple):
    r"""What acts on the tip in a physics step: :math:`f = f_0 - D v`, v at the end of the step.

    Attributes:
        wrench: Force at the tip's origin in [N] and moment in [N m], world axes, shape (6,).
        damping: D, symmetric, shape (3, 3) in [N s/m].
        outwards: The direction in which a face pushes and never pulls, shape (3,); None pulls too.
    """

    wrench: Array
    damping: Array
    outwards: Array | None = None

    def pushes(self, v: Array) -> bool:
        """Whether its force on a tip at ``v``, shape (3,) in [m/s], is one that it can exert."""
        if self.outwards is None:
            return True
        return float(self.outwards @ (self.wrench[:3] - self.damping @ v)) >= 0.0


class Joints:
    """The joints of one arm, physics step by physics step."""

    def __init__(self, model: Model, dt: float) -> None:
        """Joints as ``model`` and its plant have them, in steps of ``dt`` [s]."""
        self._model, self._dt, robot = model, dt, model.robot
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
        """Forget where the joints stood."""
        self._stand([STICK] * len(self._lower))

    def _stand(self, stands: list[int]) -> None:
        """Keep where the joints stand: which are held, and which way the others are pushed."""
        self._stands = stands
        self._sticking = stands.count(STICK) == len(stands)
        signs = [float(STICK - k) for k in stands]
        self._signs, self._sign = signs, np.array(signs)
        self._held = np.array([k == STICK for k in stands])
        self._columns = self._held[None, :]
        self._beside = LOW not in stands and HIGH not in stands

    def solve(self, q: Array, dq: Array, drive: Drive, touches: list[Touch]) -> Given:
        """What the joints give in this step.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            drive: What the motors do.
            touches: What acts on the tip.

        Returns:
            What they give.
        """
        tau = drive.tau if self._viscous is None else drive.tau - self._viscous * dq
        angles = q.tolist()
        if not touches and all(map(lt, self._low, angles)) and all(map(lt, angles, self._high)):
            if drive.bound is self._nothing:
                return Given(drive.bound, tau, None)
            if self._sticking:  # that motors hold is common, and cheap
                a = (drive.speed - dq) / self._dt
                y = self._model.inverse_dynamics(q, dq, a) - tau
                if all(map(le, map(abs, y.tolist()), drive.bound.tolist())):
                    return Given(y, tau + y, a)
            if self._beside:
                return self._slide(q, dq, drive, tau)
        return self._solve(q, dq, drive, touches, tau)

    def _slide(self, q: Array, dq: Array, drive: Drive, tau: Array) -> Given:
        """As `solve`, far from stops: first as if all joints stood where they stood last.

        That is right in 24 steps of 25, and takes 15 us where `_solve` takes 35.
        """
        bound, dt = drive.bound, self._dt
        wanted = (drive.speed - dq) / dt
        free, inverse = self._model.free_motion(q, dq, tau)
        given = np.where(self._held, wanted - free, self._sign * bound)
        rows = np.where(self._columns, inverse, self._unit).T  # as LAPACK reads: 1 us less
        y = _dgesv()(rows, given, 1, 1)[2]
        a = free + inverse @ y
        slack = _ROUNDING / dt
        for sign, torque, most, made, meant in zip(
            self._signs, y.tolist(), bound.tolist(), a.tolist(), wanted.tolist(), strict=True
        ):
            if (meant - made) * sign < -slack if sign else not -most <= torque <= most:
                ends = np.full(len(y), inf)
                G, u = dt * inverse, dq + dt * free
                problem = G, u, drive.speed, bound, -ends, ends
                y, stands = joint_torques(*problem, self._stands)
                self._stand(stands)
                a = free + inverse @ y
                break
        return Given(y, tau + y, a)

    def _solve(self, q: Array, dq: Array, drive: Drive, touches: list[Touch], tau: Array) -> Given:
        """As `solve`, with stops and touches."""
        model, h = self._model, self._model.bias(q, dq)
        if touches:
            J = model.tip_jacobian(q)
            D = J[:3].T @ sum(touch.damping for touch in touches) @ J[:3]
            G = np.asarray(np.linalg.inv(model.mass_matrix(q) / self._dt + D))
            push = tau + J.T @ sum(touch.wrench for touch in touches) - D @ dq
        else:
            G, push = self._dt * model.inverse_mass(q), tau
        u = dq + G @ (push - h)
        stops = (self._lower - q) / self._dt, (self._upper - q) / self._dt
        y, stands = joint_torques(G, u, drive.speed, drive.bound, *stops, self._stands)
        if touches:
            a = G @ (push - h + y)
            v, push = J[:3] @ (dq + a), push - D @ a
            kept = [touch for touch in touches if touch.pushes(v)]
            if len(kept) < len(touches):  # it has left the others
                return self._solve(q, dq, drive, kept, tau)
        if stands != self._stands:
            self._stand(stands)
        held = np.minimum(np.maximum(y, -drive.bound), drive.bound)
        return Given(held, push + y, (G @ (push - h + y) if not touches else a) / self._dt)
