"""Rendering: a part of a camera's picture, drawn by PyBullet's software renderer.

The renderer looks at one point in the middle of each pixel.  A real pixel collects light from its
whole area; so tags are drawn on a finer grid and averaged down, which costs little, for they are
small.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import se3
from ..shapes import Array
from .intrinsics import Intrinsics
from .tag import Picture
from .visuals import RobotVisuals

NEAR, FAR = 0.02, 12.0
"""Nothing nearer or farther than this is drawn, in [m]."""

_PLAIN = np.eye(2)  # the picture's own grid


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


class View(NamedTuple):
    """What a camera sees from where it is.

    Attributes:
        lens: Lens and sensor.
        T_wc: Pose of the camera in the world, shape (4, 4).
        robot: The robot that it sees, in its world.
    """

    lens: Intrinsics
    T_wc: Array
    robot: RobotVisuals


def draw(
    view: View,
    window: Window,
    depth: float,
    grid: Any = _PLAIN,
    size: tuple[int, int] | None = None,
    first: Any = (0, 0),
) -> Picture:
    """Let PyBullet draw a part of the picture, its middles of pixels on a grid of its own.

    PyBullet's sample points, measured in ``tests/tags/test_camera.py``, are columns 0, 1, ...
    from the left edge of what its projection matrix takes in, and rows 1, 2, ... from the
    upper.

    Args:
        view: From where.
        window: Which part.
        depth: Up to how far away, in [m].
        grid: From pixels to steps of the grid, shape (2, 2).
        size: Columns and rows of the grid; None is the window's own.
        first: Where on the grid the window's first pixel comes to lie.
    """
    (lens, T_wc, robot), (wide, tall) = view, size or (window.width, window.height)
    x0, y0 = window.left - 0.5, window.top - 0.5
    left, right = (x0 - lens.cx) / lens.fx, (x0 + window.width - lens.cx) / lens.fx
    top, bottom = (y0 - lens.cy) / lens.fy, (y0 + window.height - lens.cy) / lens.fy
    _cull(robot, T_wc, (left, right, top, bottom), depth)
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
    view_matrix = np.diag([1.0, -1.0, -1.0, 1.0]) @ se3.inverse(T_wc)
    return robot.world.pictures.draw(wide, tall, view_matrix, projection)


def draw_finely(view: View, window: Window, depth: float, s: int) -> Picture:
    """Draw a window on a finer grid, turned so that no two samples of a pixel share a row.

    A pixel holds s^2 + 1 points of the grid, all at different heights and
    at different places from left to right; an edge along the picture's own rows, which is
    common, then shows where it is to that part of a pixel.
    """
    if s == 1:
        return draw(view, window, depth)
    turn = np.array([[s, -1], [1, s]])  # from pixels to the fine grid
    size = (s * window.width + window.height + 2 * s, window.width + s * window.height + 2 * s)
    first = np.array([window.height + s - 1, s])  # where the first pixel's middle comes to lie
    fine = draw(view, window, depth, turn, size, first).reshape(-1, 3)
    column, row = np.meshgrid(np.arange(window.width), np.arange(window.height))
    middles = (s * column - row + first[0]) + size[0] * (column + s * row + first[1])
    near = np.mgrid[-s : s + 1, -s : s + 1].reshape(2, -1).T
    inside = (np.abs(near @ np.linalg.inv(turn).T + 1e-9) < 0.5).all(axis=1)
    offsets = near[inside] @ (1, size[0])
    total = np.zeros((window.height, window.width, 3), dtype=np.uint16)
    for offset in offsets:
        total += fine[middles + offset]
    return ((total + len(offsets) // 2) // len(offsets)).astype(np.uint8)


def _cull(robot: RobotVisuals, T_wc: Array, borders: tuple[float, ...], depth: float) -> None:
    """Draw only those pieces of the robot that reach into the cone seen, up to a depth."""
    centres, radii = robot.balls
    x, y, z = ((centres - T_wc[:3, 3]) @ T_wc[:3, :3]).T
    left, right, top, bottom = borders
    outside = (z + radii < NEAR) | (z - radii > depth)
    for coordinate, low, high in ((x, left, right), (y, top, bottom)):
        outside |= coordinate - low * z < -radii * np.hypot(1.0, low)
        outside |= coordinate - high * z > radii * np.hypot(1.0, high)
    robot.draw_only(~outside)
