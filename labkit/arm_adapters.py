"""What `run` drives: the simulated arm, or a real one behind a protocol of four methods."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, Protocol, runtime_checkable

import numpy as np

from .arm import Arm
from .baxter import as_robot
from .control import Command, JointPosition, JointTorque, State
from .errors import ArmLost, LabkitError, TypeMismatch
from .plant import Plant
from .robot import Robot
from .shapes import Array, as_array, as_number, shown
from .world import whole_steps

SILENCE = 0.2
"""A real arm whose state has been the same for this long, in [s], has stopped answering."""


@runtime_checkable
class RealArm(Protocol):
    """What `run` asks of an arm that is not simulated; `WallClock` has a `wait` for it.

    Each method returns within a control period, or raises what it likes: the run then stops the
    arm, and the error `ArmLost` tells why and keeps the log.  A real arm must come to rest by
    itself when commands stop coming.  Two more attributes are used where there are any: ``torque``,
    what the motors give, shape (n,) in [N m], and ``plant``.

    Attributes:
        robot: Its joints and their limits.
    """

    robot: Robot

    def state(self) -> State:
        """The newest state that has come, its time on the arm's own clock; never a NaN."""

    def apply(self, command: Command) -> None:
        """Follow a command, which is within the limits, until the next."""

    def stop(self) -> None:
        """Come to rest and stay."""

    def wait(self, t: float) -> float:
        """Wait until ``t`` [s] after the run began, and return how long ago that was, in [s].

        The run begins where t is 0.  Where the loop is late, the answer is later than t.
        """


class WallClock:
    """The clock on the wall, for real arms."""

    _start = 0.0

    def wait(self, t: float) -> float:
        """As `RealArm.wait`."""
        if t == 0.0:
            self._start = time.monotonic()
        time.sleep(max(0.0, self._start + t - time.monotonic()))
        return time.monotonic() - self._start


class Simulated:
    """A simulated arm, tick after tick."""

    def __init__(self, arm: Arm, rate: Any) -> None:
        """Drive ``arm`` at ``rate`` [Hz]."""
        arm.check_open()
        self._arm, self.robot, self.plant = arm, arm.robot, arm.plant
        self._steps = whole_steps(as_number(rate, "rate", above=0.0), arm.world.dt, "rate")
        self.period = self._steps * arm.world.dt
        self.apply, self.observe, self.recover = arm.follow, arm.observe, arm.recover
        self.lost_ticks = arm.lost_ticks

    def begin(self) -> float:
        """Begin the run; the time since then."""
        return 0.0

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Go on to the tick after ``k``: its number, its time, and whether a limit cut the last."""
        self._arm.world.step(self._steps)
        return k + 1, (k + 1) * self.period, self._arm.saturated

    def stop(self) -> None:
        """Leave the arm at rest."""
        if not self._arm.world.closed:
            self._arm.stop()


class Real:
    """A real arm, tick after tick: its limits are kept, and what it says is not trusted."""

    def __init__(self, arm: RealArm, rate: Any) -> None:
        """Drive ``arm`` at ``rate`` [Hz]."""
        self._arm, self.robot = arm, as_robot(arm.robot)
        self.plant = getattr(arm, "plant", Plant(name="real"))
        self.period = 1.0 / as_number(rate, "rate", above=0.0)
        self._shape, self._saturated, self._lost = self.robot.zeros.shape, False, False
        self._latest, self._since, self._now = -np.inf, 0.0, 0.0

    def lost_ticks(self, ticks: int) -> list[bool]:
        """None that this side knows of."""
        return [False] * ticks

    def begin(self) -> float:
        """Begin the run; the time since then."""
        return self._at(0.0)

    def _at(self, t: float) -> float:
        now = self._asked(self._arm.wait, t)
        with self._useful():
            self._now = as_number(now, "the time from its wait")
        return self._now

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Wait for the tick after ``k``, or for the next that is not yet over."""
        now = self._at((k + 1) * self.period)
        return max(k + 1, int(now / self.period + 1e-6)), now, self._saturated

    def observe(self) -> tuple[State, State, Array]:
        """The state twice, for nobody knows a truer one, and the torque."""
        answer = self._asked(self._arm.state)
        torque = self._asked(getattr, self._arm, "torque", self.robot.zeros)
        with self._useful():
            if not isinstance(answer, State):
                raise TypeMismatch(f"its state is {shown(answer)}, expected lk.State(t, q, dq)")
            named = zip((*answer[1:], torque), ("q", "dq", "tau_ext", "torque"), strict=True)
            numbers = [as_array(x, self._shape, f"its {name}") for x, name in named]
            t = as_number(answer.t, "the time of its state")
        if t != self._latest:
            self._latest, self._since = t, self._now
        elif self._now - self._since > SILENCE:
            raise ArmLost(
                f"the arm's state has not changed since t = {self._since:.3f} s; {self._rest()}"
            )
        state = State(t, *numbers[:3])
        return state, state, numbers[3]

    def apply(self, command: Command) -> None:
        """Send a command, cut to the robot's limits."""
        x, robot = command.value, self.robot  # of one shape, as the loop has seen
        if type(command) is JointPosition:
            robot.check_range(x, "JointPosition")
        else:
            most = robot.effort if type(command) is JointTorque else robot.speed
            kept = np.clip(x, -most, most)
            self._saturated = bool((kept != x).any())
            command = type(command)(kept) if self._saturated else command
        self._asked(self._arm.apply, command)

    def recover(self) -> None:
        """Leave at rest an arm that ran away."""
        self.stop()

    def stop(self) -> None:
        """Leave the arm at rest; a lost arm has received the command already."""
        if not self._lost:
            self._asked(self._arm.stop)

    def _asked(self, ask: Any, *args: Any) -> Any:
        try:
            return ask(*args)
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise ArmLost(
                f"the arm stopped answering at t = {self._now:.3f} s ({what}); {self._rest()}"
            ) from error

    @contextmanager
    def _useful(self) -> Iterator[None]:
        """Where an answer is read: one that cannot be loses the arm."""
        try:
            yield
        except LabkitError as error:
            what = f"the arm's answer at t = {self._now:.3f} s cannot be used: {error}"
            raise ArmLost(f"{what}; {self._rest()}") from error

    def _rest(self) -> str:
        """Stop it, if it hears; what became of it."""
        self._lost = True
        with suppress(Exception):
            self._arm.stop()
            return "it was told to stop"
        return "it could not be told to stop and must come to rest by itself: go and look"
