"""Run: close the loop between an arm, a target and a controller, and write down what happens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from .arm import Arm
from .arrays import Array, as_array, as_number, locked, shown
from .commands import COMMANDS, JOINTS, Command, State
from .errors import Closed, ControllerError, Diverged, LabkitError, OutOfRange, TypeMismatch
from .motion import AnySample, PoseSample, Sample, Target
from .plant import Plant
from .robot import Side
from .world import whole_steps

Controller = Callable[[State, Any], Command]
"""A function of the state and of the target's sample; nothing to inherit, nothing to register."""

RUNAWAY = 50.0
"""Joints faster than this, in [rad/s], are out of control: twelve times the quickest's limit."""


@dataclass(frozen=True, eq=False)
class Log:
    """What happened, one row for each control tick, the last one at the end of the run.

    Attributes:
        t: Time since the run began, shape (N,) in [s].
        q: Joint angles as they were, shape (N, 7) in [rad].
        dq: Joint speeds as they were, shape (N, 7) in [rad/s].
        tau: Motor torque in the last physics step before the next tick, gravity compensation
            included, shape (N, 7) in [N m]; the last row repeats the one before.
        command: What the controller asked for, shape (N, 7), in the unit of `command_type`.
        target: A `Sample` or `PoseSample` of stacked arrays, (N, ...).
        measured: The `State` that the controller saw, stacked: t (N,), q (N, 7), dq (N, 7),
            tau_ext (N, 7).
        saturated: Whether a limit of speed or torque cut what the arm did until the next tick,
            shape (N,).
        command_type: `JointPosition`, `JointVelocity` or `JointTorque`.
        controller: The controller's name.
        plant: The plant that was driven.
        side: Which arm.
    """

    t: Array
    q: Array
    dq: Array
    tau: Array
    command: Array
    target: AnySample
    measured: Any
    saturated: np.ndarray[Any, np.dtype[np.bool_]]
    command_type: type
    controller: str
    plant: Plant
    side: Side

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return (
            f"Log({self.controller} on the {self.plant.name} {self.side} arm, "
            f"{len(self)} ticks, {self.t[-1]:.3g} s)"
        )


def run(
    arm: Arm,
    target: Target,
    controller: Controller,
    rate: float = 200.0,
    duration: float | None = None,
) -> Log:
    """Let ``controller`` drive ``arm`` after ``target``.

    The arm starts where it is.  Whatever happens, it is left stopped and usable.

    Args:
        arm: The arm.
        target: A function of the time since the start, in [s], that gives a `Sample` or a
            `PoseSample`.
        controller: A function of a `State` and the target's sample that gives a command.
        rate: How often the controller is asked, in [Hz]; its period is a whole number of physics
            steps.
        duration: How long, in [s]; None takes the target's own duration.

    Returns:
        The log.  A keyboard interrupt ends the run early and returns what there is.

    Raises:
        ControllerError: The controller or the target raised, or gave something that is no command
            or no sample; it says which and when.
        Diverged: The arm ran away; the error keeps the `log` up to then.
        OutOfRange: The rate does not fit the physics step, or no duration is known.
        TypeMismatch: One of the three is not what it should be.
        Closed: The arm's world is closed.
    """
    for name, given in (("target", target), ("controller", controller)):
        if not callable(given):
            raise TypeMismatch(
                f"{name} is {shown(given)}, expected a function: run(arm, target, controller)"
            )
    if not isinstance(arm, Arm):
        raise TypeMismatch(f"arm is {shown(arm)}, expected an Arm: run(arm, target, controller)")
    rate = as_number(rate, "rate", above=0.0)
    steps = whole_steps(rate, arm.world.dt, "rate")
    ticks = _ticks(target, duration, steps * arm.world.dt)
    who, whom, world, period = _name(controller), _name(target), arm.world, steps * arm.world.dt
    lost = arm.lost_ticks(ticks)
    book = _Book(ticks, whom, _first_sample(target, whom))
    the_target = f"the target {whom}"
    kind, t, k, asked = None, 0.0, 0, who
    often = max(1, round(0.01 / period))  # every 10 ms: nothing runs far in so short a time
    try:
        for k in range(ticks):
            t, asked = k * period, the_target
            truth, seen, torque = arm.observe()
            sample = book.checked(target(t), t)
            asked = who
            command = controller(seen, sample)
            if type(command) is not kind:
                kind = _settled(command, kind, who, t)
            book.keep(k, truth, seen, torque, command, sample)
            if not k % often and not truth.dq.dot(truth.dq) <= RUNAWAY**2:  # a NaN runs away too
                raise Diverged(_runaway(arm, truth, who, t))
            if k < ticks - 1:
                if not lost[k]:
                    arm.apply(command)
                world.step(steps)
                book.saturated[k] = arm.saturated
    except KeyboardInterrupt:
        if not book.filled:
            raise
    except Diverged as error:
        error.log = book.log(kind, who, arm, period)
        raise
    except (ControllerError, Closed):
        raise
    except Exception as error:
        book.blame(t)
        what = str(error) if isinstance(error, LabkitError) else f"{type(error).__name__}: {error}"
        raise ControllerError(f"{asked} failed at t = {t:.3f} s, tick {k}: {what}") from error
    finally:
        if world.client >= 0:
            arm.stop()
    book.check_target(period)
    return book.log(kind, who, arm, period)


_shape = attrgetter("shape")


class _Book:
    """What the log is made of, while it is being written: a row of numbers for each tick."""

    def __init__(self, ticks: int, whom: str, first: AnySample) -> None:
        self.filled, self.whom, self.sample_type = 0, whom, type(first)
        self.shapes = [part.shape for part in first]
        self.latest = first
        self.widths = [JOINTS] * 5 + [part.size for part in first]
        self.rows = np.empty((ticks, sum(self.widths)))
        self.seen, self.t_seen, self.apart = np.empty((ticks, 3 * JOINTS)), np.empty(ticks), False
        self.saturated = np.zeros(ticks, dtype=bool)

    def checked(self, sample: Any, t: float) -> AnySample:
        """The target's sample: of the right kind and shapes, and read-only."""
        try:
            good = type(sample) is self.sample_type and [*map(_shape, sample)] == self.shapes
        except AttributeError:  # lists
            good = False
        self.latest = x, dx, ddx = sample if good else self.read(sample, t)
        x.setflags(False)  # type: ignore[call-arg]  # as in `locked`
        dx.setflags(False)  # type: ignore[call-arg]
        ddx.setflags(False)  # type: ignore[call-arg]
        return self.latest

    def read(self, sample: Any, t: float) -> AnySample:
        """Read a sample with care, or say what is wrong with it."""
        return _read_sample(sample, self.sample_type, self.shapes, self.whom, t)

    def blame(self, t: float) -> None:
        """Raise if it was the target that broke the controller."""
        self.read(self.latest, t)

    def keep(
        self,
        k: int,
        truth: State,
        seen: State,
        torque: Array,
        command: Command,
        sample: AnySample,
    ) -> None:
        """Write down one tick; ``torque`` belongs to the tick before."""
        x, dx, ddx = sample
        np.concatenate(
            (truth.q, truth.dq, truth.tau_ext, torque, command.value, x.ravel(), dx, ddx),
            out=self.rows[k],
        )
        if seen is not truth:
            np.concatenate(seen[1:], out=self.seen[k])
            self.apart = True
        self.t_seen[k], self.filled = seen.t, k + 1

    def check_target(self, period: float) -> None:
        """Raise if a sample held a NaN that did no harm; harmful ones were blamed at once."""
        target = self.rows[: self.filled, 5 * JOINTS :]
        for k in np.flatnonzero(~np.isfinite(target).all(axis=1))[:1]:
            parts = np.split(target[k], np.cumsum(self.widths[5:])[:-1])
            shaped = zip(parts, self.shapes, strict=True)
            self.read(self.sample_type(*(x.reshape(shape) for x, shape in shaped)), k * period)

    def log(self, kind: type | None, who: str, arm: Arm, period: float) -> Log:
        """What was written so far, frozen."""
        n, edges = self.filled, np.cumsum(self.widths)[:-1]
        q, dq, tau_ext, torque, command, *target = np.split(self.rows[:n], edges, axis=1)
        reported = np.split(self.seen[:n], 3, axis=1) if self.apart else (q, dq, tau_ext)
        shaped = zip(target, self.shapes, strict=True)
        seen = (self.t_seen[:n], *reported)
        tau = np.concatenate([torque[1:], torque[-1:]])
        at_limit = (np.abs(tau) >= arm.robot.effort * (1.0 - 1e-9)).any(axis=1)
        saturated = self.saturated[:n] | at_limit
        saturated.setflags(write=False)
        return Log(
            t=locked(period * np.arange(n, dtype=np.float64)),
            q=locked(q),
            dq=locked(dq),
            tau=locked(tau),
            command=locked(command),
            target=self.sample_type(*(locked(x.reshape(n, *shape)) for x, shape in shaped)),
            measured=State(*map(locked, seen)),  # type: ignore[arg-type]
            saturated=saturated,
            command_type=kind or type(None),
            controller=who,
            plant=arm.plant,
            side=arm.robot.side,
        )


def _ticks(target: Target, duration: float | None, period: float) -> int:
    """How many ticks the run has, its two ends included."""
    if duration is None:
        duration = getattr(target, "duration", None)
        if duration is None:
            raise OutOfRange(
                f"how long? the target {_name(target)} has no duration; give duration=..."
            )
    return round(as_number(duration, "duration", least=0.0) / period + 1e-9) + 1


def _first_sample(target: Target, whom: str) -> AnySample:
    """The target's first sample, a copy: what kind it is settles what the others must be."""
    try:
        sample: Any = target(0.0)
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise ControllerError(f"the target {whom} failed at t = 0: {what}") from error
    shapes: list[tuple[int, ...]] = [(4, 4), (6,), (6,)]
    if isinstance(sample, Sample):
        shapes = [(np.size(sample.position),)] * 3
    return _read_sample(sample, type(sample), shapes, whom, 0.0)


def _read_sample(
    sample: Any, kind: type, shapes: list[tuple[int, ...]], whom: str, t: float
) -> AnySample:
    """Read a sample with care, or say what is wrong with it."""
    if type(sample) is not kind or not isinstance(sample, Sample | PoseSample):
        raise ControllerError(
            f"the target {whom} gave {str(sample)[:80]} ({type(sample).__name__}) at t = {t:.3f} s;"
            " a target gives lk.Sample(position, velocity, acceleration) or"
            " lk.PoseSample(pose, twist, dtwist), the same kind at all times"
        )
    parts = zip(sample._fields, sample, shapes, strict=True)
    try:
        return type(sample)(*(np.array(as_array(x, n, name)) for name, x, n in parts))
    except LabkitError as error:
        raise ControllerError(f"the target {whom} at t = {t:.3f} s: {error}") from error


def _settled(command: object, kind: type | None, who: str, t: float) -> type:
    """The type of this run's commands, or what is wrong with this one."""
    names = ", ".join(f"lk.{c.__name__}(...)" for c in COMMANDS)
    if not isinstance(command, COMMANDS):
        hint = "; is a return missing?" if command is None else ""
        raise ControllerError(
            f"{who} returned {str(command)[:80]} at t = {t:.3f} s; return one of {names}{hint}"
        )
    if kind is not None:
        raise ControllerError(
            f"{who} changed from {kind.__name__} to {type(command).__name__} at t = {t:.3f} s; "
            "one run has one kind of command"
        )
    return type(command)


def _runaway(arm: Arm, truth: State, who: str, t: float) -> str:
    i = int(np.argmax(np.abs(truth.dq)))
    return (
        f"{who} lost the arm at t = {t:.3f} s: joint {arm.robot.joint_names[i]} turns at "
        f"{truth.dq[i]:.3g} rad/s (its limit is {arm.robot.speed[i]:g}); check the sign of the "
        "error, then try smaller gains or a faster rate; the log up to here is in error.log"
    )


def _name(f: object) -> str:
    return getattr(f, "__name__", type(f).__name__)
