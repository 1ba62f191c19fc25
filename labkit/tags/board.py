"""A board in the world that carries a tag: still, moved by hand, or moved on a trajectory.

It has neither weight nor substance: cameras see it, arms pass through it.
"""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from .. import se3
from ..errors import Closed, TypeMismatch
from ..shapes import Array, as_array, locked, shown
from ..trajectory import PoseSample, Sample, Target
from ..world import World
from .tag import Tag

_THICKNESS = 0.003  # of the plate behind the paper, in [m]


class Board:
    """A tag on a plate.  Put as many into a world as you like.

    Attributes:
        tag: What is printed on it.
        world: Where it is.
        bodies: The numbers of its paper and its plate in `World.pictures`.
    """

    def __init__(self, world: World, tag: Tag, T_wm: Any) -> None:
        """Put a board into ``world``.

        Args:
            world: Where to.
            tag: What is printed on it.
            T_wm: Pose of the tag in the world, shape (4, 4); its z axis comes out of the paper.

        Raises:
            TypeMismatch: The first is not a world, or the second not a tag.
            Closed: The world is closed.
        """
        if not isinstance(world, World) or not isinstance(tag, Tag):
            raise TypeMismatch(
                f"a board takes a World (an arm's is arm.world) and a Tag, not {shown(world)} and "
                f"{shown(tag)}"
            )
        self.tag, self.world = tag, world
        self.place(T_wm)
        self._build()
        world.show(self)

    def place(self, T_wm: Any) -> None:
        """Put the board somewhere, where it stays.

        Args:
            T_wm: Pose of the tag in the world, shape (4, 4).
        """
        self._home: Array = locked(np.array(se3.as_pose(T_wm, "T_wm")))
        self._motion: Target | None = None
        self._since = self.world.t

    def move(self, motion: Target) -> None:
        """Move on a trajectory, from this moment of the world's clock on.

        Args:
            motion: A function of the time since now, in [s]; its poses are the tag's, its points
                are where the tag's middle goes, turned as it is now.

        Raises:
            TypeMismatch: It is not a function, or its samples are neither poses nor points.
        """
        if not callable(motion):
            raise TypeMismatch(
                f"motion is {shown(motion)}, expected a function of time; board.place(T_wm) puts "
                "the board somewhere"
            )
        first = motion(0.0)
        is_point = isinstance(first, Sample) and first.position.shape == (3,)
        if not is_point and not isinstance(first, PoseSample):
            raise TypeMismatch(
                f"the board's motion returned {str(first)[:80]}; it must return lk.PoseSample, or "
                "lk.Sample of points, shape (3,)"
            )
        self._home, self._motion, self._since = self.T_wm, motion, self.world.t

    @property
    def T_wm(self) -> Array:
        """Where the tag really is now, shape (4, 4)."""
        return self.pose_at(self.world.t)

    def pose_at(self, t: float) -> Array:
        """Where the tag is at time ``t`` of the world's clock, by its present motion.

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

    def update(self) -> None:
        """Put what cameras see where it belongs; they call it before each picture."""
        T_wm = self.T_wm
        for body in self.bodies:
            self.world.pictures.move(body, T_wm)

    def _build(self) -> None:
        world, half = self.world, 0.5 * self.tag.paper
        if world.closed:
            raise Closed("this world was closed; make a new World")
        mesh, texture = _paper(self.tag)
        white, grey = (1.0, 1.0, 1.0, 1.0), (0.5, 0.5, 0.5, 1.0)
        plate, behind = (half, half, 0.5 * _THICKNESS), (0.0, 0.0, -_THICKNESS)
        self.bodies = (
            world.pictures.add_mesh(mesh, white, texture),
            world.pictures.add_box(plate, grey, behind),
        )


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="labkit-tags-")


@cache
def _paper(tag: Tag) -> tuple[Path, Path]:
    """PyBullet reads only files: a square and its picture, gone with the process."""
    name = Path(_folder().name) / f"{tag.dictionary}_{tag.id}_{tag.size}_{tag.border}"
    h = 0.5 * tag.paper
    corners = [(-h, -h), (h, -h), (h, h), (-h, h)]
    lines = [f"v {x!r} {y!r} 0" for x, y in corners]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "vn 0 0 1"]
    lines += ["f 1/1/1 2/2/1 3/3/1", "f 1/1/1 3/3/1 4/4/1"]
    mesh = name.with_name(f"{name.name}.obj")
    mesh.write_text("\n".join(lines) + "\n")
    return mesh, tag.save(
        name.with_name(f"{name.name}.png"), dpi=16 * tag.cells / tag.size * 0.0254
    )
