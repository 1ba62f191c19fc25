r"""The model: an arm's kinematics and equations of motion, which answer questions but move nothing.

.. math:: T_{wt} = f(q), \qquad V = J(q)\,\dot q, \qquad
    M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) = \tau + J^T F_{ext}

There are three Jacobians, each named for the twist that it returns, so none is "the Jacobian".
References: Murray, Li & Sastry (MLS) chapters 3 and 4; Lynch & Park chapters 4 to 6 and 8.
`labkit.dynamics` does the computing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import inverse, se3
from .dynamics import dynamics_of
from .errors import LabkitError, TypeMismatch
from .plant import IDEAL, Plant
from .robot import Robot, as_robot
from .shapes import Array, as_array, shown

_SLACK = 1e-9
_GRAVITY = 9.81


@dataclass(frozen=True, eq=False)
class Link:
    """One body of the arm at given joint angles, as the equations of motion need it.

    Attributes:
        mass: Mass, in [kg].
        inertia: Inertia about the centre of mass, in the link's own axes, shape (3, 3) in [kg m^2].
        T_wl: Pose of the link in the world, shape (4, 4).
        com: Centre of mass in the world, shape (3,) in [m].
        com_jacobian: Velocity of the centre and angular velocity, world axes, shape (6, n).
    """

    mass: float
    inertia: Array
    T_wl: Array
    com: Array
    com_jacobian: Array


class Model:
    """Kinematics and dynamics of one arm.

    Attributes:
        robot: Names and limits.
        plant: The plant whose armature and payload the model includes.
        dynamics: The same equations without checks of the arguments, for inner loops.
    """

    def __init__(self, robot: Robot | str = "left", plant: Plant = IDEAL) -> None:
        """Make the model of an arm with the payload and the rotors of ``plant``.

        Args:
            robot: A `Robot`, or "left" or "right" for Baxter's.
            plant: Its payload and armature are included.

        Raises:
            UnknownName: Baxter has no such arm.
            TypeMismatch: The plant is not a `Plant`.
            LabkitError: The plant fits other robots alone.
            ShapeError: The plant belongs to an arm with a different number of joints.
        """
        if not isinstance(plant, Plant):
            raise TypeMismatch(
                f"plant is {shown(plant)}, expected lk.IDEAL, lk.BAXTER or an lk.Plant(...)"
            )
        self.robot = robot = as_robot(robot)
        self.plant = plant
        if plant.fits and robot.name not in plant.fits:
            raise LabkitError(
                f"the plant {plant.name!r} fits {', '.join(plant.fits)}, not {robot.name!r}; "
                "dataclasses.replace(plant, fits=()) fits any robot"
            )
        self.dynamics = dynamics_of(robot, plant)
        self._joints = (robot.n,)

    def __repr__(self) -> str:
        return f"Model({self.robot.name!r}, {self.plant.name})"

    def _q(self, q: Any) -> Array:
        return as_array(q, self._joints, "q")

    def _motion(self, q: Any, dq: Any) -> tuple[Array, Array]:
        return as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")

    # Kinematics

    def pose(self, q: Any) -> Array:
        """Pose of the tip in the world, `T_wt` (Lynch & Park, chapter 4).

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (4, 4).
        """
        return self.dynamics.pose(self._q(q))

    def tip_jacobian(self, q: Any) -> Array:
        r"""The Jacobian of the tip in world axes, :math:`(\dot p, \omega_w) = J\,\dot q`.

        Its rows give the velocity of the tip's origin and the angular velocity; Siciliano calls it
        the geometric Jacobian.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, n); rows 0-2 in [m/rad], rows 3-5 in [rad/rad].
        """
        return self.dynamics.tip_jacobian(self._q(q))

    def body_jacobian(self, q: Any) -> Array:
        r"""The body Jacobian: the tip's twist in the tip's own axes, :math:`V_b = J_b\,\dot q`.

        MLS eq. 3.55; Lynch & Park, section 5.1.2.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, n), linear rows first.
        """
        J, R_wt = self.tip_jacobian(q), self.pose(q)[:3, :3]
        return np.vstack([R_wt.T @ J[:3], R_wt.T @ J[3:]])

    def spatial_jacobian(self, q: Any) -> Array:
        r"""The spatial Jacobian: the twist seen from the world's origin, :math:`V_s = J_s\,\dot q`.

        MLS eq. 3.51.  Its linear rows are not the velocity of the tip.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, n), linear rows first.
        """
        J, p = self.tip_jacobian(q), self.pose(q)[:3, 3]
        return np.vstack([J[:3] + se3.hat(p) @ J[3:], J[3:]])

    def tip_jacobian_rate(self, q: Any, dq: Any) -> Array:
        r"""The time derivative of `tip_jacobian`, :math:`\dot V = J\,\ddot q + \dot J\,\dot q`.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].

        Returns:
            Shape (6, n).
        """
        return self.dynamics.tip_jacobian_rate(*self._motion(q, dq))

    def point_on(self, q: Any, body: int, point: Any) -> tuple[Array, Array]:
        """Where a point of a body is, and the Jacobian of its velocity.

        Args:
            q: Joint angles, shape (n,) in [rad].
            body: The body, by the number of the joint that turns it, from 0; n is the tip's frame.
            point: In the body's frame, shape (3,) in [m].

        Returns:
            The position in the world, shape (3,) in [m], and the Jacobian, shape (3, n) in [m/rad].
        """
        point, frames = as_array(point, (3,), "point"), self.dynamics.frames(self._q(q))
        T = frames[body] if body < len(frames) else frames[-1] @ self.robot.T_hand_tip
        p = T[:3, :3] @ point + T[:3, 3]
        return p, _jacobian_of(frames[: body + 1], p, self.robot.n)[:3]

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

    def pose_error(self, T_wd: Any, q: Any) -> Array:
        """Target minus actual: how far the tip at ``q`` is from a pose.

        Args:
            T_wd: Desired pose, shape (4, 4).
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Position error [m] and orientation error [rad], world axes, shape (6,).
        """
        return se3.pose_error(T_wd, self.pose(q))

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
        return inverse.search(self, T_wt, q0, posture)

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
            LabkitWarning: A joint would exceed its speed limit.
        """
        return inverse.joint_trajectory(self, target, q0, samples)

    # Dynamics

    def mass_matrix(self, q: Any) -> Array:
        """The mass matrix M(q), symmetric and positive definite (MLS eq. 4.19).

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (n, n) in [kg m^2].
        """
        return self.dynamics.mass_matrix(self._q(q))

    def coriolis(self, q: Any, dq: Any) -> Array:
        r"""The matrix C(q, dq) for which :math:`\dot M - 2C` is skew (MLS eq. 4.23, Lemma 4.2).

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].

        Returns:
            Shape (n, n) in [kg m^2/s]; ``C @ dq`` is the Coriolis and centrifugal torque.
        """
        return self.dynamics.coriolis(*self._motion(q, dq))

    def gravity(self, q: Any) -> Array:
        r"""The torque that holds the arm still, :math:`g(q) = \partial V / \partial q` (MLS 4.27).

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (n,) in [N m].
        """
        return self.dynamics.gravity(self._q(q))

    def bias(self, q: Any, dq: Any) -> Array:
        """All torque that is not due to inertia, ``C(q, dq) @ dq + g(q)``.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].

        Returns:
            Shape (n,) in [N m].
        """
        return self.dynamics.bias(*self._motion(q, dq))

    def inverse_dynamics(self, q: Any, dq: Any, ddq: Any) -> Array:
        """The torque that a motion requires, ``M @ ddq + C @ dq + g`` (recursive Newton-Euler).

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            ddq: Joint accelerations, shape (n,) in [rad/s^2].

        Returns:
            Shape (n,) in [N m].
        """
        ddq = as_array(ddq, self._joints, "ddq")
        return self.dynamics.inverse_dynamics(*self._motion(q, dq), ddq)

    def tip_wrench(self, q: Any, tau_ext: Any) -> Array:
        r"""The wrench on the arm's tip that explains external joint torques, :math:`J^{-T}\tau`.

        The least squares solution of :math:`J^T F = \tau_{ext}`, six numbers from n torques.
        Near a singularity a small torque error becomes a large force.

        Args:
            q: Joint angles, shape (n,) in [rad].
            tau_ext: External torque, such as `State.tau_ext`, shape (n,) in [N m].

        Returns:
            Force [N] and moment [N m] about the tip's origin, world axes, shape (6,).
        """
        tau_ext = as_array(tau_ext, self._joints, "tau_ext")
        return np.asarray(np.linalg.lstsq(self.tip_jacobian(q).T, tau_ext, rcond=None)[0])

    def operational_inertia(self, q: Any) -> Array:
        r"""The inertia felt at the tip, :math:`\Lambda = (J M^{-1} J^T)^{-1}`, in world axes.

        Khatib 1987; Lynch & Park, section 8.6.  The starter code of Berkeley's lab called it
        `cart_inertia`.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (6, 6); near a singularity some entries grow without bound.
        """
        J = self.tip_jacobian(q)
        return np.linalg.inv(J @ np.linalg.solve(self.mass_matrix(q), J.T))

    def kinetic_energy(self, q: Any, dq: Any) -> float:
        """Half of ``dq @ M(q) @ dq``, in [J]."""
        q, dq = self._motion(q, dq)
        return float(0.5 * dq @ self.dynamics.mass_matrix(q) @ dq)

    def potential_energy(self, q: Any) -> float:
        """Gravitational energy, zero at the height of the world's origin, in [J]."""
        return float(sum(_GRAVITY * link.mass * link.com[2] for link in self.links(q)))

    def links(self, q: Any) -> tuple[Link, ...]:
        """The n bodies at ``q``, shape (n,) in [rad], from which M and g are summed.

        The rotors, which add a diagonal matrix to M, are not included.
        """
        frames, out = self.dynamics.frames(self._q(q)), []
        for k, (mass, com, inertia) in enumerate(self.robot.inertias(self.plant.payload)):
            p = frames[k, :3, :3] @ com + frames[k, :3, 3]
            J = _jacobian_of(frames[: k + 1], p, self.robot.n)
            out.append(Link(mass, inertia, frames[k], p, J))
        return tuple(out)


def _jacobian_of(frames: Array, p: Array, n: int) -> Array:
    """The Jacobian, shape (6, n), of a point p of the last of the bodies, which turn about z."""
    J, z = np.zeros((6, n)), frames[:, :3, 2]
    J[:3, : len(z)], J[3:, : len(z)] = np.cross(z, p - frames[:, :3, 3]).T, z.T
    return J
