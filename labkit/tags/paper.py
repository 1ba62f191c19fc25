"""A tag's paper in a picture: its pattern, averaged over the area of each pixel.

A renderer samples one point of each pixel, which would move the pattern's edges by up to half a
pixel.  The pattern is known exactly, so pixels on an edge are sampled at many points.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ..shapes import Array
from .intrinsics import Intrinsics
from .rendering import Window
from .tag import Tag

_OUTSIDE = -1.0


def paper(
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
    table = _table(tag)
    n = len(table) - 2
    column = np.clip(np.floor((x / (w * tag.paper) + 0.5) * n), -1, n).astype(int)
    row = np.clip(np.floor((0.5 - y / (w * tag.paper)) * n), -1, n).astype(int)
    return table[row + 1, column + 1], (column, row)


@cache
def _table(tag: Tag) -> Array:
    """Whiteness of each cell, 0 or 1, from the upper left, framed by cells of `_OUTSIDE`."""
    return np.pad(tag.image(1) / 255.0, 1, constant_values=_OUTSIDE)
