"""Students' own arms, which are drawn from their handles and the secret of the term.

Payload, stiction, lag and a wall follow from the HMAC of the handle under the term's secret.  The
students' file holds each arm as a sealed text, so that nobody reads a number by accident.  A
student who unseals it misses the experiment, and the grader cannot detect this.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from ..arm import Arm
from ..errors import LabkitError, OutOfRange
from ..log import Log
from ..model import Model
from ..plant import BAXTER, Plant
from ..scene import TIP_RADIUS, Wall
from ..sensors import TorqueSensors
from ..world import World
from .bugs import CAUSES, MOVES, Bug
from .seed import PUBLIC_SEED

FILE = "arms.json"
"""The file of a term's sealed arms, beside each notebook that asks about one's own arm."""
HANDLES = "course_private/handles.json"
"""The file with the term's seed and the handle of each student, in the course's folder."""
DEMO = "demo"
"""The handle of the public arm, for self-study and for a course without a term."""

RANGES = {
    "payload": (0.2, 0.8),
    "stiction": (0.6, 1.6),
    "lag": (0.03, 0.09),
    "wall": (0.04, 0.09),
}
"""The range from which each number is drawn; `OwnArm` explains the numbers."""

APART = {"payload": 0.15, "stiction": 0.1, "lag": 0.00625, "wall": 0.005}
"""Smallest difference between a number of the public arm and that of any other arm.

A measurement of the public arm is therefore wrong for every other arm.  For a number that students
measure, the difference is 1.25 tolerances.
"""

BUGS = 3
"""The number of misbehaving runs of each arm, of all pairs from `CAUSES` and `MOVES`."""
ONSETS = (0.3, 0.8)
"""The range of times at which a mistake begins, in [s], while the arm is moving."""


@dataclass(frozen=True)
class OwnArm:
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


def draw(secret: int, handle: str) -> OwnArm:
    """The arm of a handle, whatever its spelling, by HMAC-SHA256 under the term's secret."""
    handle = normalised(handle)
    digest = hmac.new(str(secret).encode(), handle.encode(), hashlib.sha256).digest()
    shares = (int.from_bytes(digest[8 * k : 8 * k + 8], "big") / 2.0**64 for k in range(4))
    public = None if handle == DEMO else draw(PUBLIC_SEED, DEMO)
    numbers = (_number(name, x, public) for name, x in zip(RANGES, shares, strict=True))
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
    payload, stiction, lag, wall = numbers
    return OwnArm(payload, stiction, lag, wall, tuple(bugs))


def _number(name: str, share: float, public: OwnArm | None) -> float:
    """The number at a share of its range, without the part of the range near the public arm."""
    least, most = RANGES[name]
    if public is None:
        return least + share * (most - least)
    middle: float = getattr(public, name)
    cut = max(middle - APART[name], least), min(middle + APART[name], most)
    number = least + share * (most - least - (cut[1] - cut[0]))
    return number if number < cut[0] else number + (cut[1] - cut[0])


def normalised(handle: str) -> str:
    """A handle in normalised spelling: composed characters in lower case.

    A Mac may decompose "ö" into "o" and two dots, and a keyboard may type letters of full width.
    """
    return unicodedata.normalize("NFKC", handle).casefold().strip()


@dataclass(frozen=True)
class Arms:
    """The arms of the students in a term.

    Attributes:
        secret: The term's seed.
        handles: The handle of each student, which may be their team's.
    """

    secret: int = PUBLIC_SEED
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
            return cls(int(found["secret"]), dict(found["handles"]))
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
        return None if handle is None else draw(self.secret, handle)

    def sealed(self) -> dict[str, str]:
        """The content of the students' `FILE`, in which each student's name opens one arm."""
        of = {who: draw(self.secret, handle) for who, handle in sorted(self.handles.items())}
        return {_hashed(who): _seal(arm, who) for who, arm in of.items()}


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
    own = _own(handle)
    known = replace(BAXTER, name="own")
    model = Model("left", known)
    tip = model.pose(model.robot.ready)[:3, 3]
    wall = Wall(tip + [own.wall + TIP_RADIUS, 0.0, 0.0], (-1.0, 0.0, 0.0))
    arm = Arm("left", own.plant, seed, q0=model.robot.ready, world=World(things=[wall]))
    # Zeroed with the load in the gripper, or the torque sensors would reveal the load at rest.
    arm._sensors = TorqueSensors(Model("left", own.plant), own.plant, arm.world.dt)
    arm.plant, arm.model = known, model  # what students know of it
    return arm


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


def _own(handle: str) -> OwnArm:
    return draw(PUBLIC_SEED, DEMO) if normalised(handle) == DEMO else _unsealed(handle)


def arms_for(folder: Path) -> Path | None:
    """The file of sealed arms that a notebook in a folder uses, or None."""
    files = (place / FILE for place in (folder, *folder.parents[:2]))
    return next((file for file in files if file.exists()), None)


def opens_the_public_arm(cells: Iterable[str]) -> bool:
    """Whether the HANDLE that a notebook's cells set last is that of the public arm."""
    said = re.findall(r"^HANDLE\s*=\s*(['\"])(.*?)\1", "\n".join(cells), re.MULTILINE)
    return bool(said) and normalised(said[-1][1]) == DEMO


def _unsealed(handle: str) -> OwnArm:
    file = arms_for(Path.cwd())
    if file is None:
        raise LabkitError(
            f"there is no {FILE} here or in the two folders above; your instructor hands it out "
            f"with the notebooks of your course. To practise, use lk.my_arm({DEMO!r})"
        )
    try:
        text = json.loads(file.read_text(encoding="utf-8")).get(_hashed(handle))
        if text is not None:
            sealed = json.loads(_masked(base64.b64decode(text), handle))
            return OwnArm(**sealed | {"bugs": tuple(Bug(**bug) for bug in sealed["bugs"])})
    except (AttributeError, KeyError, TypeError, ValueError):
        raise LabkitError(
            f"{file} is damaged; replace it with the {FILE} that your instructor handed out"
        ) from None
    raise LabkitError(
        f"{FILE} has no arm for {handle!r}; write your handle exactly as you were given it"
    )


def _hashed(handle: str) -> str:
    return hashlib.sha256(normalised(handle).encode()).hexdigest()[:16]


def _seal(arm: OwnArm, handle: str) -> str:
    return base64.b64encode(_masked(json.dumps(asdict(arm)).encode(), handle)).decode()


def _masked(data: bytes, handle: str) -> bytes:
    """The data combined by XOR with pseudo-random bytes from the handle; twice restores it."""
    stream = np.random.default_rng(list(normalised(handle).encode())).bytes(len(data))
    return bytes(a ^ b for a, b in zip(data, stream, strict=True))
