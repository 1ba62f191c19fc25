"""Rendering: a part of a camera's picture, drawn with OpenCV's rasteriser and a depth buffer.

It needs neither a physics engine nor a graphics card, and gives the same picture everywhere.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from ..shapes import Array
from .intrinsics import Intrinsics
from .surface import Surface

NEAR = 0.02
"""Nothing nearer than this is drawn, in [m]."""
FAR = 12.0
"""Nothing farther than this is drawn, in [m]."""

_LIGHT = np.array([0.6, 0.35, 1.0]) / np.linalg.norm([0.6, 0.35, 1.0])
"""Direction towards the light, world axes."""

_AMBIENT = 0.6
"""Brightness of a face that the light does not reach; one that faces it has 1."""

_HALF_ANGLE = 0.25 * np.pi  # of the rasteriser's own lens, for which `_folded` converts points

Levels = NDArray[np.float32]
"""Brightness from 0 to 1, or depth in [m]."""


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
    def rows(self) -> slice:
        """The window's rows in a picture."""
        return slice(self.top, self.top + self.height)

    @property
    def columns(self) -> slice:
        """The window's columns in a picture."""
        return slice(self.left, self.left + self.width)

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
) -> tuple[Levels, Levels]:
    """Draw a surface.

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
    lit, T_cw = _lit(surface, T_wc[:3, 3]), (T_wc[:3, 3], T_wc[:3, :3])
    corners, tints = _clipped((lit.corners - T_cw[0]) @ T_cw[1], lit.colours)
    if len(corners):
        seen = _folded(corners, lens, window, samples).astype(np.float32).reshape(1, -1, 3)
        numbers = np.arange(seen.shape[1], dtype=np.int32).reshape(1, -1, 3)
        paints = np.repeat(tints, 3, axis=0).astype(np.float32).reshape(1, -1, 3)
        own = (np.eye(4), 2.0 * _HALF_ANGLE, NEAR, FAR, _SETTINGS)
        cv2.triangleRasterize(seen, numbers, paints, colours, depth, *own)
    return colours, depth


_SETTINGS = (
    cv2.TriangleRasterizeSettings()
    .setCullingMode(cv2.RASTERIZE_CULLING_NONE)
    .setShadingType(cv2.RASTERIZE_SHADING_FLAT)
)


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


def _clipped(corners: Array, colours: Array) -> tuple[Array, Array]:
    """Triangles in the camera's frame, cut off at `NEAR`: the rasteriser drops what crosses it."""
    behind = corners[:, :, 2] < NEAR
    count = behind.sum(axis=1)
    whole, parts = count == 0, [(corners[count == 0], colours[count == 0])]
    for k in (1, 2):  # corners behind: with the odd one first, a quadrangle or a triangle is left
        cut = corners[count == k]
        odd = np.argmax(behind[count == k] == (k == 1), axis=1)
        a, b, c = (cut[np.arange(len(cut)), (odd + j) % 3] for j in range(3))
        ab, ac = (_where(a, x) for x in (b, c))
        triangles = [(a, ab, ac)] if k == 2 else [(ab, b, c), (ab, c, ac)]
        parts += [(np.stack(t, axis=1), colours[count == k]) for t in triangles]
    if whole.all():
        return parts[0]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def _where(a: Array, b: Array) -> Array:
    """The points where lines from ``a`` to ``b`` cross the depth `NEAR`, shape (n, 3)."""
    share = (NEAR - a[:, 2:]) / (b[:, 2:] - a[:, 2:])
    at = a + share * (b - a)
    at[:, 2] = NEAR
    return at


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
