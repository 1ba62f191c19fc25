r"""The model: an arm's equations of motion, which answer questions but move nothing.

.. math:: M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) = \tau + J^T F_{ext}

References: Murray, Li & Sastry (MLS) chapter 4; Lynch & Park chapter 8.  Pinocchio does
the computing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from . import se3
from .baxter import as_robot
from .errors import LabkitError, TypeMismatch, listed
from .kinematics import Kinematics
from .plant import IDEAL, Plant
from .robot import Robot
from .shapes import Array, as_array, shown


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


class Model(Kinematics):
    """Kinematics and dynamics of one arm.

    Attributes:
        robot: Names and limits.
        plant: The plant whose armature and payload the model includes.
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
        robot = as_robot(robot)
        if plant.fits and robot.name not in plant.fits:
            raise LabkitError(
                f"the plant {plant.name!r} fits {listed(plant.fits)}, not {robot.name!r}; "
                "dataclasses.replace(plant, fits=()) fits any robot"
            )
        super().__init__(robot, robot.urdf(plant))
        self._pin.armature = plant.each("armature", robot.n)
        self._lower = np.tril_indices(robot.n, -1)
        self.plant = plant

    def __repr__(self) -> str:
        return f"Model({self.robot.name!r}, {self.plant.name})"

    def mass_matrix(self, q: Any) -> Array:
        """The mass matrix M(q), symmetric and positive definite (MLS eq. 4.19).

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (n, n) in [kg m^2].
        """
        M: Array = pin.crba(self._pin, self._data, as_array(q, self._joints, "q"))
        M[self._lower] = M.T[self._lower]  # Pinocchio fills the upper half
        return M

    def inverse_mass(self, q: Any) -> Array:
        """The inverse of M(q), computed faster than by inverting it.

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (n, n) in [1/(kg m^2)].
        """
        made: Array = pin.computeMinverse(self._pin, self._data, as_array(q, self._joints, "q"))
        return made

    def coriolis(self, q: Any, dq: Any) -> Array:
        r"""The matrix C(q, dq) for which :math:`\dot M - 2C` is skew (MLS eq. 4.23, Lemma 4.2).

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].

        Returns:
            Shape (n, n) in [kg m^2/s]; ``C @ dq`` is the Coriolis and centrifugal torque.
        """
        q, dq = as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")
        made: Array = pin.computeCoriolisMatrix(self._pin, self._data, q, dq)
        return made

    def gravity(self, q: Any) -> Array:
        r"""The torque that holds the arm still, :math:`g(q) = \partial V / \partial q` (MLS 4.27).

        Args:
            q: Joint angles, shape (n,) in [rad].

        Returns:
            Shape (n,) in [N m].
        """
        q = as_array(q, self._joints, "q")
        made: Array = pin.computeGeneralizedGravity(self._pin, self._data, q)
        return made

    def bias(self, q: Any, dq: Any) -> Array:
        """All torque that is not due to inertia, ``C(q, dq) @ dq + g(q)``.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].

        Returns:
            Shape (n,) in [N m].
        """
        q, dq = as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")
        made: Array = pin.nonLinearEffects(self._pin, self._data, q, dq)
        return made

    def inverse_dynamics(self, q: Any, dq: Any, ddq: Any) -> Array:
        """The torque that a motion requires, ``M @ ddq + C @ dq + g`` (recursive Newton-Euler).

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            ddq: Joint accelerations, shape (n,) in [rad/s^2].

        Returns:
            Shape (n,) in [N m].
        """
        q, dq = as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")
        ddq = as_array(ddq, self._joints, "ddq")
        made: Array = pin.rnea(self._pin, self._data, q, dq, ddq)
        return made

    def forward_dynamics(self, q: Any, dq: Any, tau: Any) -> Array:
        """The accelerations that torques cause, ``M @ ddq = tau - C @ dq - g``.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            tau: Joint torques, shape (n,) in [N m].

        Returns:
            Shape (n,) in [rad/s^2].
        """
        q, dq = as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")
        tau = as_array(tau, self._joints, "tau")
        made: Array = pin.aba(self._pin, self._data, q, dq, tau)
        return made

    def free_motion(self, q: Array, dq: Array, tau: Array) -> tuple[Array, Array]:
        """`forward_dynamics` and `inverse_mass` in one sweep over the arm, 6 µs instead of 12.

        Args:
            q: Joint angles, shape (n,) in [rad]; no argument is checked.
            dq: Joint speeds, shape (n,) in [rad/s].
            tau: Joint torques, shape (n,) in [N m].

        Returns:
            The accelerations, shape (n,) in [rad/s^2], and the inverse of M, shape (n, n) in
            [1/(kg m^2)]; the next call to the model may overwrite both.
        """
        a: Array = pin.aba(self._pin, self._data, q, dq, tau, pin.Convention.WORLD)
        return a, pin.computeMinverse(self._pin, self._data)

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
        q, dq = as_array(q, self._joints, "q"), as_array(dq, self._joints, "dq")
        return float(pin.computeKineticEnergy(self._pin, self._data, q, dq))

    def potential_energy(self, q: Any) -> float:
        """Gravitational energy, zero at the height of the world's origin, in [J]."""
        return float(
            pin.computePotentialEnergy(self._pin, self._data, as_array(q, self._joints, "q"))
        )

    def links(self, q: Any) -> tuple[Link, ...]:
        """The n bodies at ``q``, shape (n,) in [rad], from which M and g are summed.

        The rotors, which add a diagonal matrix to M, are not included.
        """
        m, d = self._pin, self._data
        pin.computeJointJacobians(m, d, as_array(q, self._joints, "q"))
        out = []
        for i in range(1, m.njoints):
            body, T_wl = m.inertias[i], d.oMi[i].homogeneous
            com = T_wl[:3, :3] @ body.lever + T_wl[:3, 3]
            J = pin.getJointJacobian(m, d, i, pin.LOCAL_WORLD_ALIGNED).copy()
            J[:3] -= se3.hat(com - T_wl[:3, 3]) @ J[3:]
            out.append(Link(body.mass, np.array(body.inertia), T_wl, com, J))
        return tuple(out)
