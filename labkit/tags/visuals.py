"""What cameras see of robots: Baxter's meshes, or a capsule for each link of another arm.

They have no part in the physics, where the bodies of an arm have no shape.  If a world has only one
of Baxter's arms, or no arm, the missing ones are drawn at Rethink's neutral pose.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from .. import se3
from ..baxter import robot as baxter
from ..robot import SIDES, Robot
from ..scene import FACE, Table, Wall
from ..shapes import Array, locked
from ..world import World
from .surface import Surface, box, joined, mesh, wrapped

DATA = Path(__file__).parents[1] / "data"


COLOUR = (0.45, 0.47, 0.5)
"""Colour of an arm without meshes."""

THICK = 0.035
"""Radius of a capsule as a share of the total length of the capsules."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a robot.

    Attributes:
        parent: The joint that carries it.
        surface: Its triangles, in that joint's moving frame.
    """

    parent: str
    surface: Surface

    @cached_property
    def ball(self) -> tuple[Array, float]:
        """A ball that encloses the piece: its centre, shape (3,) in [m], and its radius in [m]."""
        points = self.surface.corners.reshape(-1, 3)
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        return centre, float(np.linalg.norm(points - centre, axis=1).max())


class RobotVisuals:
    """What cameras see of robots with their joints at some angles.

    Attributes:
        pieces: All parts of the robots.
        frames: World pose of each part's joint, shape (pieces, 4, 4).
    """

    def __init__(self, arms: Sequence[tuple[Robot, Array]]) -> None:
        """Take ``arms``, pairs of a robot and its joint angles, shape (n,) in [rad]."""
        q = {robot.name: angles for robot, angles in arms if robot.name in SIDES}
        others = [(robot, angles) for robot, angles in arms if robot.name not in SIDES]
        self.pieces: tuple[Piece, ...] = pieces() if q or not others else ()
        frames = joint_frames({side: baxter(side).neutral for side in SIDES} | q)
        poses = [frames[piece.parent] for piece in self.pieces]
        for robot, angles in others:
            links = capsules(robot)
            frames = link_frames(robot, angles)
            self.pieces += links
            poses += [frames[link.parent] for link in links]
        self.frames = np.array(poses)

    @property
    def balls(self) -> tuple[Array, Array]:
        """A ball around each piece: world centres (pieces, 3) and radii (pieces,) in [m]."""
        centres, radii = _balls(self.pieces)
        return np.einsum("nij,nj->ni", self.frames, centres)[:, :3], radii

    def surface(self, wanted: Any) -> Surface:
        """The world surface of the pieces for which ``wanted``, shape (pieces,), is true."""
        chosen = np.flatnonzero(wanted)
        return joined(self.pieces[i].surface.moved(self.frames[i]) for i in chosen)


def scenery(world: World) -> Surface:
    """Walls, tables and everything else that is shown in a world, except robots."""
    slabs = []
    for thing in world.things:
        if isinstance(thing, Wall | Table):
            below = se3.pose(np.eye(3), np.array([0.0, 0.0, -0.5 * FACE]))
            slab = box([*(0.5 * thing.size), 0.5 * FACE], thing.colour)
            slabs.append(slab.moved(thing.T_wf @ below))
    return joined([*slabs, *(thing.surface() for thing in world.shown)])


def joint_frames(q: dict[str, Any]) -> dict[str, Array]:
    """World poses of the moving frames of all of Baxter's joints, and of the base.

    Args:
        q: Joint angles of each side, shape (n,) in [rad].
    """
    angle = {
        name: float(x)
        for side, angles in q.items()
        for name, x in zip(baxter(side).joint_names, angles, strict=True)
    }
    frames: dict[str, Array] = {"base": np.eye(4)}
    for name, parent, T in _joints():
        frames[name] = frames[parent] @ T @ _turn(angle.get(name, 0.0))
    return frames


def link_frames(robot: Robot, q: Array) -> dict[str, Array]:
    """World poses of the moving frames of a robot's joints, and of the base.

    Args:
        robot: Any robot.
        q: Joint angles, shape (n,) in [rad].
    """
    T = np.eye(4)
    frames = {"base": T}
    for body, angle in zip(robot.bodies, q.tolist(), strict=True):
        frames[body["joint"]] = T = T @ np.array(body["T_parent"]) @ _turn(angle)
    return frames


def _turn(angle: float) -> Array:
    """A rotation about z, shape (4, 4)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


@cache
def pieces() -> tuple[Piece, ...]:
    """All of Baxter's pieces."""
    return tuple(
        Piece(p["parent"], mesh(DATA / p["mesh"], p["rgba"]).moved(_placed(p)))
        for p in _table("pieces")
    )


@lru_cache(maxsize=8)
def capsules(robot: Robot) -> tuple[Piece, ...]:
    """A capsule for each link of a robot, from one joint to the next, and to the tip."""
    ends = [*(np.array(body["T_parent"])[:3, 3] for body in robot.bodies), robot.T_hand_tip[:3, 3]]
    radius = THICK * float(sum(np.linalg.norm(end) for end in ends))
    names = ("base", *robot.joint_names)
    return tuple(Piece(name, _capsule(end, radius)) for name, end in zip(names, ends, strict=True))


def _capsule(end: Array, radius: float) -> Surface:
    """A rod with round ends, from the origin to ``end``, shape (3,) in [m]."""
    around, along = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 13)[1:], np.linspace(0, np.pi, 7))
    ring = np.array([np.cos(around) * np.sin(along), np.sin(around) * np.sin(along), np.cos(along)])
    ball = radius * ring.reshape(3, -1).T
    return wrapped(np.concatenate([ball, ball + end]), COLOUR)


@lru_cache(maxsize=8)
def _balls(parts: tuple[Piece, ...]) -> tuple[Array, Array]:
    centres = np.array([[*part.ball[0], 1.0] for part in parts])
    return centres, np.array([part.ball[1] for part in parts])


@cache
def _joints() -> tuple[tuple[str, str, Array], ...]:
    return tuple((j["name"], j["parent"], _placed(j)) for j in _table("joints"))


def _table(name: str) -> list[dict[str, Any]]:
    table: list[dict[str, Any]] = json.loads((DATA / "baxter_visual.json").read_text())[name]
    return table


def _placed(thing: dict[str, Any]) -> Array:
    R = Rotation.from_quat(thing["quaternion"]).as_matrix()
    return locked(se3.pose(R, np.array(thing["position"])))
