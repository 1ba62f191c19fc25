"""PyBullet as the engine of an arm."""

from __future__ import annotations

from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ..dynamics import dynamics_of
from ..plant import Plant
from ..quiet import quiet
from ..robot import Robot
from ..shapes import Array

with quiet():
    import pybullet as bullet


class PyBullet:
    """An arm in PyBullet."""

    def __init__(self, robot: Robot, plant: Plant, dt: float) -> None:
        """Load the arm, without the damping, limits and motors that PyBullet adds by default."""
        self._client: int = bullet.connect(bullet.DIRECT)
        here = {"physicsClientId": self._client}
        bullet.setTimeStep(dt, **here)
        bullet.setGravity(0.0, 0.0, -9.81, **here)
        with quiet(), TemporaryDirectory() as folder:
            file = Path(folder, "arm.urdf")  # PyBullet reads only files
            file.write_text(robot.urdf(plant), encoding="utf-8")
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            self._arm: int = bullet.loadURDF(str(file), useFixedBase=True, flags=flags, **here)
        self._joints = tuple(range(len(robot.lower)))
        still = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0}
        for joint in (-1, *self._joints):
            bullet.changeDynamics(self._arm, joint, **still, **here)
        for joint in self._joints:  # an empty range of angles means no limits
            free = {"jointLowerLimit": 1.0, "jointUpperLimit": -1.0, "maxJointVelocity": inf}
            bullet.changeDynamics(self._arm, joint, **free, **here)
        motors = {"forces": [0.0] * len(self._joints), **here}
        bullet.setJointMotorControlArray(self._arm, self._joints, bullet.VELOCITY_CONTROL, **motors)
        self._rotors = plant.each("armature", robot.n)
        self._geared = dynamics_of(robot, plant) if self._rotors.any() else None

    def place(self, q: Array, dq: Array) -> None:
        here = {"physicsClientId": self._client}
        self._q, self._dq = q, dq
        for joint, (angle, speed) in enumerate(zip(q, dq, strict=True)):
            bullet.resetJointState(self._arm, joint, angle, speed, **here)

    def step(self, tau: Array, ddq: Array | None) -> tuple[Array, Array]:
        if self._geared is not None:  # PyBullet has no rotors: subtract their torque
            if ddq is None:
                ddq = self._geared.acceleration(self._q, self._dq, tau)
            tau = tau - self._rotors * ddq
        bullet.setJointMotorControlArray(
            self._arm, self._joints, bullet.TORQUE_CONTROL, forces=tau.tolist(),
            physicsClientId=self._client,
        )  # fmt: skip
        bullet.stepSimulation(self._client)
        q, dq, *_ = zip(*bullet.getJointStates(self._arm, self._joints, self._client), strict=True)
        self._q, self._dq = np.array(q), np.array(dq)
        return self._q, self._dq

    def close(self) -> None:
        bullet.disconnect(physicsClientId=self._client)
