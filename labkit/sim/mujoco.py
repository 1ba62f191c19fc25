"""MuJoCo as the engine of an arm."""

from __future__ import annotations

import mujoco

from ..plant import Plant
from ..robot import Robot
from ..shapes import Array

_OFF = (
    mujoco.mjtDisableBit.mjDSBL_CONSTRAINT,  # labkit computes stops, contacts and friction
    mujoco.mjtDisableBit.mjDSBL_SENSOR,
    mujoco.mjtDisableBit.mjDSBL_ACTUATION,
    mujoco.mjtDisableBit.mjDSBL_AUTORESET,  # `run` must see an arm that runs away
)
# By default, MuJoCo writes warnings to a file in the working folder.
mujoco.set_mju_user_warning(lambda text: None)


class MuJoCo:
    """An arm in MuJoCo."""

    def __init__(self, robot: Robot, plant: Plant, dt: float) -> None:
        """Read the arm from its URDF text."""
        self._model = mujoco.MjModel.from_xml_string(robot.urdf(plant))
        self._model.dof_armature[:] = plant.each("armature", robot.n)
        self._model.opt.timestep = dt
        for part in _OFF:
            self._model.opt.disableflags |= int(part)
        self._data = mujoco.MjData(self._model)
        self._q, self._dq, self._tau = self._data.qpos, self._data.qvel, self._data.qfrc_applied

    def place(self, q: Array, dq: Array) -> None:
        self._q[:], self._dq[:] = q, dq

    def step(self, tau: Array, ddq: Array | None) -> tuple[Array, Array]:
        self._tau[:] = tau
        mujoco.mj_step(self._model, self._data)
        return self._q.copy(), self._dq.copy()

    def close(self) -> None:
        pass  # MuJoCo frees its memory with the object
