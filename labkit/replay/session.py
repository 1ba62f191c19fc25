"""A live session: one thread that owns the simulator, keeps real time and obeys the page.

The thread runs the same loop as `run` and reads the messages of the page between two ticks.  Any
error ends the run with a message and leaves the arm at rest.
"""

from __future__ import annotations

import inspect
import re
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from pathlib import Path
from queue import Empty, SimpleQueue
from statistics import median
from typing import Any, cast

import numpy as np

from ..arm import Arm
from ..control import JointTorque
from ..errors import Diverged, LabkitError
from ..log import Log
from ..model import Model
from ..plant import Plant
from ..run import Driven, run_driven
from ..shapes import Array
from .hand import Hand
from .surroundings import Surroundings

LONGEST = 120.0
"""Longest duration of a run, in [s]; then the next one begins where it ended."""

ABSENT = 60.0
"""Time without a message from any page after which the session pauses, in [s]."""

STEP = 0.05
"""Time by which the button "Step" advances, in [s]."""

FRAME = 1 / 30
"""Time between two pictures, in [s]."""

LATE = 0.1
"""A loop that is late by more than this, in [s], continues from there without catching up."""

PATIENCE = 1.0
"""A controller that has not returned after this long, in [s], may never return."""

TURN = 5e-4
"""Switch interval of Python's threads while an arm is live, in [s], lest other cells delay it."""

CALLS = 50
"""Number of calls by whose median a controller is judged too slow."""

OF_PLANT = {f.name for f in fields(Plant)} - {"name", "fits", "gravity_compensation"}
"""Names of dials that change the plant."""

_LIBRARY = re.compile(f"^{re.escape(str(Path(__file__).parents[1]))}|site-packages")
_USUAL = sys.getswitchinterval()
_LIMIT = "a run ends after {:g} s; at t = {:.0f} s the next one began, which Keep this run keeps"
_OVER = 10**9  # a tick later than the last of any run


@dataclass(frozen=True)
class Dial:
    """A number that the user can change.

    Attributes:
        name: Name of a number of `Plant`, or of an argument of a controller.
        min: Least value.
        max: Largest value.
        value: Starting value.
        unit: Unit of the values.
    """

    name: str
    min: float
    max: float
    value: float
    unit: str = ""


class Law:
    """The selected controller, called with the values of the dials that are among its arguments.

    Attributes:
        name: Name of the selected controller.
        values: Present values of the dials.
        asked: Latest command of the controller.
        since: Time at which the present call began, by `time.monotonic`; None between two calls.
    """

    asked: Any = None
    since: float | None = None

    def __init__(self, laws: Mapping[str, Callable[..., Any]], dials: Mapping[str, Dial]) -> None:
        """Select the first controller, and set the dials to their starting values."""
        self._laws, self._took = laws, deque[float](maxlen=CALLS)
        own = dials.keys() - OF_PLANT
        self._takes = {law: [d for d in arguments(f) if d in own] for law, f in laws.items()}
        self.name = next(iter(laws))
        self.values = {name: dial.value for name, dial in dials.items()}

    @property
    def __name__(self) -> str:
        """The controller and its dials, for logs and messages."""
        return ", ".join([self.name, *(f"{d} {self.values[d]:g}" for d in self._takes[self.name])])

    def dialled(self, usual: Plant) -> Plant:
        """The usual plant with the values of its dials."""
        numbers: Any = {name: x for name, x in self.values.items() if name in OF_PLANT}
        return replace(usual, **numbers, name=f"{usual.name}, dialled")

    def reset(self) -> None:
        """Let the selected controller forget, if it has a memory; `run_driven` calls this."""
        self._took.clear()
        if reset := getattr(self._laws[self.name], "reset", None):
            reset()

    def __call__(self, state: Any, target: Any) -> Any:
        """The selected controller's command."""
        self.since = began = time.monotonic()
        try:
            dials = {d: self.values[d] for d in self._takes[self.name]}
            self.asked = self._laws[self.name](state, target, **dials)
        finally:
            self.since = None
            self._took.append(time.monotonic() - began)
        return self.asked

    def check_pace(self, period: float) -> None:
        """Raise `LabkitError` if half of the latest calls took longer than a period, in [s]."""
        if len(self._took) == CALLS and median(self._took) > period:
            raise LabkitError(
                f"{self.name} takes {1e3 * median(self._took):.1f} ms, but is called every "
                f"{1e3 * period:g} ms; make it faster, or give live(..., rate=...) a lower rate"
            )


def arguments(law: Callable[..., Any]) -> tuple[str, ...]:
    """The names of a controller's arguments."""
    try:
        return tuple(inspect.signature(law).parameters)
    except (TypeError, ValueError):
        return ()


class Session(Driven):
    """An arm, its controllers and a hand, which run in a separate thread until `close`.

    Attributes:
        logs: The runs that were kept, in order.
    """

    def __init__(
        self,
        arm: Arm,
        laws: Mapping[str, Callable[..., Any]],
        target: Any,
        dials: Mapping[str, Dial],
        rate: float,
        show: Callable[[dict[str, Any]], None],
    ) -> None:
        """Make a session that has not begun; ``show`` receives each picture as numbers."""
        super().__init__(arm, rate)
        self.arm, self._show = arm, show
        self.law, self.around = Law(laws, dials), Surroundings(arm, target)
        self.hand, self._pull, self._thread = Hand(arm), Pull(arm), threading.Thread()
        self._usual, self._q0 = arm.plant, arm.truth().q.copy()
        self._inbox: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self.logs, self.state, self.note = list[Log](), "ready", ""
        self._within = self._keep = self._over = self._again = False  # of a run
        self._steps_left, self._heard, self._limit = 0, 0.0, ""
        self._changes: list[Callable[[], Any]] = []
        self._began, self._move = 0.0, 0  # of the run in real time; of the hand in the last picture
        self._pictures = deque([(0.0, 0.0)], maxlen=30)  # when, and what time it was in the world

    # From any thread

    def tell(self, message: dict[str, Any]) -> None:
        """Take a message from the page; the thread reads it before its next tick."""
        if message.get("kind") in (None, "files"):  # not meant for the arm
            return
        if self.state == "closed" and self._thread.is_alive():
            self._thread.join(2 * PATIENCE)  # it is ending and reads no more messages
        self._heard = time.monotonic()
        self._inbox.put({**message, "heard": self._heard})
        if self._thread.is_alive():
            if self.law.since and self._heard - self.law.since > PATIENCE:
                note = f"{self.law.name} has not returned; does every loop in it end?"
                self._show({"kind": "note", "note": f"{note} Choose Kernel, Restart Kernel"})
        elif message["kind"] in ("go", "step"):
            self._thread = threading.Thread(target=self._main, name="labkit live", daemon=True)
            self._thread.start()
        else:
            self._obey()
            self._change()
            self._picture()

    def close(self) -> None:
        """End the session, which leaves the arm at rest and free for other cells."""
        self._inbox.put({"kind": "close"})
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(2 * PATIENCE)

    # In the thread

    def _main(self) -> None:
        world = self.arm.world
        world.put(self.hand)
        world.owner, self.state = threading.get_ident(), "ready"
        sys.setswitchinterval(TURN)
        try:
            while self.state != "closed":
                self._one_run()
            self._picture()
        finally:
            sys.setswitchinterval(_USUAL)
            world.things.remove(self.hand)  # another session may follow with its own hand
            self.arm.become(self._usual)
            world.owner = None

    def _one_run(self) -> None:
        """Run until something ends the run: a dial, another controller, "keep" or an error."""
        self._change()
        self._obey(wait=self.state != "running")
        if self._changes or self.state != "running":
            return
        self._within, self._over, self._again, self._keep = True, False, False, False
        self.plant, self._began = self.arm.plant, time.monotonic()
        self.around.begin_run()
        try:
            log = run_driven(self, self.around.target, self.law, LONGEST)
        except Exception as error:
            if self.state != "closed":
                self._rest(error)
            return
        finally:
            self._within = False
        self._limit = "" if self._over else _LIMIT.format(LONGEST, self.arm.world.t)
        self.around.go_on(0.0 if self._again else float(log.t[-1]))
        if self._keep:
            self.logs.append(log)
            self._picture()

    def _change(self) -> None:
        """Apply the pending changes between two runs."""
        if self._changes:
            for change in self._changes:
                change()
            self._changes.clear()
            self._picture()

    def _rest(self, error: Exception) -> None:
        """Bring the arm to rest and say why."""
        self.hand.let_go()
        self.arm.recover()
        if isinstance(error, Diverged):
            self.logs.append(cast(Log, error.log))
        self.state, self.note = "stopped", sentence(error)
        self._picture()

    def begin(self) -> float:
        """Begin a run; the time since then."""
        self._pull.begin()
        return 0.0

    def stop(self) -> None:
        """Stop the arm, unless another run follows immediately."""
        if self.state != "running":
            super().stop()

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Simulate a tick, wait for real time, and read the messages of the page."""
        self.law.check_pace(self.period)
        self.hand.tire()
        self.around.approach(self.period)
        k, t, cut = super().advance(k)
        if self._steps_left:
            self._steps_left -= 1
            self.state = "running" if self._steps_left else "paused"
        self._pace(t)
        self._obey()  # after the wait, so that the next tick has the newest messages
        while self.state == "paused" and not self._over:
            self._picture()
            self._obey(wait=True)
            self._began = time.monotonic() - t
        return (_OVER if self._over or self.state != "running" else k), t, cut

    def _pace(self, t: float) -> None:
        """Show a picture if one is due, then wait for real time."""
        now = time.monotonic()
        if now - self._heard > ABSENT:
            self.state, self.note = "paused", "nobody looked for a minute"
        if self.hand.move != self._move or now - self._pictures[-1][0] > FRAME:
            self._move = self.hand.move
            self._pictures.append((now, self.arm.world.t))
            self._picture()
        ahead = self._began + t - time.monotonic()
        if ahead < -LATE:
            self._began -= ahead
        time.sleep(max(0.0, ahead))

    def _obey(self, wait: bool = False) -> None:
        """Carry out the messages of the page; with `wait`, wait for at least one."""
        with suppress(Empty):
            while True:
                message = self._inbox.get(wait, ABSENT if wait else None)
                getattr(self, f"_on_{message['kind']}", lambda message: None)(message)
                wait = False

    def _on_go(self, message: dict[str, Any]) -> None:
        self.state, self.note, self._limit, self._steps_left = "running", "", "", 0
        self._pictures = deque([(time.monotonic(), self.arm.world.t)], maxlen=30)

    def _on_pause(self, message: dict[str, Any]) -> None:
        self.state = "paused" if self.state == "running" else self.state

    def _on_step(self, message: dict[str, Any]) -> None:
        self._on_go(message)
        self._steps_left = max(1, round(STEP / self.period))

    def _on_reset(self, message: dict[str, Any]) -> None:
        self.hand.let_go()
        self.arm.reset(self._q0)
        self.around.begin_again()
        self._over, self._again, self.note = True, True, ""
        self.state = "running" if self.state == "running" else "ready"
        self._picture()

    def _on_keep(self, message: dict[str, Any]) -> None:
        if self._within:
            self._keep = self._over = True
        else:
            self.note = self.note or "there is no run to keep: press Start or Step first"
            self._picture()

    def _on_close(self, message: dict[str, Any]) -> None:
        self.hand.let_go()
        self.state, self.note = "closed", "ended: other cells can use the arm; Start begins again"

    def _on_hand(self, message: dict[str, Any]) -> None:
        self.hand.follow(message)

    def _on_thing(self, message: dict[str, Any]) -> None:
        self.around.move(message["name"], message["position"])

    def _on_law(self, message: dict[str, Any]) -> None:
        self._after(lambda: setattr(self.law, "name", message["name"]))

    def _on_dial(self, message: dict[str, Any]) -> None:
        self._after(lambda: self._turn(message["name"], float(message["value"])))

    def _after(self, change: Callable[[], Any]) -> None:
        """Apply a change after the present run, because a run has one controller and one plant."""
        self._changes.append(change)
        self._over = True

    def _turn(self, name: str, value: float) -> None:
        self.law.values[name] = value
        if name in OF_PLANT:
            self.arm.become(self.law.dialled(self._usual))

    # What the page draws

    def _picture(self) -> None:
        if self.state == "running":
            said = self._pull.look(self.law.asked, self.around.wanted(), self.hand.at is None)
            self.note = f"{self.law.name} {said}" if said else self._limit
        self._show(self.numbers())

    def numbers(self) -> dict[str, Any]:
        """The session as the page draws it."""
        (a, x), (b, y) = self._pictures[0], self._pictures[-1]
        return {
            "kind": "frame", "state": self.state, "note": self.note, "law": self.law.name,
            "pace": round((y - x) / (b - a), 3) if b > a else None,
            "kept": [round(float(log.t[-1]), 1) for log in self.logs],
            "move": self.hand.move, **self.around.seen(), **self.hand.seen(),
        }  # fmt: skip


def sentence(error: Exception) -> str:
    """The reason why the arm stopped, with the student's line that caused it."""
    what = str(error).replace("error.log", "view.log")
    if not isinstance(error, LabkitError):
        what = f"{type(error).__name__}: {what}"
    steps = traceback.extract_tb((error.__cause__ or error).__traceback__)
    own = [step.line for step in steps if step.line and not _LIBRARY.search(step.filename)]
    return f"{what} (line: {own[-1]})" if own else what


FAR = 0.05
"""Distance of the tip from the target up to which a controller is not judged, in [m]."""

LOOKS = 10
"""Number of consecutive checks, made 30 times a second, that are judged together."""

WEAK = 2.0
"""A pull smaller than this, in [N], has no usable direction."""

_SAYS = {
    1: "pulls the arm away from its target; check the signs of its spring and its damper",
    2: "pulls along the error as the tool's axes have it; are the error and the Jacobian in the "
    "same axes?",
    3: "pulls towards its target, but the arm's weight pulls it elsewhere; does it add gravity?",
}
_RIGHT, _CLEAR = 0.7, 0.85  # cosines


class Pull:
    """Checks the direction of a controller's pull repeatedly."""

    def __init__(self, arm: Arm) -> None:
        """Prepare to check the controller that drives ``arm``."""
        self._arm = arm
        self.begin()

    def begin(self) -> None:
        """Start again, for another controller or another run."""
        self._looks: deque[list[float]] = deque(maxlen=LOOKS)
        self._said = ""

    def look(self, asked: Any, T_wd: Array | None, alone: bool) -> str:
        """Say what is wrong with the controller once that is clear, otherwise nothing.

        Args:
            asked: The controller's latest command; only torques have a pull.
            T_wd: Desired pose of the tip, shape (4, 4), if it is known.
            alone: Whether no hand is pulling as well.
        """
        if T_wd is None or not alone or not isinstance(asked, JointTorque):
            self._looks.clear()
            return self._said
        arm, q, tau = self._arm, self._arm.truth().q, asked.value
        way = T_wd[:3, 3] - arm.tip()[0]
        if np.linalg.norm(way) < FAR:
            self.begin()
            return ""
        g = arm.model.gravity(q)
        felt = tip_force(arm.model, q, tau if arm.plant.gravity_compensation else tau - g)
        in_tool = arm.model.pose(q)[:3, :3].T @ way
        ways = [(felt, way), (felt, -way), (felt, in_tool), (tip_force(arm.model, q, tau), way)]
        self._looks.append([_cosine(force, along) for force, along in ways])
        likely = np.mean(self._looks, axis=0)
        best = int(likely[1:].argmax()) + 1
        if len(self._looks) == LOOKS and likely[0] < _RIGHT and likely[best] > _CLEAR:
            self._said = self._said or _SAYS[best]
        return self._said


def tip_force(model: Model, q: Array, torque: Array) -> Array:
    """The force at the tip that is equivalent to joint torques, world axes, shape (3,) in [N]."""
    return np.asarray(np.linalg.lstsq(model.tip_jacobian(q).T, torque, rcond=1e-3)[0][:3])


def _cosine(force: Array, way: Array) -> float:
    size = float(np.linalg.norm(force))
    return 0.0 if size < WEAK else float(force @ way) / (size * float(np.linalg.norm(way)))
