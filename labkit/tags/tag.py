"""AR tags: a square pattern with a number, of a stated size, to print or to put on a `Board`.

The origin of the tag's frame m is the middle of the black square, with x to the right, y up and z
out of the paper towards the viewer.  Its size is the side of the black square, as in OpenCV and
AprilTag; the white border around it does not count.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from .. import se3
from ..errors import OutOfRange, TypeMismatch
from ..shapes import Array, as_array, as_number, locked, shown
from ..trajectory import PoseSample, Sample, Target
from ..world import World
from .drawing import Surface, box

Picture = NDArray[np.uint8]
"""Grey levels (height, width) or colours (height, width, 3) in RGB order, 0 to 255."""

PATTERNS = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
"""The family of tags most common in robotics, 587 tags that differ in at least 11 of 36 bits."""

CELLS = 8
"""Cells along a side of the black square."""

_THICKNESS = 0.003  # of the plate behind the paper, in [m]
_GREY = (0.5, 0.5, 0.5)


@dataclass(frozen=True)
class Tag:
    """A square tag that a camera can recognize.

    Attributes:
        id: Its number among the tags of AprilTag 36h11.
        size: Side of the black square, in [m].
    """

    id: int = 0
    size: float = 0.1

    def __post_init__(self) -> None:
        count = len(PATTERNS.bytesList)
        if not isinstance(self.id, int | np.integer) or not 0 <= self.id < count:
            raise OutOfRange(
                f"id is {self.id!r}; the tags of AprilTag 36h11 are numbered 0 to {count - 1}"
            )
        as_number(self.size, "size", above=0.0)

    @property
    def paper(self) -> float:
        """Side of the white paper, in [m]: the border has the width of a cell."""
        return self.size * (CELLS + 2) / CELLS

    @property
    def corners(self) -> Array:
        """The black square's corners in the tag's frame, shape (4, 3) in [m]: see `tag_corners`."""
        return tag_corners(self.size)

    def image(self, cell: int = 16) -> Picture:
        """Draw the tag with its border.

        Args:
            cell: Pixels along each side of a cell.

        Returns:
            Grey levels, shape (n, n), 0 or 255.
        """
        bits = cv2.aruco.generateImageMarker(PATTERNS, int(self.id), CELLS)
        framed: Picture = np.pad(bits, 1, constant_values=255).astype(np.uint8)
        return framed.repeat(cell, axis=0).repeat(cell, axis=1)


def tag_corners(size: float) -> Array:
    """The corners of the black square in the tag's frame, in the detector's order.

    The order is clockwise from the upper left, as seen by someone looking at the tag.

    Args:
        size: Side of the black square, in [m].

    Returns:
        Shape (4, 3) in [m], read-only.

    Raises:
        OutOfRange: The size is not positive.
    """
    half = 0.5 * as_number(size, "size", above=0.0)
    return locked(half * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]], dtype=float))


class Board:
    """A tag on a plate, still or in motion; a world can contain any number of them.

    It has no part in the physics: cameras see it, and arms pass through it.

    Attributes:
        tag: The tag that is printed on it.
        world: The world that it is in.
    """

    def __init__(self, world: World, tag: Tag, T_wm: Any) -> None:
        """Put a board into ``world``.

        Args:
            world: The world to put it in.
            tag: The tag that is printed on it.
            T_wm: Pose of the tag in the world, shape (4, 4); its z axis comes out of the paper.

        Raises:
            TypeMismatch: ``world`` is not a world, or ``tag`` is not a tag.
        """
        if not isinstance(world, World) or not isinstance(tag, Tag):
            raise TypeMismatch(
                f"a board takes a World (an arm's is arm.world) and a Tag, not {shown(world)} and "
                f"{shown(tag)}"
            )
        self.tag, self.world = tag, world
        self.place(T_wm)
        world.show(self)

    def place(self, T_wm: Any) -> None:
        """Put the board at a pose, where it stays.

        Args:
            T_wm: Pose of the tag in the world, shape (4, 4).
        """
        self._home: Array = locked(np.array(se3.as_pose(T_wm, "T_wm")))
        self._motion: Target | None = None
        self._since = self.world.t

    def move(self, motion: Target) -> None:
        """Move the board on a trajectory that starts now, by the world's clock.

        Args:
            motion: A function of the time since now, in [s].  It returns poses of the tag, or
                points for the tag's middle, which then keeps its present orientation.

        Raises:
            TypeMismatch: ``motion`` is no such function.
        """
        first = motion(0.0) if callable(motion) else motion
        if not isinstance(first, Sample | PoseSample):
            raise TypeMismatch(
                f"a board's motion is a function of time that returns lk.PoseSample or lk.Sample, "
                f"not {shown(first)}; board.place(T_wm) puts it somewhere"
            )
        if isinstance(first, Sample):
            as_array(first.position, (3,), "the board's position")
        self._home, self._motion, self._since = self.T_wm, motion, self.world.t

    @property
    def T_wm(self) -> Array:
        """True present pose of the tag, shape (4, 4)."""
        return self.pose_at(self.world.t)

    def pose_at(self, t: float) -> Array:
        """Pose of the tag at time ``t`` [s] of the world's clock, by its present motion.

        Returns:
            `T_wm`, shape (4, 4), read-only.
        """
        if self._motion is None:
            return self._home
        sample = self._motion(t - self._since)
        if isinstance(sample, PoseSample):
            return locked(np.array(se3.as_pose(sample.pose, "the board's pose")))
        T = np.array(self._home)
        T[:3, 3] = as_array(sample.position, (3,), "the board's position")
        return locked(T)

    @property
    def outline(self) -> Array:
        """The paper's corners in the tag's frame, shape (4, 3) in [m]."""
        return np.asarray(self.tag.corners * (self.tag.paper / self.tag.size))

    def surface(self) -> Surface:
        """The plate behind the paper, in the world; the paper itself is printed by the camera."""
        half = 0.5 * self.tag.paper
        plate = box((half, half, 0.5 * _THICKNESS), _GREY)
        return plate.moved(self.T_wm @ se3.pose(np.eye(3), np.array([0.0, 0.0, -_THICKNESS])))


def as_picture(x: Any) -> Picture:
    """Read ``x`` as a picture in grey levels.

    Args:
        x: Shape (height, width), or (height, width, 3) in RGB order, of dtype uint8.

    Returns:
        Grey levels, shape (height, width).

    Raises:
        TypeMismatch: ``x`` is not a picture.
    """
    if not isinstance(x, np.ndarray) or x.dtype != np.uint8:
        what = f"an array of {x.dtype}" if isinstance(x, np.ndarray) else type(x).__name__
        raise TypeMismatch(f"image is {what}, expected a picture: a NumPy array of uint8, 0 to 255")
    if x.size and x.ndim == 3 and x.shape[2] == 3:
        return np.asarray(cv2.cvtColor(x, cv2.COLOR_RGB2GRAY), dtype=np.uint8)
    if x.size and x.ndim == 2:
        return x
    raise TypeMismatch(f"image has shape {x.shape}, expected (height, width) or (height, width, 3)")
