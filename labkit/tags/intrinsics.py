r"""Intrinsics: how a camera projects points to pixels.

.. math:: u = f_x x + c_x, \qquad v = f_y y + c_y

with x = X/Z and y = Y/Z; a lens with distortion first bends these by OpenCV's model, with
r^2 = x^2 + y^2:

.. math::

    d &= 1 + k_1 r^2 + k_2 r^4 + k_3 r^6 \\
    x' &= d\,x + 2 p_1 x y + p_2\,(r^2 + 2 x^2) \\
    y' &= d\,y + p_1\,(r^2 + 2 y^2) + 2 p_2 x y

The camera's frame c has z forward, x to the right and y down in the picture.  Pixel (0, 0) is the
middle of the upper left pixel (OpenCV's convention), so the middle of a picture 640 pixels wide is
at u = 319.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from ..errors import OutOfRange, ShapeError
from ..shapes import Array, as_array, as_number, as_numbers, locked


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
        distortion: k1, k2, p1, p2 and k3, as `cv2.projectPoints` takes them; none by default.
    """

    width: int = 640
    height: int = 480
    fx: float = 515.0
    fy: float = 515.0
    cx: Any = None
    cy: Any = None
    distortion: Any = (0.0, 0.0, 0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name, middle in (("width", "cx"), ("height", "cy")):
            n = getattr(self, name)
            if not isinstance(n, int | np.integer) or not 8 <= n <= 8192:
                raise OutOfRange(f"{name} is {n!r}; give a whole number of pixels from 8 to 8192")
            given = getattr(self, middle)
            at = 0.5 * (n - 1) if given is None else as_number(given, middle)
            object.__setattr__(self, middle, at)
        as_number(self.fx, "fx", above=0.0)
        as_number(self.fy, "fy", above=0.0)
        bent = as_array(self.distortion, (5,), "distortion")
        object.__setattr__(self, "distortion", tuple(bent.tolist()))

    @property
    def matrix(self) -> Array:
        """The camera matrix K, shape (3, 3)."""
        return locked(np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]]))

    def straightened(self, pixels: Any) -> Array:
        """Convert pixels, shape (n, 2), to those of the same lens without distortion."""
        if not any(self.distortion):
            return np.asarray(pixels)
        K, bent = self.matrix, np.array(self.distortion)
        exact = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-10)
        flat = np.asarray(pixels, dtype=float)[:, None]
        straight = cv2.undistortImagePoints(flat, K, bent, arg1=exact)
        return np.asarray(straight, dtype=float)[:, 0]

    def bent(self, pixels: Any) -> Array:
        """Convert pixels of the lens without distortion, shape (n, 2), to those of this lens."""
        K = self.matrix
        rays = (np.asarray(pixels) - K[:2, 2]) / K.diagonal()[:2]
        return self.project(np.column_stack([rays, np.ones(len(rays))]))

    def project(self, points: Any) -> Array:
        """Project points to pixels of the picture.

        Args:
            points: Points in the camera's frame, shape (n, 3) in [m].

        Returns:
            Pixels (u, v), shape (n, 2); they may lie outside the picture.

        Raises:
            ShapeError: A point does not have three coordinates.
            OutOfRange: A point is not in front of the camera.
        """
        p = as_numbers(points, "points")
        if p.ndim != 2 or p.shape[1] != 3:
            raise ShapeError("points", (len(np.atleast_2d(p)), 3), p.shape)
        if (behind := p[:, 2] <= 0.0).any():
            i = int(behind.argmax())
            raise OutOfRange(
                f"point {i} is at z = {p[i, 2]:.3g} m in the camera's frame: it is behind the "
                "camera; are these coordinates of the world?"
            )
        K: Array = self.matrix
        if any(self.distortion):
            bent = np.array(self.distortion)
            seen = cv2.projectPoints(p, np.zeros(3), np.zeros(3), K, bent)[0]
            return np.asarray(seen, dtype=float)[:, 0]
        return np.asarray((p[:, :2] / p[:, 2:]) * K.diagonal()[:2] + K[:2, 2])


def without_distortion(lens: Intrinsics) -> tuple[Intrinsics, Any]:
    """A lens without distortion that sees everything that ``lens`` sees, and a map between them.

    Interpolation would blur edges and shift them, so both have pixels of half the size.

    Returns:
        The new lens, and for each half pixel of ``lens`` the pixel of the new lens, shape
        (2 height, 2 width, 2), float32; ``lens`` itself and None if there is no distortion.
    """
    if not any(lens.distortion):
        return lens, None
    v, u = 0.5 * np.indices((2 * lens.height, 2 * lens.width)) - 0.25
    seen = 2.0 * lens.straightened(np.column_stack([u.ravel(), v.ravel()])) + 0.5
    low, high = np.floor(seen.min(axis=0)), np.ceil(seen.max(axis=0))
    wide, tall = (int(n) for n in high - low + 1)
    middle = 2.0 * lens.matrix[:2, 2] + 0.5 - low
    flat = Intrinsics(wide, tall, 2.0 * lens.fx, 2.0 * lens.fy, *middle)
    return flat, (seen - low).reshape(*u.shape, 2).astype(np.float32)
