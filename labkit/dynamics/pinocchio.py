"""The equations of motion by Pinocchio, whose functions return copies."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ..plant import Plant
from ..robot import Robot
from ..shapes import Array
from . import PerThread


class Pinocchio:
    """An arm in Pinocchio."""

    def __init__(self, robot: Robot, plant: Plant) -> None:
        """Read the arm from its URDF text."""
        self._model = m = pin.buildModelFromXML(robot.urdf(plant))
        m.armature = plant.each("armature", robot.n)
        place, kind = pin.SE3(robot.T_hand_tip), pin.FrameType.OP_FRAME
        self._tip = m.addFrame(pin.Frame("tip", robot.n, 0, place, kind))
        self._own = PerThread(m.createData)

    def frames(self, q: Array) -> Array:
        data = self._own.data
        pin.forwardKinematics(self._model, data, q)
        return np.array([T.homogeneous for T in data.oMi[1:]])

    def pose(self, q: Array) -> Array:
        data = self._own.data
        pin.forwardKinematics(self._model, data, q)
        return pin.updateFramePlacement(self._model, data, self._tip).homogeneous

    def tip_jacobian(self, q: Array) -> Array:
        axes = pin.LOCAL_WORLD_ALIGNED
        return pin.computeFrameJacobian(self._model, self._own.data, q, self._tip, axes)

    def tip_jacobian_rate(self, q: Array, dq: Array) -> Array:
        m, data, axes = self._model, self._own.data, pin.LOCAL_WORLD_ALIGNED
        pin.computeJointJacobiansTimeVariation(m, data, q, dq)
        pin.updateFramePlacement(m, data, self._tip)
        return pin.getFrameJacobianTimeVariation(m, data, self._tip, axes)

    def mass_matrix(self, q: Array) -> Array:
        return pin.crba(self._model, self._own.data, q)

    def coriolis(self, q: Array, dq: Array) -> Array:
        return pin.computeCoriolisMatrix(self._model, self._own.data, q, dq)

    def gravity(self, q: Array) -> Array:
        return pin.computeGeneralizedGravity(self._model, self._own.data, q)

    def bias(self, q: Array, dq: Array) -> Array:
        return pin.nonLinearEffects(self._model, self._own.data, q, dq)

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array) -> Array:
        return pin.rnea(self._model, self._own.data, q, dq, ddq)

    def acceleration(self, q: Array, dq: Array, tau: Array) -> Array:
        return pin.aba(self._model, self._own.data, q, dq, tau)

    def free_motion(self, q: Array, dq: Array, tau: Array) -> tuple[Array, Array]:
        m, data = self._model, self._own.data
        ddq = pin.aba(m, data, q, dq, tau, pin.Convention.WORLD)
        return ddq, pin.computeMinverse(m, data)  # from the same sweep over the arm
