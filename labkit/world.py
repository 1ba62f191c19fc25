"""The world: a physics engine with a clock of its own, and what stands in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Protocol, Self

from .errors import Closed, OutOfRange, TypeMismatch
from .shapes import Array, as_number, shown
from .sim.engine import Engine
from .sim.pybullet import PyBullet

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

    def surface(self) -> Any:
        """Its triangles where it is now, a `labkit.tags.surface.Surface`."""


class World:
    """One physics world; two of them never share anything.

    Attributes:
        dt: The physics step, in [s].
        steps: How many physics steps were taken.
        engine: What integrates the motion.
        things: What was put into it, the arms apart.
        arms: The arms that stand in it.
        shown: What only cameras see.
    """

    engine: Engine | None = None

    def __init__(self, dt: float = 1e-3, things: Iterable[Thing] = ()) -> None:
        """Open a world with gravity.

        Args:
            dt: The physics step, in [s].
            things: What to put into it: `Table`, `Wall`, `Spring`, `Push` …
        """
        self.dt = as_number(dt, "dt", above=0.0)
        self.engine = PyBullet(self.dt)
        self.steps = 0
        self._actors: list[Actor] = []
        self.things: list[Thing] = []
        self.arms: list[Pushable] = []
        self.shown: list[Shown] = []
        for thing in things:
            self.put(thing)

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self.engine is None

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
        if self.closed:
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
        """Let cameras see ``thing`` from now on."""
        self.shown.append(thing)

    def step(self, count: int = 1) -> None:
        """Advance by ``count`` physics steps.

        Raises:
            Closed: The world is closed.
        """
        engine = self.engine
        if engine is None:
            raise Closed("this world was closed; make a new World, or a new Arm")
        for _ in range(count):
            for act in self._actors:
                act()
            engine.step()
            self.steps += 1

    def close(self) -> None:
        """Free the world; closing twice is harmless."""
        if self.engine is not None:
            self.engine.close()
        self.engine = None

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
