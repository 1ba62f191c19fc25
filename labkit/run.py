"""Run: close the loop between an arm, a target and a controller, and log what happens."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np

from .arm import Arm
from .control import COMMANDS, Controller
from .errors import (
    Closed,
    ControllerError,
    Diverged,
    LabkitError,
    OutOfRange,
    ShapeError,
    TypeMismatch,
)
from .log import Log, Recorder
from .robot import Robot
from .shapes import Array, as_array, as_number, shown
from .trajectory import AnySample, Sample, Target
from .world import whole_steps

ORDER = "the order is arm, target, controller"
RUNAWAY = 50.0
"""An arm whose joint speeds are a longer vector than this, in [rad/s], is out of control.

The fastest of Baxter's joints are limited to 4 rad/s."""


def run(
    arm: Arm,
    target: Target,
    controller: Controller,
    rate: float = 200.0,
    duration: float | None = None,
) -> Log:
    """Let ``controller`` drive ``arm`` along ``target``.

    The arm starts where it is.  Whatever happens, it is left stopped and usable; an arm that ran
    away is brought to rest at once.

    Args:
        arm: The arm.
        target: A function of the time since the start, in [s], that returns a `Sample` or a
            `PoseSample`.
        controller: A function of a `State` and the target's sample that returns a command.  If it
            is an object with a method ``reset()``, that is called first.
        rate: How often the controller is called, in [Hz]; its period is a whole number of physics
            steps.
        duration: Length of the run, in [s]; None means the target's own duration.

    Returns:
        The log.  A keyboard interrupt ends the run early and returns the log up to that point.

    Raises:
        ControllerError: The controller or the target raised, or returned something that is not a
            command or not a sample; the error says which and when, and keeps the `log` up to then.
        Diverged: The arm ran away; the error keeps the log too.
        OutOfRange: The rate does not fit the physics step, or no duration is known.
        TypeMismatch: The arm, the target or the controller has the wrong type, or target and
            controller are swapped.
        Closed: The arm's world is closed.
    """
    check_order(target, controller)
    if not isinstance(arm, Arm):
        raise TypeMismatch(f"arm is {shown(arm)}, expected an Arm; {ORDER}")
    return run_driven(Driven(arm, rate), target, controller, duration)


class Driven:
    """An arm, driven tick by tick; `live` has one with a clock of its own."""

    def __init__(self, arm: Arm, rate: Any) -> None:
        """Drive ``arm`` at ``rate`` [Hz]."""
        arm.check_open()
        self.arm = arm
        self._steps = whole_steps(as_number(rate, "rate", above=0.0), arm.world.dt, "rate")
        self.period = self._steps * arm.world.dt

    def advance(self, k: int) -> tuple[int, float, bool]:
        """Go on to the next tick; its number and time, and whether a limit cut the last command."""
        self.arm.world.step(self._steps)
        return k + 1, (k + 1) * self.period, self.arm.saturated

    def stop(self) -> None:
        """Leave the arm at rest."""
        if not self.arm.world.closed:
            self.arm.stop()


def check_order(target: object, *controllers: object) -> None:
    """Raise `TypeMismatch` unless all are functions, in the order that `run` and `live` share."""
    for name, given, arguments in (
        ("target", target, ("the time",)),
        *(("controller", law, ("the state", "the target's sample")) for law in controllers),
    ):
        if not callable(given) or not _takes(given, arguments):
            what = f"expected a function of {' and '.join(arguments)}"
            raise TypeMismatch(f"{name} is {shown(given)}, {what}; {ORDER}")


def _takes(function: Any, arguments: tuple[str, ...]) -> bool:
    """Whether a function can be called with these; a dial is an argument more."""
    try:
        inspect.signature(function).bind_partial(*arguments)
    except TypeError:
        return False
    except ValueError:  # a built-in function does not say
        pass
    return True


def run_driven(
    driven: Driven, target: Target, controller: Controller, duration: float | None
) -> Log:
    """Do the same as `run` for a driven arm."""
    last = _ticks(target, duration, driven.period) - 1
    samples = _Samples(target)
    arm = driven.arm
    recorder = Recorder(arm.robot, arm.plant, name_of(controller), samples.first)
    try:
        _loop(driven, controller, last, samples, recorder)
        log = recorder.log()
        samples.check_all(log)
    except ControllerError as error:
        error.log = recorder.log() if len(recorder) else None
        raise
    return log


def _loop(
    driven: Driven, controller: Controller, last: int, samples: _Samples, recorder: Recorder
) -> None:
    """Go through the ticks up to the ``last`` one, and leave the arm at rest."""
    arm, robot, name = driven.arm, driven.arm.robot, name_of(controller)
    lost = arm.lost_ticks(last + 1)
    kind, k, t, running = None, 0, 0.0, name
    try:
        if reset := getattr(controller, "reset", None):
            reset()
        while True:
            running = samples.name
            q, dq, torque, seen = arm.observe()
            sample = samples.at(t)
            recorder.keep(t, q, dq, torque, seen, sample)
            running = name
            command = controller(seen, sample)
            if type(command) is not kind:
                recorder.kind = kind = _command_type(command, kind, name, t)
            if command.value.shape != robot.zeros.shape:
                raise ShapeError(kind.__name__, robot.zeros.shape, command.value.shape)
            recorder.commanded(command)
            if not dq.dot(dq) <= RUNAWAY**2:  # a NaN runs away too
                raise Diverged(_runaway(robot, dq, name, t))
            if k >= last:
                break
            if not lost[k]:
                arm.follow(command)
            k, t, cut = driven.advance(k)
            recorder.cut(cut)
    except KeyboardInterrupt:
        if not len(recorder):
            raise
    except Diverged:
        arm.recover()
        raise
    except (ControllerError, Closed):
        raise
    except Exception as error:
        samples.check(samples.latest, t)  # was it the target that broke the controller?
        why = str(error) if isinstance(error, LabkitError) else f"{type(error).__name__}: {error}"
        raise ControllerError(f"{running} failed at t = {t:.3f} s, tick {k}: {why}") from error
    finally:
        driven.stop()


class _Samples:
    """The samples of a target, which keep one type and shape; each is a copy."""

    def __init__(self, target: Target) -> None:
        """Take the first sample, which determines the type and shape of the others."""
        self._target, self.name = target, f"the target {name_of(target)}"
        try:
            first: Any = target(0.0)
        except Exception as error:
            raise ControllerError(
                f"{self.name} failed at t = 0: {type(error).__name__}: {error}"
            ) from error
        self._kind: Any = type(first)
        self._shapes: tuple[tuple[int, ...], ...] = ((4, 4), (6,), (6,))
        if isinstance(first, Sample):
            self._shapes = ((np.size(first.position),),) * 3
        self.check(first, 0.0)
        self.first = self.latest = self.at(0.0)

    def at(self, t: float) -> AnySample:
        """The sample at time ``t`` [s]; whether its numbers are finite is asked later."""
        sample: Any = self._target(t)
        try:
            a, b, c = [np.array(part, np.float64, order="C") for part in sample]
            good = type(sample) is self._kind and (a.shape, b.shape, c.shape) == self._shapes
        except (TypeError, ValueError):
            good = False
        if not good:
            self.check(sample, t)
        self.latest = self._kind(a, b, c)
        return self.latest

    def check(self, sample: Any, t: float) -> None:
        """Say what is wrong with a sample."""
        if type(sample) is not self._kind or not isinstance(sample, AnySample):
            raise ControllerError(
                f"{self.name} returned {str(sample)[:80]} ({type(sample).__name__}) at "
                f"t = {t:.3f} s; a target returns lk.Sample(position, velocity, acceleration) or "
                "lk.PoseSample(pose, twist, dtwist), the same kind at all times"
            )
        try:
            for name, part, shape in zip(sample._fields, sample, self._shapes, strict=True):
                as_array(part, shape, name)
        except LabkitError as error:
            raise ControllerError(f"{self.name} at t = {t:.3f} s: {error}") from error

    def check_all(self, log: Log) -> None:
        """Raise if a sample held a NaN that had no effect; other NaNs have been reported by now."""
        good = [np.isfinite(x).reshape(len(x), -1).all(axis=1) for x in log.target]
        for k in np.flatnonzero(~np.logical_and.reduce(good))[:1]:
            self.check(self._kind(*(x[k] for x in log.target)), float(log.t[k]))


def _ticks(target: Target, duration: float | None, period: float) -> int:
    """The number of ticks of the run, including both ends."""
    if duration is None:
        duration = getattr(target, "duration", None)
        if duration is None:
            raise OutOfRange(f"the target {name_of(target)} has no duration; give duration=...")
    return round(as_number(duration, "duration", least=0.0) / period + 1e-9) + 1


def _command_type(command: object, kind: type | None, who: str, t: float) -> type:
    """The type of this run's commands; raises if the command does not fit."""
    if not isinstance(command, COMMANDS):
        names = ", ".join(f"lk.{c.__name__}(...)" for c in COMMANDS)
        raise ControllerError(
            f"{who} returned {str(command)[:80]} at t = {t:.3f} s; return one of {names}"
        )
    if kind is not None:
        raise ControllerError(
            f"{who} changed from {kind.__name__} to {type(command).__name__} at t = {t:.3f} s; "
            "one run has one kind of command"
        )
    return type(command)


def _runaway(robot: Robot, dq: Array, who: str, t: float) -> str:
    i = int(np.argmax(np.abs(dq)))
    return (
        f"{who} lost the arm at t = {t:.3f} s: joint {robot.joint_names[i]} turns at "
        f"{dq[i]:.3g} rad/s (its limit is {robot.speed[i]:g}); check the sign of the "
        "error, then try smaller gains or a faster rate; the log up to here is in error.log"
    )


def name_of(f: object) -> str:
    """The name of a controller or a target in logs and messages; a lambda has none."""
    return getattr(f, "__name__", type(f).__name__).replace("<lambda>", "unnamed function")
