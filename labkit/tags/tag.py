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

from ..errors import OutOfRange, TypeMismatch
from ..shapes import Array, as_number, locked

Picture = NDArray[np.uint8]
"""Grey levels (height, width) or colours (height, width, 3) in RGB order, 0 to 255."""

PATTERNS = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
"""The family of tags most common in robotics, 587 tags that differ in at least 11 of 36 bits."""

CELLS = 8
"""Cells along a side of the black square."""


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
