r"""Kinematics: where the tip is, how it moves with the joints, and which joints put it there.

.. math:: T_{wt} = f(q), \qquad V = J(q)\,\dot q

There are three Jacobians, each named for the twist that it returns, so none is "the Jacobian".
References: Murray, Li & Sastry (MLS) chapter 3; Lynch & Park chapters 4 to 6.  Pinocchio does the
computing.
"""

from __future__ import annotations

import threading
import warnings
from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin

from . import se3
from .errors import LabkitWarning, TypeMismatch, Unreachable
from .paths import Spline
from .robot import Robot
from .shapes import Array, as_array
from .trajectory import Chain, Hold, PosePath, PoseSample, Sample, Trajectory

NEAR_SINGULAR = 0.03
"""Below this smallest singular value of the tip Jacobian, a pose counts as near a singularity."""

_ITERATIONS = 200
_SLACK = 1e-9
_MEASURED = 0.1  # [rad]; a measured start may be beyond a limit, by noise or by a soft stop


class _WorkSpace(threading.local):
    """Pinocchio's working memory, of which each thread, such as that of `live`, has its own."""

    def __init__(self, model: Any) -> None:
        self.data = model.createData()


class Kinematics:
    """The geometry of an arm.

    Attributes:
        robot: Names and limits.
    """

    def __init__(self, robot: Robot, urdf: str) -> None:
        """Read the bodies from ``urdf``; joint names and limits come from ``robot``."""
        self.robot = robot
        self._pin = pin.buildModelFromXML(urdf)
        self._tip = self._pin.addFrame(
            pin.Frame("tip", robot.n, 0, pin.SE3(robot.T_hand_tip), pin.FrameType.OP_FRAME)
        )
        self._work = _WorkSpace(self._pin)
        self._joints = (robot.n,)

    @property
    def _data(self) -> Any:
        return self._work.data

    def pose(self, q: Any) -> Array:
        """Pose of the tip in the world, `T_wt` (Lynch & Park, chapter 4).

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (4, 4).
        """
        pin.forwardKinematics(self._pin, self._data, as_array(q, self._joints, "q"))
        T: Array = pin.updateFramePlacement(self._pin, self._data, self._tip).homogeneous
        return T

    def tip_jacobian(self, q: Any) -> Array:
        r"""The Jacobian of the tip in world axes, :math:`(\dot p, \omega_w) = J\,\dot q`.

        Its rows give the velocity of the tip's origin and the angular velocity; Siciliano calls it
        the geometric Jacobian.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, n); rows 0-2 in [m/rad], rows 3-5 in [rad/rad].
        """
        return self._jacobian(q, pin.LOCAL_WORLD_ALIGNED)

    def point_on(self, q: Any, body: int, point: Any) -> tuple[Array, Array]:
        """Where a point of a body is, and the Jacobian of its velocity.

        Args:
            q: Joint angles, shape (n,) in [rad].
            body: The body, by the number of the joint that turns it, from 0; n is the tip's frame.
            point: In the body's frame, shape (3,) in [m].

        Returns:
            The position in the world, shape (3,) in [m], and the Jacobian, shape (3, n) in [m/rad].
        """
        n = self.robot.n
        q, point = as_array(q, self._joints, "q"), as_array(point, (3,), "point")
        pin.computeJointJacobians(self._pin, self._data, q)
        joint = min(body, n - 1) + 1
        T = self._data.oMi[joint]
        T = T * pin.SE3(self.robot.T_hand_tip) if body >= n else T
        p = T.act(point)
        J = pin.getJointJacobian(self._pin, self._data, joint, pin.LOCAL_WORLD_ALIGNED)
        return p, J[:3] - se3.hat(p - self._data.oMi[joint].translation) @ J[3:]

    def body_jacobian(self, q: Any) -> Array:
        r"""The body Jacobian: the tip's twist in the tip's own axes, :math:`V_b = J_b\,\dot q`.

        MLS eq. 3.55; Lynch & Park, section 5.1.2.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, n), linear rows first.
        """
        return self._jacobian(q, pin.LOCAL)

    def spatial_jacobian(self, q: Any) -> Array:
        r"""The spatial Jacobian: the twist seen from the world's origin, :math:`V_s = J_s\,\dot q`.

        MLS eq. 3.51.  Its linear rows are not the velocity of the tip.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, n), linear rows first.
        """
        return self._jacobian(q, pin.WORLD)

    def _jacobian(self, q: Any, frame: Any) -> Array:
        q = as_array(q, self._joints, "q")
        J: Array = pin.computeFrameJacobian(self._pin, self._data, q, self._tip, frame)
        return J

    def tip_jacobian_rate(self, q: Any, dq: Any) -> Array:
        r"""The time derivative of `tip_jacobian`, :math:`\dot V = J\,\ddot q + \dot J\,\dot q`.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].

        Returns:
            Shape (6, n).
        """
        q, dq = as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")
        pin.computeJointJacobiansTimeVariation(self._pin, self._data, q, dq)
        pin.updateFramePlacement(self._pin, self._data, self._tip)
        dJ: Array = pin.getFrameJacobianTimeVariation(
            self._pin, self._data, self._tip, pin.LOCAL_WORLD_ALIGNED
        )
        return dJ

    def manipulability(self, q: Any) -> float:
        """The volume of the velocity ellipsoid, the product of the Jacobian's singular values.

        Yoshikawa 1985; Lynch & Park, section 5.4.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            A number that is zero at a singularity.
        """
        return float(np.prod(np.linalg.svd(self.tip_jacobian(q), compute_uv=False)))

    def nearness_to_singularity(self, q: Any) -> float:
        """The smallest singular value of `tip_jacobian`.

        In its slowest direction, the tip moves at most at this speed, for joint speeds of length 1.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Zero at a singularity, about 0.1 at a comfortable pose.
        """
        return float(np.linalg.svd(self.tip_jacobian(q), compute_uv=False)[-1])

    # Inverse kinematics

    def within_limits(self, q: Any, name: str = "q", slack: float = _SLACK) -> Array:
        """Read joint angles and check that they are within the joints' range.

        Args:
            q: Joint angles, shape (n,) in [rad].
            name: What to call them in the message if they are out of range.
            slack: Tolerance beyond either limit, in [rad].

        Returns:
            The same angles.

        Raises:
            JointLimitExceeded: A joint is outside its range.
        """
        angles: Array = as_array(q, self._joints, name)
        self.robot.check_range(angles, name, slack)
        return angles

    def inverse_kinematics(self, T_wt: Any, q0: Any, *, posture: Any = None) -> Array:
        """The joint angles nearest to a posture among those that put the tip at a pose.

        Gauss-Newton iteration on the pose error.  The freedom that a seventh joint leaves is used
        to come close to ``posture``, so the answer depends only on the pose and the posture, and
        closed paths give closed joint paths.

        Args:
            T_wt: Desired pose, shape (4, 4).
            q0: Start of the search, shape (n,) in [rad]; measured angles may be 0.1 rad beyond the
                limits.
            posture: Joint angles to stay close to, shape (n,) in [rad]; None means ``q0``.

        Returns:
            Shape (n,) in [rad], within the joint limits, exact to 1e-9 m and rad.

        Raises:
            Unreachable: No such angles were found.  The message says how near the search came, and
                "cannot be reached" only where no start can help.
            JointLimitExceeded: ``q0`` or ``posture`` is more than 0.1 rad outside its range.
        """
        if self.robot.n < 6:
            raise Unreachable(
                f"the {self.robot.n} joints of {self.robot.name} cannot put the tip at any pose, "
                "which takes six; give a target of joint angles"
            )
        T_wt = se3.as_pose(T_wt, "T_wt")
        q = np.clip(self.within_limits(q0, "q0", _MEASURED), self.robot.lower, self.robot.upper)
        near = q if posture is None else self.within_limits(posture, "posture", _MEASURED)
        nearest, least = q, np.inf
        for _ in range(_ITERATIONS):
            e = self.pose_error(T_wt, q)
            if e @ e < least:
                nearest, least = q, float(e @ e)
            J = self.tip_jacobian(q)
            damping = 1e-4 * min(1.0, float(e @ e))  # vanishes at the solution
            J_inv = J.T @ np.linalg.inv(J @ J.T + damping * np.eye(6))
            free = near - q
            free = free - J_inv @ (J @ free)
            step = J_inv @ e + free
            if e @ e < 1e-20 and free @ free < 1e-18:
                return q
            step *= min(1.0, 0.5 / float(np.abs(step).max()))
            moved = np.clip(q + step, self.robot.lower, self.robot.upper)
            if e @ e < 1e-20 and np.abs(moved - q).max() < 1e-9:  # the posture pulls into a limit
                return q
            q = moved
        e = self.pose_error(T_wt, q)
        if e @ e < 1e-18:
            return q
        place = ", ".join(f"{x:.3f}" for x in T_wt[:3, 3])
        raise Unreachable(f"the pose at ({place}) m {self._reason(T_wt, q, nearest)}")

    def pose_error(self, T_wd: Any, q: Any) -> Array:
        """Target minus actual: how far the tip at ``q`` is from a pose.

        Args:
            T_wd: Desired pose, shape (4, 4).
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Position error [m] and orientation error [rad], world axes, shape (6,).
        """
        return se3.pose_error(T_wd, self.pose(q))

    def joint_trajectory(self, target: Any, q0: Any, *, samples: int = 101) -> Any:
        """The joint motion that takes the tip along a workspace target.

        Inverse kinematics runs once along s.  Each solution starts the search for the next one,
        and all stay close to ``q0``.  A quintic spline joins them on the target's own schedule.

        Args:
            target: A `Trajectory`, a `Chain` of trajectories or a `Hold`, of poses or points; for
                points, the tip keeps the orientation that it has at ``q0``.
            q0: Joint angles at the start, shape (n,) in [rad].
            samples: How many poses to solve along each path.

        Returns:
            A target of the same type whose samples are joint angles, shape (n,) in [rad].

        Raises:
            Unreachable: No joint angles were found for a pose of the path; gives s, the pose and
                the reason.
            TypeMismatch: ``target`` is something else, such as a target of joint angles.

        Warns:
            LabkitWarning: A joint would exceed its speed limit, or the path comes near a
                singularity.
        """
        q0 = self.within_limits(q0, "q0")
        if isinstance(target, Chain):
            parts, q = [], q0
            for part in target.parts:
                parts.append(self._joint_trajectory(part, q, q0, samples))
                q = parts[-1](part.duration).position
            return Chain(parts)
        return self._joint_trajectory(target, q0, q0, samples)

    def _joint_trajectory(self, target: Any, q: Array, posture: Array, samples: int) -> Any:
        if not isinstance(target, Trajectory | Hold):
            raise TypeMismatch(
                f"joint_trajectory takes a Trajectory, Chain or Hold, not {type(target).__name__}"
            )
        start, R_wt = target(0.0), self.pose(posture)[:3, :3]
        if isinstance(start, Sample) and start.position.size != 3:
            raise TypeMismatch(
                f"joint_trajectory takes poses or points of the tip, not {start.position.size} "
                "numbers; a target of joint angles can be followed as it is"
            )
        if isinstance(target, Hold):
            T_wt = start.pose if isinstance(start, PoseSample) else se3.pose(R_wt, start.position)
            return Hold(self.inverse_kinematics(T_wt, q, posture=posture), target.duration)
        if isinstance(start, Sample):
            target = Trajectory(PosePath(target.path, R_wt), target.scaling)
        grid = np.linspace(0.0, 1.0, samples)
        angles = np.empty((samples, self.robot.n))
        for k, s in enumerate(grid):
            try:
                q = self.inverse_kinematics(target.path(s).pose, q, posture=posture)
            except Unreachable as error:
                raise Unreachable(f"at s = {s:.2f} {error}") from None
            angles[k] = q
        jump = np.abs(np.diff(angles, axis=0)).max()
        if jump > 0.5:
            raise Unreachable(
                f"the joint angles jump by {jump:.2f} rad between two neighbouring poses: the path "
                "runs through a singularity; move it, or start from another q0"
            )
        _warn_of_singularity(grid, np.array([self.tip_jacobian(q) for q in angles]))
        joints = Trajectory(Spline(grid, angles), target.scaling)
        _warn_of_speed(joints, self.robot)
        return joints

    def _reason(self, T_wt: Array, q: Array, nearest: Array) -> str:
        """Why a search that ended at q failed: too far away, a joint at its limit, or stuck.

        Only the first is a proof.  The second joint's origin turns about the first axis, so it is
        always on one circle, and the wrist is always within the arm's span of this circle.
        """
        e, T = self.pose_error(T_wt, nearest), self.pose(q)
        mm, degrees = 1e3 * np.linalg.norm(e[:3]), np.degrees(np.linalg.norm(e[3:]))
        off = f"(nearest found: {mm:.3g} mm and {degrees:.3g} degrees off)"
        places = [M.translation.copy() for M in self._data.oMi[1:]]
        axis = self._data.oMi[self.robot.n].rotation[:, 2]
        if np.linalg.norm(np.cross(axis, places[-1] - places[-2])) < 1e-9:
            places.pop()  # the last joint turns about a line through the one before
        wrist = places[-1]
        reach = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(places[1:]))
        hand = T[:3, :3].T @ (T[:3, 3] - wrist)  # from the wrist to the tip, constant
        base = self._data.oMi[1]
        x, y, z = base.actInv(T_wt[:3, 3] - T_wt[:3, :3] @ hand)  # seen from the first joint
        a, b, c = base.actInv(places[1])
        distance = np.hypot(np.hypot(x, y) - np.hypot(a, b), z - c)  # from the circle
        if distance > reach + 1e-6:  # rounding must not make a proof
            return (
                f"cannot be reached: it puts the wrist at least {distance:.3f} m from the shoulder "
                f"and the arm spans {reach:.3f} m {off}; bring it nearer"
            )
        at_limit = np.flatnonzero((q - self.robot.lower < 1e-6) | (self.robot.upper - q < 1e-6))
        if at_limit.size:
            i = at_limit[0]
            return (
                f"was not found from this q0 {off}: joint {self.robot.joint_names[i]} ended at its "
                f"limit of {q[i]:.4g} rad; start from another q0, or change the orientation"
            )
        return f"was not found from this q0 {off}; start from another q0"


def _warn_of_speed(trajectory: Any, robot: Robot) -> None:
    """Warn if a joint motion is faster than the arm.

    Args:
        trajectory: A target of joint angles with a duration.
        robot: The arm with its speed limits.

    Warns:
        LabkitWarning: Gives the joint, the time, both speeds and a sufficient duration.
    """
    t = np.linspace(0.0, trajectory.duration, 201)
    share = np.abs([trajectory(x).velocity for x in t]) / robot.speed
    k, i = np.unravel_index(int(share.argmax()), share.shape)
    if share[k, i] > 1.0 + 1e-9:
        warnings.warn(
            f"too fast: at t = {t[k]:.2f} s joint {robot.joint_names[i]} should turn at "
            f"{share[k, i] * robot.speed[i]:.3g} rad/s, but its limit is {robot.speed[i]:g}; the "
            f"arm will lag unless the motion takes {share[k, i] * trajectory.duration:.3g} s",
            LabkitWarning,
            stacklevel=4,
        )


def _warn_of_singularity(s: Array, jacobians: Array) -> None:
    """Warn if a path comes near a singularity.

    Args:
        s: Places along the path, shape (k,).
        jacobians: The tip Jacobian at each, shape (k, 6, n).

    Warns:
        LabkitWarning: Gives s and the manipulability there.
    """
    sigma = np.linalg.svd(jacobians, compute_uv=False)
    k = int(sigma[:, -1].argmin())
    if sigma[k, -1] < NEAR_SINGULAR:
        warnings.warn(
            f"near a singularity: at s = {s[k]:.2f} the manipulability is {sigma[k].prod():.2g} "
            f"and the smallest singular value {sigma[k, -1]:.2g}, below {NEAR_SINGULAR:g}; expect "
            "high joint speeds, or move the path, or start from another q0",
            LabkitWarning,
            stacklevel=4,
        )
