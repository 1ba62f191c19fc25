"""PyBullet as the engine of an arm, and as the renderer of the cameras."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import se3
from ..model import Model
from ..plant import Plant
from ..quiet import quiet
from ..robot import Robot
from ..shapes import Array

with quiet():
    import pybullet as bullet

_LIGHT = (0.6, 0.35, 1.0)  # where the light comes from, world axes


class PyBullet:
    """An arm in a world of PyBullet's."""

    def __init__(self, robot: Robot, plant: Plant, dt: float) -> None:
        """Load the arm; nothing that PyBullet does unasked is left in it."""
        self._client: int = bullet.connect(bullet.DIRECT)
        here = {"physicsClientId": self._client}
        bullet.setTimeStep(dt, **here)
        bullet.setGravity(0.0, 0.0, -9.81, **here)
        with quiet(), TemporaryDirectory() as folder:
            file = Path(folder, "arm.urdf")  # PyBullet reads only files
            file.write_text(robot.urdf(plant))
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            self._arm: int = bullet.loadURDF(str(file), useFixedBase=True, flags=flags, **here)
        self._joints = tuple(range(len(robot.lower)))
        still = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0}
        for joint in (-1, *self._joints):
            bullet.changeDynamics(self._arm, joint, **still, **here)
        for joint in self._joints:  # an empty range of angles is none
            free = {"jointLowerLimit": 1.0, "jointUpperLimit": -1.0, "maxJointVelocity": inf}
            bullet.changeDynamics(self._arm, joint, **free, **here)
        motors = {"forces": [0.0] * len(self._joints), **here}
        bullet.setJointMotorControlArray(self._arm, self._joints, bullet.VELOCITY_CONTROL, **motors)
        self._rotors = np.array(plant.armature)
        self._geared = Model(robot.side, plant) if self._rotors.any() else None

    def place(self, q: Array) -> None:
        for joint, angle in enumerate(q):
            bullet.resetJointState(self._arm, joint, angle, 0.0, physicsClientId=self._client)

    def state(self) -> tuple[Array, Array]:
        q, dq, *_ = zip(*bullet.getJointStates(self._arm, self._joints, self._client), strict=True)
        self._state = np.array(q), np.array(dq)
        return self._state

    def step(self, tau: Array) -> None:
        if self._geared is not None:  # PyBullet has no rotors: take off what they would take
            tau = tau - self._rotors * self._geared.forward_dynamics(*self._state, tau)
        bullet.setJointMotorControlArray(
            self._arm, self._joints, bullet.TORQUE_CONTROL, forces=tau.tolist(),
            physicsClientId=self._client,
        )  # fmt: skip
        bullet.stepSimulation(self._client)

    def close(self) -> None:
        bullet.disconnect(physicsClientId=self._client)


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
