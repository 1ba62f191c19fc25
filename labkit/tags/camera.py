"""A camera in the world: fixed somewhere, or in the robot's hand.

PyBullet's software renderer looks at one point in the middle of each pixel.  A real pixel collects
light from its whole area; so tags are drawn on a finer grid and averaged down, which costs little,
for they are small.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import se3
from ..arm import Arm
from ..errors import Closed, LabkitError, OutOfRange, TypeMismatch
from ..quiet import quiet
from ..shapes import Array, as_number, as_vector, locked, shown
from ..world import World
from .board import Board
from .intrinsics import Intrinsics
from .tag import Picture
from .visuals import RobotVisuals

with quiet():
    import pybullet as bullet

NEAR, FAR = 0.02, 12.0
"""Nothing nearer or farther than this is drawn, in [m]."""

BACKGROUND = 255
"""Grey level where there is nothing to see."""

_MARGIN = 4  # pixels around a tag's paper that are drawn with it
_PLAIN = np.eye(2)  # the picture's own grid
_LIGHT = (0.6, 0.35, 1.0)  # where the light comes from, world axes


class CameraBlocked(LabkitError, ValueError):
    """The camera's eye is inside of something."""


class Window(NamedTuple):
    """A part of the picture, in pixels.

    Attributes:
        left: First column.
        top: First row.
        width: How many columns.
        height: How many rows.
    """

    left: int
    top: int
    width: int
    height: int

    @property
    def rows(self) -> slice:
        """Its rows of a picture."""
        return slice(self.top, self.top + self.height)

    @property
    def columns(self) -> slice:
        """Its columns of a picture."""
        return slice(self.left, self.left + self.width)


class Camera:
    """A camera that takes pictures of a world.

    Attributes:
        world: What it looks at.
        intrinsics: Its lens and sensor.
        noise: Standard deviation of each colour of each pixel, in grey levels.
        samples: How fine tags are drawn: at s^2 + 1 points of each pixel.
    """

    def __init__(
        self,
        world: World,
        T_wc: Any,
        intrinsics: Intrinsics | None = None,
        *,
        noise: float = 0.0,
        samples: int = 2,
        seed: int = 0,
    ) -> None:
        """Fix a camera in ``world``.

        Args:
            world: What it looks at.
            T_wc: Pose of the camera in the world (z forward, x right, y down), shape (4, 4);
                `looking_at` makes one.
            intrinsics: Lens and sensor; None is 640 x 480 pixels and a focal length of 515 px.
            noise: Standard deviation of each colour of each pixel, in grey levels of 255.
            samples: s, for s^2 + 1 points of each pixel on a tag; 1 shows the renderer's own jagged
                edges.
            seed: Of the noise.

        Raises:
            TypeMismatch: The world is not a `World`, or the lens not `Intrinsics`.
            OutOfRange: ``noise`` or ``samples`` is not what it may be.
        """
        if not isinstance(world, World):
            raise TypeMismatch(f"world is {shown(world)}, expected a World; an arm's is arm.world")
        self.world = world
        self.intrinsics = Intrinsics() if intrinsics is None else intrinsics
        if not isinstance(self.intrinsics, Intrinsics):
            raise TypeMismatch(f"intrinsics is {shown(intrinsics)}, expected lk.Intrinsics(...)")
        self.noise = as_number(noise, "noise", least=0.0)
        if not isinstance(samples, int) or not 1 <= samples <= 8:
            raise OutOfRange(f"samples is {samples!r}; give a whole number from 1 to 8")
        self.samples = samples
        self._random = np.random.default_rng(seed)
        self._hand: Arm | None = None
        self.place(T_wc)

    @classmethod
    def in_hand(cls, arm: Arm, intrinsics: Intrinsics | None = None, **options: Any) -> Camera:
        """Baxter's hand camera, which moves with the arm.

        Args:
            arm: Whose hand.
            intrinsics: As for a fixed camera.
            **options: The other arguments of a fixed camera.
        """
        camera = cls(arm.world, np.eye(4), intrinsics, **options)
        camera._hand = arm
        return camera

    def place(self, T_wc: Any) -> None:
        """Fix the camera somewhere, also if it was in a hand.

        Args:
            T_wc: Pose of the camera in the world, shape (4, 4).
        """
        self._fixed: Array = locked(np.array(se3.as_pose(T_wc, "T_wc")))
        self._hand = None

    @property
    def T_wc(self) -> Array:
        """Where the camera really is now, shape (4, 4)."""
        return self._fixed if self._hand is None else _held(self._hand, self._hand.truth().q)

    @property
    def reported_T_wc(self) -> Array:
        """Where the robot thinks that the camera is: by its reported joint angles, if in a hand."""
        return self._fixed if self._hand is None else _held(self._hand, self._hand.state().q)

    def image(self) -> Picture:
        """Take a picture.

        Returns:
            Colours in RGB order, shape (height, width, 3), 0 to 255, read-only.

        Raises:
            CameraBlocked: The camera is inside the robot.
            Closed: The world is closed.
        """
        T_wc, looks = self._focus()
        size = Window(0, 0, self.intrinsics.width, self.intrinsics.height)
        picture = self._draw(T_wc, looks, size, FAR)
        if self.samples > 1:
            self._refine(picture, T_wc, looks)
        return self._developed(picture, [size])

    def tag_image(self) -> Picture:
        """A quick picture of only the tags and of what may hide them; the rest stays blank.

        Returns:
            As `image`; without noise, where both show something, they show the same.

        Raises:
            CameraBlocked: The camera is inside the robot.
            Closed: The world is closed.
        """
        T_wc, looks = self._focus()
        shape = (self.intrinsics.height, self.intrinsics.width, 3)
        picture = np.full(shape, BACKGROUND, np.uint8)
        return self._developed(picture, self._refine(picture, T_wc, looks))

    def _focus(self) -> tuple[Array, RobotVisuals]:
        """Everything in its place; where the camera is, and the robot it sees."""
        if self.world.client < 0:
            raise Closed("this camera's world was closed; make a new World, and a Camera in it")
        looks = RobotVisuals.of(self.world)
        for thing in self.world.shown:
            thing.update()
        T_wc = self.T_wc
        blocker = None if self._hand else looks.around(T_wc[:3, 3])
        if blocker is not None:
            x, y, z = T_wc[:3, 3]
            raise CameraBlocked(
                f"the camera at ({x:.3g}, {y:.3g}, {z:.3g}) m is inside the robot, near its joint "
                f"{blocker}; move it out with camera.place(T_wc)"
            )
        return T_wc, looks

    def _refine(self, picture: Picture, T_wc: Array, looks: RobotVisuals) -> list[Window]:
        """Draw tags, and what may hide them, finely over the picture."""
        windows = []
        for board in [thing for thing in self.world.shown if isinstance(thing, Board)]:
            place = self._window(board, T_wc)
            if place is None:
                continue
            window, depth = place
            behind = self._behind(board)
            self._paint(behind, 0.0)
            fine = self._finely(T_wc, looks, window, depth)
            self._paint(behind, 1.0)
            part = picture[window.rows, window.columns]
            np.copyto(part, fine, where=(fine != BACKGROUND).any(axis=2, keepdims=True))
            windows.append(window)
        return windows

    def _window(self, board: Board, T_wc: Array) -> tuple[Window, float] | None:
        """The part of the picture that a board's paper covers, and a depth just behind it."""
        T_cm = se3.inverse(T_wc) @ board.T_wm
        corners = board.outline @ T_cm[:3, :3].T + T_cm[:3, 3]
        if corners[:, 2].min() < NEAR or T_cm[:3, 2] @ T_cm[:3, 3] >= 0.0:
            return None  # too near to be seen whole, or seen from behind
        pixels, lens = self.intrinsics.project(corners), self.intrinsics
        low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - _MARGIN, 0)
        high = np.ceil(pixels.max(axis=0)).astype(int) + _MARGIN + 1
        wide, tall = np.minimum(high, (lens.width, lens.height)) - low
        if wide <= 0 or tall <= 0:
            return None
        return Window(int(low[0]), int(low[1]), int(wide), int(tall)), 1.05 * float(
            corners[:, 2].max()
        )

    def _behind(self, board: Board) -> dict[int, Any]:
        """Colours of the plain bodies that lie behind a board's plane and so cannot hide it."""
        client, T_wm = self.world.client, board.T_wm
        ours = {body for thing in self.world.shown for body in thing.bodies}
        found = {}
        for i in range(bullet.getNumBodies(physicsClientId=client)):
            body = bullet.getBodyUniqueId(i, physicsClientId=client)
            if body in ours or bullet.getNumJoints(body, physicsClientId=client):
                continue
            box = np.array(bullet.getAABB(body, physicsClientId=client)) - T_wm[:3, 3]
            if np.maximum(*(box * T_wm[:3, 2])).sum() <= 0.0:  # its foremost corner
                shapes = bullet.getVisualShapeData(body, physicsClientId=client)
                if len(shapes) == 1:
                    found[body] = shapes[0][7]
        return found

    def _paint(self, bodies: dict[int, Any], opacity: float) -> None:
        """Show bodies in their colours, times an opacity."""
        for body, (*rgb, alpha) in bodies.items():
            bullet.changeVisualShape(
                body, -1, rgbaColor=[*rgb, alpha * opacity], physicsClientId=self.world.client
            )

    def _finely(self, T_wc: Array, looks: RobotVisuals, window: Window, depth: float) -> Picture:
        """Draw a window on a finer grid, turned so that no two samples of a pixel share a row.

        With s for `samples` a pixel holds s^2 + 1 points of the grid, all at different heights and
        at different places from left to right; an edge along the picture's own rows, which is
        common, then shows where it is to that part of a pixel.
        """
        s = self.samples
        if s == 1:
            return self._draw(T_wc, looks, window, depth)
        turn = np.array([[s, -1], [1, s]])  # from pixels to the fine grid
        size = (s * window.width + window.height + 2 * s, window.width + s * window.height + 2 * s)
        first = np.array([window.height + s - 1, s])  # where the first pixel's middle comes to lie
        fine = self._draw(T_wc, looks, window, depth, turn, size, first).reshape(-1, 3)
        column, row = np.meshgrid(np.arange(window.width), np.arange(window.height))
        middles = (s * column - row + first[0]) + size[0] * (column + s * row + first[1])
        near = np.mgrid[-s : s + 1, -s : s + 1].reshape(2, -1).T
        inside = (np.abs(near @ np.linalg.inv(turn).T + 1e-9) < 0.5).all(axis=1)
        offsets = near[inside] @ (1, size[0])
        total = np.zeros((window.height, window.width, 3), dtype=np.uint16)
        for offset in offsets:
            total += fine[middles + offset]
        return ((total + len(offsets) // 2) // len(offsets)).astype(np.uint8)

    def _draw(
        self,
        T_wc: Array,
        looks: RobotVisuals,
        window: Window,
        depth: float,
        grid: Any = _PLAIN,
        size: tuple[int, int] | None = None,
        first: Any = (0, 0),
    ) -> Picture:
        """Let PyBullet draw a part of the picture, its middles of pixels on a grid of its own.

        PyBullet's sample points, measured in ``tests/vision/test_camera.py``, are columns 0, 1, ...
        from the left edge of what its projection matrix takes in, and rows 1, 2, ... from the
        upper.

        Args:
            T_wc: Pose of the camera, shape (4, 4).
            looks: The robot.
            window: Which part.
            depth: Up to how far away, in [m].
            grid: From pixels to steps of the grid, shape (2, 2).
            size: Columns and rows of the grid; None is the window's own.
            first: Where on the grid the window's first pixel comes to lie.
        """
        lens, (wide, tall) = self.intrinsics, size or (window.width, window.height)
        x0, y0 = window.left - 0.5, window.top - 0.5
        left, right = (x0 - lens.cx) / lens.fx, (x0 + window.width - lens.cx) / lens.fx
        top, bottom = (y0 - lens.cy) / lens.fy, (y0 + window.height - lens.cy) / lens.fy
        self._cull(looks, T_wc, (left, right, top, bottom), depth)
        (a, b), (c, d) = grid @ np.diag([lens.fx, lens.fy])
        e, f = grid @ (lens.cx - window.left, lens.cy - window.top) + first
        span = depth - NEAR
        projection = np.array(
            [
                [2 * a / wide, -2 * b / wide, 1 - 2 * e / wide, 0],
                [-2 * c / tall, 2 * d / tall, 2 * (f + 1) / tall - 1, 0],
                [0, 0, -(depth + NEAR) / span, -2 * depth * NEAR / span],
                [0, 0, -1, 0],
            ]
        )
        view = np.diag([1.0, -1.0, -1.0, 1.0]) @ se3.inverse(T_wc)
        _, _, rgba, _, _ = bullet.getCameraImage(
            wide,
            tall,
            view.T.ravel().tolist(),
            projection.T.ravel().tolist(),
            lightDirection=_LIGHT,
            shadow=0,
            renderer=bullet.ER_TINY_RENDERER,
            flags=bullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self.world.client,
        )
        return np.ascontiguousarray(
            np.asarray(rgba, dtype=np.uint8).reshape(tall, wide, 4)[..., :3]
        )

    @staticmethod
    def _cull(looks: RobotVisuals, T_wc: Array, borders: tuple[float, ...], depth: float) -> None:
        """Draw only those pieces of the robot that reach into the cone seen, up to a depth."""
        centres, radii = looks.balls
        x, y, z = ((centres - T_wc[:3, 3]) @ T_wc[:3, :3]).T
        left, right, top, bottom = borders
        outside = (z + radii < NEAR) | (z - radii > depth)
        for coordinate, low, high in ((x, left, right), (y, top, bottom)):
            outside |= coordinate - low * z < -radii * np.hypot(1.0, low)
            outside |= coordinate - high * z > radii * np.hypot(1.0, high)
        looks.draw_only(~outside)

    def _developed(self, picture: Picture, windows: list[Window]) -> Picture:
        """With the sensor's noise where something was drawn, frozen."""
        if self.noise and windows:
            drawn = np.zeros(picture.shape[:2], dtype=bool)
            for window in windows:
                drawn[window.rows, window.columns] = True
            grain = self._random.standard_normal((int(drawn.sum()), 3), dtype=np.float32)
            noisy = picture[drawn] + np.float32(self.noise) * grain
            picture[drawn] = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
        picture.setflags(write=False)
        return picture


def _held(arm: Arm, q: Array) -> Array:
    """Pose in the world of the camera in an arm's hand, at joint angles ``q``."""
    T_tc = se3.inverse(arm.robot.T_hand_tip) @ arm.robot.T_hand_camera
    return locked(arm.model.pose(q) @ T_tc)


def looking_at(eye: Any, at: Any, up: Any = (0.0, 0.0, 1.0)) -> Array:
    """The pose of a camera that looks at a point.

    Args:
        eye: Where the camera is, world axes, shape (3,) in [m].
        at: What it looks at, shape (3,) in [m].
        up: Which way is up in the picture, shape (3,).

    Returns:
        `T_wc`, shape (4, 4).

    Raises:
        OutOfRange: The two points are one, or the camera looks along ``up``.
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
