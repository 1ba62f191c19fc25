"""A board in the world that carries a tag: still, moved by hand, or moved on a trajectory.

It has no part in the physics: cameras see it, and arms pass through it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import se3
from ..errors import TypeMismatch
from ..shapes import Array, as_array, locked, shown
from ..trajectory import PoseSample, Sample, Target
from ..world import World
from .drawing import Surface, box
from .tag import Tag

_THICKNESS = 0.003  # of the plate behind the paper, in [m]
_GREY = (0.5, 0.5, 0.5)


class Board:
    """A tag on a plate; a world can contain any number of them.

    Attributes:
        tag: The tag that is printed on it.
        world: The world that it is in.
    """

    def __init__(self, world: World, tag: Tag, T_wm: Any) -> None:
        """Put a board into ``world``.

        Args:
            world: The world to put it in.
            tag: The tag that is printed on it.
            T_wm: Pose of the tag in the world, shape (4, 4); its z axis comes out of the paper.

        Raises:
            TypeMismatch: ``world`` is not a world, or ``tag`` is not a tag.
        """
        if not isinstance(world, World) or not isinstance(tag, Tag):
            raise TypeMismatch(
                f"a board takes a World (an arm's is arm.world) and a Tag, not {shown(world)} and "
                f"{shown(tag)}"
            )
        self.tag, self.world = tag, world
        self.place(T_wm)
        world.show(self)

    def place(self, T_wm: Any) -> None:
        """Put the board at a pose, where it stays.

        Args:
            T_wm: Pose of the tag in the world, shape (4, 4).
        """
        self._home: Array = locked(np.array(se3.as_pose(T_wm, "T_wm")))
        self._motion: Target | None = None
        self._since = self.world.t

    def move(self, motion: Target) -> None:
        """Move the board on a trajectory that starts now, by the world's clock.

        Args:
            motion: A function of the time since now, in [s].  It returns poses of the tag, or
                points for the tag's middle, which then keeps its present orientation.

        Raises:
            TypeMismatch: ``motion`` is no such function.
        """
        first = motion(0.0) if callable(motion) else motion
        if not isinstance(first, Sample | PoseSample):
            raise TypeMismatch(
                f"a board's motion is a function of time that returns lk.PoseSample or lk.Sample, "
                f"not {shown(first)}; board.place(T_wm) puts it somewhere"
            )
        if isinstance(first, Sample):
            as_array(first.position, (3,), "the board's position")
        self._home, self._motion, self._since = self.T_wm, motion, self.world.t

    @property
    def T_wm(self) -> Array:
        """True present pose of the tag, shape (4, 4)."""
        return self.pose_at(self.world.t)

    def pose_at(self, t: float) -> Array:
        """Pose of the tag at time ``t`` [s] of the world's clock, by its present motion.

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

    def surface(self) -> Surface:
        """The plate behind the paper, in the world; the paper itself is printed by the camera."""
        half = 0.5 * self.tag.paper
        plate = box((half, half, 0.5 * _THICKNESS), _GREY)
        return plate.moved(self.T_wm @ se3.pose(np.eye(3), np.array([0.0, 0.0, -_THICKNESS])))
