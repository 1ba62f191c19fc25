"""What cameras see of Baxter: meshes, moved with the joints before each picture.

They belong to no physics: arms in the engine are seven bodies without a shape.  Where a world has
only one arm, or none, the other hangs at Rethink's neutral pose.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from .. import se3
from ..baxter import robot
from ..scene import FACE, Table, Wall
from ..shapes import Array, locked
from ..world import World

DATA = Path(__file__).parents[1] / "data"


@dataclass(frozen=True, eq=False)
class Piece:
    """A mesh of one colour, a part of the robot.

    Attributes:
        parent: The joint that carries it.
        T_jp: Its pose in that joint's moving frame, shape (4, 4).
        colour: Red, green, blue, opacity, from 0 to 1.
        file: The mesh's file.
    """

    parent: str
    T_jp: Array
    colour: tuple[float, ...]
    file: Path

    @cached_property
    def points(self) -> Array:
        """The mesh's corners, shape (n, 3) in [m]."""
        lines = self.file.read_text().splitlines()
        return np.array([x.split()[1:4] for x in lines if x.startswith("v ")], dtype=float)

    @cached_property
    def ball(self) -> tuple[Array, float]:
        """A ball around the mesh: its centre, shape (3,) in [m], and its radius in [m]."""
        centre = 0.5 * (self.points.min(axis=0) + self.points.max(axis=0))
        return centre, float(np.linalg.norm(self.points - centre, axis=1).max())

    @cached_property
    def _hull(self) -> Array:
        """Planes of the convex hull, outward normals and offsets, shape (planes, 4)."""
        return np.asarray(ConvexHull(self.points).equations)

    def encloses(self, point: Array) -> bool:
        """Whether a point is within the convex hull: the real shells are hollow."""
        return bool((self._hull[:, :3] @ point + self._hull[:, 3]).max() < -0.002)


class RobotVisuals:
    """What cameras see of the robot in one world; made when the first camera opens its eye.

    Attributes:
        world: Where it stands.
        bodies: The numbers of the pieces in `World.pictures`.
        poses: Pose of each piece in the world at the last update, shape (pieces, 4, 4).
    """

    @staticmethod
    def of(world: World) -> RobotVisuals:
        """Those in ``world``: there is one robot."""
        found = next((thing for thing in world.shown if isinstance(thing, RobotVisuals)), None)
        return RobotVisuals(world) if found is None else found

    def __init__(self, world: World) -> None:
        """Load the meshes into ``world``."""
        self.world = world
        self.bodies = [world.pictures.add_mesh(p.file, p.colour) for p in pieces()]
        self._seen = np.ones(len(self.bodies), dtype=bool)
        self._centres = np.array([[*p.ball[0], 1.0] for p in pieces()])
        self._radii = np.array([p.ball[1] for p in pieces()])
        self._at: bytes = b""
        world.show(self)
        self.update()

    def update(self) -> None:
        """Move every piece to where the joints are now."""
        q = {side: robot(side).neutral for side in ("left", "right")}
        q |= {arm.robot.side: arm.truth().q for arm in self.world.arms}
        now = q["left"].tobytes() + q["right"].tobytes()
        if now == self._at:
            return
        self._at = now
        frames = joint_frames(q)
        self.poses = np.array([frames[piece.parent] @ piece.T_jp for piece in pieces()])
        for body, T in zip(self.bodies, self.poses, strict=True):
            self.world.pictures.move(body, T)

    @property
    def balls(self) -> tuple[Array, Array]:
        """A ball around each piece: centres in the world (pieces, 3) and radii (pieces,) in [m]."""
        return np.einsum("nij,nj->ni", self.poses, self._centres)[:, :3], self._radii

    def draw_only(self, wanted: Any) -> None:
        """Leave pieces out of the pictures to come: they would cost time and show nothing.

        Args:
            wanted: Which pieces to draw, shape (pieces,), bool.
        """
        for i in np.flatnonzero(wanted != self._seen):
            *rgb, opacity = pieces()[i].colour
            self.world.pictures.paint(self.bodies[i], [*rgb, opacity if wanted[i] else 0.0])
        self._seen = np.array(wanted)

    def around(self, point: Array) -> str | None:
        """The joint whose link a point of the world, shape (3,) in [m], is inside of, if any."""
        centres, radii = self.balls
        for i in np.flatnonzero(np.linalg.norm(centres - point, axis=1) < radii):
            T = self.poses[i]
            if pieces()[i].encloses(T[:3, :3].T @ (point - T[:3, 3])):
                return pieces()[i].parent
        return None


def show_slabs(world: World) -> None:
    """Let cameras see the walls and tables that were put into a world since the last time."""
    drawn = world.pictures.slabs
    for thing in world.things:
        if isinstance(thing, Wall | Table) and thing not in drawn:
            half = np.array([*(0.5 * thing.size), 0.5 * FACE])
            drawn[thing] = world.pictures.add_box(half, thing.colour.tolist())
            T = thing.T_wf
            world.pictures.move(
                drawn[thing], T @ se3.pose(np.eye(3), np.array([0.0, 0.0, -half[2]]))
            )


def joint_frames(q: dict[str, Any]) -> dict[str, Array]:
    """Pose in the world of every joint's moving frame, and of the base.

    Args:
        q: Joint angles of each side, shape (7,) in [rad].
    """
    angle = {
        name: float(x)
        for side, angles in q.items()
        for name, x in zip(robot(side).joint_names, angles, strict=True)
    }
    frames: dict[str, Array] = {"base": np.eye(4)}
    for name, parent, T in _joints():
        c, s = np.cos(angle.get(name, 0.0)), np.sin(angle.get(name, 0.0))
        turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        frames[name] = frames[parent] @ T @ turn
    return frames


@cache
def pieces() -> tuple[Piece, ...]:
    """All the robot's pieces."""
    return tuple(
        Piece(p["parent"], _placed(p), tuple(p["rgba"]), DATA / p["mesh"]) for p in _table("pieces")
    )


@cache
def _joints() -> tuple[tuple[str, str, Array], ...]:
    return tuple((j["name"], j["parent"], _placed(j)) for j in _table("joints"))


def _table(name: str) -> list[dict[str, Any]]:
    table: list[dict[str, Any]] = json.loads((DATA / "baxter_visual.json").read_text())[name]
    return table


def _placed(thing: dict[str, Any]) -> Array:
    R = Rotation.from_quat(thing["quaternion"]).as_matrix()
    return locked(se3.pose(R, np.array(thing["position"])))
