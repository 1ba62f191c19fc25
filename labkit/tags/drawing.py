r"""Drawing: a lens, surfaces, and how OpenCV's rasteriser draws one through the other.

.. math:: u = f_x X/Z + c_x, \qquad v = f_y Y/Z + c_y

The camera's frame c has z forward, x to the right and y down in the picture.  Pixel (0, 0) is the
middle of the upper left pixel (OpenCV's convention), so the middle of a picture 640 pixels wide is
at u = 319.5.  A real lens bends lines too: undo that with ``cv2.undistort`` before anything else.

What cameras see of robots are Baxter's meshes, which have no part in the physics.  If a world has
only one of Baxter's arms, or no arm, the missing ones are drawn at Rethink's neutral pose.  Other
arms are not seen.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from .. import se3
from ..errors import OutOfRange
from ..robot import SIDES, Robot
from ..robot import robot as baxter
from ..scene import FACE, Table, Wall
from ..shapes import Array, as_array, as_number, locked
from ..world import World

DATA = Path(__file__).parents[1] / "data"
NEAR, FAR = 0.02, 12.0
"""Nothing nearer or farther than this is drawn, in [m]."""
_LIGHT = np.array([0.6, 0.35, 1.0]) / np.linalg.norm([0.6, 0.35, 1.0])  # where it is, world axes
_AMBIENT = 0.6  # brightness of a face that the light does not reach; one that faces it has 1
_HALF_ANGLE = 0.25 * np.pi  # of the rasteriser's own lens, for which `_folded` converts points
_SETTINGS = (
    cv2.TriangleRasterizeSettings()
    .setCullingMode(cv2.RASTERIZE_CULLING_NONE)
    .setShadingType(cv2.RASTERIZE_SHADING_FLAT)
)
_BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


@dataclass(frozen=True)
class Intrinsics:
    """A camera's lens and sensor, as a value.

    Attributes:
        width: Width of the picture, in [px].
        height: Height of the picture, in [px].
        fx: Focal length along x, in [px].
        fy: Focal length along y, in [px].
        cx: Where the optical axis meets the picture, along x, in [px]; None is the middle.
        cy: The same along y.
    """

    width: int = 640
    height: int = 480
    fx: float = 515.0
    fy: float = 515.0
    cx: Any = None
    cy: Any = None

    def __post_init__(self) -> None:
        for name in ("width", "height", "fx", "fy"):
            as_number(getattr(self, name), name, above=0.0)
        for n, middle in ((self.width, "cx"), (self.height, "cy")):
            given = getattr(self, middle)
            at = 0.5 * (n - 1) if given is None else as_number(given, middle)
            object.__setattr__(self, middle, at)

    @property
    def matrix(self) -> Array:
        """The camera matrix K, shape (3, 3)."""
        return locked(np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]]))

    def project(self, points: Any) -> Array:
        """Project points to the picture.

        Args:
            points: Points in the camera's frame, in front of it, shape (n, 3) in [m].

        Returns:
            Pixels, shape (n, 2).

        Raises:
            ShapeError: The points do not have three coordinates.
            OutOfRange: A point is not in front of the camera.
        """
        p = as_array(points, (len(points), 3), "points")
        if (behind := p[:, 2] <= 0.0).any():
            i = int(behind.argmax())
            raise OutOfRange(
                f"point {i} is at z = {p[i, 2]:.3g} m in the camera's frame: it is behind the "
                "camera; are these coordinates of the world?"
            )
        return np.asarray((p[:, :2] / p[:, 2:]) * [self.fx, self.fy] + [self.cx, self.cy])


class Surface(NamedTuple):
    """A set of coloured triangles.

    Attributes:
        corners: Corners of each triangle, shape (n, 3, 3) in [m].
        colours: Red, green and blue of each triangle, from 0 to 1, shape (n, 3).
    """

    corners: Array
    colours: Array

    def moved(self, T: Array) -> Surface:
        """The surface in another frame, in which its own frame has the pose ``T``, shape (4, 4)."""
        return self._replace(corners=self.corners @ T[:3, :3].T + T[:3, 3])

    def only(self, wanted: Any) -> Surface:
        """Only the triangles for which ``wanted``, shape (n,), is true."""
        return Surface(self.corners[wanted], self.colours[wanted])


def in_colour(corners: Array, colour: Any) -> Surface:
    """Triangles, shape (n, 3, 3) in [m], in one colour: red, green and blue, from 0 to 1."""
    return Surface(corners, np.tile(np.asarray(colour, dtype=float)[:3], (len(corners), 1)))


def joined(surfaces: Iterable[Surface]) -> Surface:
    """Several surfaces as one."""
    nothing = Surface(np.empty((0, 3, 3)), np.empty((0, 3)))
    corners, colours = zip(nothing, *surfaces, strict=True)
    return Surface(np.concatenate(corners), np.concatenate(colours))


def box(half: Any, colour: Any) -> Surface:
    """A box about the origin with edges of twice the lengths ``half``, shape (3,) in [m]."""
    return in_colour((_BOX * half)[ConvexHull(_BOX).simplices], colour)


class Window(NamedTuple):
    """A part of the picture, in pixels.

    Attributes:
        left: First column.
        top: First row.
        width: Number of columns.
        height: Number of rows.
    """

    left: int
    top: int
    width: int
    height: int

    @property
    def place(self) -> tuple[slice, slice]:
        """The window's rows and columns in a picture."""
        return slice(self.top, self.top + self.height), slice(self.left, self.left + self.width)

    def rays(self, lens: Intrinsics, samples: int = 1) -> tuple[Array, Array]:
        """Directions of the samples: X/Z of each column and Y/Z of each row, in the camera's frame.

        Args:
            lens: The lens.
            samples: Number of samples along each side of a pixel.

        Returns:
            Shapes (width * samples,) and (height * samples,), without unit.
        """
        u = self.left - 0.5 + (np.arange(self.width * samples) + 0.5) / samples
        v = self.top - 0.5 + (np.arange(self.height * samples) + 0.5) / samples
        return (u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy


def brightness(normals: Any) -> Array:
    """Brightness of faces, from 0 to 1, by Lambert's law with ambient light.

    Args:
        normals: Unit vectors out of the faces, world axes, shape (..., 3).
    """
    return np.asarray(_AMBIENT + (1.0 - _AMBIENT) * np.maximum(normals @ _LIGHT, 0.0))


def draw(
    surface: Surface, lens: Intrinsics, T_wc: Array, window: Window, samples: int = 1
) -> tuple[Any, Any]:
    """Draw a surface; it takes no graphics card, and is the same picture everywhere.

    Args:
        surface: The surface, in the world.
        lens: Lens and sensor.
        T_wc: Pose of the camera in the world, shape (4, 4).
        window: The part of the picture to draw.
        samples: Number of samples along each side of a pixel.

    Returns:
        Colours, shape (rows, columns, 3), white where the picture is empty, and depths along the
        camera's axis, shape (rows, columns), within a thousandth of `FAR` where it is empty.
    """
    wide, tall = window.width * samples, window.height * samples
    colours, depth = np.ones((tall, wide, 3), np.float32), np.full((tall, wide), FAR, np.float32)
    lit = _lit(surface, T_wc[:3, 3])
    corners, tints = _clipped((lit.corners - T_wc[:3, 3]) @ T_wc[:3, :3], lit.colours)
    if len(corners):
        seen = _folded(corners, lens, window, samples).astype(np.float32).reshape(1, -1, 3)
        numbers = np.arange(seen.shape[1], dtype=np.int32).reshape(1, -1, 3)
        paints = np.repeat(tints, 3, axis=0).astype(np.float32).reshape(1, -1, 3)
        own = (np.eye(4), 2.0 * _HALF_ANGLE, NEAR, FAR, _SETTINGS)
        cv2.triangleRasterize(seen, numbers, paints, colours, depth, *own)
    return colours, depth


def _lit(surface: Surface, eye: Array) -> Surface:
    """The surface with the light applied; of a sheet, the side towards the eye counts."""
    a, b, c = np.moveaxis(surface.corners, 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    solid = lengths > 0.0  # a triangle without an area is not seen
    normals = normals[solid] / lengths[solid, None]
    away = np.einsum("ij,ij->i", normals, eye - a[solid]) < 0.0
    shade = brightness(np.where(away[:, None], -normals, normals))
    corners, colours = surface.only(solid)
    return Surface(corners, colours * shade[:, None])


def _clipped(corners: Array, colours: Array) -> Surface:
    """Triangles in the camera's frame, cut off at `NEAR`: the rasteriser drops what crosses it."""
    behind = corners[:, :, 2] < NEAR
    count = behind.sum(axis=1)
    parts = [Surface(corners, colours).only(count == 0)]
    for k in (1, 2):  # corners behind: with the odd one first, a quadrangle or a triangle is left
        cut = corners[count == k]
        odd = np.argmax(behind[count == k] == (k == 1), axis=1)
        a, b, c = (cut[np.arange(len(cut)), (odd + j) % 3] for j in range(3))
        ab, ac = (a + (NEAR - a[:, 2:]) / (x - a)[:, 2:] * (x - a) for x in (b, c))
        ab[:, 2] = ac[:, 2] = NEAR
        triangles = [(a, ab, ac)] if k == 2 else [(ab, b, c), (ab, c, ac)]
        parts += [Surface(np.stack(t, axis=1), colours[count == k]) for t in triangles]
    return joined(parts)


def _folded(corners: Array, lens: Intrinsics, window: Window, samples: int) -> Array:
    """Convert points to OpenGL's axes such that the rasteriser's lens shows them as ``lens`` would.

    The rasteriser samples the middles of pixels, its axis meets the picture's middle, and its focal
    length is half of the picture's height.
    """
    x, y, z = np.moveaxis(corners, -1, 0)
    wide, tall = window.width * samples, window.height * samples
    focal = 0.5 * tall / np.tan(_HALF_ANGLE)
    u = samples * (lens.cx - window.left + 0.5) - 0.5 * wide
    v = samples * (lens.cy - window.top + 0.5) - 0.5 * tall
    right = (samples * lens.fx * x + u * z) / focal
    down = (samples * lens.fy * y + v * z) / focal
    return np.stack([right, -down, -z], axis=-1)


class Piece(NamedTuple):
    """A part of a robot.

    Attributes:
        parent: The joint that carries it.
        surface: Its triangles, in that joint's moving frame.
        centre: Middle of a ball that encloses it, shape (3,) in [m], in the same frame.
        radius: Radius of the ball, in [m].
    """

    parent: str
    surface: Surface
    centre: Array
    radius: float


def _piece(parent: str, surface: Surface) -> Piece:
    points = surface.corners.reshape(-1, 3)
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return Piece(parent, surface, centre, float(np.linalg.norm(points - centre, axis=1).max()))


class RobotVisuals:
    """What cameras see of robots with their joints at some angles.

    Attributes:
        pieces: All parts of the robots.
        frames: World pose of each part's joint, shape (pieces, 4, 4).
    """

    def __init__(self, arms: Sequence[tuple[Robot, Array]]) -> None:
        """Take ``arms``, pairs of a robot and its joint angles, shape (n,) in [rad]."""
        q = {robot.name: angles for robot, angles in arms if robot.name in SIDES}
        self.pieces: tuple[Piece, ...] = _meshes() if q or not arms else ()
        frames = joint_frames({side: baxter(side).neutral for side in SIDES} | q)
        poses = [frames[piece.parent] for piece in self.pieces]
        self.frames = np.array(poses).reshape(-1, 4, 4)

    @property
    def balls(self) -> tuple[Array, Array]:
        """A ball around each piece: world centres (pieces, 3) and radii (pieces,) in [m]."""
        centres = np.array([[*piece.centre, 1.0] for piece in self.pieces]).reshape(-1, 4)
        radii = np.array([piece.radius for piece in self.pieces])
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
    names = {side: baxter(side).joint_names for side in q}
    angle = {name: x for side in q for name, x in zip(names[side], q[side], strict=True)}
    frames: dict[str, Array] = {"base": np.eye(4)}
    for joint in _table("joints"):
        turn = _turn(float(angle.get(joint["name"], 0.0)))
        frames[joint["name"]] = frames[joint["parent"]] @ joint["T"] @ turn
    return frames


def _turn(angle: float) -> Array:
    """A rotation about z, shape (4, 4)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


@cache
def _meshes() -> tuple[Piece, ...]:
    """All of Baxter's pieces."""
    found = []
    for piece in _table("pieces"):
        points, sides, *_ = cv2.loadMesh(str(DATA / piece["mesh"]))
        corners = np.asarray(points, dtype=float)[0][np.array(sides)[:, 0]]
        found.append(_piece(piece["parent"], in_colour(corners, piece["rgba"]).moved(piece["T"])))
    return tuple(found)


@cache
def _table(name: str) -> list[dict[str, Any]]:
    """Baxter's joints or pieces, each with its pose T in its parent's frame, shape (4, 4)."""
    rows: list[dict[str, Any]] = json.loads((DATA / "baxter_visual.json").read_text())[name]
    for row in rows:
        turn = Rotation.from_quat(row["quaternion"]).as_matrix()
        row["T"] = locked(se3.pose(turn, np.array(row["position"])))
    return rows
