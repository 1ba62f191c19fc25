"""Run: close the loop between an arm, a target and a controller, and write down what happens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from .arm import Arm, whole_steps
from .arrays import Array, as_array, as_number, locked
from .commands import COMMANDS, JOINTS, Command, State
from .errors import ControllerError, Diverged, LabkitError, OutOfRange
from .motion import AnySample, PoseSample, Sample, Target
from .plant import Plant
from .robot import Side

Controller = Callable[[State, Any], Command]
"""A function of the state and of the target's sample; nothing to inherit, nothing to register."""

RUNAWAY = 50.0
"""A joint faster than this, in [rad/s], is out of control: twelve times the quickest's limit."""


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
    """
    steps = whole_steps(rate, arm.world.dt, "rate")
    ticks = _ticks(target, duration, steps * arm.world.dt)
    who, whom, world, period = _name(controller), _name(target), arm.world, steps * arm.world.dt
    lost = arm.lost_ticks(ticks)
    first = _checked_sample(target, whom)
    book = _Book(ticks, first)
    kind, sample_type = None, type(first)
    t, k = 0.0, 0
    try:
        for k in range(ticks):
            t = k * period
            truth, seen, torque = arm.observe()
            sample = target(t) if k else first
            if type(sample) is not sample_type or not book.keep_target(k, sample):
                raise ControllerError(_bad_sample(sample, whom, t))
            command = controller(seen, sample)
            if type(command) is not kind:
                kind = _settled(command, kind, who, t)
            book.keep(k, t, truth, seen, torque, command.value)
            if truth.dq.dot(truth.dq) > RUNAWAY**2:
                raise Diverged(_runaway(arm, truth, who, t))
            if k < ticks - 1:
                if not lost[k]:
                    arm.apply(command)
                world.step(steps)
                book.saturated[k] = arm.saturated
    except KeyboardInterrupt:
        return book.log(k, kind, who, arm)
    except Diverged as error:
        error.log = book.log(k + 1, kind, who, arm)
        raise
    except ControllerError:
        raise
    except Exception as error:
        what = str(error) if isinstance(error, LabkitError) else f"{type(error).__name__}: {error}"
        raise ControllerError(f"{who} failed at t = {t:.3f} s, tick {k}: {what}") from error
    finally:
        if world.client >= 0:
            arm.stop()
    return book.log(ticks, kind, who, arm)


class _Book:
    """The columns of a log while it is being written."""

    def __init__(self, ticks: int, first: AnySample) -> None:
        self.t, self.t_seen = np.zeros(ticks), np.zeros(ticks)
        self.q, self.dq, self.tau, self.command, self.q_seen, self.dq_seen, self.tau_seen = (
            np.zeros((ticks, JOINTS)) for _ in range(7)
        )
        self.saturated = np.zeros(ticks, dtype=bool)
        self.target = tuple(np.zeros((ticks, *part.shape)) for part in first)
        self.sample_type = type(first)

    def keep_target(self, k: int, sample: AnySample) -> bool:
        """Write down the sample and lock it; False if it is not finite."""
        size = 0.0
        for column, part in zip(self.target, sample, strict=True):
            column[k] = part
            part.setflags(write=False)
            size += float(np.vdot(part, part))
        return isfinite(size)

    def keep(self, k: int, t: float, truth: State, seen: State, tau: Array, command: Array) -> None:
        """Write down one tick; ``tau`` belongs to the tick before."""
        self.t[k], self.t_seen[k] = t, seen.t
        self.q[k], self.dq[k], self.command[k] = truth.q, truth.dq, command
        self.q_seen[k], self.dq_seen[k], self.tau_seen[k] = seen.q, seen.dq, seen.tau_ext
        if k:
            self.tau[k - 1] = self.tau[k] = tau

    def log(self, rows: int, kind: type | None, who: str, arm: Arm) -> Log:
        """The first ``rows`` rows, frozen."""
        cut = {
            name: locked(getattr(self, name)[:rows]) for name in ("t", "q", "dq", "tau", "command")
        }
        seen = (self.t_seen, self.q_seen, self.dq_seen, self.tau_seen)
        at_limit = np.abs(cut["tau"]) >= arm.robot.effort * (1.0 - 1e-9)
        saturated = self.saturated[:rows] | at_limit.any(axis=1)
        saturated.setflags(write=False)
        return Log(
            **cut,
            target=self.sample_type(*(locked(column[:rows]) for column in self.target)),
            measured=State(*(locked(x[:rows]) for x in seen)),  # type: ignore[arg-type]
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


def _checked_sample(target: Target, whom: str) -> AnySample:
    """The target's first sample, read carefully, so that the loop can be quick about the rest."""
    try:
        sample = target(0.0)
    except Exception as error:
        raise ControllerError(
            f"the target {whom} failed at t = 0: {type(error).__name__}: {error}"
        ) from error
    if isinstance(sample, PoseSample):
        shapes: tuple[tuple[int, ...], ...] = ((4, 4), (6,), (6,))
    elif isinstance(sample, Sample):
        shapes = (np.shape(sample.position),) * 3
        if len(shapes[0]) != 1:
            raise ControllerError(_bad_sample(sample, whom, 0.0))
    else:
        raise ControllerError(_bad_sample(sample, whom, 0.0))
    parts = zip(sample._fields, sample, shapes, strict=True)
    return type(sample)(*(np.array(as_array(x, n, f"{whom}'s {name}")) for name, x, n in parts))


def _bad_sample(sample: object, whom: str, t: float) -> str:
    return (
        f"the target {whom} gave {str(sample)[:120]} at t = {t:.3f} s; a target gives "
        "lk.Sample(position, velocity, acceleration) or lk.PoseSample(pose, twist, dtwist), finite"
    )


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
