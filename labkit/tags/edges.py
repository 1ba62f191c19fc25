"""Edges: the corners of a dark square to a few hundredths of a pixel.

Each side is met by short rows of samples across it.  Along such a row the picture rises from dark
to light; where a sharp edge would have to be to make the same sum is where the side is, however the
pixels blurred it.  A line through these places, by total least squares, is the side; the sides'
intersections are the corners.  How far the places lie off their lines, and how wide the rise from
dark to light is, tell how good the corners are.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import cv2
import numpy as np

from ..shapes import Array
from .intrinsics import Intrinsics
from .tag import Picture

_ROWS, _DEEP = 24, 13  # rows across each side, and samples along each of them
_LONGEST = 2.5  # half of a row's length, in [px], if the tag's cells are large enough
_ALONG = np.linspace(0.12, 0.88, _ROWS)[:, None]  # the corners themselves are rounded off
_ACROSS = np.linspace(-1.0, 1.0, _DEEP)[:, None]
_WEIGHT = np.full(_DEEP, 1.0 / (_DEEP - 1))
_WEIGHT[[0, -1]] *= 0.5  # the trapezoidal rule
_GRAIN = 1.6  # how much more a corner is off than its sides' scatter says, as rendered
_CUT = 0.37  # [px] by which it is off for each unit of slope left at the rows' ends, as rendered
_LEAST = 0.01  # [px]; the sides of a tag square to the picture do not scatter at all
_STEEP = 0.11  # with more slope there, a row is too short for the blur, and the edge is lost
_PURE = 0.2  # a row must begin dark and end light, to this share of the contrast


class Outline(NamedTuple):
    """The corners of a dark square.

    Attributes:
        corners: Shape (4, 2) in [px], as a lens without distortion would show them.
        noise: Standard deviation of a corner's coordinate, by this picture, in [px].
    """

    corners: Array
    noise: float


def sharpened(picture: Picture, corners: Any, cells: int, lens: Intrinsics) -> Outline | None:
    """The corners of a dark square on light ground, found again from its sides.

    Args:
        picture: Grey levels, shape (height, width).
        corners: About where they are, shape (4, 2) in [px], in order.
        cells: How many cells of its pattern a side has: a row may not be longer than a cell.
        lens: The lens; one with distortion makes the sides crooked.

    Returns:
        The outline; None, if a side cannot be seen well.
    """
    given: Array = lens.straightened(np.asarray(corners, dtype=float))
    found = given
    for _ in range(2):  # the second time from the better place
        sides = _sides(picture, found, cells, lens)
        if sides is None:
            return None
        points, directions, noise = sides
        found = _meet(points, directions)
        if not np.abs(found - given).max() < _LONGEST:
            return None
    return Outline(found, noise)


def _sides(picture: Picture, corners: Array, cells: int, lens: Intrinsics) -> Any:
    """A point and a direction for each side, and the noise; None if a side is not seen well."""
    following = np.roll(corners, -1, axis=0)
    along = following - corners
    length = np.linalg.norm(along, axis=1, keepdims=True)
    if length.min() < 4.0:
        return None
    along = along / length
    outward = np.column_stack([along[:, 1], -along[:, 0]])
    to_next, to_last = (np.roll(corners, -k, axis=0) - corners for k in (2, 3))
    widths = np.abs([np.einsum("ij,ij->i", x, outward) for x in (to_next, to_last)]).min(axis=0)
    outward *= np.sign(-np.einsum("ij,ij->i", to_next, outward))[:, None]
    reach = np.clip(0.4 * widths / cells, 0.8, _LONGEST)
    starts = corners[:, None] + _ALONG * (following - corners)[:, None]  # (4, rows, 2)
    places = starts[:, :, None] + (outward * reach[:, None])[:, None, None] * _ACROSS
    seen = places.reshape(-1, 2)
    seen = lens.bent(seen) if any(lens.distortion) else seen
    x, y = np.moveaxis(seen.reshape(4 * _ROWS, _DEEP, 2).astype(np.float32), 2, 0)
    levels = cv2.remap(picture, x, y, cv2.INTER_LINEAR).reshape(4, _ROWS, _DEEP).astype(float)
    dark, light = np.median(levels[..., 0], axis=1), np.median(levels[..., -1], axis=1)
    if (light - dark).min() < 10.0:
        return None
    share = (levels - dark[:, None, None]) / (light - dark)[:, None, None]
    usable = (np.abs(share[..., 0]) < _PURE) & (np.abs(share[..., -1] - 1.0) < _PURE)
    shift = reach[:, None] * (1.0 - 2.0 * np.clip(share, -_PURE, 1.0 + _PURE) @ _WEIGHT)
    lines = _lines(starts + outward[:, None] * shift[..., None], usable)
    if lines is None:
        return None
    ends = share[..., 2] - share[..., 0], share[..., -1] - share[..., -3]  # 0 where it is level
    slope = np.mean(ends, axis=(0, 2))
    if slope.max() > _STEEP:
        return None
    noise = max(_LEAST, float(np.hypot(_GRAIN * lines[2], _CUT * slope.mean())))
    return *lines[:2], noise


def _lines(points: Array, keep: Any) -> tuple[Array, Array, float] | None:
    """A point on each side, its direction, and the noise of the corners that follow.

    The noise of an end of a line through n places is twice that of each over the root of n.
    """
    for _ in range(3):
        count = keep.sum(axis=1)
        if count.min() < _ROWS // 3:
            return None
        centre = np.einsum("ijk,ij->ik", points, keep) / count[:, None]
        x, y = np.moveaxis(points - centre[:, None], 2, 0)
        xx, yy, xy = ((a * b * keep).sum(axis=1) for a, b in ((x, x), (y, y), (x, y)))
        angle = 0.5 * np.arctan2(2.0 * xy, xx - yy)[:, None]  # of the longer principal axis
        off = y * np.cos(angle) - x * np.sin(angle)
        spread = np.sqrt((off * off * keep).sum(axis=1) / count)
        keep &= np.abs(off) < 2.5 * np.maximum(spread, 0.02)[:, None]
    noise = float(np.sqrt(np.mean(4.0 * spread**2 / count)))
    return centre, np.column_stack([np.cos(angle), np.sin(angle)]), noise


def _meet(points: Array, directions: Array) -> Array:
    """Where each side meets the one before it."""
    before, turn = np.roll(points, 1, axis=0), np.roll(directions, 1, axis=0)
    gap = before - points
    distance = (gap[:, 0] * turn[:, 1] - gap[:, 1] * turn[:, 0]) / (
        directions[:, 0] * turn[:, 1] - directions[:, 1] * turn[:, 0]
    )
    return np.asarray(points + distance[:, None] * directions)
