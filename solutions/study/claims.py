"""Judge what the report claimed about its controllers by paired differences.

A pair is one task and one seed, run with both methods from the same start.  Seeds of one task do
not count as tasks, because they only change the start and the noise.  So each task has its own
verdict, over its seeds, and a verdict on tracking in general has the tasks as its units, each with
the mean over its seeds.  A claim *held* if the interval of the difference is above zero, *did not
hold* if it is below, and is *undecided* otherwise.  Of twelve claims at 95 % each, one would be
decided by chance in every second campaign, so the intervals for a family of m claims have the level
1 - 0.05 / m (Bonferroni), which makes 95 % hold for the whole family.

A task counts for a claim if both methods received the same target.  The built-in method cannot
follow a moving goal, so it receives another target on the tag, and claims about it are judged on
the three paths.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from scipy.stats import t as student

from labkit.errors import OutOfRange

from .grid import Row, pick

THREE = ("workspace velocity", "joint velocity", "joint torque")
IMPEDANCE = ("joint impedance", "workspace impedance")
TICK = 0.005
"""The resolution of the clock of a run at 200 Hz, in [s]."""


class Outcome(Enum):
    """The verdict on a claim."""

    HELD = "held"
    DID_NOT_HOLD = "did not hold"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Interval:
    """A mean difference and its confidence interval.

    Attributes:
        of: What the units are: the name of a task, for its seeds; "tasks"; or "seeds".
        mean: The mean of the differences.
        half_width: The half width of the interval of the mean.
        units: The number of differences.
    """

    of: str
    mean: float
    half_width: float
    units: int

    @property
    def outcome(self) -> Outcome:
        """The verdict, by the side of zero on which the interval is."""
        if abs(self.mean) <= self.half_width:
            return Outcome.UNDECIDED
        return Outcome.HELD if self.mean > 0.0 else Outcome.DID_NOT_HOLD

    def as_data(self) -> dict[str, Any]:
        """The interval as JSON data, with the outcome in words."""
        return {**vars(self), "outcome": self.outcome.value}


@dataclass(frozen=True)
class Finding:
    """A claim and its evidence.

    Attributes:
        claim: The claim, for which a positive difference is evidence.
        unit: The unit of the differences.
        overall: The interval over the tasks, or over the seeds if there is only one condition.
        tasks: The interval of each task over its seeds.
    """

    claim: str
    unit: str
    overall: Interval
    tasks: tuple[Interval, ...] = ()

    def __str__(self) -> str:
        x = self.overall
        alone = "; ".join(f"{t.of} {t.outcome.value} ({t.mean:+.3g})" for t in self.tasks)
        return (
            f"{self.claim}: {x.outcome.value} ({x.mean:+.3g} ± {x.half_width:.2g} {self.unit} over "
            f"{x.units} {x.of}{'; alone: ' * bool(alone)}{alone})"
        )

    def as_data(self) -> dict[str, Any]:
        """The finding as JSON data."""
        alone = [task.as_data() for task in self.tasks]
        return {
            "claim": self.claim,
            "unit": self.unit,
            "overall": self.overall.as_data(),
            "tasks": alone,
        }


def interval(of: str, differences: Sequence[float], claims: int, least: float = 0.0) -> Interval:
    """Student's interval of the mean difference, at a level for ``claims`` of them together.

    Args:
        of: What the units are.
        differences: One difference for each unit.
        claims: How many claims are judged together.
        least: The least half width, given by the resolution of the measurement.

    Raises:
        OutOfRange: There are fewer than two units.
    """
    d = np.asarray(differences, dtype=float)
    if len(d) < 2:
        raise OutOfRange(
            f"{len(d)} pair cannot show a spread, so {of!r} cannot be judged; take two"
        )
    t = student.ppf(1.0 - 0.025 / claims, len(d) - 1)
    half = float(t * d.std(ddof=1) / np.sqrt(len(d)))
    return Interval(of, float(d.mean()), max(half, least), len(d))


def judge(
    claim: str,
    unit: str,
    a: Mapping[Any, float],
    b: Mapping[Any, float],
    *,
    claims: int = 1,
    least: float = 0.0,
) -> Finding:
    """Judge whether ``a`` exceeds ``b``.

    Args:
        claim: The claim for which a positive difference is evidence.
        unit: The unit of the numbers.
        a: A number for each pair; the keys are (seed, task).
        b: The numbers to subtract, under the same keys.
        claims: How many claims are judged together.
        least: See `interval`.

    Raises:
        OutOfRange: A task has fewer than two pairs.
    """
    keys = sorted(a.keys() & b.keys())
    by_task: dict[str, list[float]] = {}
    for seed, task in keys:
        by_task.setdefault(task, []).append(a[seed, task] - b[seed, task])
    alone = tuple(interval(task, d, claims, least) for task, d in by_task.items())
    if len(alone) == 1:
        (one,) = alone
        return Finding(claim, unit, Interval("seeds", one.mean, one.half_width, one.units))
    means = [task.mean for task in alone]
    return Finding(claim, unit, interval("tasks", means, claims, least), alone)


def verdicts(rows: Sequence[Row], gains: Sequence[Row], noise: Sequence[Row]) -> list[Finding]:
    """The report's claims (sections 5.2 and 6) from the campaign's rows.

    Args:
        rows: The rows of `campaign.numbers`.
        gains: The rows of `campaign.converge`.
        noise: The rows of `campaign.derivative`.
    """
    planned = [row for row in rows if row["task"] != "tag"]
    asked: list[tuple[str, Sequence[Row], tuple[str, ...], tuple[str, ...]]] = [
        (f"{joint} tracks better than {workspace}", rows, (workspace,), (joint,))
        for joint, workspace in (
            ("joint velocity", "workspace velocity"),
            ("joint impedance", "workspace impedance"),
        )
    ]
    worse = "the impedance controllers track worse than the other three"
    asked += [(worse, rows, IMPEDANCE, THREE)]
    asked += [
        (f"the built-in method tracks better than {name}", planned, (name,), ("baseline",))
        for name in (*THREE, *IMPEDANCE)
    ]
    found = [
        judge(claim, "mm", _mean(on, a), _mean(on, b), claims=len(asked))
        for claim, on, a, b in asked
    ]
    found += [
        judge(
            f"four times the gain converges faster on the {arm} arm",
            "s",
            _by_seed(gains, "tenth_s", plant=plant, Kp=3.0),
            _by_seed(gains, "tenth_s", plant=plant, Kp=12.0),
            claims=2,
            least=TICK,
        )
        for plant, arm in (("ideal", "ideal"), ("baxter", "realistic"))
    ]
    late = {Kd: _by_seed(noise, "late_rms_mm", plant="baxter", Kd=Kd) for Kd in (0.0, 0.5)}
    better = "Kd = 0.5 tracks better than Kd = 0"
    found.append(judge(better, "mm", late[0.0], late[0.5], claims=3))
    for number, unit, what in (
        ("shake_mm_s", "mm/s", "makes the arm shake"),
        ("late_rms_mm", "mm", "spoils the tracking"),
    ):
        price = {
            plant: _minus(
                _by_seed(noise, number, plant=plant, Kd=1.0),
                _by_seed(noise, number, plant=plant, Kd=0.0),
            )
            for plant in ("baxter", "baxter without noise")
        }
        found.append(
            judge(
                f"noise limits Kd: through the noise, Kd = 1 {what}",
                unit,
                price["baxter"],
                price["baxter without noise"],
                claims=3,
            )
        )
    return found


def _mean(rows: Iterable[Row], controllers: Sequence[str]) -> dict[Any, float]:
    """The tracking error on Baxter's plant, mean over controllers, for each (seed, task)."""
    here = [
        row
        for row in pick(rows, plant="baxter")
        if row["controller"] in controllers and not row["failed"]
    ]
    keys = {(row["seed"], row["task"]) for row in here}
    each = {key: [r["late_rms_mm"] for r in here if (r["seed"], r["task"]) == key] for key in keys}
    return {key: float(np.mean(x)) for key, x in each.items() if len(x) == len(controllers)}


def _by_seed(rows: Iterable[Row], number: str, **names: Any) -> dict[Any, float]:
    """A number of a single condition, for each (seed, "")."""
    return {(r["seed"], ""): r[number] for r in pick(rows, **names) if not r["failed"]}


def _minus(a: Mapping[Any, float], b: Mapping[Any, float]) -> dict[Any, float]:
    return {key: a[key] - b[key] for key in a.keys() & b.keys()}
