"""A camera in the world: fixed somewhere, or in the robot's hand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import cv2
import numpy as np

from .. import se3
from ..arm import Arm
from ..errors import Closed, LabkitError, OutOfRange, TypeMismatch
from ..shapes import Array, as_number, as_random, as_vector, locked, shown
from ..world import World
from .board import Board
from .intrinsics import Intrinsics, without_distortion
from .paper import paper
from .rendering import FAR, NEAR, Window, brightness, draw
from .surface import Surface, joined
from .tag import Picture
from .visuals import RobotVisuals, scenery

BACKGROUND = 255
"""Grey level of the empty background."""

_MARGIN = 4  # pixels that are drawn around a tag's paper
_INSTANTS = 9  # that are drawn during an exposure
_FINE = 4  # samples of a pixel along each side where something may hide a tag


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
        if max(self.shade, self.vignette) > 1.0:
            raise OutOfRange(f"shade is {self.shade}, vignette {self.vignette}; give at most 1")
        for name, least, most in (("samples", 1, 16), ("jpeg", 0, 100)):
            n = getattr(self, name)
            if not isinstance(n, int) or not least <= n <= most:
                raise OutOfRange(f"{name} is {n!r}; give a whole number from {least} to {most}")


class Camera:
    """A camera that takes pictures of a world.

    Attributes:
        world: The world that it sees.
        intrinsics: Its lens and sensor.
        optics: What it does to a picture.
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
            TypeMismatch: The world is not a `World`, the lens not `Intrinsics`, or the seed not a
                number.
            OutOfRange: One of the optics is outside its permitted range.
        """
        if not isinstance(world, World):
            raise TypeMismatch(f"world is {shown(world)}, expected a World; an arm's is arm.world")
        self.world = world
        self.intrinsics = Intrinsics() if intrinsics is None else intrinsics
        if not isinstance(self.intrinsics, Intrinsics):
            raise TypeMismatch(f"intrinsics is {shown(intrinsics)}, expected lk.Intrinsics(...)")
        self.optics = Optics(**optics)
        self._wide, self._seen_at = without_distortion(self.intrinsics)
        self._random = as_random(seed)
        self._hand: Arm | None = None
        self.place(T_wc)

    @classmethod
    def in_hand(cls, arm: Arm, intrinsics: Intrinsics | None = None, **options: Any) -> Camera:
        """Put a camera into a hand, as on Baxter, so that it moves with the arm.

        Args:
            arm: The arm with the hand.
            intrinsics: As for a fixed camera.
            **options: The other arguments of a fixed camera.

        Raises:
            LabkitError: The hand has no camera.
        """
        if arm.robot.T_hand_camera is None:
            raise LabkitError(
                f"{arm.robot.name} has no camera in its hand; dataclasses.replace(robot, "
                "T_hand_camera=...) gives it one, or use a fixed camera: looking_at(eye, at)"
            )
        camera = cls(arm.world, np.eye(4), intrinsics, **options)
        camera._hand = arm
        return camera

    def place(self, T_wc: Any) -> None:
        """Fix the camera at a pose, even if it was in a hand.

        Args:
            T_wc: Pose of the camera in the world, shape (4, 4).
        """
        self._fixed: Array = locked(np.array(se3.as_pose(T_wc, "T_wc")))
        self._hand = None

    @property
    def T_wc(self) -> Array:
        """True present pose of the camera, shape (4, 4)."""
        return self._fixed if self._hand is None else _held(self._hand, self._hand.truth().q)

    @property
    def reported_T_wc(self) -> Array:
        """Pose of the camera as the robot knows it, from the reported joint angles if in a hand.

        Returns:
            Shape (4, 4).
        """
        return self._fixed if self._hand is None else _held(self._hand, self._hand.state().q)

    def image(self) -> Picture:
        """Take a picture.

        Returns:
            Colours in RGB order, shape (height, width, 3), 0 to 255, read-only.

        Raises:
            Closed: The world is closed.
        """
        robot, T_wc = self._focus()
        size = Window(0, 0, self._wide.width, self._wide.height)
        seen = joined([self._robot_in(robot, T_wc, size, FAR), scenery(self.world)])
        picture = 255.0 * draw(seen, self._wide, T_wc, size)[0]
        return self._developed(self._exposed(picture, robot, T_wc)[0], [size])

    def tag_image(self) -> Picture:
        """Take a quick picture of only the tags and of what hides them; the rest stays blank.

        Returns:
            As for `image`; without noise, blur or JPEG, both are the same within a tag's paper.

        Raises:
            Closed: The world is closed.
        """
        robot, T_wc = self._focus()
        picture = np.full((self._wide.height, self._wide.width, 3), BACKGROUND, np.float32)
        return self._developed(*self._exposed(picture, robot, T_wc))

    def _exposed(self, picture: Any, robot: RobotVisuals, T_wc: Array) -> tuple[Any, list[Window]]:
        """The picture with the tags printed on it, averaged over the exposure; their windows."""
        if not self.optics.exposure:
            return picture, self._print(picture, robot, T_wc, self.world.t)
        total, windows = np.zeros_like(picture), []
        for share in (np.arange(_INSTANTS) + 0.5) / _INSTANTS - 0.5:
            one = picture.copy()
            windows += self._print(one, robot, T_wc, self.world.t + share * self.optics.exposure)
            total += one / _INSTANTS
        return total, windows

    def _focus(self) -> tuple[RobotVisuals, Array]:
        """The robot in its present posture, and the pose of the camera."""
        if self.world.closed:
            raise Closed("this camera's world was closed; make a new World, and a Camera in it")
        return RobotVisuals([(arm.robot, arm.truth().q) for arm in self.world.arms]), self.T_wc

    def _robot_in(self, robot: RobotVisuals, T_wc: Array, window: Window, depth: float) -> Surface:
        """The pieces of the robot that reach into a window's cone, up to a depth."""
        centres, radii = robot.balls
        x, y, z = ((centres - T_wc[:3, 3]) @ T_wc[:3, :3]).T
        outside = (z + radii < NEAR) | (z - radii > depth)
        for coordinate, rays in zip((x, y), window.rays(self._wide), strict=True):
            low, high = rays[0], rays[-1]
            outside |= coordinate - low * z < -radii * np.hypot(1.0, low)
            outside |= coordinate - high * z > radii * np.hypot(1.0, high)
        return robot.surface(~outside)

    def _print(self, picture: Any, robot: RobotVisuals, T_wc: Array, t: float) -> list[Window]:
        """Print the tags' papers over a picture, then what hides them; returns their windows."""
        boards = [thing for thing in self.world.shown if isinstance(thing, Board)]
        poses = [se3.inverse(T_wc) @ board.pose_at(t) for board in boards]
        windows = []
        for k in sorted(range(len(boards)), key=lambda k: -float(poses[k][2, 3])):  # nearest last
            board, T_cm = boards[k], poses[k]
            place = self._window(board, T_cm)
            if place is None:
                continue
            window, depth = place
            share, white = paper(board.tag, T_cm, self._wide, window, self.optics.samples)
            light = 255.0 * float(brightness(board.T_wm[:3, 2]))
            shade = light * np.linspace(1.0, 1.0 - self.optics.shade, window.width)
            part = picture[window.rows, window.columns]
            part += share[..., None] * ((shade * white)[..., None] - part)
            self._hide(part, board, robot, T_wc, window, depth)
            windows.append(window)
        return windows

    def _hide(
        self,
        part: Any,
        board: Board,
        robot: RobotVisuals,
        T_wc: Array,
        window: Window,
        depth: float,
    ) -> None:
        """Draw what is in front of a board over its part of the picture."""
        T_wm = board.T_wm
        near = joined([self._robot_in(robot, T_wc, window, depth), scenery(self.world)])
        height = (near.corners - T_wm[:3, 3]) @ T_wm[:3, 2]
        near = near.only((height > 1e-6).any(axis=1))
        if not len(near.corners):
            return
        n = _FINE
        colours, z = draw(near, self._wide, T_wc, window, n)
        right, down = window.rays(self._wide, n)
        normal, middle = T_wc[:3, :3].T @ T_wm[:3, 2], T_wc[:3, :3].T @ (T_wm[:3, 3] - T_wc[:3, 3])
        plane = (normal @ middle) / (normal[0] * right + (normal[1] * down + normal[2])[:, None])
        before = ((z < plane) | (plane <= 0.0)) & (z < 0.99 * FAR)
        tiles = (window.height, n, window.width, n)
        share = before.reshape(tiles).mean(axis=(1, 3))[..., None]
        colour = (255.0 * colours * before[..., None]).reshape(*tiles, 3).mean(axis=(1, 3))
        part += colour - share * part

    def _window(self, board: Board, T_cm: Array) -> tuple[Window, float] | None:
        """The part of the picture that a board's paper covers, and a depth just behind it."""
        corners = board.outline @ T_cm[:3, :3].T + T_cm[:3, 3]
        if corners[:, 2].min() < NEAR or T_cm[:3, 2] @ T_cm[:3, 3] >= 0.0:
            return None  # too near to be seen whole, or seen from behind
        pixels, lens = self._wide.project(corners), self._wide
        low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - _MARGIN, 0)
        high = np.ceil(pixels.max(axis=0)).astype(int) + _MARGIN + 1
        wide, tall = np.minimum(high, (lens.width, lens.height)) - low
        if wide <= 0 or tall <= 0:
            return None
        return Window(int(low[0]), int(low[1]), int(wide), int(tall)), float(corners[:, 2].max())

    def _developed(self, picture: Any, windows: list[Window]) -> Picture:
        """Apply lens and optics, with noise where something was drawn; the result is read-only."""
        drawn = np.zeros(picture.shape[:2], np.uint8)
        for window in windows:
            drawn[window.rows, window.columns] = 1
        if self._seen_at is not None:
            at, nothing = self._seen_at, cast(Any, None)  # the first map holds both coordinates
            size = (self.intrinsics.width, self.intrinsics.height)
            # Linear: OpenCV's cubic kernel (a = -0.75) shifts an edge by up to 0.047 pixels.
            picture = cv2.remap(picture, at, nothing, cv2.INTER_LINEAR)
            picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
            drawn = np.asarray(cv2.remap(drawn, at, nothing, cv2.INTER_NEAREST))[::2, ::2]
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


def _held(arm: Arm, q: Array) -> Array:
    """World pose of the camera in an arm's hand at joint angles ``q``."""
    T_hc: Any = arm.robot.T_hand_camera
    T_tc = se3.inverse(arm.robot.T_hand_tip) @ T_hc
    return locked(arm.model.pose(q) @ T_tc)


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
