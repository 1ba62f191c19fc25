"""Students' own arms, and runs in which a torque law has one mistake; both follow from a name.

What is marked is a function that measures, on arms and runs that it has not seen.  Nothing here is
secret: who looks into an arm misses the experiment, and is asked in the room.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arm import Arm
from ..control import JointTorque, State
from ..errors import Diverged, OutOfRange
from ..log import Log
from ..model import Model
from ..paths import Line, Quintic
from ..plant import BAXTER, Plant
from ..run import run
from ..scene import TIP_RADIUS, Wall
from ..sensors import TorqueSensors
from ..shapes import Array
from ..trajectory import Chain, Hold, Sample, Trajectory
from ..world import World


class Recipe:
    """An argument that is made anew for each call, such as an arm."""

    def made(self) -> Any:
        """The argument that the function is given."""
        raise NotImplementedError


PLANT = Plant(name="textbook", armature=0.05, viscous=0.7, velocity_noise=0.01)
"""The arm in all these runs; the law compensates its gravity."""
RATE = 200.0
STALE = 12
"""Age of a delayed state, in ticks."""
KP, KD = 60.0, 16.0

CAUSES = {
    "a": "the error of the speed has the wrong sign",
    "b": "gravity is left out",
    "c": "gravity is added twice",
    "d": "the state is 60 ms old",
    "e": "the target is always the last one (index -1)",
    "f": "the target's acceleration is left out",
    "g": "the errors of the joints w0 and w2 are exchanged",
    "h": "the joints' own speed is damped, not the error of the speed",
}
"""The possible mistakes, by letter."""

MOVES = (
    (0.5, 0.3, 0.0, -0.4, 0.3, 0.2, 0.9),
    (-0.4, -0.2, 0.4, 0.5, -0.8, 0.3, -0.5),
    (0.3, -0.3, -0.4, 0.3, 0.5, -0.4, 0.8),
)
"""Displacements from the ready pose, in [rad].

The arm goes there, rests for a quarter of a second and comes back.
"""
ONSETS = (0.3, 0.8)
"""The range of times at which a mistake begins, in [s], while the arm is moving."""
LASTS = 1.2


@dataclass(frozen=True)
class Bug(Recipe):
    """One misbehaving run.

    Attributes:
        cause: A letter of `CAUSES`.
        move: Index into `MOVES`.
        onset: When the mistake enters the law, in [s].
        seed: Seed of the noise.
    """

    cause: str
    move: int
    onset: float
    seed: int

    @classmethod
    def drawn(cls, random: np.random.Generator) -> Bug:
        """A run with any cause, such as for a hidden case."""
        cause, move = random.choice(list(CAUSES)), int(random.integers(len(MOVES)))
        return cls(str(cause), move, float(random.uniform(*ONSETS)), int(random.integers(1000)))

    def made(self) -> Log:
        """The run, up to the moment when the arm diverges, if it does."""
        return _run(there_and_back(MOVES[self.move]), self.cause, self.onset, self.seed)


def there_and_back(move: Any) -> Chain:
    """A target that moves the joints by `move`, rests there and comes back."""
    ready = Model("left", PLANT).robot.ready
    goal = ready + np.asarray(move, dtype=float)
    go, back = Line(ready, goal), Line(goal, ready)
    return Chain(
        [Trajectory(go, Quintic(LASTS)), Hold(goal, 0.25), Trajectory(back, Quintic(LASTS))]
    )


def _run(target: Chain, cause: str, onset: float, seed: int) -> Log:
    model = Model("left", PLANT)
    with Arm("left", PLANT, seed, q0=target(0.0).position) as arm:
        try:
            return run(arm, target, _law(model, target(target.duration), cause, onset), RATE)
        except Diverged as error:
            if not isinstance(error.log, Log):
                raise
            return error.log


def commanded(log: Log, cause: str) -> Array:
    """What computed torque with one mistake would command in the states that a run saw.

    Args:
        log: One of these runs; its move ends where it begins.
        cause: A letter of `CAUSES`; "" is the right law.

    Returns:
        The torques at each tick, shape (N, n) in [N m].
    """
    rows = [Sample(*row) for row in zip(*log.target, strict=True)]
    law = _law(Model("left", PLANT), rows[0], cause, 0.0)
    states = [State(*row) for row in zip(*log.measured, strict=True)]
    return np.array([law(*pair).value for pair in zip(states, rows, strict=True)])


def _law(
    model: Model, last: Sample, cause: str, onset: float
) -> Callable[[State, Sample], JointTorque]:
    """Computed torque, which has one mistake from `onset` on."""
    before: list[State] = []

    def law(state: State, wanted: Sample) -> JointTorque:
        now = cause if state.t >= onset else ""
        before.append(state)
        if now == "d":
            state = before[max(0, len(before) - 1 - STALE)]
        if now == "e":
            wanted = last
        q, dq = state.q, state.dq
        e, de = wanted.position - q, wanted.velocity - dq
        if now == "a":
            de = -de
        elif now == "h":
            de = -dq
        elif now == "g":
            e = _exchanged(e)
        ddq = KP * e + KD * de + (0.0 if now == "f" else wanted.acceleration)
        weights = {"b": 0.0, "c": 2.0}.get(now, 1.0)
        tau = model.mass_matrix(q) @ ddq + model.coriolis(q, dq) @ dq
        return JointTorque(tau + weights * model.gravity(q))

    law.__name__ = "computed torque"
    return law


def _exchanged(e: Array) -> Array:
    e = e.copy()
    e[[4, 6]] = e[[6, 4]]
    return e


DEMO = "demo"
"""The handle of the public arm."""
RANGES = {
    "payload": (0.2, 0.8),
    "stiction": (0.6, 1.6),
    "lag": (0.03, 0.09),
    "wall": (0.04, 0.09),
}
"""The range from which each number of an `OwnArm` is drawn."""


@dataclass(frozen=True)
class OwnArm(Recipe):
    """What distinguishes a student's arm from Baxter's.

    Attributes:
        payload: Point mass at the tip, in [kg].
        stiction: Dry friction of s0, in [N m]; that of the other joints is scaled equally.
        lag: Time constant of the velocity mode, in [s].
        wall: Distance from the resting tip to the wall in front of it, along x, in [m].
    """

    payload: float
    stiction: float
    lag: float
    wall: float

    @property
    def plant(self) -> Plant:
        """The plant of Baxter with these numbers."""
        scale = self.stiction / BAXTER.stiction[0]
        return replace(
            BAXTER,
            name="own",
            payload=self.payload,
            stiction=tuple(scale * x for x in BAXTER.stiction),
            velocity_lag=self.lag,
        )

    @classmethod
    def drawn(cls, random: np.random.Generator) -> OwnArm:
        """An arm with numbers from `RANGES`, such as for a hidden case."""
        payload, stiction, lag, wall = (random.uniform(*ends) for ends in RANGES.values())
        return cls(payload, stiction, lag, wall)

    def made(self, seed: int = 0) -> Arm:
        """The arm, at rest in its ready pose in front of its wall; it reports Baxter's numbers."""
        known = replace(BAXTER, name="own")
        model = Model("left", known)
        tip = model.pose(model.robot.ready)[:3, 3]
        wall = Wall(tip + [self.wall + TIP_RADIUS, 0.0, 0.0], (-1.0, 0.0, 0.0))
        arm = Arm("left", self.plant, seed, q0=model.robot.ready, world=World(things=[wall]))
        # Zeroed with the load in the gripper, or the torque sensors would reveal the load at rest.
        arm._sensors = TorqueSensors(Model("left", self.plant), self.plant, arm.world.dt)
        arm.plant, arm.model = known, model  # what students know of it
        return arm


PUBLIC_ARMS = (
    OwnArm(payload=0.33415, stiction=1.43938, lag=0.0326893, wall=0.0586362),
    OwnArm(payload=0.28682, stiction=1.04221, lag=0.0504176, wall=0.0884370),
)
"""Two arms for public cases of a function that measures; the first is that of `DEMO`."""
PUBLIC_BUGS = (Bug("c", 2, 0.74, 577), Bug("h", 0, 0.53, 291), Bug("f", 1, 0.78, 875))
"""Three misbehaving runs for public cases, which are those of `DEMO`."""


def _random(handle: str) -> np.random.Generator:
    """A generator for a handle, whatever its spelling: composed characters in lower case."""
    spelling = unicodedata.normalize("NFKC", handle).casefold().strip()
    return np.random.default_rng(list(spelling.encode()) or [0])


def my_arm(handle: str = DEMO, seed: int = 0) -> Arm:
    """Your own arm, at rest in its ready pose in front of its wall.

    Args:
        handle: Your name in the course, or your team's; "demo" is a public arm to practise on.
        seed: Seed of the sensors' noise.

    Returns:
        An arm that reports Baxter's parameters; you find out how it differs.
    """
    own = PUBLIC_ARMS[0] if handle == DEMO else OwnArm.drawn(_random(handle))
    return own.made(seed)


def my_bug(number: int, handle: str = DEMO) -> Log:
    """One of your misbehaving runs, in which the law is right only at first.

    Args:
        number: The number of the run, from 1 to 3.
        handle: As for `my_arm`.

    Raises:
        OutOfRange: There is no such run.
    """
    if number not in (1, 2, 3):
        raise OutOfRange(f"the run is {number!r}; choose a run from 1 to 3")
    random = _random(handle)
    causes = random.permutation(list(CAUSES))
    own = [replace(Bug.drawn(random), cause=str(cause)) for cause in causes[:3]]
    return (PUBLIC_BUGS if handle == DEMO else own)[number - 1].made()
