"""What cameras see of Baxter: meshes, where the joints have moved them.

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
from .surface import Surface, box, joined, mesh

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
    def surface(self) -> Surface:
        """Its triangles, in the joint's moving frame."""
        return mesh(self.file, self.colour).moved(self.T_jp)

    @cached_property
    def ball(self) -> tuple[Array, float]:
        """A ball around it: its centre, shape (3,) in [m], and its radius in [m]."""
        points = self.surface.corners.reshape(-1, 3)
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        return centre, float(np.linalg.norm(points - centre, axis=1).max())

    @cached_property
    def _hull(self) -> Array:
        """Planes of the convex hull, outward normals and offsets, shape (planes, 4)."""
        return np.asarray(ConvexHull(self.surface.corners.reshape(-1, 3)).equations)

    def encloses(self, point: Array) -> bool:
        """Whether a point is within the convex hull: the real shells are hollow."""
        return bool((self._hull[:, :3] @ point + self._hull[:, 3]).max() < -0.002)


class RobotVisuals:
    """What cameras see of the robot, with its joints where they are now.

    Attributes:
        frames: Pose in the world of each piece's joint, shape (pieces, 4, 4).
    """

    def __init__(self, world: World) -> None:
        """Look where the joints of ``world`` are."""
        q = {side: robot(side).neutral for side in ("left", "right")}
        q |= {arm.robot.side: arm.truth().q for arm in world.arms}
        frames = joint_frames(q)
        self.frames = np.array([frames[piece.parent] for piece in pieces()])

    @property
    def balls(self) -> tuple[Array, Array]:
        """A ball around each piece: centres in the world (pieces, 3) and radii (pieces,) in [m]."""
        centres, radii = _balls()
        return np.einsum("nij,nj->ni", self.frames, centres)[:, :3], radii

    def surface(self, wanted: Any) -> Surface:
        """Those pieces that are wanted, shape (pieces,), bool, in the world."""
        return joined(pieces()[i].surface.moved(self.frames[i]) for i in np.flatnonzero(wanted))

    def around(self, point: Array) -> str | None:
        """The joint whose link a point of the world, shape (3,) in [m], is inside of, if any."""
        centres, radii = self.balls
        for i in np.flatnonzero(np.linalg.norm(centres - point, axis=1) < radii):
            T = self.frames[i]
            if pieces()[i].encloses(T[:3, :3].T @ (point - T[:3, 3])):
                return pieces()[i].parent
        return None


def scenery(world: World) -> Surface:
    """Walls, tables and whatever else is shown in a world, the robot apart."""
    slabs = []
    for thing in world.things:
        if isinstance(thing, Wall | Table):
            below = se3.pose(np.eye(3), np.array([0.0, 0.0, -0.5 * FACE]))
            slab = box([*(0.5 * thing.size), 0.5 * FACE], thing.colour)
            slabs.append(slab.moved(thing.T_wf @ below))
    return joined([*slabs, *(thing.surface() for thing in world.shown)])


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
def _balls() -> tuple[Array, Array]:
    centres = np.array([[*piece.ball[0], 1.0] for piece in pieces()])
    return centres, np.array([piece.ball[1] for piece in pieces()])


@cache
def _joints() -> tuple[tuple[str, str, Array], ...]:
    return tuple((j["name"], j["parent"], _placed(j)) for j in _table("joints"))


def _table(name: str) -> list[dict[str, Any]]:
    table: list[dict[str, Any]] = json.loads((DATA / "baxter_visual.json").read_text())[name]
    return table


def _placed(thing: dict[str, Any]) -> Array:
    R = Rotation.from_quat(thing["quaternion"]).as_matrix()
    return locked(se3.pose(R, np.array(thing["position"])))
