r"""Live: an arm in real time, in a thread of its own that obeys the page and a hand.

It runs the same loop as `run` and reads the messages of the page between two ticks.  Any error
ends the run with a message and leaves the arm at rest.  Pause ends the thread, so that other cells
can use the arm; Start makes a new one.

A hand can pull the arm anywhere.  It is a spring and a damper between a point of a link and a
place in the world, as strong as a person's arm at most,

.. math:: f = k\,(x - p) - d\,\dot p, \qquad |f| \le f_{max}, \qquad \tau = J_p^T f ,

or a constant force at that point.
"""

from __future__ import annotations

import inspect
import re
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import se3
from ..arm import Arm
from ..control import JointTorque
from ..errors import LabkitError, OutOfRange, TypeMismatch, UnknownName
from ..model import Model
from ..plant import EVIDENCE, Plant
from ..robot import SIDES
from ..run import Driven, check_order, name_of, run_driven
from ..shapes import Array, as_array, as_number, shown
from ..trajectory import Hold, PoseSample, Sample, Target
from ..world import World
from .motion import Motion, compact, drawn, drawn_thing, placed
from .player import still

if TYPE_CHECKING:
    from .widgets import Live

STIFFNESS, DAMPING, STRONGEST = 400.0, 12.0, 60.0
"""Of the hand: its spring, in [N/m], its damper, in [N s/m], and its largest force, in [N]."""

STEADY = 1.0
"""Time after the last message about it at which a hand lets go, in [s]."""

LONGEST, ABSENT = 120.0, 60.0
"""Times in [s]: of a run, after which the next one begins where it ended; and without a message
from any page, after which the session pauses."""

FRAME, LATE = 1 / 30, 0.1
"""Time between two pictures, in [s]; a loop that is later than the second goes on from there."""

POINTS = 121
"""Number of points on the drawn path of the target."""

OF_PLANT = {f.name for f in fields(Plant)} - {"name", "fits", "gravity_compensation"}
"""Names of dials that change the plant."""

_SOFT = np.array([300.0] * 3 + [2.0] * 3)  # [N/m] and [N m/rad]
_DAMPED = 15.0  # [1/s]

_LIBRARY = re.compile(f"^{re.escape(str(Path(__file__).parents[1]))}|site-packages")


class Hand:
    """A hand beside an arm, which follows the messages of a page.

    Attributes:
        at: Point at which it holds the arm, world axes, shape (3,) in [m]; None while it holds
            nothing.
        force: Its force in the last physics step, world axes, shape (3,) in [N].
    """

    def __init__(self, arm: Arm) -> None:
        """Make a hand that holds nothing yet; ``arm.world.put(hand)`` puts it beside the arm."""
        self._arm, self.heard = arm, 0.0
        self.let_go()

    def let_go(self) -> None:
        """Let go of the arm."""
        self.at: Array | None = None
        self.force: Array = np.zeros(3)
        self._point: tuple[int, Array] | None = None
        self._to: Array | None = None

    def push(self, body: int, point: Any, force: Any) -> None:
        """Push at a point of a body with a constant force.

        Args:
            body: The body, by the number of its joint; n is the tip's frame.
            point: Point of the body, in the body's frame, shape (3,) in [m].
            force: Force, world axes, shape (3,) in [N].
        """
        self._point = body, as_array(point, (3,), "point")
        self.force = _bounded(as_array(force, (3,), "force"))

    def follow(self, message: Mapping[str, Any]) -> None:
        """Carry out a message: pull the point ``local`` of ``link`` ``to`` a place, or push it."""
        self.let_go()
        self.heard = time.monotonic()
        if "to" in message:
            self._to = as_array(message["to"], (3,), "to")
            self._point = message["link"], as_array(message["local"], (3,), "local")
        elif "force" in message:
            self.push(message["link"], message["local"], message["force"])

    def seen(self) -> dict[str, Any]:
        """The hand's action as plain numbers, for the page to draw."""
        if self.at is None or self._point is None:
            return {"at": None, "force": None, "link": None}
        at, force = self.at.round(4).tolist(), self.force.round(3).tolist()
        return {"at": at, "force": force, "link": self._point[0]}

    def act(self, world: World) -> None:
        """Pull during the next physics step."""
        if self._point is None:
            return
        _, q, dq, _ = self._arm.truth()
        self.at, J = self._arm.model.point_on(q, *self._point)
        if self._to is not None:
            self.force = _bounded(STIFFNESS * (self._to - self.at) - DAMPING * (J @ dq))
        self._arm.pull(J.T @ self.force)


def _bounded(force: Array) -> Array:
    return force * min(1.0, STRONGEST / max(1e-9, float(np.linalg.norm(force))))


class Surroundings:
    """The target and the things of an arm's world, which the page shows and moves.

    Attributes:
        since: The target's time at which the present run began, in [s].
    """

    def __init__(self, arm: Arm, target: Any) -> None:
        """Take the target and the things in the world of ``arm``."""
        self._arm, self._target, self.since = arm, target, 0.0
        duration = getattr(target, "duration", None)
        self._round = duration if duration and _closed(target, duration) else None
        self._latest: Any = target(0.0)

    def target(self, t: float) -> Any:
        """The target; a closed path repeats for ever."""
        t += self.since
        self._latest = self._target(t % self._round if self._round else t)
        return self._latest

    def wanted(self, sample: Any = None) -> Array | None:
        """The desired pose of the tip, shape (4, 4); None if the target is only a point."""
        sample = self._latest if sample is None else sample
        if isinstance(sample, PoseSample):
            return np.asarray(sample.pose)
        if isinstance(sample, Sample) and sample.position.size == self._arm.robot.n:
            return self._arm.model.pose(sample.position)
        return None

    def path(self) -> list[list[float]]:
        """Path of a moving target, in [m]; empty if it is not known in advance."""
        times = np.linspace(0.0, getattr(self._target, "duration", 0.0), POINTS)
        poses = [self.wanted(self._target(t)) for t in times] if times[-1] else []
        places = [T[:3, 3] for T in poses if T is not None]
        moves = bool(places) and np.ptp(places, axis=0).max() > 1e-3
        return np.round(places, 4).tolist() if moves else []

    def seen(self) -> dict[str, Any]:
        """The arm and its surroundings as plain numbers, for the page to draw."""
        arm, T_wd = self._arm, self.wanted()
        most = arm.robot.effort * (1.0 - 1e-9)
        return {
            "t": round(arm.world.t, 4),
            "q": arm.truth().q.round(5).tolist(),
            "error": None if T_wd is None else float(np.linalg.norm(arm.tip()[0] - T_wd[:3, 3])),
            "spent": np.flatnonzero(np.abs(arm.torque) >= most).tolist(),
            "things": self.things(),
        }

    def things(self) -> dict[str, Any]:
        """The things that the page draws, by name."""
        found: dict[str, Any] = {}
        T_wd = self.wanted()
        if T_wd is not None:
            found["target"] = placed("target", T_wd) | {"fixed": True}
        for i, thing in enumerate(self._arm.world.things):
            if data := drawn_thing(thing):
                found[f"thing {i}"] = data | {"fixed": True}
        for i, board in enumerate(self._arm.world.shown):
            if hasattr(board, "T_wm"):
                found[f"tag {i}"] = placed("tag", board.T_wm) | {"size": float(board.tag.paper)}
        return found

    def move(self, name: str, position: Any) -> None:
        """Move a tag so that its middle is at ``position``, shape (3,) in [m]."""
        board = self._arm.world.shown[int(name.removeprefix("tag "))]
        board.place(se3.pose(board.T_wm[:3, :3], as_array(position, (3,), "position")))


def _closed(target: Any, duration: float) -> bool:
    """Whether a target moves and ends where it began."""
    first, middle, last = (target(t)[0] for t in (0.0, 0.5 * duration, duration))
    return bool(np.allclose(first, last, atol=1e-6) and not np.allclose(first, middle, atol=1e-6))


class Law:
    """The selected controller, called with the values of the dials that are among its arguments.

    Attributes:
        name: Name of the selected controller.
        values: Present values of the dials.
    """

    def __init__(self, laws: Mapping[str, Callable[..., Any]], values: Mapping[str, float]) -> None:
        """Select the first controller."""
        self._laws = laws
        own = values.keys() - OF_PLANT
        self._takes = {law: [d for d in arguments(f) if d in own] for law, f in laws.items()}
        self.name, self.values = next(iter(laws)), dict(values)

    @property
    def __name__(self) -> str:
        """The selected controller, for messages."""
        return self.name

    def reset(self) -> None:
        """Let the selected controller forget, if it has a memory; `run_driven` calls this."""
        if reset := getattr(self._laws[self.name], "reset", None):
            reset()

    def __call__(self, state: Any, target: Any) -> Any:
        """The selected controller's command."""
        dials = {d: self.values[d] for d in self._takes[self.name]}
        return self._laws[self.name](state, target, **dials)


def arguments(law: Callable[..., Any]) -> tuple[str, ...]:
    """The names of a controller's arguments."""
    try:
        return tuple(inspect.signature(law).parameters)
    except (TypeError, ValueError):
        return ()


class LiveSession(Driven):
    """An arm, its controllers and a hand; the arm moves in a separate thread until it is paused."""

    def __init__(
        self,
        arm: Arm,
        laws: Mapping[str, Callable[..., Any]],
        target: Any,
        dials: Mapping[str, float],
        rate: float,
        show: Callable[[dict[str, Any]], None],
    ) -> None:
        """Make a session that has not begun; ``show`` receives each picture as numbers."""
        super().__init__(arm, rate)
        self._show, self._q0 = show, arm.truth().q
        self.law, self.around, self.hand = Law(laws, dials), Surroundings(arm, target), Hand(arm)
        self._inbox: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self._thread, self.state, self.note = threading.Thread(), "ready", ""
        self._again, self._began, self._drawn, self._heard, self._late = False, 0.0, 0.0, 0.0, 0.0

    def tell(self, message: dict[str, Any]) -> None:
        """Take a message from the page; while the arm moves, its thread reads it."""
        self._heard = time.monotonic()
        if self.state == "running":
            self._inbox.put(message)
            return
        if self._thread.is_alive():
            self._thread.join(1.0)  # it is ending
        if message.get("kind") == "go":
            self.state, self.note, self._inbox = "running", "", SimpleQueue()
            self._thread = threading.Thread(target=self._main, name="labkit live", daemon=True)
            self._thread.start()
        else:
            self._obey(message)
            self._show(self.numbers())

    def close(self) -> None:
        """Pause, which leaves the arm at rest and free for other cells."""
        self._inbox.put({"kind": "pause"})
        if self._thread.is_alive():
            self._thread.join(2.0)

    def _main(self) -> None:
        world = self.arm.world
        world.put(self.hand)
        world.owner = threading.get_ident()
        try:
            while self.state == "running":  # reset, a dial or another controller begins a new run
                t0, self._again = world.t, False
                self._began = time.monotonic()
                run_driven(self, self.around.target, self.law, LONGEST)
                if not self._again:
                    self.around.since += world.t - t0
        except Exception as error:
            self.arm.recover()
            self.state, self.note = "stopped", sentence(error)
        finally:
            self.hand.let_go()
            world.things.remove(self.hand)  # another session may follow with its own hand
            world.owner = None
            self._show(self.numbers())

    def stop(self) -> None:
        """Stop the arm, unless another run follows immediately."""
        if self.state != "running":
            super().stop()

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Simulate a tick, wait for real time, and obey the page."""
        k, t, cut = super().advance(k)
        now = time.monotonic()
        if now - self.hand.heard > STEADY:
            self.hand.let_go()
        if now - self._drawn > FRAME:
            self._drawn = now
            slow = f"slower than real time: the machine is busy, or {self.law.name} slow"
            self.note = slow if now - self._late < 1.0 else ""
            self._show(self.numbers())
        if now - self._heard > ABSENT:
            self.state, self.note = "ready", "nobody looked for a minute"
        ahead = self._began + t - time.monotonic()
        if ahead < -LATE:
            self._began -= ahead
            self._late = now
        time.sleep(max(0.0, ahead))
        over = False  # obey after the wait, so that the next tick has the newest messages
        while not self._inbox.empty():
            over |= self._obey(self._inbox.get())
        if over or self.state != "running":
            raise KeyboardInterrupt  # as the user does to a run
        return k, t, cut

    def _obey(self, message: Mapping[str, Any]) -> bool:
        """Carry out a message of the page; whether it ends a run."""
        match message.get("kind"):
            case "pause":
                self.state = "ready"
            case "reset":
                self.hand.let_go()
                self.arm.reset(self._q0)
                self.note = ""
                if hasattr(self.around._target, "duration"):  # a tag's target goes on with its tag
                    self.around.since, self._again = 0.0, True
            case "law":
                self.law.name = message["name"]
            case "dial":
                name = message["name"]
                self.law.values[name] = float(message["value"])
                if name in OF_PLANT:
                    number: Any = {name: self.law.values[name]}
                    self.arm.become(replace(self.arm.plant, **number))
            case "hand":
                self.hand.follow(message)
                return False
            case "thing":
                self.around.move(message["name"], message["position"])
                return False
            case _:
                return False
        return True

    def numbers(self) -> dict[str, Any]:
        """The session as the page draws it."""
        frame = {"kind": "frame", "state": self.state, "note": self.note, "law": self.law.name}
        return frame | self.around.seen() | self.hand.seen()


def sentence(error: Exception) -> str:
    """The reason why the arm stopped, with the student's line that caused it."""
    what = str(error)
    if not isinstance(error, LabkitError):
        what = f"{type(error).__name__}: {what}"
    steps = traceback.extract_tb((error.__cause__ or error).__traceback__)
    own = [step.line for step in steps if step.line and not _LIBRARY.search(step.filename)]
    return f"{what} (line: {own[-1]})" if own else what


def live(
    arm: Arm,
    target: Target | None = None,
    controller: Callable[..., Any] | Mapping[str, Callable[..., Any]] | None = None,
    *,
    rate: float = 200.0,
    title: str = "The arm, live",
    **dials: Any,
) -> Live:
    """Show an arm in real time that the user can pull with the mouse, by touch or with keys.

    ``lk.live(lk.Arm("left"))`` is a soft arm to play with.  A tag to drag, which the student's
    own servo follows by the camera's readings::

        readings = lk.TagStream(camera, board.tag, rate=10.0, delay=0.1)
        lk.live(arm, lk.TagTarget(readings, follower), controller, rate=100.0)

    Nothing runs before "Start" is pressed.  While the arm moves it belongs to the cell, and its use
    in other cells raises an error; Pause frees it.  If a controller raises, loses the arm or is too
    slow, the arm is left at rest, and a message beside the picture names the controller.

    Args:
        arm: A simulated arm, preferably one made for this cell; it starts where it is.
        target: As for `run`.  A closed path repeats for ever.  None is the place where the arm is.
            Tags can be dragged.
        controller: As for `run`; or several by name, to switch between.  One that has an argument
            with the name of a dial is given the dial's value there: ``law(state, target, Kp)``.
            None is a spring of 300 N/m from the tip to the target's pose.
        rate: How often the controller is called, in [Hz].
        title: The heading.
        **dials: For each dial a range (low, high) or (low, high, start), and perhaps a unit, as in
            (50.0, 1500.0, 300.0, "N/m").  A number of `Plant`, such as payload, stiction or
            state_delay, changes the arm itself; it starts where the arm has it.

    Returns:
        A view to put last in a cell; ``view.close()`` pauses it.

    Raises:
        TypeMismatch: The arm is not simulated, a controller or the target is not a function, they
            are swapped, or a dial has no range.
        UnknownName: Neither a controller nor the plant has a number of a dial's name.
        OutOfRange: A dial starts outside its range, or the rate does not fit the physics step.
    """
    from .widgets import Live

    if not isinstance(arm, Arm):
        raise TypeMismatch(f"arm is {shown(arm)}, expected a simulated lk.Arm")
    target = Hold(arm.model.pose(arm.truth().q), 1.0) if target is None else target
    controller = _soft(arm.model) if controller is None else controller
    named = controller if isinstance(controller, Mapping) else {name_of(controller): controller}
    check_order(target, *named.values())
    laws = {str(name): law for name, law in named.items()}
    found = [read_dial(name, span, arm.plant, laws) for name, span in dials.items()]
    widget, robot = Live(), arm.robot
    values = {dial["name"]: dial["value"] for dial in found}
    widget.session = LiveSession(arm, laws, target, values, rate, widget.send)
    widget.on_msg(lambda _, message, __: widget.session.tell(message))
    first = widget.session.numbers()
    widget.data = compact(
        {
            "kind": "live",
            "title": title,
            "alt": title,
            "side": robot.name,
            **({} if robot.name in SIDES else {"robot": drawn(robot)}),
            "laws": list(laws),
            "dials": found,
            "joints": [n.removeprefix(f"{robot.name}_") for n in robot.joint_names],
            "first": first,
            "path": widget.session.around.path(),
        }
    )
    widget.words = f"{title}. Run this cell, press Start, and pull the arm with the mouse."
    q = np.array([first["q"]] * 2)
    widget.picture = lambda: still(Motion(robot, np.array([0.0, 1.0]), q))
    return widget


def _soft(model: Model) -> Callable[..., JointTorque]:
    """A spring from the tip to the target's pose; speeds die away as fast in all joints."""

    def soft(state: Any, target: Any) -> JointTorque:
        q, J = state.q, model.tip_jacobian(state.q)
        spring = J.T @ (_SOFT * se3.pose_error(target.pose, model.pose(q)))
        weight = 0.0 if model.plant.gravity_compensation else model.gravity(q)
        return JointTorque(spring - _DAMPED * model.mass_matrix(q) @ state.dq + weight)

    return soft


def read_dial(
    name: str, span: Any, plant: Plant, laws: Mapping[str, Callable[..., Any]]
) -> dict[str, Any]:
    """A dial, from its range (low, high) or (low, high, start), and perhaps a unit.

    Raises:
        TypeMismatch: It has no range.
        OutOfRange: Its start is outside its range.
        UnknownName: It is neither a number of the plant nor an argument of a controller.
    """
    taken = {x for law in laws.values() for x in arguments(law)[2:]}
    if name not in OF_PLANT | taken:
        raise UnknownName("dial", name, sorted(OF_PLANT | taken))
    try:
        usual = EVIDENCE[name].unit if name in EVIDENCE else ""
        *numbers, unit = span if isinstance(span[-1], str) else (*span, usual)
        low, high, *start = (as_number(x, name) for x in numbers)
    except (TypeError, ValueError, LookupError):
        raise TypeMismatch(
            f"the dial {name} is {shown(span)}; give its range, {name}=(low, high) or "
            f"{name}=(low, high, start)"
        ) from None
    value = start[0] if start else low
    if name in OF_PLANT:
        own: Any = getattr(plant, name)
        value = min(max(max(own) if isinstance(own, tuple) else own, low), high)
    if not low <= value <= high or low >= high:
        raise OutOfRange(f"the dial {name} starts at {value:g}, outside {low:g} to {high:g}")
    return {"name": name, "min": low, "max": high, "value": value, "unit": unit}
