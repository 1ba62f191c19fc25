"""Recorded trials of gains: what a run would have given, without running it.

Made by ``python -m solutions.trials``; between the recorded gains the error is interpolated.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from math import inf, isfinite, log
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import as_number
from ..errors import OutOfRange


@dataclass(frozen=True)
class Trials:
    """RMS errors recorded over a plane of gains.

    Attributes:
        cases: Names of the cases, such as "line, seed 0".
        Kp: Proportional gains, ascending, m of them, in [1/s].
        Kd: Derivative gains, ascending, n of them, without unit.
        rms_mm: For each case m rows of n RMS errors in [mm]; None where the arm was lost.
    """

    cases: tuple[str, ...]
    Kp: tuple[float, ...]
    Kd: tuple[float, ...]
    rms_mm: tuple[Any, ...]

    def __post_init__(self) -> None:
        """Make rows that nobody can write to, for a student is given them."""
        rows = tuple(tuple(map(tuple, table)) for table in self.rms_mm)
        object.__setattr__(self, "rms_mm", rows)

    def error(self, case: int, Kp: float, Kd: float) -> float:
        """The error of one case, in [mm], infinite where the arm is lost.

        Args:
            case: Which.
            Kp: Within the recorded range.
            Kd: Within the recorded range.

        Raises:
            OutOfRange: No such case, or gains that nobody recorded.
        """
        if not isinstance(case, int | np.integer) or not 0 <= case < len(self.cases):
            raise OutOfRange(f"there are cases 0 to {len(self.cases) - 1}, not {case!r}")
        i, x = _place(as_number(Kp, "Kp"), self.Kp, "Kp", log)
        j, y = _place(as_number(Kd, "Kd"), self.Kd, "Kd", float)
        rows = np.array(self.rms_mm[case], dtype=float)[i : i + 2, j : j + 2]
        weights = np.outer([1.0 - x, x], [1.0 - y, y])
        used = weights > 1e-12
        value = float(np.sum(weights[used] * rows[used]))
        return value if isfinite(value) else inf

    def worst(self, Kp: float, Kd: float) -> float:
        """The largest error over all cases, in [mm]."""
        return max(self.error(case, Kp, Kd) for case in range(len(self.cases)))

    def save(self, path: Path) -> None:
        """Write it as JSON."""
        path.write_text(json.dumps(vars(self)) + "\n")


LINE = Path(__file__).parents[1] / "data" / "trials_line.json"
"""The joint velocity PD along the line on Baxter's plant, five seeds."""


def read_trials(path: Path) -> Trials:
    """The trials that `Trials.save` wrote."""
    data = json.loads(path.read_text())
    return Trials(**{key: tuple(value) for key, value in data.items()})


@dataclass(frozen=True)
class Runner:
    """Tries gains for you, a limited number of times.

    Attributes:
        trials: What was recorded.
        budget: How many tries there are.
    """

    trials: Trials
    budget: int = 20
    _tried: list[tuple[float, float, int]] = field(default_factory=list, init=False, compare=False)

    def __call__(self, Kp: float, Kd: float, seed: int = 0) -> float:
        """The RMS error of a run with these gains, in [mm]; infinite if the arm was lost.

        Args:
            Kp: Proportional gain, in [1/s].
            Kd: Derivative gain.
            seed: Which noise and which start; 0 to 4.

        Raises:
            OutOfRange: The tries are used up, or nobody recorded such gains.
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
    """The cell of a grid that a value falls in, and where in it, from 0 to 1."""
    if not grid[0] <= value <= grid[-1]:
        raise OutOfRange(f"{name} = {value:g} was not recorded; take {grid[0]:g} to {grid[-1]:g}")
    i = min(int(np.searchsorted(grid, value, side="right")) - 1, len(grid) - 2)
    low, high = scale(grid[i]), scale(grid[i + 1])
    return i, float((scale(value) - low) / (high - low))
