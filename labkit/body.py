"""The body: the arm as PyBullet is told of it.  What moves it is in `arm`."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from .baxter import robot
from .plant import Plant
from .quiet import quiet
from .robot import DOF, Side
from .scene import TIP_DAMPING, TIP_RADIUS, TIP_STIFFNESS

with quiet():
    import pybullet as bullet


def load(client: int, side: Side, plant: Plant) -> int:
    """Load an arm, with a ball for a fingertip, into the world of a PyBullet client.

    Nothing that PyBullet does unasked is left in it: no damping of its own, and joints only as
    viscous as the plant's.

    Returns:
        PyBullet's number of the body, whose links and joints 0 to 6 are the arm's.
    """
    with quiet(), TemporaryDirectory() as folder:
        file = Path(folder, "arm.urdf")  # PyBullet reads only files
        file.write_text(_urdf(side, plant))
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body: int = bullet.loadURDF(
            str(file), useFixedBase=True, flags=flags, physicsClientId=client
        )
    still = {"linearDamping": 0.0, "angularDamping": 0.0, "physicsClientId": client}
    for joint, viscous in enumerate((0.0, *plant.viscous), start=-1):
        bullet.changeDynamics(body, joint, jointDamping=viscous, **still)
    pad = {"contactStiffness": TIP_STIFFNESS, "contactDamping": TIP_DAMPING}
    hand = DOF - 1
    bullet.changeDynamics(
        body, hand, lateralFriction=1.0, restitution=0.0, physicsClientId=client, **pad
    )
    # PyBullet would show the ball; what cameras see of the arm is in `tags.visuals`.
    bullet.changeVisualShape(body, hand, rgbaColor=[0, 0, 0, 0], physicsClientId=client)
    return body


def _urdf(side: Side, plant: Plant) -> str:
    """The arm with the ball."""
    x, y, z = robot(side).T_hand_tip[:3, 3]
    ball = (
        f'<collision><origin xyz="{x} {y} {z}"/><geometry><sphere radius="{TIP_RADIUS}"/>'
        "</geometry></collision></link>"
    )
    return ball.join(robot(side).urdf(plant).rsplit("</link>", 1))
