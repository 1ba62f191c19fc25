"""The equations of motion by MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np

from ..plant import Plant
from ..robot import Robot
from ..shapes import Array
from . import PerThread


class MuJoCo:
    """An arm in MuJoCo, whose functions read the positions and speeds that `_at` has set."""

    def __init__(self, robot: Robot, plant: Plant) -> None:
        """Read the arm from its URDF text."""
        self._model = mujoco.MjModel.from_xml_string(robot.urdf(plant))
        self._model.dof_armature[:] = self._rotors = plant.each("armature", robot.n)
        self._n, self._hand_tip = robot.n, robot.T_hand_tip
        self._still, self._each = np.zeros(robot.n), np.eye(robot.n)
        self._own = PerThread(lambda: mujoco.MjData(self._model))

    def frames(self, q: Array) -> Array:
        data = self._at(q)
        T = np.tile(np.eye(4), (self._n, 1, 1))
        T[:, :3, :3], T[:, :3, 3] = data.xmat[1:].reshape(-1, 3, 3), data.xpos[1:]
        return T

    def pose(self, q: Array) -> Array:
        data, T = self._at(q), np.eye(4)
        T[:3, :3] = data.xmat[-1].reshape(3, 3) @ self._hand_tip[:3, :3]
        T[:3, 3] = self._tip(data)
        return T

    def tip_jacobian(self, q: Array) -> Array:
        data, J = self._at(q), np.empty((6, self._n))
        mujoco.mj_jac(self._model, data, J[:3], J[3:], self._tip(data), self._n)
        return J

    def tip_jacobian_rate(self, q: Array, dq: Array) -> Array:
        data, dJ = self._at(q, dq), np.empty((6, self._n))
        mujoco.mj_jacDot(self._model, data, dJ[:3], dJ[3:], self._tip(data), self._n)
        return dJ

    def mass_matrix(self, q: Array) -> Array:
        data, M = self._at(q), np.empty((self._n, self._n))
        mujoco.mj_crb(self._model, data)
        mujoco.mj_fullM(self._model, data, M)
        return M

    def coriolis(self, q: Array, dq: Array) -> Array:
        r"""By Christoffel's symbols: :math:`C(q, v)\,w = [b(v + w) - b(v - w)] / 4`.

        The bias b is quadratic in the speeds, and gravity cancels.
        """
        data = self._at(q)
        columns = [self._bias(data, dq + w) - self._bias(data, dq - w) for w in self._each]
        return 0.25 * np.array(columns).T

    def gravity(self, q: Array) -> Array:
        return self.bias(q, self._still)

    def bias(self, q: Array, dq: Array) -> Array:
        return self._bias(self._at(q), dq)

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array) -> Array:
        data, tau = self._at(q, dq), np.empty(self._n)
        data.qacc[:] = ddq
        mujoco.mj_rne(self._model, data, 1, tau)
        return tau + self._rotors * ddq

    def acceleration(self, q: Array, dq: Array, tau: Array) -> Array:
        return self.free_motion(q, dq, tau)[0]

    def free_motion(self, q: Array, dq: Array, tau: Array) -> tuple[Array, Array]:
        data, inverse = self._at(q), np.empty_like(self._each)
        bias = self._bias(data, dq)
        mujoco.mj_crb(self._model, data)
        mujoco.mj_factorM(self._model, data)
        mujoco.mj_solveM(self._model, data, inverse, self._each)
        return inverse.dot(tau - bias), inverse

    def _bias(self, data: mujoco.MjData, dq: Array) -> Array:
        tau = np.empty(self._n)
        data.qvel[:] = dq
        mujoco.mj_comVel(self._model, data)
        mujoco.mj_rne(self._model, data, 0, tau)
        return tau

    def _at(self, q: Array, dq: Array | None = None) -> mujoco.MjData:
        """The working memory, with what follows from q, and from dq if it is given."""
        data = self._own.data
        data.qpos[:] = q
        mujoco.mj_kinematics(self._model, data)
        mujoco.mj_comPos(self._model, data)
        if dq is not None:
            data.qvel[:] = dq
            mujoco.mj_comVel(self._model, data)
        return data

    def _tip(self, data: mujoco.MjData) -> Array:
        """Where the tip is, shape (3,)."""
        return data.xpos[-1] + data.xmat[-1].reshape(3, 3) @ self._hand_tip[:3, 3]
