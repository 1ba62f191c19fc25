"""A live session: one thread that owns the simulator and keeps real time.

The thread runs the same loop as `run` and reads the messages of the page between two ticks.  Any
error ends the run with a message and leaves the arm at rest.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import Any, cast

from ..arm import Arm
from ..arm_adapters import Simulated
from ..errors import Diverged
from ..log import Log
from ..run import run_driven
from .dials import Dial, Dialled
from .hand import Hand
from .pacer import Pacer
from .pull import Pull
from .surroundings import Surroundings
from .watch import PATIENCE, Watch, sentence

LONGEST = 120.0
"""Longest duration of a run, in [s]; then the next one begins where it ended."""

ABSENT = 60.0
"""Time without a message from any page after which the session pauses, in [s]."""

STEP = 0.05
"""Time by which the button "Step" advances, in [s]."""

_OVER = 10**9  # a tick later than the last of any run

_LIMIT = "a run ends after {:g} s; at t = {:.0f} s the next one began, which Keep this run keeps"


class Session(Simulated):
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
        self._law, self.around = Dialled(laws, dials), Surroundings(arm, target)
        self._hand, self._pull, self._thread = Hand(arm), Pull(arm), threading.Thread()
        self._usual, self._q0 = arm.plant, arm.truth().q.copy()
        self._inbox: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self.logs, self.state, self.note = list[Log](), "ready", ""
        self._within = self._keep = self._over = self._again = False  # of a run
        self._steps_left, self._heard, self._limit = 0, 0.0, ""
        self._changes: list[Callable[[], Any]] = []
        self._watch = Watch(self.period, lambda note: show({"kind": "note", "note": note}))
        self._clock = Pacer()

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
            return
        if message["kind"] in ("go", "step"):
            self._thread = threading.Thread(target=self._main, name="labkit live", daemon=True)
            self._thread.start()
            self._watch.over(self._thread)
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
        world.put(self._hand)
        world.owner, self.state = threading.get_ident(), "ready"
        try:
            while self.state != "closed":
                self._one_run()
            self._picture()
        finally:
            world.things.remove(self._hand)  # another session may follow with its own hand
            self.arm.become(self._usual)
            world.owner = None

    def _one_run(self) -> None:
        """Run until something ends the run: a dial, another controller, "keep" or an error."""
        self._change()
        self._obey(wait=self.state != "running")
        if self._changes or self.state != "running":
            return
        self._within, self._over, self._again, self._keep = True, False, False, False
        self.plant = self.arm.plant
        self._clock.set(0.0)
        self.around.begin_run()
        try:
            log = run_driven(self, self.around.target, self._law, LONGEST)
        except BaseException as error:
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

    def _rest(self, error: BaseException) -> None:
        """Bring the arm to rest and say why."""
        self._hand.let_go()
        self.arm.recover()
        if isinstance(error, Diverged):
            self.logs.append(cast(Log, error.log))
        self.state, self.note = "stopped", sentence(error, self._law.name)
        self._picture()

    def begin(self) -> float:
        """Begin a run; the time since then."""
        self._pull.begin()
        self._watch.begins(self._law.name)
        return 0.0

    def stop(self) -> None:
        """Stop the arm, unless another run follows immediately."""
        self._watch.ends()
        if self.state != "running":
            super().stop()

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Simulate a tick, wait for real time, and read the messages of the page."""
        self._watch.ends()
        self._watch.check_pace()
        self._hand.tire()
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
            self._clock.set(t)
        self._watch.begins(self._law.name)
        return (_OVER if self._over or self.state != "running" else k), t, cut

    def _pace(self, t: float) -> None:
        """Wait for real time, and show a picture if one is due."""
        if time.monotonic() - self._heard > ABSENT:
            self.state, self.note = "paused", "nobody looked for a minute"
        if self._clock.is_due(self._hand.move):
            self._clock.shown(self.arm.world.t, self._hand.move)
            self._picture()
        time.sleep(max(0.0, self._clock.ahead(t)))

    def _obey(self, wait: bool = False) -> None:
        """Carry out the messages of the page; with `wait`, wait for at least one."""
        with suppress(Empty):
            while True:
                message = self._inbox.get(wait, ABSENT if wait else None)
                getattr(self, f"_on_{message['kind']}", lambda message: None)(message)
                wait = False

    def _on_go(self, message: dict[str, Any]) -> None:
        self.state, self.note, self._limit, self._steps_left = "running", "", "", 0
        self._clock.begin(self.arm.world.t)

    def _on_pause(self, message: dict[str, Any]) -> None:
        self.state = "paused" if self.state == "running" else self.state

    def _on_step(self, message: dict[str, Any]) -> None:
        self._on_go(message)
        self._steps_left = max(1, round(STEP / self.period))

    def _on_reset(self, message: dict[str, Any]) -> None:
        self._hand.let_go()
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
        self._hand.let_go()
        self.state, self.note = "closed", "ended: other cells can use the arm; Start begins again"

    def _on_hand(self, message: dict[str, Any]) -> None:
        self._hand.follow(message)

    def _on_thing(self, message: dict[str, Any]) -> None:
        self.around.move(message["name"], message["position"])

    def _on_law(self, message: dict[str, Any]) -> None:
        self._after(lambda: setattr(self._law, "name", message["name"]))

    def _on_dial(self, message: dict[str, Any]) -> None:
        self._after(lambda: self._turn(message["name"], float(message["value"])))

    def _after(self, change: Callable[[], Any]) -> None:
        """Apply a change after the present run, because a run has one controller and one plant."""
        self._changes.append(change)
        self._over = True

    def _turn(self, name: str, value: float) -> None:
        if self._law.turn(name, value):
            self.arm.become(self._law.dialled(self._usual))

    # What the page draws

    def _picture(self) -> None:
        if self.state == "running":
            said = self._pull.look(self._law.asked, self.around.wanted(), self._hand.at is None)
            self.note = f"{self._law.name} {said}" if said else self._limit
        self._show(self.numbers())

    def numbers(self) -> dict[str, Any]:
        """The session as the page draws it."""
        return {
            "kind": "frame", "state": self.state, "note": self.note, "law": self._law.name,
            "pace": self._clock.pace, "kept": [round(float(log.t[-1]), 1) for log in self.logs],
            "move": self._hand.move, **self.around.seen(), **self._hand.seen(),
        }  # fmt: skip
