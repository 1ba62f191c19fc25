"""The log: what happened in a run, one row for each control tick."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from .baxter import robot
from .control import COMMANDS, Command, State
from .plant import Plant
from .robot import DOF, Side
from .shapes import Array, locked
from .trajectory import AnySample, PoseSample, Sample


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


def load_log(path: Path) -> Log:
    """A log from a file that `solutions.study.recording.save` wrote, in single precision."""
    with np.load(path) as file:
        about = json.loads(str(file["about"]))
        columns = {name: file[name] for name in file.files if name != "about"}
    wide: dict[str, Any] = {
        x: a if a.dtype == bool else locked(a.astype(np.float64)) for x, a in columns.items()
    }
    kind = {c.__name__: c for c in (Sample, PoseSample)}[about.pop("target")]
    command = {c.__name__: c for c in COMMANDS}[about.pop("command")]
    plant = about.pop("plant")
    plant |= {x: tuple(v) for x, v in plant.items() if isinstance(v, list)}
    return Log(
        **{name: column for name, column in wide.items() if "." not in name},
        target=kind(*(wide[f"target.{x}"] for x in kind._fields)),
        measured=State(*(wide[f"measured.{x}"] for x in State._fields)),
        command_type=command,
        plant=Plant(**plant),
        **about,
    )


class Recorder:
    """A log while it is being written: each tick is kept as the bytes of its numbers.

    Joining ten short arrays takes 0.4 us, and copying them into a table of NumPy's takes 5.
    """

    def __init__(self, period: float, first: AnySample) -> None:
        """Write down ticks ``period`` [s] apart, with samples like ``first``."""
        self._period, self._kind = period, type(first)
        # q, dq, torque, command, the target's sample, and q, dq, tau_ext as reported
        self._shapes = [(DOF,)] * 4 + [part.shape for part in first] + [(DOF,)] * 3
        self._rows: list[bytes] = []
        self._times: list[float] = []
        self._cut: list[bool] = []

    def __len__(self) -> int:
        return len(self._rows)

    def keep(
        self, truth: State, seen: State, torque: Array, command: Command, sample: AnySample
    ) -> None:
        """Write down one tick; ``torque`` belongs to the tick before."""
        x, dx, ddx = sample
        given = x.tobytes(), dx.tobytes(), ddx.tobytes()  # however they lie in memory
        row: Any = (truth.q, truth.dq, torque, command.value, *given, *seen[1:])
        self._rows.append(b"".join(row))
        self._times.append(seen.t)

    def cut(self, saturated: bool) -> None:
        """Write down whether a limit cut what the arm did since the latest tick."""
        self._cut.append(saturated)

    def log(self, command_type: type, controller: str, plant: Plant, side: Side) -> Log:
        """What was written so far, frozen."""
        n = len(self)
        ends = np.cumsum([prod(shape) for shape in self._shapes])
        table = np.frombuffer(b"".join(self._rows)).reshape(n, ends[-1])
        parts = zip(np.split(table, ends[:-1], axis=1), self._shapes, strict=True)
        q, dq, torque, command, *others = (locked(x.reshape(n, *shape)) for x, shape in parts)
        tau = locked(np.concatenate([torque[1:], torque[-1:]]))
        at_limit = np.abs(tau) >= robot(side).effort * (1.0 - 1e-9)
        saturated = at_limit.any(axis=1) | np.array([*self._cut, False][:n])
        saturated.setflags(write=False)
        return Log(
            t=locked(self._period * np.arange(n, dtype=np.float64)),
            q=q,
            dq=dq,
            tau=tau,
            command=command,
            target=self._kind(*others[:3]),
            measured=State(locked(np.array(self._times[:n])), *others[3:]),  # type: ignore[arg-type]
            saturated=saturated,
            command_type=command_type,
            controller=controller,
            plant=plant,
            side=side,
        )
