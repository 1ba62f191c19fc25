"""PyBullet: an engine for the plant."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from .. import se3
from ..plant import Plant
from ..quiet import quiet
from ..robot import DOF, Robot
from ..shapes import Array
from .engine import FACE, TIP_DAMPING, TIP_RADIUS, TIP_STIFFNESS

with quiet():
    import pybullet as bullet

_JOINTS = tuple(range(DOF))
_HAND = DOF - 1


class PyBullet:
    """A world of PyBullet's."""

    def __init__(self, dt: float) -> None:
        """Open a world with a step of ``dt`` [s]."""
        self._client: int = bullet.connect(bullet.DIRECT)
        self._here = {"physicsClientId": self._client}
        self._levers: dict[int, Array] = {}
        bullet.setTimeStep(dt, **self._here)
        bullet.setGravity(0.0, 0.0, -9.81, **self._here)
        # By default the solver stops early, and a motor told to stand still creeps at 0.6 mrad/s.
        bullet.setPhysicsEngineParameter(solverResidualThreshold=0.0, **self._here)

    def add_arm(self, robot: Robot, plant: Plant) -> int:
        """Nothing that PyBullet does unasked is left in it, above all no damping of its own."""
        x, y, z = robot.T_hand_tip[:3, 3]
        ball = (
            f'<collision><origin xyz="{x} {y} {z}"/><geometry><sphere radius="{TIP_RADIUS}"/>'
            "</geometry></collision></link>"
        )
        with quiet(), TemporaryDirectory() as folder:
            file = Path(folder, "arm.urdf")  # PyBullet reads only files
            file.write_text(ball.join(robot.urdf(plant).rsplit("</link>", 1)))
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            arm: int = bullet.loadURDF(str(file), useFixedBase=True, flags=flags, **self._here)
        still = {"linearDamping": 0.0, "angularDamping": 0.0, **self._here}
        for joint, viscous in enumerate((0.0, *plant.viscous), start=-1):
            bullet.changeDynamics(arm, joint, jointDamping=viscous, **still)
        pad = {"contactStiffness": TIP_STIFFNESS, "contactDamping": TIP_DAMPING, **self._here}
        bullet.changeDynamics(arm, _HAND, lateralFriction=1.0, restitution=0.0, **pad)
        hand, com = robot.T_hand_tip, bullet.getDynamicsInfo(arm, _HAND, self._client)[3]
        self._levers[arm] = hand[:3, :3].T @ (
            hand[:3, 3] - com
        )  # from the hand's centre to the tip
        return arm

    def add_box(
        self, T_wf: Array, size: Array, stiffness: float, damping: float, friction: float
    ) -> None:
        half = [*(0.5 * size).tolist(), 0.5 * FACE]
        shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half, **self._here)
        middle = (T_wf[:3, 3] - 0.5 * FACE * T_wf[:3, 2]).tolist()
        turn = se3.quaternion(T_wf[:3, :3]).tolist()
        body = bullet.createMultiBody(0.0, shape, -1, middle, turn, **self._here)
        material = {"contactStiffness": stiffness, "contactDamping": damping, **self._here}
        bullet.changeDynamics(body, -1, restitution=0.0, lateralFriction=friction, **material)

    def place(self, arm: int, q: Array) -> None:
        for joint, angle in enumerate(q):
            bullet.resetJointState(arm, joint, angle, 0.0, **self._here)

    def state(self, arm: int) -> tuple[Array, Array, Array]:
        q, dq, _, tau = zip(*bullet.getJointStates(arm, _JOINTS, self._client), strict=True)
        return np.array(q), np.array(dq), np.array(tau)

    def spin(self, arm: int, speeds: Array, effort: list[float]) -> None:
        bullet.setJointMotorControlArray(
            arm, _JOINTS, bullet.VELOCITY_CONTROL,
            targetVelocities=speeds.tolist(), forces=effort, **self._here,
        )  # fmt: skip

    def drive(self, arm: int, tau: Array) -> None:
        bullet.setJointMotorControlArray(
            arm, _JOINTS, bullet.TORQUE_CONTROL, forces=tau.tolist(), **self._here
        )

    def push(self, arm: int, R_wt: Array, force: Array, moment: Array) -> None:
        # PyBullet's idea of where the link is lags a step behind: count the lever from there.
        centre = bullet.getLinkState(arm, _HAND, **self._here)[0]
        at, frame = (R_wt @ self._levers[arm] + centre).tolist(), bullet.WORLD_FRAME
        bullet.applyExternalForce(arm, _HAND, force.tolist(), at, frame, **self._here)
        if moment.any():
            bullet.applyExternalTorque(arm, _HAND, moment.tolist(), frame, **self._here)

    def step(self) -> None:
        bullet.stepSimulation(self._client)

    def close(self) -> None:
        bullet.disconnect(**self._here)
