r"""Fitting: the corners of a tag to a hundredth of a pixel, from all edges of its pattern.

The number of a tag tells its whole picture, up to what the camera did to it.  A model of that
picture is fitted to the grey levels by least squares (Lucas & Kanade 1981; as AprilTag's own edge
refinement, but with every edge of the pattern), for the corners and, at the same time, for

- the width of the blur across each of the two families of edges, and how the two are correlated,
- black and white, each a linear function of the place, because light is uneven,
- the curve of the sensor's response, to second order.

A blurred edge, averaged over the width of a pixel, has a profile :math:`F_i(x)`: the difference of
two integrals of the normal distribution.  Whiteness is :math:`m = \sum_{ij} D_{ij} F_i(x) F_j(y)`,
where D holds the pattern's steps.
Weights make pixels harmless that the model cannot explain, such as those behind a finger.

The covariance is that of least squares.  Counting pixels as independent makes it too small, since
neighbours agree; counting each cell as one (Liang & Zeger 1986) makes it too large where only the
edges' profile is not quite a Gaussian's.  The variance taken is the cube root of the first squared
times the second.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ..shapes import Array
from .intrinsics import Intrinsics
from .tag import CELLS, Picture, Tag

_SQUARE = 0.5 * CELLS * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])  # in cells, y down
_EDGES = np.arange(-0.5 * CELLS, 0.5 * CELLS + 1)
_BESIDE = 0.2  # cells around the black square that are looked at: blur adds what is beside paper
_MOST, _FEW = 1500, 300  # pixels that are looked at, and until the corners move less than
_NEARLY = 0.05  # [px]
_CLEAR = 3.0  # widths of the blur to the edge of the paper, beside which all may be
_FAR = 50.0  # [px]; the unit of the leans of black and white
_STEPS, _STILL = 15, 0.01  # at most so many, until the corners move less than this [px]
_FIRST = np.array([0.0] * 8 + [1.2, 1.2, 0.0, 0.0])
"""Shifts of the corners and widths of the blur in [px], its correlation, the response's curve."""
_LOOSE = np.array([1.5] * 8 + [1.0, 1.0, 0.4, 0.3])  # how far they may be from that
_LIMIT = np.array([1.0] * 8 + [0.3] * 4 + [np.inf] * 6)  # of one step
_LOW, _HIGH = np.array([[0.1, 0.1, -0.9, -0.9], [8.0, 8.0, 0.9, 0.9]])
_LEAST = 0.002  # [px]; corners without noise are off by this
_SPARE = 1.8  # by which the variance is larger, as rendered pictures say
_FAINT = 10.0  # grey levels from black to white
_EXPLAINED = 0.6  # least share of the variance of the grey levels


class Outline(NamedTuple):
    """The corners of a tag.

    Attributes:
        corners: Shape (4, 2) in [px], as a lens without distortion would show them.
        covariance: Covariance of their coordinates, x and y in turn, shape (8, 8) in [px^2].
    """

    corners: Array
    covariance: Array


def fitted(picture: Picture, corners: Array, number: int, lens: Intrinsics) -> Outline | None:
    """Refine the corners of a tag.

    Args:
        picture: Grey levels, shape (height, width).
        corners: Approximate corners, shape (4, 2) in [px], without distortion.
        number: The tag's number.
        lens: The lens.

    Returns:
        The outline; None if the picture does not look like this tag.
    """
    middle = corners.mean(axis=0)
    pixels = _pixels(picture.shape, lens.bent(middle + 1.3 * (corners - middle)))
    places = lens.straightened(pixels.astype(float)) - middle
    given = corners - middle
    x, y, _ = _on_tag(_to_tag(given)[0], places)
    near = np.flatnonzero(np.maximum(abs(x), abs(y)) < 0.5 * CELLS + _BESIDE)
    if len(near) < 80:
        return None
    near = near[np.linspace(0, len(near) - 1, min(len(near), _MOST)).astype(int)]
    places, levels = places[near], picture[pixels[near, 1], pixels[near, 0]].astype(float)
    first = np.concatenate([_FIRST, [levels.min(), 0, 0, levels.max(), 0, 0]])
    p, known = first, np.zeros(len(first))
    every = max(1, len(near) // _FEW)
    for _ in range(_STEPS):
        seen, J, cells, clear = _model(p, given, places[::every], number)
        off, contrast = levels[::every] - seen, p[15] - p[12]
        scale = max(1.0, 0.03 * abs(contrast), 1.48 * float(np.median(abs(off))))
        weight = clear / (1.0 + (off / (3.0 * scale)) ** 2)
        variance = float(weight @ off**2 / weight.sum())
        known[: len(_LOOSE)] = variance / _LOOSE**2
        JW = J * weight[:, None]
        if not np.isfinite(variance + JW.sum()):
            return None
        N = JW.T @ J + np.diag(known)
        step = np.linalg.lstsq(N, JW.T @ off + known * (first - p), rcond=1e-12)[0]
        p = p + np.clip(step, -_LIMIT, _LIMIT)
        p[8:12] = np.clip(p[8:12], _LOW, _HIGH)
        moved = np.abs(step[:8]).max()
        if every == 1 and moved < _STILL:
            break
        every = every if moved > _NEARLY else 1
    else:
        return None
    whole = float(weight @ (levels - np.average(levels, weights=weight)) ** 2)
    if contrast < _FAINT or weight @ off**2 > (1.0 - _EXPLAINED) * whole:
        return None
    back, scores = np.linalg.inv(N), np.zeros((int(cells.max()) + 1, len(p)))
    np.add.at(scores, cells, JW * off[:, None])
    pulls = scores @ back[:, :8]  # on the corners, by each cell
    agree = float(np.trace(np.linalg.solve(back[:8, :8], pulls.T @ pulls))) / 8.0
    growth = _SPARE * variance * np.cbrt(max(1.0, agree / variance))
    C = growth * back[:8, :8] + _LEAST**2 * np.eye(8)
    return Outline(corners + p[:8].reshape(4, 2), C)


def _pixels(shape: tuple[int, ...], corners: Array) -> Any:
    """The pixels (u, v) in the rectangle around some corners, shape (n, 2)."""
    low = np.maximum(np.floor(corners.min(axis=0)), 0).astype(int)
    high = np.minimum(np.ceil(corners.max(axis=0)) + 1, shape[::-1]).astype(int)
    u, v = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
    return np.column_stack([u.ravel(), v.ravel()])


def _to_tag(corners: Array) -> tuple[Array, Array]:
    """The homography from pixels to cells of the tag, and its derivative by the corners.

    Returns:
        Its eight entries, shape (8,), the ninth being 1; and shape (8, 8).
    """
    (x, y), one, none = _SQUARE.T[..., None], np.ones((4, 1)), np.zeros((4, 3))
    A = np.block([[corners, one, none, -x * corners], [none, corners, one, -y * corners]])
    g = np.linalg.solve(A, np.vstack([x, y]))[:, 0]
    B = np.zeros((2, 4, 4, 2))
    k = np.arange(4)
    B[0, k, k], B[1, k, k] = g[:2] - x * g[6:], g[3:5] - y * g[6:]
    return g, -np.linalg.solve(A, B.reshape(8, 8))


def _on_tag(g: Array, places: Array) -> tuple[Array, Array, Array]:
    u, v = places.T
    w = g[6] * u + g[7] * v + 1.0
    return (g[0] * u + g[1] * v + g[2]) / w, (g[3] * u + g[4] * v + g[5]) / w, w


@cache
def _steps(number: int) -> Array:
    """The steps of a tag's whiteness at the crossings of its edges, shape (x, y) = (10, 10)."""
    white = Tag(number).image(1).T / 255.0
    return np.asarray(np.diff(np.diff(white, axis=0, prepend=0), axis=1, prepend=0))


def _normal(z: Any) -> tuple[Any, Any]:
    """The normal distribution and its density; Abramowitz & Stegun, 26.2.17, as erf is slow."""
    bell = np.float32(0.39894228) * np.exp(np.float32(-0.5) * z * z)
    t = 1.0 / (1.0 + np.float32(0.2316419) * np.abs(z))
    rest = bell * t * np.polyval(_NORMAL, t)
    return np.where(z < 0.0, rest, 1.0 - rest), bell


_NORMAL = np.array([1.330274429, -1.821255978, 1.781477937, -0.356563782, 0.319381530], np.float32)


def _model(p: Array, given: Array, places: Array, number: int) -> tuple[Array, Array, Any, Any]:
    """Grey levels of places, their derivatives, cells, and if the paper's edge is far."""
    g, by_corners = _to_tag(given + p[:8].reshape(4, 2))
    x, y, w = _on_tag(g, places)
    D, F, rise, wider, widths = _steps(number), [], [], [], []
    for a, i, blur in ((x, 0, p[8]), (y, 3, p[9])):
        toward = np.abs([g[i] - a * g[6], g[i + 1] - a * g[7]]) / w  # cells per pixel
        slope, half = np.hypot(*toward)[:, None], 0.5 * toward.max(axis=0)[:, None]
        z = ((a[:, None] - _EDGES + np.array([half, -half])) / (blur * slope)).astype(np.float32)
        share, bell = _normal(z)
        ends = z * share + bell  # the integral of the share
        width = blur * slope / (2.0 * half)
        F.append(np.column_stack([np.ones(len(a)), width * (ends[0] - ends[1])]))
        rise.append(width * (share[0] - share[1]))
        wider.append((bell[0] - bell[1]) * width / blur)
        widths.append(blur * slope[:, 0])
    (dx, dy), (sx, sy) = rise, widths
    across_y, across_x = F[1] @ D.T, F[0] @ D
    rise_x, rise_y = across_y[:, 1:] * dx, across_x[:, 1:] * dy
    both = ((dx @ D[1:, 1:]) * dy).sum(axis=1)
    bent = p[8] * p[9] * ((wider[0] @ D[1:, 1:]) * wider[1]).sum(axis=1)
    m = (F[0] * across_y).sum(axis=1) + p[10] * (both + 0.5 * p[10] * bent)  # Mehler's formula
    around = np.column_stack([np.ones(len(x)), places / _FAR])
    white = m + p[11] * m * (1.0 - m)
    contrast = around @ (p[15:] - p[12:15])
    k = contrast * (1.0 + p[11] * (1.0 - 2.0 * m))
    kx, ky = k * rise_x.sum(axis=1) / sx / w, k * rise_y.sum(axis=1) / sy / w
    to_w = -(kx * x + ky * y)
    u, v = places.T
    by_g = np.column_stack([kx * u, kx * v, kx, ky * u, ky * v, ky, to_w * u, to_w * v])
    J = np.column_stack([
        by_g @ by_corners,
        k * (wider[0] * across_y[:, 1:]).sum(axis=1),
        k * (wider[1] * across_x[:, 1:]).sum(axis=1),
        k * (both + p[10] * bent),
        contrast * m * (1.0 - m),
        around * (1.0 - white)[:, None],
        around * white[:, None],
    ])  # fmt: skip
    seen = (1.0 - white) * (around @ p[12:15]) + white * (around @ p[15:])
    cells = (np.floor(x) + 6).astype(int) * 12 + (np.floor(y) + 6).astype(int)
    edge = np.minimum((0.5 * CELLS + 1.0 - abs(x)) / sx, (0.5 * CELLS + 1.0 - abs(y)) / sy)
    return seen, J, cells, (edge > _CLEAR) | (np.maximum(abs(x), abs(y)) < 0.5 * CELLS)
