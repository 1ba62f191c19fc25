"""A camera in the world, and what it does to a picture.

A renderer samples one point of each pixel, which would move the edges of a tag's pattern by up to
half a pixel.  The pattern is known exactly, so pixels on an edge are sampled at many points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np

from .. import se3
from ..errors import Closed, OutOfRange, TypeMismatch
from ..shapes import Array, as_number, as_random, as_vector, locked, shown
from ..world import World
from . import drawing
from .drawing import FAR, NEAR, Intrinsics, RobotVisuals, Surface, Window
from .tag import Board, Picture, Tag

BACKGROUND = 255
"""Grey level of the empty background."""

_MARGIN = 4  # pixels that are drawn around a tag's paper
_INSTANTS = 9  # that are drawn during an exposure
_FINE = 4  # samples of a pixel along each side where something may hide a tag
_OUTSIDE = -1.0  # whiteness beside the paper


@dataclass(frozen=True)
class Optics:
    """What a camera does to a picture, in this order; by default, nothing.

    Attributes:
        samples: The number s of samples along each side of a pixel on an edge of a tag; with 1,
            edges are jagged.
        shade: Share by which light falls from the left to the right edge of a tag's paper.
        exposure: Time for which the shutter is open, centred on the time of the picture, in [s].
            Moving boards are smeared; the robot, and a camera in its hand, count as still.
        blur: Standard deviation of the blur of a lens out of focus, in [px].
        vignette: Share of the light that is lost in the picture's corners.
        gamma: Exponent of the sensor's response.
        noise: Standard deviation of each colour of each pixel, in grey levels.
        jpeg: Quality to which the picture is compressed, from 1 to 100; 0 leaves it as it is.
    """

    samples: int = 8
    shade: float = 0.0
    exposure: float = 0.0
    blur: float = 0.0
    vignette: float = 0.0
    gamma: float = 1.0
    noise: float = 0.0
    jpeg: int = 0

    def __post_init__(self) -> None:
        for name in ("shade", "exposure", "blur", "vignette", "noise"):
            as_number(getattr(self, name), name, least=0.0)
        as_number(self.gamma, "gamma", above=0.0)
        as_number(self.samples, "samples", least=1.0)
        if max(self.shade, self.vignette) > 1.0:
            raise OutOfRange(f"shade is {self.shade}, vignette {self.vignette}; give at most 1")


class Camera:
    """A camera that takes pictures of a world.

    Attributes:
        world: The world that it sees.
        intrinsics: Its lens and sensor.
        optics: What it does to a picture.
        T_wc: Pose of the camera in the world, shape (4, 4).
    """

    def __init__(
        self,
        world: World,
        T_wc: Any,
        intrinsics: Intrinsics | None = None,
        *,
        seed: int = 0,
        **optics: Any,
    ) -> None:
        """Fix a camera in ``world``.

        Args:
            world: The world that it sees.
            T_wc: Pose of the camera in the world (z forward, x right, y down), shape (4, 4);
                `looking_at` makes one.
            intrinsics: Lens and sensor; None means 640 x 480 pixels and a focal length of 515 px.
            seed: Seed of the noise.
            **optics: `Optics`, such as ``noise=2.0`` or ``blur=1.0``.

        Raises:
            TypeMismatch: The world is not a `World`, or the seed not a number.
            OutOfRange: One of the optics is outside its permitted range.
        """
        if not isinstance(world, World):
            raise TypeMismatch(f"world is {shown(world)}, expected a World; an arm's is arm.world")
        self.world = world
        self.intrinsics = Intrinsics() if intrinsics is None else intrinsics
        self.optics = Optics(**optics)
        self._random = as_random(seed)
        self.place(T_wc)

    def place(self, T_wc: Any) -> None:
        """Put the camera at a pose in the world, shape (4, 4)."""
        self.T_wc: Array = locked(np.array(se3.as_pose(T_wc, "T_wc")))

    def image(self) -> Picture:
        """Take a picture.

        Returns:
            Colours in RGB order, shape (height, width, 3), 0 to 255, read-only.

        Raises:
            Closed: The world is closed.
        """
        robot = self._robots()
        size = Window(0, 0, self.intrinsics.width, self.intrinsics.height)
        seen = drawing.joined([self._robot_in(robot, size, FAR), drawing.scenery(self.world)])
        picture = 255.0 * drawing.draw(seen, self.intrinsics, self.T_wc, size)[0]
        return self._developed(self._exposed(picture, robot)[0], [size])

    def tag_image(self) -> Picture:
        """Take a quick picture of only the tags and of what hides them; the rest stays blank.

        Returns:
            As for `image`; without noise, blur or JPEG, both are the same within a tag's paper.

        Raises:
            Closed: The world is closed.
        """
        lens = self.intrinsics
        picture = np.full((lens.height, lens.width, 3), BACKGROUND, np.float32)
        return self._developed(*self._exposed(picture, self._robots()))

    def _exposed(self, picture: Any, robot: RobotVisuals) -> tuple[Any, list[Window]]:
        """The picture with the tags printed on it, averaged over the exposure; their windows."""
        if not self.optics.exposure:
            return picture, self._print(picture, robot, self.world.t)
        total, windows = np.zeros_like(picture), []
        for share in (np.arange(_INSTANTS) + 0.5) / _INSTANTS - 0.5:
            one = picture.copy()
            windows += self._print(one, robot, self.world.t + share * self.optics.exposure)
            total += one / _INSTANTS
        return total, windows

    def _robots(self) -> RobotVisuals:
        """The robots in their present postures."""
        if self.world.closed:
            raise Closed("this camera's world was closed; make a new World, and a Camera in it")
        return RobotVisuals([(arm.robot, arm.truth().q) for arm in self.world.arms])

    def _robot_in(self, robot: RobotVisuals, window: Window, depth: float) -> Surface:
        """The pieces of the robot that reach into a window's cone, up to a depth."""
        centres, radii = robot.balls
        x, y, z = ((centres - self.T_wc[:3, 3]) @ self.T_wc[:3, :3]).T
        outside = (z + radii < NEAR) | (z - radii > depth)
        for coordinate, rays in zip((x, y), window.rays(self.intrinsics), strict=True):
            low, high = rays[0], rays[-1]
            outside |= coordinate - low * z < -radii * np.hypot(1.0, low)
            outside |= coordinate - high * z > radii * np.hypot(1.0, high)
        return robot.surface(~outside)

    def _print(self, picture: Any, robot: RobotVisuals, t: float) -> list[Window]:
        """Print the tags' papers over a picture, then what hides them; returns their windows."""
        boards = [thing for thing in self.world.shown if isinstance(thing, Board)]
        seen = [(se3.inverse(self.T_wc) @ board.pose_at(t), board) for board in boards]
        windows = []
        for T_cm, board in sorted(seen, key=lambda one: -float(one[0][2, 3])):  # nearest last
            place = self._window(board, T_cm)
            if place is None:
                continue
            window, depth = place
            share, white = printed(board.tag, T_cm, self.intrinsics, window, self.optics.samples)
            light = 255.0 * float(drawing.brightness(board.T_wm[:3, 2]))
            shade = light * np.linspace(1.0, 1.0 - self.optics.shade, window.width)
            part = picture[window.place]
            part += share[..., None] * ((shade * white)[..., None] - part)
            arm, around = self._robot_in(robot, window, depth), drawing.scenery(self.world)
            self._hide(part, board.T_wm, drawing.joined([arm, around]), window)
            windows.append(window)
        return windows

    def _hide(self, part: Any, T_wm: Array, near: Surface, window: Window) -> None:
        """Draw what is in front of a board over its part of the picture."""
        height = (near.corners - T_wm[:3, 3]) @ T_wm[:3, 2]
        near = near.only((height > 1e-6).any(axis=1))
        if not len(near.corners):
            return
        n = _FINE
        colours, z = drawing.draw(near, self.intrinsics, self.T_wc, window, n)
        right, down = window.rays(self.intrinsics, n)
        T_cm = se3.inverse(self.T_wc) @ T_wm
        normal, middle = T_cm[:3, 2], T_cm[:3, 3]
        plane = (normal @ middle) / (normal[0] * right + (normal[1] * down + normal[2])[:, None])
        before = ((z < plane) | (plane <= 0.0)) & (z < 0.99 * FAR)
        size, seen = (window.width, window.height), before.astype(np.float32)[..., None]
        share, colour = (
            cv2.resize(x, size, interpolation=cv2.INTER_AREA)
            for x in (seen, 255.0 * colours * seen)
        )
        part += colour - share[..., None] * part

    def _window(self, board: Board, T_cm: Array) -> tuple[Window, float] | None:
        """The part of the picture that a board's paper covers, and a depth just behind it."""
        corners = board.outline @ T_cm[:3, :3].T + T_cm[:3, 3]
        if corners[:, 2].min() < NEAR or T_cm[:3, 2] @ T_cm[:3, 3] >= 0.0:
            return None  # too near to be seen whole, or seen from behind
        pixels, lens = self.intrinsics.project(corners), self.intrinsics
        low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - _MARGIN, 0)
        high = np.ceil(pixels.max(axis=0)).astype(int) + _MARGIN + 1
        wide, tall = np.minimum(high, (lens.width, lens.height)) - low
        if wide <= 0 or tall <= 0:
            return None
        return Window(int(low[0]), int(low[1]), int(wide), int(tall)), float(corners[:, 2].max())

    def _developed(self, picture: Any, windows: list[Window]) -> Picture:
        """Apply the optics, with noise where something was drawn; the result is read-only."""
        drawn = np.zeros(picture.shape[:2], np.uint8)
        for window in windows:
            drawn[window.place] = 1
        dials = self.optics
        if dials.blur:
            picture = cv2.GaussianBlur(picture, (0, 0), dials.blur)
        if dials.vignette:
            lens = self.intrinsics
            v, u = np.indices(drawn.shape)
            far = (u / (lens.width - 1) - 0.5) ** 2 + (v / (lens.height - 1) - 0.5) ** 2
            picture = picture * (1.0 - 2.0 * dials.vignette * np.asarray(far))[..., None]
        if dials.gamma != 1.0:
            picture = 255.0 * (picture / 255.0) ** dials.gamma
        if dials.noise and drawn.any():
            place = drawn > 0
            grain = self._random.standard_normal((int(place.sum()), 3), dtype=np.float32)
            picture[place] += np.float32(dials.noise) * grain
        levels: Picture = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
        if dials.jpeg:
            packed = cv2.imencode(".jpg", levels, [cv2.IMWRITE_JPEG_QUALITY, dials.jpeg])[1]
            levels = np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR_BGR), np.uint8)
        levels.setflags(write=False)
        return levels


def looking_at(eye: Any, at: Any, up: Any = (0.0, 0.0, 1.0)) -> Array:
    """The pose of a camera that looks at a point.

    Args:
        eye: Position of the camera, world axes, shape (3,) in [m].
        at: Point that it looks at, world axes, shape (3,) in [m].
        up: Direction that is up in the picture, world axes, shape (3,).

    Returns:
        `T_wc`, shape (4, 4).

    Raises:
        OutOfRange: The two points coincide, or the camera looks along ``up``.
    """
    eye, at, up = (as_vector(x, 3, n) for x, n in ((eye, "eye"), (at, "at"), (up, "up")))
    z = at - eye
    x = np.cross(z, up)
    if np.linalg.norm(z) < 1e-9 or np.linalg.norm(x) < 1e-9 * np.linalg.norm(z):
        raise OutOfRange(
            f"a camera at {eye.tolist()} cannot look at {at.tolist()} with {up.tolist()} upwards; "
            "looking straight down, give up=(1, 0, 0)"
        )
    z, x = z / np.linalg.norm(z), x / np.linalg.norm(x)
    return se3.pose(np.column_stack([x, np.cross(z, x), z]), eye)


def printed(
    tag: Tag, T_cm: Array, lens: Intrinsics, window: Window, samples: int
) -> tuple[Array, Array]:
    """Compute which share of each pixel shows a tag's paper, and how white that share is.

    Args:
        tag: The tag, all of it in front of the camera.
        T_cm: Its pose in the camera's frame, shape (4, 4).
        lens: Lens and sensor.
        window: The part of the picture.
        samples: Number of points along each side of a pixel on an edge.

    Returns:
        The share of each pixel that the paper covers, and how white that share is, both from 0 to 1
        and with the window's shape.
    """
    to_tag: Any = np.linalg.inv(lens.matrix @ T_cm[:3, [0, 1, 3]])  # from pixels to the paper
    u = window.left - 0.5 + np.arange(window.width + 1)
    v = window.top - 0.5 + np.arange(window.height + 1)
    level, cell = _levels(tag, to_tag, *np.meshgrid(u, v))
    low, high = slice(None, -1), slice(1, None)
    around = [(low, low), (low, high), (high, low), (high, high)]  # a pixel's four corners
    alike = np.logical_and.reduce([level[place] == level[around[0]] for place in around[1:]])
    spans = [np.ptp([part[place] for place in around], axis=0) for part in cell]
    edge = ~alike | (np.maximum(*spans) > 1)
    share = (level[around[0]] != _OUTSIDE).astype(float)
    white = np.maximum(level[around[0]], 0.0)
    i, j = np.nonzero(edge)
    # No two points share a row or a column, so edges along rows or columns are as exact as others.
    first, second = (x.ravel() for x in np.indices((samples, samples)))
    du, dv = (
        (first + (second + 0.5) / samples) / samples,
        (second + (first + 0.5) / samples) / samples,
    )
    fine, _ = _levels(tag, to_tag, u[j][:, None] + du, v[i][:, None] + dv)
    on = fine != _OUTSIDE
    share[edge] = on.mean(axis=1)
    white[edge] = (fine * on).sum(axis=1) / np.maximum(on.sum(axis=1), 1)
    return share, white


def _levels(tag: Tag, to_tag: Any, u: Any, v: Any) -> tuple[Array, tuple[Any, Any]]:
    """Whiteness of the paper at points of the picture, -1 beside it, and the points' cells."""
    x, y, w = (to_tag[i, 0] * u + to_tag[i, 1] * v + to_tag[i, 2] for i in range(3))
    table = _whiteness(tag)
    n = len(table) - 2
    column = np.clip(np.floor((x / (w * tag.paper) + 0.5) * n), -1, n).astype(int)
    row = np.clip(np.floor((0.5 - y / (w * tag.paper)) * n), -1, n).astype(int)
    return table[row + 1, column + 1], (column, row)


@cache
def _whiteness(tag: Tag) -> Array:
    """Whiteness of each cell, 0 or 1, from the upper left, framed by cells of `_OUTSIDE`."""
    return np.pad(tag.image(1) / 255.0, 1, constant_values=_OUTSIDE)
