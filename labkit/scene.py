r"""The scene: what an arm can meet in its world, as frozen values.

A `Table` and a `Wall` are solid; the tip, a small ball, is all of the arm that they meet.  A
`Spring` and a `Push` act on the tip without touching it.  PyBullet makes a contact as stiff as
the two bodies' stiffnesses in series and as damped as their dampings together:

.. math:: 1/k = 1/k_{thing} + 1/k_{tip}, \qquad d = d_{thing} + d_{tip}
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import se3
from .errors import OutOfRange, UnknownName
from .robot import Side
from .shapes import Array, as_number, lock_vectors, locked
from .sim.engine import FACE as FACE
from .sim.engine import TIP_RADIUS as TIP_RADIUS
from .sim.engine import TIP_STIFFNESS as TIP_STIFFNESS
from .world import Actor, Pushable, World


def contact_stiffness(thing: Wall | Table) -> float:
    """What the tip feels when it presses on a thing, the two stiffnesses in series, in [N/m]."""
    return 1.0 / (1.0 / thing.stiffness + 1.0 / TIP_STIFFNESS)


@dataclass(frozen=True, eq=False)
class Wall:
    """A flat solid face; with a low stiffness, a compliant surface.

    Attributes:
        point: The middle of the face, shape (3,) in [m], world axes.
        normal: Out of the face, shape (3,), of any length.
        size: Width and height of the face, shape (2,) in [m].
        stiffness: Of the wall alone, in [N/m]; see `contact_stiffness`.
        damping: Of the wall alone, in [N s/m].
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

    @property
    def T_wf(self) -> Array:
        """Pose of the face in the world, its z axis along the normal, shape (4, 4)."""
        z = self.normal
        x = np.cross(np.eye(3)[1 if abs(z[1]) < 0.9 else 2], z)
        x /= np.linalg.norm(x)
        return se3.pose(np.column_stack([x, np.cross(z, x), z]), self.point)

    def put_into(self, world: World) -> None:
        """Build it."""
        _build(world, self)


@dataclass(frozen=True, eq=False)
class Table:
    """A level table top.

    Attributes:
        height: Of its upper face, in [m] of the world; the default is out of the way of motions
            that stay within 0.25 m of `Robot.ready`.
        centre: Of its upper face, seen from above, shape (2,) in [m].
        size: Along x and y, shape (2,) in [m].
        stiffness: Of the table alone, in [N/m]; see `contact_stiffness`.
        damping: Of the table alone, in [N s/m].
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

    @property
    def T_wf(self) -> Array:
        """Pose of the upper face in the world, shape (4, 4)."""
        return se3.pose(np.eye(3), np.array([*self.centre, self.height]))

    def put_into(self, world: World) -> None:
        """Build it."""
        _build(world, self)


@dataclass(frozen=True, eq=False)
class Push:
    """A scripted hand: a constant wrench on the tip during a window of time.

    Attributes:
        force: On the arm, at the tip's origin, world axes, shape (3,) in [N].
        moment: On the arm, world axes, shape (3,) in [N m].
        start: When it begins, in [s] of the world's clock.
        duration: How long it lasts, in [s].
        side: Whose tip; None where the world has only one arm.
    """

    force: Any = (0.0, 0.0, 0.0)
    moment: Any = (0.0, 0.0, 0.0)
    start: float = 0.0
    duration: float = np.inf
    side: Side | None = None

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "force", "moment")
        as_number(self.start, "start")
        if not self.duration > 0.0:
            raise OutOfRange(f"duration is {self.duration}, it must be greater than 0")

    def put_into(self, world: World) -> Actor:
        """Wait for the window."""
        half = 0.5 * world.dt

        def act() -> None:
            if self.start - half < world.t < self.start + self.duration - half:
                _arm_of(world, self.side).push(self.force, self.moment)

        return act


@dataclass(frozen=True, eq=False)
class Spring:
    r"""A spring of no length of its own between the tip and an anchor: :math:`f = k(a - p) - d v`.

    Attributes:
        anchor: Where it pulls the tip to, world axes, shape (3,) in [m].
        stiffness: k in [N/m].
        damping: d in [N s/m].
        side: Whose tip; None where the world has only one arm.
    """

    anchor: Any
    stiffness: float
    damping: float = 0.0
    side: Side | None = None

    def __post_init__(self) -> None:
        lock_vectors(self, 3, "anchor")
        as_number(self.stiffness, "stiffness", least=0.0)
        as_number(self.damping, "damping", least=0.0)

    def force(self, p: Array, v: Array) -> Array:
        """On the arm, for a tip at ``p`` [m] moving at ``v`` [m/s], shape (3,) in [N]."""
        return np.asarray(self.stiffness * (self.anchor - p) - self.damping * v)

    def put_into(self, world: World) -> Actor:
        """Hook it on."""

        def act() -> None:
            arm = _arm_of(world, self.side)
            _, q, dq, *_ = arm.truth()
            p, v = arm.model.pose(q)[:3, 3], arm.model.tip_jacobian(q)[:3] @ dq
            arm.push(self.force(p, v), np.zeros(3))

        return act


def _arm_of(world: World, side: Side | None) -> Pushable:
    arms = [arm for arm in world.arms if side in (None, arm.robot.side)]
    if len(arms) == 1:
        return arms[0]
    if arms:
        raise OutOfRange("this world has two arms: give side='left' or side='right'")
    if not world.arms:
        raise OutOfRange("this world has no arm to push: lk.Arm(world=world) puts one into it")
    raise UnknownName("arm in this world", str(side), [arm.robot.side for arm in world.arms])


def _check_slab(thing: Any) -> None:
    """Size and material of a wall or a table top."""
    lock_vectors(thing, 2, "size")
    lock_vectors(thing, 4, "colour")
    for side in thing.size:
        as_number(side, "size", above=0.0)
    as_number(thing.stiffness, "stiffness", above=0.0)
    as_number(thing.damping, "damping", least=0.0)
    as_number(thing.friction, "friction", least=0.0)


def _build(world: World, thing: Wall | Table) -> None:
    assert world.engine is not None
    material = thing.stiffness, thing.damping, thing.friction
    world.engine.add_box(thing.T_wf, thing.size, *material)
