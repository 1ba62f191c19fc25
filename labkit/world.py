"""The world: a clock, the arms and everything else around them."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol, Self

from .errors import Closed, OutOfRange, TypeMismatch
from .shapes import as_number, shown
from .sim import chosen

if TYPE_CHECKING:
    from .arm import Arm


class Thing(Protocol):
    """Something to put into a world, where it acts on the arms."""

    def act(self, world: World) -> None:
        """Act on the arms of ``world`` for the next physics step."""


class World:
    """One physics world; two of them never share anything.

    Attributes:
        dt: The physics step, in [s].
        steps: Number of physics steps taken so far.
        engine: The physics engine that moves its arms, "pybullet" or "mujoco".
        closed: Whether the world has been closed.
        things: The things that were put into it, without the arms.
        arms: The arms that were put into it.
        shown: Things that are visible only to cameras.
        owner: Identifier of the only thread that may step it, such as that of `live`; None is any.
    """

    closed = True
    owner: int | None = None

    def __init__(
        self, dt: float = 1e-3, things: Iterable[Thing] = (), engine: str | None = None
    ) -> None:
        """Open a world with gravity.

        Args:
            dt: The physics step, in [s].
            things: What to put into it: `Table`, `Wall`, `Spring`, `Push` …
            engine: "pybullet" or "mujoco"; None means the environment variable LABKIT_ENGINE if it
                is set, otherwise PyBullet if it is installed, otherwise MuJoCo.

        Raises:
            UnknownName: There is no such engine.
        """
        self.dt = as_number(dt, "dt", above=0.0)
        self.engine = chosen(engine)
        self.steps = 0
        self.things: list[Thing] = []
        self.arms: list[Arm] = []
        self.shown: list[Any] = []
        self.closed = False
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
            TypeMismatch: ``thing`` cannot be put into a world.
        """
        if self.closed:
            raise Closed("this world was closed; make a new World")
        if isinstance(thing, type) or not hasattr(thing, "act"):
            raise TypeMismatch(
                f"cannot add {shown(thing)}; expected an object with act(world), such as "
                "lk.Table() or lk.Wall(...)"
            )
        self.things.append(thing)

    def check_owner(self) -> None:
        """Raise `Closed` if another thread moves this world."""
        if self.owner is not None and self.owner != threading.get_ident():
            raise Closed(
                "this arm is live in a cell of this notebook; make a new Arm, or press Pause there"
            )

    def show(self, thing: Any) -> None:
        """Let cameras see ``thing`` from now on; its method `surface` returns its triangles."""
        self.shown.append(thing)

    def step(self, count: int = 1) -> None:
        """Advance by ``count`` physics steps.

        Raises:
            Closed: The world is closed.
        """
        if self.closed:
            raise Closed("this world was closed; make a new World, or a new Arm")
        self.check_owner()
        for _ in range(count):
            for thing in self.things:
                thing.act(self)
            for arm in self.arms:
                arm.step()
            self.steps += 1

    def close(self) -> None:
        """Free the world; closing twice is harmless."""
        if self.closed:
            return
        self.closed = True
        for arm in self.arms:
            arm.release()

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
    if steps < 0.999 or abs(steps - round(steps)) > 1e-5 * steps:  # as precise as the message
        raise OutOfRange(
            f"{name} is {rate:g} Hz: its period is {steps:.6g} physics steps of {dt:g} s, but must "
            f"be a whole number of them; try {1.0 / (max(1, round(steps)) * dt):g} Hz"
        )
    return round(steps)
