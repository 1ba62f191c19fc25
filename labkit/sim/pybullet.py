"""PyBullet: the plant's engine, and the cameras' renderer."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

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
_LIGHT = (0.6, 0.35, 1.0)  # where the light comes from, world axes


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


class Box(NamedTuple):
    """A plain box that cameras see.

    Attributes:
        half: Half of its edges, shape (3,) in [m].
        colour: Red, green, blue and opacity, from 0 to 1.
        T: Its pose in the world, shape (4, 4).
    """

    half: Array
    colour: tuple[float, ...]
    T: Array


class Pictures:
    """What cameras see, drawn by PyBullet's software renderer; it has no physics.

    Bodies go by numbers; colours are red, green, blue and opacity, from 0 to 1.

    Attributes:
        boxes: The boxes by their numbers.
        slabs: The numbers of the walls and tables that stand among the boxes.
    """

    def __init__(self) -> None:
        """Begin with nothing to see."""
        self._client = bullet.connect(bullet.DIRECT)
        self._here = {"physicsClientId": self._client}
        self.boxes: dict[int, Box] = {}
        self.slabs: dict[Any, int] = {}

    def add_mesh(self, file: Path, colour: Iterable[float], texture: Path | None = None) -> int:
        """Show a mesh; with a picture printed on it, without gloss."""
        look: dict[str, Any] = {"fileName": str(file), "rgbaColor": list(colour)}
        with quiet():
            if texture is None:
                return self._add(bullet.GEOM_MESH, **look)
            body = self._add(bullet.GEOM_MESH, specularColor=[0, 0, 0], **look)
            number = bullet.loadTexture(str(texture), **self._here)
            bullet.changeVisualShape(body, -1, textureUniqueId=number, **self._here)
        return body

    def add_box(self, half: Any, colour: Iterable[float], centre: Any = (0.0, 0.0, 0.0)) -> int:
        """Show a box of half edges ``half`` about a centre in its own frame, both in [m]."""
        look = {"halfExtents": list(half), "rgbaColor": list(colour)}
        body = self._add(bullet.GEOM_BOX, visualFramePosition=list(centre), **look)
        self.boxes[body] = Box(np.array(half), tuple(colour), np.eye(4))
        return body

    def _add(self, kind: int, **shape: Any) -> int:
        seen = bullet.createVisualShape(kind, **shape, **self._here)
        return int(bullet.createMultiBody(0, -1, seen, **self._here))

    def move(self, body: int, T: Array) -> None:
        """Put a body to a pose in the world, shape (4, 4)."""
        turn = se3.quaternion(T[:3, :3]).tolist()
        bullet.resetBasePositionAndOrientation(body, T[:3, 3].tolist(), turn, **self._here)
        if body in self.boxes:
            self.boxes[body] = self.boxes[body]._replace(T=T)

    def paint(self, body: int, colour: Iterable[float]) -> None:
        """Show a body in a colour."""
        bullet.changeVisualShape(body, -1, rgbaColor=list(colour), **self._here)

    def draw(self, wide: int, tall: int, view: Array, projection: Array) -> NDArray[np.uint8]:
        """Draw with OpenGL's two matrices; colours from 0 to 255, shape (tall, wide, 3)."""
        matrices = view.T.ravel().tolist(), projection.T.ravel().tolist()
        rgba = bullet.getCameraImage(
            wide, tall, *matrices, lightDirection=_LIGHT, shadow=0,
            renderer=bullet.ER_TINY_RENDERER, flags=bullet.ER_NO_SEGMENTATION_MASK, **self._here,
        )[2]  # fmt: skip
        return np.ascontiguousarray(np.asarray(rgba, np.uint8).reshape(tall, wide, 4)[..., :3])

    def close(self) -> None:
        """Free what it holds."""
        bullet.disconnect(**self._here)
