"""A camera in the world: fixed somewhere, or in the robot's hand."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import se3
from ..arm import Arm
from ..errors import Closed, LabkitError, OutOfRange, TypeMismatch
from ..shapes import Array, as_number, as_vector, locked, shown
from ..world import World
from .board import Board
from .intrinsics import Intrinsics
from .rendering import FAR, NEAR, View, Window, draw, draw_finely
from .tag import Picture
from .visuals import RobotVisuals, show_slabs

BACKGROUND = 255
"""Grey level where there is nothing to see."""

_MARGIN = 4  # pixels around a tag's paper that are drawn with it


class CameraBlocked(LabkitError, ValueError):
    """The camera's eye is inside of something."""


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
        view = self._focus()
        size = Window(0, 0, self.intrinsics.width, self.intrinsics.height)
        picture = draw(view, size, FAR)
        if self.samples > 1:
            self._refine(picture, view)
        return self._developed(picture, [size])

    def tag_image(self) -> Picture:
        """A quick picture of only the tags and of what may hide them; the rest stays blank.

        Returns:
            As `image`; without noise, where both show something, they show the same.

        Raises:
            CameraBlocked: The camera is inside the robot.
            Closed: The world is closed.
        """
        view = self._focus()
        shape = (self.intrinsics.height, self.intrinsics.width, 3)
        picture = np.full(shape, BACKGROUND, np.uint8)
        return self._developed(picture, self._refine(picture, view))

    def _focus(self) -> View:
        """Everything in its place; where the camera is, and the robot it sees."""
        if self.world.closed:
            raise Closed("this camera's world was closed; make a new World, and a Camera in it")
        robot = RobotVisuals.of(self.world)
        show_slabs(self.world)
        for thing in self.world.shown:
            thing.update()
        T_wc = self.T_wc
        blocker = None if self._hand else robot.around(T_wc[:3, 3])
        if blocker is not None:
            x, y, z = T_wc[:3, 3]
            raise CameraBlocked(
                f"the camera at ({x:.3g}, {y:.3g}, {z:.3g}) m is inside the robot, near its joint "
                f"{blocker}; move it out with camera.place(T_wc)"
            )
        return View(self.intrinsics, T_wc, robot)

    def _refine(self, picture: Picture, view: View) -> list[Window]:
        """Draw tags, and what may hide them, finely over the picture."""
        windows = []
        for board in [thing for thing in self.world.shown if isinstance(thing, Board)]:
            place = self._window(board, view.T_wc)
            if place is None:
                continue
            window, depth = place
            behind = self._behind(board)
            for body, (*rgb, _) in behind.items():
                self.world.pictures.paint(body, [*rgb, 0.0])
            fine = draw_finely(view, window, depth, self.samples)
            for body, colour in behind.items():
                self.world.pictures.paint(body, colour)
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
        """Colours of the boxes that lie behind a board's plane and so cannot hide it."""
        normal, middle = board.T_wm[:3, 2], board.T_wm[:3, 3]
        ours = {body for thing in self.world.shown for body in thing.bodies}
        return {
            body: colour
            for body, (half, colour, T) in self.world.pictures.boxes.items()
            if body not in ours
            and (T[:3, 3] - middle) @ normal + abs(normal @ T[:3, :3]) @ half <= 0.0
        }

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
