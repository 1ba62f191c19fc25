"""Runs in which a torque law is right at first and then has one mistake, for students to find."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arm import Arm
from ..control import JointTorque, State
from ..errors import Diverged
from ..log import Log
from ..model import Model
from ..paths import Line, Quintic
from ..plant import Plant
from ..run import run
from ..shapes import Array
from ..trajectory import Chain, Hold, Sample, Trajectory
from .calling import Recipe
from .forms import Choose, RightOrWrong, shown
from .verdict import Difference, Kind

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
SHOWS = 0.003
"""Deviation of a joint from the right run at which the mistake is visible, in [rad]."""


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
        """The run, which is what a function that looks for the cause is given."""
        return self.log()

    def log(self) -> Log:
        """The run, up to the moment when the arm diverges, if it does."""
        return _run(there_and_back(MOVES[self.move]), self.cause, self.onset, self.seed)

    def first_visible(self) -> float:
        """When a joint first deviates by `SHOWS` from the run of the right law, in [s]."""
        wrong, right = self.log(), Bug("", self.move, self.onset, self.seed).log()
        n = min(len(wrong), len(right))
        off = np.abs(wrong.q[:n] - right.q[:n]).max(axis=1) > SHOWS
        return float(wrong.t[np.argmax(off)]) if off.any() else float("inf")


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


CHOICE = Choose(CAUSES)
NEAR = 0.15
"""Tolerance of the time at which a mistake is first visible, in [s]."""


@dataclass(frozen=True)
class Found(RightOrWrong):
    """The judge of a diagnosis of a misbehaving run: the cause and when it is first visible.

    Attributes:
        number: Index of the run, from 0.
    """

    number: int

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the diagnosis is right, or if it is plausible and nothing is expected."""
        try:
            cause, seconds = answer
            seconds = float(seconds)
        except (TypeError, ValueError, OverflowError):
            what = 'a letter and a time in s, such as ("b", 1.25)'
            return Difference(Kind.REFUSED, found=f"it is {shown(answer)}; write {what}")
        if found := CHOICE.problem(cause):
            return Difference(Kind.REFUSED, found=found)
        if expected is None or (cause == expected[0] and abs(seconds - expected[1]) <= NEAR):
            return None
        return Difference(Kind.VALUE, expected=str(expected), found=str(answer))

    def expected(self, arm: Any) -> tuple[str, float]:
        """The right diagnosis for a student's `OwnArm`."""
        bug: Bug = arm.bugs[self.number]
        return bug.cause, bug.first_visible()
