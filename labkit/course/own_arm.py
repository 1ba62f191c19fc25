"""An arm of one's own: no two handles have the same one; who knows the secret draws it again.

Payload, stiction, lag and a wall follow from the HMAC of the handle under the term's secret.  What
students get holds each arm as a sealed text, so that nobody reads a number by accident.  A
student who unseals it has missed the experiment, and the grader cannot tell.
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
"""The sealed arms of a term, beside each notebook that asks about one's own arm."""
HANDLES = "course_private/handles.json"
"""The term's seed and the handle of each student, in the course's folder."""
DEMO = "demo"
"""The handle of the public arm, for self-study and for a course without a term."""

RANGES = {
    "payload": (0.2, 0.8),
    "stiction": (0.6, 1.6),
    "lag": (0.03, 0.09),
    "wall": (0.04, 0.09),
}
"""From where to where each number is drawn; below `OwnArm` says what it is."""

APART = {"payload": 0.15, "stiction": 0.1, "lag": 0.00625, "wall": 0.005}
"""How far from the public arm's numbers those of any other arm lie; a measurement of the public
arm is then wrong everywhere else.  Where a number is asked for, it is 1.25 tolerances."""

BUGS = 3
"""The number of misbehaving runs that each arm has, of `CAUSES` times `MOVES`."""
ONSETS = (0.3, 0.8)
"""In which part of a run the mistake comes in, in [s], while the arm is under way."""


@dataclass(frozen=True)
class OwnArm:
    """What is particular about somebody's arm; the rest is Baxter's.

    Attributes:
        payload: Point mass at the tip, in [kg].
        stiction: Dry friction of s0, in [N m]; that of the other joints is scaled alike.
        lag: Time constant of the velocity mode, in [s].
        wall: Distance from the resting tip to the wall in front of it, along x, in [m].
        bugs: Three misbehaving runs to find the cause of.
    """

    payload: float
    stiction: float
    lag: float
    wall: float
    bugs: tuple[Bug, ...] = ()

    @property
    def plant(self) -> Plant:
        """Baxter with these numbers."""
        scale = self.stiction / BAXTER.stiction[0]
        return replace(
            BAXTER,
            name="own",
            payload=self.payload,
            stiction=tuple(scale * x for x in BAXTER.stiction),
            velocity_lag=self.lag,
        )


def draw(secret: int, handle: str) -> OwnArm:
    """The arm of a handle, in any spelling of it, by HMAC-SHA256 under the term's secret."""
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
    """A number at a share of its range, from which those near the public arm's are cut out."""
    least, most = RANGES[name]
    if public is None:
        return least + share * (most - least)
    middle: float = getattr(public, name)
    cut = max(middle - APART[name], least), min(middle + APART[name], most)
    number = least + share * (most - least - (cut[1] - cut[0]))
    return number if number < cut[0] else number + (cut[1] - cut[0])


def normalised(handle: str) -> str:
    """A handle in the one spelling by which it is known: composed, in small letters.

    A Mac may take "ö" apart into "o" and two dots, and a keyboard may type letters of full width.
    """
    return unicodedata.normalize("NFKC", handle).casefold().strip()


@dataclass(frozen=True)
class Arms:
    """Whose arm is whose in a term.

    Attributes:
        secret: The term's seed.
        handles: By student: their own handle, or their team's.
    """

    secret: int = PUBLIC_SEED
    handles: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, course: Path) -> Arms:
        """Those of the course in a folder; of nobody where no arms were given out.

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
        """What `of` reads."""
        return json.dumps(asdict(self), indent=1, sort_keys=True) + "\n"

    def arm(self, student: str) -> OwnArm | None:
        """A student's arm, or None."""
        known = {normalised(who): handle for who, handle in self.handles.items()}
        handle = known.get(normalised(student))
        return None if handle is None else draw(self.secret, handle)

    def sealed(self) -> dict[str, str]:
        """What students get, for `FILE`: each opens it by the name of their folder."""
        of = {who: draw(self.secret, handle) for who, handle in sorted(self.handles.items())}
        return {_hashed(who): _seal(arm, who) for who, arm in of.items()}


def my_arm(handle: str = DEMO, seed: int = 0) -> Arm:
    """Your own arm, at rest in its ready pose before its wall.

    Args:
        handle: Yours, or your team's; "demo" is a public arm to practise on.
        seed: Of the noise of its sensors.

    Returns:
        An arm that calls itself Baxter's; what is particular about it is for you to find out.

    Raises:
        LabkitError: The file of arms is not there, or does not know the handle.
    """
    own = _own(handle)
    known = replace(BAXTER, name="own")
    model = Model("left", known)
    tip = model.pose(model.robot.ready)[:3, 3]
    wall = Wall(tip + [own.wall + TIP_RADIUS, 0.0, 0.0], (-1.0, 0.0, 0.0))
    arm = Arm("left", own.plant, seed, q0=model.robot.ready, world=World(things=[wall]))
    # Zeroed with the load in the gripper, or its torque sensors would tell it at rest.
    arm._sensors = TorqueSensors(Model("left", own.plant), own.plant, arm.world.dt)
    arm.plant, arm.model = known, model  # what is known of it
    return arm


def my_bug(number: int, handle: str = DEMO) -> Log:
    """One of your misbehaving runs: a law that was right at first.

    Args:
        number: From 1 to 3.
        handle: As for `my_arm`.

    Raises:
        OutOfRange: There is no such run.
        LabkitError: As for `my_arm`.
    """
    if number not in range(1, BUGS + 1):
        raise OutOfRange(f"there are the runs 1 to {BUGS}, and no run {number!r}")
    return _own(handle).bugs[number - 1].log()


def _own(handle: str) -> OwnArm:
    return draw(PUBLIC_SEED, DEMO) if normalised(handle) == DEMO else _unsealed(handle)


def arms_for(folder: Path) -> Path | None:
    """The file of sealed arms that a notebook in a folder opens, if there is one."""
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
            f"with the notebooks of your course. To practise, take lk.my_arm({DEMO!r})"
        )
    try:
        text = json.loads(file.read_text(encoding="utf-8")).get(_hashed(handle))
        if text is not None:
            sealed = json.loads(_masked(base64.b64decode(text), handle))
            return OwnArm(**sealed | {"bugs": tuple(Bug(**bug) for bug in sealed["bugs"])})
    except (AttributeError, KeyError, TypeError, ValueError):
        raise LabkitError(
            f"{file} is damaged; put the {FILE} that your instructor handed out in its place"
        ) from None
    raise LabkitError(
        f"{FILE} has no arm for {handle!r}; write your handle as your course gave it to you"
    )


def _hashed(handle: str) -> str:
    return hashlib.sha256(normalised(handle).encode()).hexdigest()[:16]


def _seal(arm: OwnArm, handle: str) -> str:
    return base64.b64encode(_masked(json.dumps(asdict(arm)).encode(), handle)).decode()


def _masked(data: bytes, handle: str) -> bytes:
    """The data with a stream of bytes laid over it, which the handle starts; twice is once."""
    stream = np.random.default_rng(list(normalised(handle).encode())).bytes(len(data))
    return bytes(a ^ b for a, b in zip(data, stream, strict=True))
