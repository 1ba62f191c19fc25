"""Surfaces: what cameras see, as triangles with one colour each."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from ..shapes import Array

_BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
_SIDES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip


class Surface(NamedTuple):
    """A set of coloured triangles.

    Attributes:
        corners: Corners of each triangle, shape (n, 3, 3) in [m].
        colours: Red, green and blue of each triangle, from 0 to 1, shape (n, 3).
    """

    corners: Array
    colours: Array

    def moved(self, T: Array) -> Surface:
        """The surface in another frame, in which its own frame has the pose ``T``, shape (4, 4)."""
        return self._replace(corners=self.corners @ T[:3, :3].T + T[:3, 3])

    def only(self, wanted: Any) -> Surface:
        """Only the triangles for which ``wanted``, shape (n,), is true."""
        return Surface(self.corners[wanted], self.colours[wanted])


NOTHING = Surface(np.empty((0, 3, 3)), np.empty((0, 3)))


def in_colour(corners: Array, colour: Any) -> Surface:
    """Triangles, shape (n, 3, 3) in [m], in one colour: red, green and blue, from 0 to 1."""
    return Surface(corners, np.tile(np.asarray(colour, dtype=float)[:3], (len(corners), 1)))


def joined(surfaces: Iterable[Surface]) -> Surface:
    """Several surfaces as one."""
    corners, colours = zip(NOTHING, *surfaces, strict=True)
    return Surface(np.concatenate(corners), np.concatenate(colours))


def box(half: Any, colour: Any) -> Surface:
    """A box about the origin.

    Args:
        half: Half the lengths of its edges, shape (3,) in [m].
        colour: Red, green and blue, and perhaps opacity, which is ignored.
    """
    corners = (_BOX * half)[_SIDES]
    return in_colour(corners, colour)


def wrapped(points: Array, colour: Any) -> Surface:
    """The convex hull of points, shape (n, 3) in [m]."""
    corners = points[ConvexHull(points).simplices]
    return in_colour(corners, colour)


def mesh(file: Path, colour: Any) -> Surface:
    """Read the triangles of a Wavefront file (``.obj``), in its own frame."""
    points, sides = [], []
    for line in file.read_text(encoding="utf-8").splitlines():
        kind, *words = line.split() or [""]
        if kind == "v":
            points.append([float(word) for word in words[:3]])
        elif kind == "f":
            first, *rest = (int(word.partition("/")[0]) - 1 for word in words)
            sides += [[first, a, b] for a, b in pairwise(rest)]
    corners = np.array(points)[np.array(sides)]
    return in_colour(corners, colour)
