r"""The scene: the things that can act on an arm in its world, as frozen values.

A `Table` and a `Wall` are solid.  Only the tip of the arm, a small ball, collides with them, and
only with their face, not with its rim.  A `Spring` and a `Push` act on the tip without contact.  A
contact has the two stiffnesses in series and the sum of the two dampings:

.. math:: 1/k = 1/k_{thing} + 1/k_{tip}, \qquad d = d_{thing} + d_{tip}
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from . import se3
from .errors import OutOfRange
from .joints import TipForce
from .shapes import Array, as_number, lock_vectors, locked
from .world import World

if TYPE_CHECKING:
    from .arm import Arm

TIP_RADIUS = 0.01
"""Radius of the ball about the tip's origin, in [m]; contact begins at this distance."""

TIP_STIFFNESS = 10_000.0
"""Stiffness of the finger's rubber pad, in [N/m]."""

TIP_DAMPING = 20.0
"""Damping of the finger's rubber pad, in [N s/m]."""

FACE = 0.02
"""Thickness of a wall or a table top, in [m]."""

CREEP = 1e-4
"""Speed up to which dry friction grows, in [m/s]; a tip that it holds creeps more slowly."""


def contact_stiffness(thing: _Slab) -> float:
    """Stiffness of the contact of the tip with a thing, both in series, in [N/m]."""
    return 1.0 / (1.0 / thing.stiffness + 1.0 / TIP_STIFFNESS)


class _Slab:
    """A wall or a table top, as the tip meets it."""

    T_wf: Any
    size: Any
    stiffness: float
    damping: float
    friction: float

    def act(self, world: World) -> None:
        """Push back the tips that are in the slab."""
        for arm in world.arms:
            self._meet(arm, world.dt, *arm.tip())

    def _meet(self, arm: Arm, dt: float, p: Array, v: Array) -> None:
        """Push back a tip in the slab with the springs and the dampers of slab and pad."""
        n = self.T_wf[:3, 2]
        x, y, z = self.T_wf[:3, :3].T @ (p - self.T_wf[:3, 3])
        k, d, depth = contact_stiffness(self), self.damping + TIP_DAMPING, TIP_RADIUS - z
        press = k * depth - d * float(n @ v)
        beside = max(abs(x) / self.size[0], abs(y) / self.size[1]) > 0.5
        if beside or press <= 0.0 or not 0.0 < depth < TIP_RADIUS + FACE:
            return
        across = np.eye(3) - np.outer(n, n)
        slide = float(np.linalg.norm(across @ v))
        drag = self.friction * press / max(slide, CREEP)
        damping = (d + k * dt) * np.outer(n, n) + drag * across
        arm.touch(TipForce(np.append(k * depth * n, np.zeros(3)), damping, outwards=n))


@dataclass(frozen=True, eq=False)
class Wall(_Slab):
    """A flat solid face, or a compliant surface if its stiffness is low.

    Attributes:
        point: The middle of the face, shape (3,) in [m], world axes.
        normal: Vector out of the face, shape (3,), of any length.
        size: Width and height of the face, shape (2,) in [m].
        stiffness: Stiffness of the wall alone, in [N/m]; see `contact_stiffness`.
        damping: Damping of the wall alone, in [N s/m].
        friction: Coefficient of dry friction; 0 keeps the force along the normal.
        colour: Red, green, blue and opacity, from 0 to 1.
    """

    point: Any
    normal: Any
    size: Any = (1.0, 1.0)
    stiffness: float = 5_000.0
    damping: float = 100.0
    friction: float = 0.0
    colour: Any = (0.75, 0.75, 0.8, 1.0)

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "point", "normal")
        length = float(np.linalg.norm(self.normal))
        if length < 1e-9:
            raise OutOfRange("normal must not be the zero vector: it says where the wall faces")
        object.__setattr__(self, "normal", locked(self.normal / length))
        _check_slab(self)

    @cached_property
    def T_wf(self) -> Array:
        """Pose of the face in the world, its z axis along the normal, shape (4, 4)."""
        z = self.normal
        x = np.cross(np.eye(3)[1 if abs(z[1]) < 0.9 else 2], z)
        x /= np.linalg.norm(x)
        return locked(se3.pose(np.column_stack([x, np.cross(z, x), z]), self.point))


@dataclass(frozen=True, eq=False)
class Table(_Slab):
    """A level table top.

    Attributes:
        height: Height of its upper face in the world, in [m]; the default is clear of motions
            that stay within 0.25 m of `Robot.ready`.
        centre: Centre of its upper face, x and y in the world, shape (2,) in [m].
        size: Size along x and y, shape (2,) in [m].
        stiffness: Stiffness of the table alone, in [N/m]; see `contact_stiffness`.
        damping: Damping of the table alone, in [N s/m].
        friction: Coefficient of dry friction.
        colour: Red, green, blue and opacity, from 0 to 1.
    """

    height: float = -0.25
    centre: Any = (0.8, 0.0)
    size: Any = (0.8, 1.6)
    stiffness: float = 20_000.0
    damping: float = 200.0
    friction: float = 0.4
    colour: Any = (0.72, 0.56, 0.38, 1.0)

    def __post_init__(self) -> None:
        as_number(self.height, "height")
        lock_vectors(self, 2, "centre")
        _check_slab(self)

    @cached_property
    def T_wf(self) -> Array:
        """Pose of the upper face in the world, shape (4, 4)."""
        return locked(se3.pose(np.eye(3), np.array([*self.centre, self.height])))


@dataclass(frozen=True, eq=False)
class Push:
    """A scripted hand: a constant wrench on each arm's tip during a window of time.

    Attributes:
        force: Force on the arm at the tip's origin, world axes, shape (3,) in [N].
        moment: Moment on the arm, world axes, shape (3,) in [N m].
        start: When it begins, in [s] on the world's clock.
        duration: How long it lasts, in [s].
    """

    force: Any = (0.0, 0.0, 0.0)
    moment: Any = (0.0, 0.0, 0.0)
    start: float = 0.0
    duration: float = np.inf

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "force", "moment")
        as_number(self.start, "start")
        if not self.duration > 0.0:
            raise OutOfRange(f"duration is {self.duration}; it must be greater than 0")

    def act(self, world: World) -> None:
        """Push during the window."""
        if self.start - 0.5 * world.dt < world.t < self.start + self.duration - 0.5 * world.dt:
            for arm in world.arms:
                arm.push(self.force, self.moment)


@dataclass(frozen=True, eq=False)
class Spring:
    r"""A spring of zero rest length from the tip to an anchor, :math:`f = k(a - p) - d v`.

    Attributes:
        anchor: Point to which it pulls the tip, world axes, shape (3,) in [m].
        stiffness: k in [N/m].
        damping: d in [N s/m].
    """

    anchor: Any
    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "anchor")
        as_number(self.stiffness, "stiffness", least=0.0)
        as_number(self.damping, "damping", least=0.0)

    def force(self, p: Array, v: Array) -> Array:
        """Force on the arm, for a tip at ``p`` [m] moving at ``v`` [m/s], shape (3,) in [N]."""
        return np.asarray(self.stiffness * (self.anchor - p) - self.damping * v)

    def act(self, world: World) -> None:
        """Pull with the force of the end of the step."""
        give = self.damping + self.stiffness * world.dt
        for arm in world.arms:
            pull = self.stiffness * (self.anchor - arm.tip()[0])
            arm.touch(TipForce(np.append(pull, np.zeros(3)), give * np.eye(3)))


def _check_slab(thing: Any) -> None:
    """Check the size and the material of a wall or a table top."""
    lock_vectors(thing, 2, "size")
    lock_vectors(thing, 4, "colour")
    for side in thing.size:
        as_number(side, "size", above=0.0)
    as_number(thing.stiffness, "stiffness", above=0.0)
    as_number(thing.damping, "damping", least=0.0)
    as_number(thing.friction, "friction", least=0.0)
