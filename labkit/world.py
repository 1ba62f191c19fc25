"""The world: a physics engine with a clock of its own, and what stands in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Protocol, Self

from . import se3
from .errors import Closed, OutOfRange, TypeMismatch
from .quiet import quiet
from .shapes import Array, as_number, shown

with quiet():
    import pybullet as bullet


Actor = Callable[[], None]
"""Applies forces and motor targets for the next physics step."""


class Thing(Protocol):
    """Something to put into a world: a value that builds itself there."""

    def put_into(self, world: World) -> Actor | None:
        """Build it; what it returns, if anything, acts before each physics step from now on."""


class Pushable(Protocol):
    """An arm, as far as the things around it need to know it."""

    def truth(self) -> Any:
        """The joints as they really are."""

    def push(self, force: Array, moment: Array) -> None:
        """Push the tip during the next physics step."""

    @property
    def robot(self) -> Any:
        """Its names."""

    @property
    def model(self) -> Any:
        """Its equations."""


class Shown(Protocol):
    """Something that cameras see and the physics does not."""

    @property
    def bodies(self) -> Iterable[int]:
        """PyBullet's numbers of what is seen."""

    def update(self) -> None:
        """Put its looks where they belong now."""


class World:
    """One physics world; two of them never share anything.

    Attributes:
        dt: The physics step, in [s].
        steps: How many physics steps were taken.
        client: PyBullet's number of this world, -1 once it is closed.
        things: What was put into it, the arms apart.
        arms: The arms that stand in it.
        shown: What only cameras see.
    """

    client: int = -1

    def __init__(self, dt: float = 1e-3, things: Iterable[Thing] = ()) -> None:
        """Open a world with gravity.

        Args:
            dt: The physics step, in [s].
            things: What to put into it: `Table`, `Wall`, `Spring`, `Push` …
        """
        self.dt = as_number(dt, "dt", above=0.0)
        self.client = bullet.connect(bullet.DIRECT)
        self.steps = 0
        self._actors: list[Actor] = []
        self.things: list[Thing] = []
        self.arms: list[Pushable] = []
        self.shown: list[Shown] = []
        bullet.setTimeStep(self.dt, physicsClientId=self.client)
        bullet.setGravity(0.0, 0.0, -9.81, physicsClientId=self.client)
        # By default the solver stops early, and a motor told to stand still creeps at 0.6 mrad/s.
        bullet.setPhysicsEngineParameter(solverResidualThreshold=0.0, physicsClientId=self.client)
        for thing in things:
            self.put(thing)

    @property
    def t(self) -> float:
        """The time in this world, in [s]."""
        return self.steps * self.dt

    def put(self, thing: Thing) -> None:
        """Put a thing into the world, where it stays.

        Raises:
            Closed: The world is closed.
            TypeMismatch: It cannot be put into a world.
        """
        if self.client < 0:
            raise Closed("this world was closed; make a new World")
        if isinstance(thing, type) or not hasattr(thing, "put_into"):
            raise TypeMismatch(
                f"cannot add {shown(thing)}; expected an object with put_into(), such as "
                "lk.Table() or lk.Wall(...)"
            )
        actor = thing.put_into(self)
        self.things.append(thing)
        if actor is not None:
            self.add(actor)

    def add(self, actor: Actor) -> None:
        """Call ``actor`` before each physics step from now on."""
        self._actors.append(actor)

    def show(self, thing: Shown) -> None:
        """Let ``thing`` be brought up to date before each picture from now on."""
        self.shown.append(thing)

    def add_visual(self, kind: int, **shape: Any) -> int:
        """Put something to be seen into the world, which nothing touches; PyBullet's number."""
        seen = bullet.createVisualShape(kind, physicsClientId=self.client, **shape)
        return int(bullet.createMultiBody(0, -1, seen, physicsClientId=self.client))

    def move_visual(self, body: int, T: Array) -> None:
        """Put a body that is only seen to a pose, shape (4, 4)."""
        turn = se3.quaternion(T[:3, :3]).tolist()
        bullet.resetBasePositionAndOrientation(
            body, T[:3, 3].tolist(), turn, physicsClientId=self.client
        )

    def paint(self, body: int, colour: Iterable[float]) -> None:
        """Show a body in a colour: red, green, blue and opacity, from 0 to 1."""
        bullet.changeVisualShape(body, -1, rgbaColor=list(colour), physicsClientId=self.client)

    def step(self, count: int = 1) -> None:
        """Advance by ``count`` physics steps.

        Raises:
            Closed: The world is closed.
        """
        client = self.client
        if client < 0:
            raise Closed("this world was closed; make a new World, or a new Arm")
        for _ in range(count):
            for act in self._actors:
                act()
            bullet.stepSimulation(client)
            self.steps += 1

    def close(self) -> None:
        """Free the world; closing twice is harmless."""
        if self.client >= 0:
            bullet.disconnect(physicsClientId=self.client)
            self.client = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()


def whole_steps(rate: float, dt: float, name: str) -> int:
    """How many physics steps of ``dt`` [s] a period of ``rate`` [Hz] has; 0 for a rate of 0."""
    if rate == 0.0:
        return 0
    steps = 1.0 / (rate * dt)
    if steps < 0.999 or abs(steps - round(steps)) > 1e-5 * steps:  # as exact as it is shown
        raise OutOfRange(
            f"{name} is {rate:g} Hz: its period is {steps:.3g} physics steps of {dt:g} s, it must "
            f"be a whole number; try {1.0 / (max(1, round(steps)) * dt):g} Hz"
        )
    return round(steps)
