"""The log: what happened in a run, one row for each control tick."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from .control import COMMANDS, Command, State
from .errors import LabkitError
from .plant import Plant
from .robot import SIDES, Robot, as_robot
from .shapes import Array, locked
from .trajectory import AnySample, PoseSample, Sample


@dataclass(frozen=True, eq=False)
class Log:
    """The record of a run, with one row for each control tick, the last one at its end.

    Attributes:
        t: Time since the run began, shape (N,) in [s].
        q: True joint angles, shape (N, n) in [rad].
        dq: True joint speeds, shape (N, n) in [rad/s].
        tau: Motor torque in the last physics step before the next tick, including gravity
            compensation, shape (N, n) in [N m]; the last row repeats the one before it.
        command: The controller's command, shape (N, n), in the unit of `command_type`.
        target: A `Sample` or `PoseSample` of stacked arrays, (N, ...).
        measured: The `State` that the controller saw, stacked: t (N,), q (N, n), dq (N, n),
            tau_ext (N, n).
        saturated: Whether a limit of speed or torque cut the command before the next tick, shape
            (N,).
        command_type: `JointPosition`, `JointVelocity` or `JointTorque`.
        controller: The controller's name.
        plant: The plant that was driven.
        robot: The arm.
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
    robot: Robot

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return (
            f"Log({self.controller} on the {self.plant.name} {self.robot.name} arm, "
            f"{len(self)} ticks, {self.t[-1]:.3g} s)"
        )

    def save(self, path: Any, *, single: bool = False) -> None:
        """Write the log, its robot and its plant to a file that `load` can read.

        Args:
            path: The file; ".npz" is appended to a name without it.
            single: Store the numbers in single precision: half the size, accurate to a micrometre.

        Raises:
            LabkitError: The file cannot be written.
        """
        columns = {name: getattr(self, name) for name in _ROWS}
        for name in ("target", "measured"):
            parts = getattr(self, name)._asdict()
            columns |= {f"{name}.{part}": numbers for part, numbers in parts.items()}
        about = {
            "target": type(self.target).__name__,
            "command": self.command_type.__name__,
            "controller": self.controller,
            "plant": asdict(self.plant),
            "robot": self.robot.name if _is_baxters(self.robot) else self.robot.data(),
        }
        if single:
            columns = {
                x: a if a.dtype == bool else a.astype(np.float32) for x, a in columns.items()
            }
        try:
            np.savez_compressed(path, about=np.array(json.dumps(about)), **columns)
        except OSError as error:
            raise LabkitError(
                f"the log cannot be written to {path}: {error.strerror}; save it somewhere else"
            ) from None

    @classmethod
    def load(cls, path: Any) -> Log:
        """Read a log that `save` wrote.

        Raises:
            LabkitError: The file cannot be read, or is not a log.
        """
        path = Path(path)
        if not path.exists() and path.suffix != ".npz":
            path = path.with_name(f"{path.name}.npz")  # the name that `save` used
        try:
            with np.load(path) as file:
                about = json.loads(str(file["about"]))
                columns: dict[str, Any] = {x: file[x] for x in file.files if x != "about"}
            return cls(**_read(about, columns))
        except Exception as error:  # there are many ways to be no such file
            raise LabkitError(
                f"{path} is not a log that labkit saved, or is damaged: {error}; take the file "
                "that log.save(...) wrote, or run it again"
            ) from None


_ROWS = ("t", "q", "dq", "tau", "command", "saturated")


def _is_baxters(robot: Robot) -> bool:
    """Whether ``robot`` is one of Baxter's arms, unmodified."""
    return robot.name in SIDES and robot.data() == as_robot(robot.name).data()


def _read(about: dict[str, Any], columns: dict[str, Any]) -> dict[str, Any]:
    """The fields of a log from the contents of its file."""
    wide = {x: locked(a if a.dtype == bool else a.astype(np.float64)) for x, a in columns.items()}
    target = {c.__name__: c for c in (Sample, PoseSample)}[about["target"]]
    robot = about["robot"]
    return {
        **{name: wide[name] for name in _ROWS},
        "target": target(*(wide[f"target.{x}"] for x in target._fields)),
        "measured": State._make(wide[f"measured.{x}"] for x in State._fields),
        "command_type": {c.__name__: c for c in COMMANDS}[about["command"]],
        "controller": about["controller"],
        "plant": Plant(**about["plant"]),
        "robot": Robot(**robot) if isinstance(robot, dict) else as_robot(robot),
    }


class Recorder:
    """Records a log while a run goes on, each tick as the bytes of one row of a table."""

    kind: type = type(None)
    """The type of the run's commands."""

    def __init__(self, robot: Robot, plant: Plant, controller: str, first: AnySample) -> None:
        """Record a run of ``controller``, whose target's samples are like ``first``."""
        self._robot, self._plant, self._controller = robot, plant, controller
        self._sample = type(first)
        # q, dq, torque, q, dq and tau_ext as reported, the target's sample, command
        self._shapes = [(robot.n,)] * 6 + [part.shape for part in first] + [(robot.n,)]
        self._next: tuple[float, float, bytes] = (0.0, 0.0, b"")
        self._rows: list[bytes] = []
        self._times: list[tuple[float, float]] = []
        self._cut: list[bool] = []

    def __len__(self) -> int:
        return len(self._times)

    def keep(
        self, t: float, q: Array, dq: Array, torque: Array, seen: State, sample: AnySample
    ) -> None:
        """Record the arm and its target at ``t`` [s], before the controller gets them."""
        parts: Any = (q, dq, torque, seen.q, seen.dq, seen.tau_ext, *sample)
        self._next = t, seen.t, b"".join(parts)

    def commanded(self, command: Command) -> None:
        """Record the controller's command, with which the tick counts."""
        t, reported, row = self._next
        self._rows.append(row + command.value.tobytes())
        self._times.append((t, reported))

    def cut(self, saturated: bool) -> None:
        """Record whether a limit cut the command after the latest tick."""
        self._cut.append(saturated)

    def log(self) -> Log:
        """The log of the ticks recorded so far, read-only."""
        n = len(self)
        ends = np.cumsum([prod(shape) for shape in self._shapes])[:-1]
        table = np.frombuffer(b"".join(self._rows)).reshape(n, -1)
        parts = zip(np.split(table, ends, axis=1), self._shapes, strict=True)
        q, dq, torque, *others, command = (
            locked(np.array(x).reshape(n, *shape)) for x, shape in parts
        )
        tau = locked(np.concatenate([torque[1:], torque[-1:]]))
        at_limit = np.abs(tau) >= self._robot.effort * (1.0 - 1e-9)
        saturated = at_limit.any(axis=1) | np.array([*self._cut, False][:n])
        saturated.setflags(write=False)
        t, reported = (locked(x) for x in np.array(self._times).T.copy())
        return Log(
            t=t,
            q=q,
            dq=dq,
            tau=tau,
            command=command,
            target=self._sample(*others[3:]),
            measured=State(reported, *others[:3]),  # type: ignore[arg-type]
            saturated=saturated,
            command_type=self.kind,
            controller=self._controller,
            plant=self._plant,
            robot=self._robot,
        )
