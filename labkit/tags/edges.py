r"""Edges: the corners of a dark square to a few hundredths of a pixel, with their covariance.

Short rows of samples cross each side.  Along such a row the picture rises from dark to light, and
the side is where a sharp edge would give the same sum of grey levels, however much the pixels
blurred it.  The side is the line through these places by total least squares, and the corners are
the intersections of the sides.  If a row is shorter than the rise, a step towards the side falls
short of it, so the rows are centred on the latest sides again until the sides stay the same.

A line through n places, each off by :math:`\sigma`, is off by :math:`a + b x` at x along the side
from their middle, where a has the variance :math:`\sigma^2/n` and b :math:`\sigma^2/\sum x^2`.
The error of the corner of two sides with unit normals N is :math:`N^{-1}` times those of the sides.
Neighbouring places share pixels, so sigma comes from the means of groups of them (batch means; Law,
Simulation Modeling and Analysis, section 9.5.3).  The errors of the levels of black and white
add to a, because all places of a side share them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates

from ..shapes import Array
from .intrinsics import Intrinsics
from .tag import CELLS, Picture

_ROWS, _DEEP = 48, 25
"""Rows across each side, and samples along a row; 24 rows leave an error of 0.015 px, 48 0.009."""

_GROUPS = 8  # of neighbouring rows, whose means err independently
_STEPS = 6  # at most; 2 leave 0.022 px of error in a blur of 1 px, 5 leave 0.012
_STILL = 0.001  # [px]; corners that move less have converged
_LONGEST = 2.5  # half of a row's length, in [px], if the tag's cells are large enough
_ALONG = np.linspace(0.12, 0.88, _ROWS)[:, None]  # the corners themselves are rounded off
_ACROSS = np.linspace(-1.0, 1.0, _DEEP)[:, None]
_WEIGHT = np.full(_DEEP, 1.0 / (_DEEP - 1))
_WEIGHT[[0, -1]] *= 0.5  # the trapezoidal rule
_SIXTH = _DEEP // 6  # of a row, at whose ends the picture should be level
_LEAST = 0.005  # [px]; corners without noise are off by 0.009 in all
_STEEP = 0.11  # with more slope there, a row is too short for the blur, and the edge is lost
_UNSEEN = 0.1  # [px] of a side for each unit of that slope; 0.006 in a blur of 1 px, as rendered
_BLACK, _WHITE = 0.0, 255.0  # beyond these a sensor sees nothing
_PURE = 0.2  # a row must begin dark and end light, to this share of the contrast


class Outline(NamedTuple):
    """The corners of a dark square.

    Attributes:
        corners: Shape (4, 2) in [px], as a lens without distortion would show them.
        covariance: Covariance of their coordinates, x and y in turn, shape (8, 8) in [px^2].
    """

    corners: Array
    covariance: Array


def sharpened(picture: Picture, corners: Any, lens: Intrinsics) -> Outline | None:
    """Refine the corners of a dark square on a light background from its sides.

    Args:
        picture: Grey levels, shape (height, width).
        corners: Approximate corners, shape (4, 2) in [px], in order.
        lens: The lens, whose distortion bends the sides.

    Returns:
        The outline; None if a side cannot be seen well.
    """
    given: Array = lens.straightened(np.asarray(corners, dtype=float))
    found = given
    for _ in range(_STEPS):
        seen = _sides(picture, found, lens)
        if seen is None:
            return None
        sides = seen
        last, found = found, _meet(sides.points, sides.directions)
        if not np.abs(found - given).max() < _LONGEST:
            return None
        if np.abs(found - last).max() < _STILL:
            break
    return Outline(found, _covariance(found, sides))


class _Sides(NamedTuple):
    """Lines: points on them (4, 2), unit directions (4, 2), variances of a and of b (4,)."""

    points: Array
    directions: Array
    offset: Array
    turn: Array


def _sides(picture: Picture, corners: Array, lens: Intrinsics) -> _Sides | None:
    """The lines along the sides; None if a side is not seen well."""
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
    reach = np.clip(0.4 * widths / CELLS, 0.8, _LONGEST)  # a row is no longer than a cell
    starts = corners[:, None] + _ALONG * (following - corners)[:, None]  # (4, rows, 2)
    places = starts[:, :, None] + (outward * reach[:, None])[:, None, None] * _ACROSS
    seen = places.reshape(-1, 2)
    seen = lens.bent(seen) if any(lens.distortion) else seen
    # Not OpenCV's `remap`, which rounds places to 1/32 of a pixel and levels to whole ones.
    sampled = map_coordinates(picture, seen.T[::-1], output=float, order=1, mode="nearest")
    levels = sampled.reshape(4, _ROWS, _DEEP)
    dark, light = np.median(levels[..., 0], axis=1), np.median(levels[..., -1], axis=1)
    if (light - dark).min() < 10.0:
        return None
    share = (levels - dark[:, None, None]) / (light - dark)[:, None, None]
    usable = (np.abs(share[..., 0]) < _PURE) & (np.abs(share[..., -1] - 1.0) < _PURE)
    if usable.sum(axis=1).min() < _ROWS // 3:
        return None
    levels = _uncut(levels, usable)
    within = np.broadcast_to(usable[..., None], (4, _ROWS, 2))
    dark, light = np.average(levels[..., [0, -1]], 1, within).T[..., None, None]
    share = (levels - dark) / (light - dark)
    shift = reach[:, None] * (1.0 - 2.0 * np.clip(share, -_PURE, 1.0 + _PURE) @ _WEIGHT)
    k = _SIXTH
    ends = share[..., k] - share[..., 0], share[..., -1] - share[..., -1 - k]  # 0 if level
    slope = np.mean(ends, axis=(0, 2))
    if slope.max() > _STEEP:
        return None
    lines = _lines(starts + outward[:, None] * shift[..., None], usable)
    if lines is None:
        return None
    levelled = (share[..., 0] + share[..., -1] - 1.0) * usable
    level = (reach**2).mean() * _variance(levelled, usable, 4) / usable.sum(axis=1)
    return lines._replace(offset=lines.offset + level + (_UNSEEN * slope.mean()) ** 2)


def _uncut(levels: Array, usable: Any) -> Array:
    """Remove from the rows the noise of black or white that the sensor has clipped.

    Clipped noise moves the mean of black or white, but not the rise between them, so the tag would
    look larger, by 0.013 px on each side with a noise of 10.
    """
    for end, inner, rail in ((0, 2, _BLACK), (-1, -3, _WHITE)):
        away = np.abs(levels - rail)
        ends = np.ma.array(away[..., [end, inner]], mask=np.dstack([~usable] * 2))
        mean, beyond = ends.mean(axis=1).T
        level = (mean < 2.0 * ends[..., 0].std(axis=1)) & (beyond < 1.5 * mean)  # grain, no slope
        noise = level[:, None, None] & (away < 3.0 * mean[:, None, None])
        levels = np.where(noise, rail, levels)
    return levels


def _lines(points: Array, keep: Any) -> _Sides | None:
    """Fit lines to places along the sides, shape (4, rows, 2), without the outliers."""
    for _ in range(3):
        count = keep.sum(axis=1)
        if count.min() < _ROWS // 3:
            return None
        centre = np.einsum("ijk,ij->ik", points, keep) / count[:, None]
        x, y = np.moveaxis(points - centre[:, None], 2, 0)
        xx, yy, xy = ((a * b * keep).sum(axis=1) for a, b in ((x, x), (y, y), (x, y)))
        angle = 0.5 * np.arctan2(2.0 * xy, xx - yy)[:, None]  # of the longer principal axis
        c, s = np.cos(angle), np.sin(angle)
        off = (y * c - x * s) * keep
        spread = np.sqrt((off * off).sum(axis=1) / count)
        length = (((x * c + y * s) * keep) ** 2).sum(axis=1)
        inside = keep
        keep = keep & (np.abs(off) < 2.5 * np.maximum(spread, 0.02)[:, None])
    variance = _variance(off, inside, 8)
    return _Sides(centre, np.column_stack([c, s]), variance / count, variance / length)


def _variance(x: Array, counts: Any, taken: int) -> float:
    """Variance of each of the values along the sides, as if their errors were independent.

    Args:
        x: Residuals of the values, shape (4, rows), 0 for values that do not count.
        counts: Which values count, shape (4, rows).
        taken: How many parameters were fitted to all values.
    """
    groups = 4, _GROUPS, -1
    members = counts.reshape(groups).sum(axis=2)
    total = (x.reshape(groups).sum(axis=2) ** 2 / np.maximum(members, 1)).sum()
    return float(total / ((members > 0).sum() - taken))


def _covariance(corners: Array, sides: _Sides) -> Array:
    """Covariance of the eight coordinates from the variances of the four lines."""
    leans = np.zeros((4, 2, 2, 4))  # corner, coordinate; a or b, line
    normals = np.column_stack([-sides.directions[:, 1], sides.directions[:, 0]])
    for k in range(4):
        both = [k, k - 1]
        along = np.einsum("ij,ij->i", corners[k] - sides.points[both], sides.directions[both])
        lean = np.linalg.inv(normals[both])
        leans[k][:, 0, both], leans[k][:, 1, both] = lean, lean * along
    G = leans.reshape(8, 8)
    variances = np.concatenate([sides.offset, sides.turn])
    return np.asarray((G * variances) @ G.T + _LEAST**2 * np.eye(8))


def _meet(points: Array, directions: Array) -> Array:
    """The intersection of each side with the one before it."""
    before, turn = np.roll(points, 1, axis=0), np.roll(directions, 1, axis=0)
    gap = before - points
    distance = (gap[:, 0] * turn[:, 1] - gap[:, 1] * turn[:, 0]) / (
        directions[:, 0] * turn[:, 1] - directions[:, 1] * turn[:, 0]
    )
    return np.asarray(points + distance[:, None] * directions)
