"""Runs and trials that come with labkit, for those who lack the planner or the time to run them.

They were recorded by ``solutions/study``: `baseline`, `campaign` and `trials`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from math import inf, isfinite, log
from pathlib import Path
from typing import Any

import numpy as np

from .errors import OutOfRange, UnknownName
from .log import Log
from .shapes import Array, as_number

DATA = Path(__file__).parent / "data"
LINE = DATA / "trials_line.json"
"""Trials of the joint velocity PD along the line on Baxter's plant with five seeds."""


def names() -> tuple[str, ...]:
    """The names of the recorded runs."""
    return tuple(sorted(path.stem for path in (DATA / "recorded").iterdir()))


def load(name: str) -> Log:
    """Load a recorded run, one of `names`, whose numbers are accurate to a micrometre.

    Raises:
        UnknownName: There is no such recording.
    """
    if name not in names():
        raise UnknownName("recorded run", name, names())
    return Log.load(DATA / "recorded" / f"{name}.npz")


def campaign(table: str = "rows") -> Any:
    """Results of every controller on every task with ten seeds, one row for each run.

    Args:
        table: "rows"; or "gains" or "noise", the runs that ask what limits the gains.

    Returns:
        Dicts with the run's "controller", "task", "plant" and "seed", and its errors.
    """
    head, *rows = json.loads((DATA / "campaign.json").read_text())[table]
    return [dict(zip(head, row, strict=True)) for row in rows]


def read_trials(path: Path) -> Trials:
    """Read the trials in a file that `solutions.study.trials` wrote."""
    return Trials(**{key: tuple(value) for key, value in json.loads(path.read_bytes()).items()})


@dataclass(frozen=True)
class Trials:
    """RMS errors of the tip recorded over a plane of gains.

    Attributes:
        cases: Names of the cases, such as "line, seed 0".
        Kp: Proportional gains, ascending, m of them.
        Kd: Derivative gains, ascending, n of them.
        rms_mm: For each case, m rows of n RMS errors in [mm], with None where there is none: the
            arm was lost, or there was no run.
    """

    cases: tuple[str, ...]
    Kp: tuple[float, ...]
    Kd: tuple[float, ...]
    rms_mm: tuple[Any, ...]

    def __post_init__(self) -> None:
        """Make the rows immutable, because students receive them."""
        rows = tuple(tuple(map(tuple, table)) for table in self.rms_mm)
        object.__setattr__(self, "rms_mm", rows)

    def array(self, case: int = 0) -> Array:
        """The errors of a case, shape (m, n) in [mm], NaN where there is none."""
        return np.array(self.rms_mm[case], dtype=float)

    def error(self, case: int, Kp: float, Kd: float) -> float:
        """The error of one case, in [mm], infinite where none was recorded.

        Between the recorded gains, it is interpolated linearly in Kd and in the logarithm of Kp.

        Args:
            case: Index of the case.
            Kp: Proportional gain, within the recorded range.
            Kd: Derivative gain, within the recorded range.

        Raises:
            OutOfRange: There is no such case, or the gains are outside the recorded range.
        """
        if not isinstance(case, int | np.integer) or not 0 <= case < len(self.cases):
            raise OutOfRange(f"there are cases 0 to {len(self.cases) - 1}, not {case!r}")
        i, x = _place(as_number(Kp, "Kp"), self.Kp, "Kp", log)
        j, y = _place(as_number(Kd, "Kd"), self.Kd, "Kd", float)
        weights = np.outer([1.0 - x, x], [1.0 - y, y])
        used = weights > 1e-12
        value = np.sum(weights[used] * self.array(case)[i : i + 2, j : j + 2][used])
        return float(value) if isfinite(value) else inf

    def worst(self, Kp: float, Kd: float) -> float:
        """The largest error over all cases, in [mm]."""
        return max(self.error(case, Kp, Kd) for case in range(len(self.cases)))


@dataclass(frozen=True)
class Runner:
    """Tries gains a limited number of times.

    Attributes:
        trials: The recorded trials.
        budget: How many tries are allowed.
    """

    trials: Trials
    budget: int = 20
    _tried: list[tuple[float, float, int]] = field(default_factory=list, init=False, compare=False)

    def __call__(self, Kp: float, Kd: float, seed: int = 0) -> float:
        """The RMS error of a run with these gains, in [mm]; infinite where none was recorded.

        None was recorded where the arm was lost, or where no run was made.

        Args:
            Kp: Proportional gain, in [1/s].
            Kd: Derivative gain, without unit.
            seed: Seed of the noise and the start, from 0 to 4.

        Raises:
            OutOfRange: The tries are used up, or the gains are outside the recorded range.
        """
        if len(self._tried) >= self.budget:
            raise OutOfRange(f"all {self.budget} tries are used up; choose with what you have seen")
        self._tried.append((Kp, Kd, seed))
        return self.trials.error(seed, Kp, Kd)

    @property
    def left(self) -> int:
        """How many tries are left."""
        return self.budget - len(self._tried)


def _place(value: float, grid: tuple[float, ...], name: str, scale: Any) -> tuple[int, float]:
    """The cell of a grid that contains a value, and the position in that cell, from 0 to 1."""
    if not grid[0] <= value <= grid[-1]:
        raise OutOfRange(f"{name} = {value:g} was not recorded; take {grid[0]:g} to {grid[-1]:g}")
    i = min(int(np.searchsorted(grid, value, side="right")) - 1, len(grid) - 2)
    low, high = scale(grid[i]), scale(grid[i + 1])
    return i, float((scale(value) - low) / (high - low))
