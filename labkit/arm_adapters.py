"""The arms that `run` can drive: a simulated one, or a real one that has four methods."""

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
    """The methods that `run` needs from a real arm; `WallClock` provides `wait`.

    Each method returns within a control period, or raises any exception: the run then stops the
    arm and raises `ArmLost`, which gives the reason and keeps the log.  A real arm must come to
    rest by itself when commands stop coming.  Two more attributes are used if the arm has them:
    ``torque``, the motor torque, shape (n,) in [N m], and ``plant``.

    Attributes:
        robot: Its joints and their limits.
    """

    robot: Robot

    def state(self) -> State:
        """The newest state received, with its time on the arm's own clock and without a NaN."""

    def apply(self, command: Command) -> None:
        """Follow a command, which is within the limits, until the next one."""

    def stop(self) -> None:
        """Come to rest and stay there."""

    def wait(self, t: float) -> float:
        """Wait until ``t`` [s] after the start of the run; return the time since the start, in [s].

        The call with t = 0 starts the run.  If the loop is late, the returned time exceeds ``t``.
        """


class WallClock:
    """Real time, for real arms."""

    _start = 0.0

    def wait(self, t: float) -> float:
        """Wait as `RealArm.wait` describes."""
        if t == 0.0:
            self._start = time.monotonic()
        time.sleep(max(0.0, self._start + t - time.monotonic()))
        return time.monotonic() - self._start


class Simulated:
    """A simulated arm, driven tick by tick."""

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
        """Go on to the next tick; its number and time, and whether a limit cut the last command."""
        self._arm.world.step(self._steps)
        return k + 1, (k + 1) * self.period, self._arm.saturated

    def stop(self) -> None:
        """Leave the arm at rest."""
        if not self._arm.world.closed:
            self._arm.stop()


class Real:
    """A real arm, driven tick by tick, with its limits enforced and its answers checked."""

    def __init__(self, arm: RealArm, rate: Any) -> None:
        """Drive ``arm`` at ``rate`` [Hz]."""
        self._arm, self.robot = arm, as_robot(arm.robot)
        self.plant = getattr(arm, "plant", Plant(name="real"))
        self.period = 1.0 / as_number(rate, "rate", above=0.0)
        self._shape, self._saturated, self._lost = self.robot.zeros.shape, False, False
        self._latest, self._since, self._now = -np.inf, 0.0, 0.0

    def lost_ticks(self, ticks: int) -> list[bool]:
        """No tick is known to be lost in advance."""
        return [False] * ticks

    def begin(self) -> float:
        """Begin the run; the time since then."""
        return self._at(0.0)

    def _at(self, t: float) -> float:
        now = self._call(self._arm.wait, t)
        with self._checking_answer():
            self._now = as_number(now, "the time from its wait")
        return self._now

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Wait for the tick after ``k``, or for a later one if that one has passed already."""
        now = self._at((k + 1) * self.period)
        return max(k + 1, int(now / self.period + 1e-6)), now, self._saturated

    def observe(self) -> tuple[State, State, Array]:
        """The reported state twice, because the true state is unknown, and the torque."""
        answer = self._call(self._arm.state)
        torque = self._call(getattr, self._arm, "torque", self.robot.zeros)
        with self._checking_answer():
            if not isinstance(answer, State):
                raise TypeMismatch(f"its state is {shown(answer)}, expected lk.State(t, q, dq)")
            named = zip((*answer[1:], torque), ("q", "dq", "tau_ext", "torque"), strict=True)
            numbers = [as_array(x, self._shape, f"its {name}") for x, name in named]
            t = as_number(answer.t, "the time of its state")
        if t != self._latest:
            self._latest, self._since = t, self._now
        elif self._now - self._since > SILENCE:
            raise ArmLost(
                f"the arm's state has not changed since t = {self._since:.3f} s; {self._halt()}"
            )
        state = State(t, *numbers[:3])
        return state, state, numbers[3]

    def apply(self, command: Command) -> None:
        """Send a command, clipped to the robot's limits."""
        x, robot = command.value, self.robot  # the loop has checked its shape
        if type(command) is JointPosition:
            robot.check_range(x, "JointPosition")
        else:
            most = robot.effort if type(command) is JointTorque else robot.speed
            kept = np.clip(x, -most, most)
            self._saturated = bool((kept != x).any())
            command = type(command)(kept) if self._saturated else command
        self._call(self._arm.apply, command)

    def recover(self) -> None:
        """Bring an arm that ran away to rest."""
        self.stop()

    def stop(self) -> None:
        """Leave the arm at rest; a lost arm has already been sent the command to stop."""
        if not self._lost:
            self._call(self._arm.stop)

    def _call(self, ask: Any, *args: Any) -> Any:
        try:
            return ask(*args)
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            raise ArmLost(
                f"the arm stopped answering at t = {self._now:.3f} s ({what}); {self._halt()}"
            ) from error

    @contextmanager
    def _checking_answer(self) -> Iterator[None]:
        """Raise `ArmLost` if the block cannot read an answer of the arm."""
        try:
            yield
        except LabkitError as error:
            what = f"the arm's answer at t = {self._now:.3f} s cannot be used: {error}"
            raise ArmLost(f"{what}; {self._halt()}") from error

    def _halt(self) -> str:
        """Try to stop the arm, and return a clause that says whether that worked."""
        self._lost = True
        with suppress(Exception):
            self._arm.stop()
            return "it was told to stop"
        return "it could not be told to stop and must come to rest by itself: go and look"
