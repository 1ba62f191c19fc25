r"""A camera in the world: fixed somewhere, or in the robot's hand.

PyBullet's software renderer looks at one point in the middle of each pixel.  A real pixel collects
light from its whole area, and edges are only as sharp as that; so tags are drawn several times as
fine and averaged down, which costs little, for they are small.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import cv2
import numpy as np

from . import se3
from .arm import Arm
from .arrays import Array, as_number, as_vector, locked
from .board import Board
from .errors import Closed, LabkitError, OutOfRange
from .intrinsics import Intrinsics
from .looks import Looks
from .quiet import quiet
from .tags import Picture
from .world import World

with quiet():
    import pybullet as bullet

NEAR, FAR = 0.02, 12.0
"""Nothing nearer or farther than this is drawn, in [m]."""

BACKGROUND = 255
"""Grey level where there is nothing to see."""

_MARGIN = 4  # pixels around a tag's paper that are drawn with it
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
        samples: How many times as fine tags are drawn, along each side.
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
            samples: How many times as fine tags are drawn; 1 shows the renderer's own jagged edges.
            seed: Of the noise.
        """
        self.world = world
        self.intrinsics = Intrinsics() if intrinsics is None else intrinsics
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
        return self._fixed if self._hand is None else self._in_hand(self._hand.truth().q)

    @property
    def reported_T_wc(self) -> Array:
        """Where the robot thinks that the camera is: by its reported joint angles, if in a hand."""
        return self._fixed if self._hand is None else self._in_hand(self._hand.state().q)

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
        picture = self._draw(T_wc, looks, size, 1, FAR)
        if self.samples > 1:
            self._refine(picture, T_wc, looks, whole=True)
        return self._developed(picture, [size])

    def glimpse(self) -> Picture:
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
        return self._developed(picture, self._refine(picture, T_wc, looks, whole=False))

    def _in_hand(self, q: Array) -> Array:
        arm = self._hand
        assert arm is not None
        T_tc = se3.inverse(arm.robot.T_hand_tip) @ arm.robot.T_hand_camera
        return locked(arm.model.pose(q) @ T_tc)

    def _focus(self) -> tuple[Array, Looks]:
        """Everything in its place; where the camera is, and the robot it sees."""
        if self.world.client < 0:
            raise Closed("this camera's world was closed; make a new World, and a Camera in it")
        looks = Looks.of(self.world)
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

    def _refine(self, picture: Picture, T_wc: Array, looks: Looks, *, whole: bool) -> list[Window]:
        """Draw the windows around the tags finely, with or without what is behind the tags."""
        windows = []
        for board in self.world.shown:
            place = self._window(board, T_wc) if isinstance(board, Board) else None
            if place is None:
                continue
            window, depth = place
            fine = self._draw(T_wc, looks, window, self.samples, FAR if whole else depth)
            if self.samples > 1:
                size = (window.width, window.height)
                fine = np.asarray(
                    cv2.resize(fine, size, interpolation=cv2.INTER_AREA), dtype=np.uint8
                )
            picture[window.rows, window.columns] = fine
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

    def _draw(self, T_wc: Array, looks: Looks, window: Window, fine: int, depth: float) -> Picture:
        """Let PyBullet draw a part of the picture.

        Its sample points, measured in ``tests/test_camera.py``, are columns 0, 1, ... counted from
        the left edge of the frustum and rows 1, 2, ... counted from the upper one.
        """
        lens = self.intrinsics
        # Borders of the window on the plane z = 1 of the camera's frame.
        x0, y0 = window.left - 0.5, window.top - 0.5
        left, right = (x0 - lens.cx) / lens.fx, (x0 + window.width - lens.cx) / lens.fx
        top, bottom = (y0 - lens.cy) / lens.fy, (y0 + window.height - lens.cy) / lens.fy
        self._cull(looks, T_wc, (left, right, top, bottom), depth)
        dx, dy = -0.5 / (fine * lens.fx), 0.5 / (fine * lens.fy)  # onto the middles of the pixels
        frustum = (left - dx, right - dx, -(bottom - dy), -(top - dy))
        projection = bullet.computeProjectionMatrix(*(NEAR * x for x in frustum), NEAR, depth)
        view = np.diag([1.0, -1.0, -1.0, 1.0]) @ se3.inverse(T_wc)
        width, height = window.width * fine, window.height * fine
        _, _, rgba, _, _ = bullet.getCameraImage(
            width,
            height,
            view.T.ravel().tolist(),
            projection,
            lightDirection=_LIGHT,
            shadow=0,
            renderer=bullet.ER_TINY_RENDERER,
            flags=bullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self.world.client,
        )
        return np.ascontiguousarray(
            np.asarray(rgba, dtype=np.uint8).reshape(height, width, 4)[..., :3]
        )

    @staticmethod
    def _cull(looks: Looks, T_wc: Array, borders: tuple[float, ...], depth: float) -> None:
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
