"""A live session: one thread that owns the simulator and keeps the time of the wall.

The thread runs the same loop as `run`, tick after tick; between two ticks it reads what came from
the page.  What can go wrong ends the run with a sentence and leaves the arm at rest.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np

from ..arm import Arm
from ..driven import Simulated
from ..hand import Hand
from ..log import Log
from ..run import loop
from .dials import Dial, Dialled
from .pull import Pull
from .surroundings import Surroundings
from .watch import PATIENCE, Watch, sentence

FRESH, SLOW_PAGE = 0.2, 1.0
"""A pointer of which nothing was heard for this long, in [s], lets go; where a page says that it is
slow, after three times its slowest turn of late, but at most after the second of these."""

STEADY = 5.0
"""A push by a button goes on for this long, in [s], after the last word of it."""

LONGEST = 120.0
"""A run is at most this long, in [s]; then the next begins where it ended."""

ABSENT = 60.0
"""Without a word from any page for this long, in [s], the session pauses."""

FRAME = 1 / 30
"""Time between two pictures, in [s]."""

STEP = 0.05
"""What the button "Step" advances, in [s]."""

_OVER = 10**9  # a tick later than the last of any run

_LIMIT = "a run is at most {:g} s long: a new one, which can be kept, began at t = {:.0f} s"


class Session(Simulated):
    """An arm, its laws and a hand, in a thread of their own from `start` to `close`.

    Attributes:
        logs: The runs that were kept, in their order.
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
        """A session that has not begun; ``show`` receives each picture, in numbers."""
        super().__init__(arm, rate)
        self.arm, self._dials, self._show = arm, dials, show
        self._law, self.around = Dialled(laws, dials), Surroundings(arm, target)
        self._hand, self._pull, self._thread = Hand(arm), Pull(arm), threading.Thread()
        self._usual, self._q0 = arm.plant, np.array(arm.truth().q)
        self._inbox: SimpleQueue[dict[str, Any]] = SimpleQueue()
        self.logs: list[Log] = []
        self.state, self.note = "ready", ""
        self._within = self._keep = self._over = self._again = False  # of a run
        self._steps_left, self._heard, self._held, self._patience = 0, 0.0, 0.0, FRESH
        self._limit = ""  # what is said of a run that reached the limit
        self._move = self._answered = 0  # the hand's moves, as the page counts them
        self._changes: list[Callable[[], Any]] = []
        self._watch = Watch(self.period, lambda note: show({"kind": "note", "note": note}))
        self._real = deque([(0.0, 0.0)], maxlen=30)

    # From any thread

    def tell(self, message: dict[str, Any]) -> None:
        """Take a message from the page; the thread reads it before its next tick."""
        if self.state == "closed" and self._thread.is_alive():
            self._thread.join(2 * PATIENCE)  # it is on its way out, and reads no more
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
        """End it; the arm is at rest and free for other cells."""
        self._inbox.put({"kind": "close"})
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(2 * PATIENCE)

    # In the thread

    def _main(self) -> None:
        self.arm.world.owner, self.state = threading.get_ident(), "ready"
        try:
            while self.state != "closed":
                self._one_run()
            self._picture()
        finally:
            self.arm.become(self._usual)
            self.arm.world.owner = None

    def _one_run(self) -> None:
        """From a start to whatever ends it: a dial, another law, "keep", an error."""
        self._change()
        self._obey(wait=self.state != "running")
        if self._changes or self.state != "running":
            return
        self._over = self._again = self._keep = False
        self._within = True
        self.plant, self._began = self.arm.plant, time.monotonic()
        try:
            log = loop(self, self.around.target, self._law, LONGEST)
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
        """Turn what is to be turned between two runs."""
        if self._changes:
            for change in self._changes:
                change()
            self._changes.clear()
            self._picture()

    def _rest(self, error: BaseException) -> None:
        """Put the arm to rest and say why."""
        self._hand.let_go()
        self.arm.recover()
        if getattr(error, "log", None) is not None:  # of an arm that ran away
            self.logs.append(error.log)  # type: ignore[attr-defined]
        self.state, self.note = "stopped", sentence(error, self._law.name)
        self._picture()

    def begin(self) -> float:
        """A run begins."""
        self._pull.begin()
        self._watch.begins(self._law.name)
        return 0.0

    def stop(self) -> None:
        """A run that only makes room for the next does not stop the arm."""
        self._watch.ends()
        if self.state != "running":
            super().stop()

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Take the physics of a tick, read what came, and wait for the wall's clock."""
        self._watch.ends()
        self._watch.check_pace()
        if time.monotonic() - self._held > self._patience:
            self._hand.let_go()
        self.around.approach(self.period)
        k, t, cut = super().advance(k)
        if self._steps_left:
            self._steps_left -= 1
            self.state = "running" if self._steps_left else "paused"
        self._pace(t)
        self._obey()  # after the wait, so that the next tick has what came meanwhile
        while self.state == "paused" and not self._over:
            self._picture()
            self._obey(wait=True)
            self._began = time.monotonic() - t
        self._watch.begins(self._law.name)
        return (_OVER if self._over or self.state != "running" else k), t, cut

    def _pace(self, t: float) -> None:
        """Wait for the wall; a loop that is late by more than 0.1 s goes on from there."""
        ahead = self._began + t - (now := time.monotonic())
        if ahead < -0.1:
            self._began = now - t
        if now - self._heard > ABSENT:
            self.state, self.note = "paused", "nobody looked for a minute"
        if self._move != self._answered or now - self._real[-1][0] > FRAME:
            self._answered = self._move
            self._real.append((now, self.arm.world.t))
            self._picture()
        time.sleep(max(0.0, ahead))

    def _obey(self, wait: bool = False) -> None:
        """Do what the page asked for; with `wait`, wait for something."""
        with suppress(Empty):
            while True:
                message = self._inbox.get(wait, ABSENT if wait else None)
                getattr(self, f"_on_{message['kind']}", lambda message: None)(message)
                wait = False

    def _on_go(self, message: dict[str, Any]) -> None:
        self.state, self.note, self._limit, self._steps_left = "running", "", "", 0
        self._real = deque([(time.monotonic(), self.arm.world.t)], maxlen=30)

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
        slow = min(SLOW_PAGE, max(FRESH, 3.0 * message.get("every", 0.0)))
        self._held, self._patience = message["heard"], STEADY if "force" in message else slow
        self._move = message.get("move", self._move)
        point = message["link"], message["local"]
        if "force" in message:
            self._hand.push(*point, message["force"])
        elif "to" in message:
            self._hand.take(*point, message["to"])
        else:
            self._hand.let_go()

    def _on_thing(self, message: dict[str, Any]) -> None:
        self.around.move(message["name"], message["position"])

    def _on_law(self, message: dict[str, Any]) -> None:
        self._after(lambda: setattr(self._law, "name", message["name"]))

    def _on_dial(self, message: dict[str, Any]) -> None:
        self._after(lambda: self._turn(message["name"], float(message["value"])))

    def _after(self, change: Callable[[], Any]) -> None:
        """End the run, for one run has one law on one plant, and begin the next with a change."""
        self._changes.append(change)
        self._over = True

    def _turn(self, name: str, value: float) -> None:
        self._law.values[name] = value
        if self._dials[name].of_plant:
            numbers: Any = {n: v for n, v in self._law.values.items() if self._dials[n].of_plant}
            self.arm.become(replace(self._usual, **numbers, name=f"{self._usual.name}, dialled"))

    # What the page draws

    def _picture(self) -> None:
        if self.state == "running":
            said = self._pull.look(self._law.asked, self.around.wanted(), self._hand.at is None)
            self.note = f"{self._law.name} {said}" if said else self._limit
        self._show(self.numbers())

    def numbers(self) -> dict[str, Any]:
        """The session as the page draws it."""
        (a, x), (b, y) = self._real[0], self._real[-1]
        return {
            "kind": "frame",
            "state": self.state,
            "note": self.note,
            "law": self._law.name,
            "pace": round((y - x) / (b - a), 3) if b > a else None,
            "kept": [round(float(log.t[-1]), 1) for log in self.logs],
            "move": self._move,
            **self.around.seen(),
            **self._hand.seen(),
        }
