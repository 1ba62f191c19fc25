"""Students' own arms, which are drawn from their handles and a key of the term.

Payload, stiction, lag and a wall follow from the HMAC of the handle under the key.  The students'
file holds them as they are: a student who looks misses the experiment, and nobody can tell.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..arm import Arm
from ..control import JointTorque, State
from ..errors import Diverged, LabkitError, OutOfRange
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


FILE = "arms.json"
"""The file of a term's arms, beside each notebook that asks about one's own arm."""
HANDLES = "course_private/handles.json"
"""The file with the key of the arms and the handle of each student, in the course's folder."""
DEMO = "demo"
"""The handle of the public arm, for self-study and for a course without a term."""

RANGES = {
    "payload": (0.2, 0.8),
    "stiction": (0.6, 1.6),
    "lag": (0.03, 0.09),
    "wall": (0.04, 0.09),
}
"""The range from which each number of an `OwnArm` is drawn."""

BUGS = 3
"""The number of misbehaving runs of each arm, of all pairs from `CAUSES` and `MOVES`."""


@dataclass(frozen=True)
class OwnArm(Recipe):
    """What distinguishes a student's arm from Baxter's.

    Attributes:
        payload: Point mass at the tip, in [kg].
        stiction: Dry friction of s0, in [N m]; that of the other joints is scaled equally.
        lag: Time constant of the velocity mode, in [s].
        wall: Distance from the resting tip to the wall in front of it, along x, in [m].
        bugs: Three misbehaving runs, whose causes are to be found.
    """

    payload: float
    stiction: float
    lag: float
    wall: float
    bugs: tuple[Bug, ...] = ()

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


def draw(key: str, handle: str) -> OwnArm:
    """The arm of a handle, whatever its spelling, by HMAC-SHA256 under a key."""
    digest = hmac.new(key.encode(), normalised(handle).encode(), hashlib.sha256).digest()
    shares = (int.from_bytes(digest[8 * k : 8 * k + 8], "big") / 2.0**64 for k in range(4))
    numbers = {
        name: least + share * (most - least)
        for share, (name, (least, most)) in zip(shares, RANGES.items(), strict=True)
    }
    random = np.random.default_rng(list(digest))
    causes = random.choice(list(CAUSES), BUGS, replace=False)
    bugs = (
        Bug(str(cause), int(move), round(float(onset), 2), int(seed))
        for cause, move, onset, seed in zip(
            causes,
            random.integers(len(MOVES), size=BUGS),
            random.uniform(*ONSETS, BUGS),
            random.integers(1000, size=BUGS),
            strict=True,
        )
    )
    return OwnArm(**numbers, bugs=tuple(bugs))


def normalised(handle: str) -> str:
    """A handle in normalised spelling: composed characters in lower case.

    A Mac may decompose "ö" into "o" and two dots, and a keyboard may type letters of full width.
    """
    return unicodedata.normalize("NFKC", handle).casefold().strip()


@dataclass(frozen=True)
class Arms:
    """The arms of the students in a term.

    Attributes:
        key: The term's key for arms; without a term, one that anybody can compute.
        handles: The handle of each student, which may be their team's.
    """

    key: str = ""
    handles: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, course: Path) -> Arms:
        """The arms of the course in a folder; empty if no arms were given out.

        Raises:
            LabkitError: The file is damaged.
        """
        path = course / HANDLES
        if not path.exists():
            return cls()
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
            return cls(str(found["key"]), dict(found["handles"]))
        except (ValueError, KeyError, TypeError):
            raise LabkitError(
                f"{path} is damaged; delete it, and import the list of students again"
            ) from None

    def text(self) -> str:
        """The text of the file that `of` reads."""
        return json.dumps(asdict(self), indent=1, sort_keys=True) + "\n"

    def arm(self, student: str) -> OwnArm | None:
        """A student's arm, or None if the student has no handle."""
        known = {normalised(who): handle for who, handle in self.handles.items()}
        handle = known.get(normalised(student))
        return None if handle is None else draw(self.key, handle)

    def table(self) -> str:
        """The text of the students' `FILE`: each arm by the hash of a student's name.

        The file may lie in a public place, so it is no class list.
        """
        of = {_hashed(who): asdict(draw(self.key, x)) for who, x in sorted(self.handles.items())}
        return json.dumps(of, indent=1) + "\n"


def my_arm(handle: str = DEMO, seed: int = 0) -> Arm:
    """Your own arm, at rest in its ready pose in front of its wall.

    Args:
        handle: Your handle, or your team's; "demo" is a public arm to practise on.
        seed: Seed of the sensors' noise.

    Returns:
        An arm that reports Baxter's parameters; you find out how it differs.

    Raises:
        LabkitError: The file of arms is missing, or does not contain the handle.
    """
    return _own(handle).made(seed)


def my_bug(number: int, handle: str = DEMO) -> Log:
    """One of your misbehaving runs, in which the law is right only at first.

    Args:
        number: The number of the run, from 1 to 3.
        handle: As for `my_arm`.

    Raises:
        OutOfRange: There is no such run.
        LabkitError: As for `my_arm`.
    """
    if number not in range(1, BUGS + 1):
        raise OutOfRange(f"the run is {number!r}; choose a run from 1 to {BUGS}")
    return _own(handle).bugs[number - 1].log()


def public_arm() -> OwnArm:
    """The arm of `DEMO`."""
    return draw("2019", DEMO)


PUBLIC_ARMS = (replace(public_arm(), bugs=()), OwnArm.drawn(np.random.default_rng(2019)))
"""Two arms for public cases of a function that measures; the first is that of `DEMO`."""


def _own(handle: str) -> OwnArm:
    if normalised(handle) == DEMO:
        return public_arm()
    places = (place / FILE for place in (Path.cwd(), *Path.cwd().parents[:2]))
    file = next((place for place in places if place.exists()), None)
    if file is None:
        raise LabkitError(
            f"there is no {FILE} here or in the two folders above; your instructor hands it out "
            f"with the notebooks of your course. To practise, use lk.my_arm({DEMO!r})"
        )
    try:
        found = json.loads(file.read_text(encoding="utf-8")).get(_hashed(handle))
        if found is not None:
            return OwnArm(**found | {"bugs": tuple(Bug(**bug) for bug in found["bugs"])})
    except (AttributeError, KeyError, TypeError, ValueError):
        raise LabkitError(
            f"{file} is damaged; replace it with the {FILE} that your instructor handed out"
        ) from None
    raise LabkitError(
        f"{FILE} has no arm for {handle!r}; write your handle exactly as you were given it"
    )


def _hashed(handle: str) -> str:
    return hashlib.sha256(normalised(handle).encode()).hexdigest()[:16]
