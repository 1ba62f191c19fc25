"""What the report claimed of its controllers, judged by paired differences over the seeds.

A pair is one task and one seed, run both ways from the same start.  A claim *held* if the mean
difference is positive and its 95 % interval (Student's t) excludes zero, *did not hold* if it is
negative and the interval excludes zero; else, or if the seeds disagree about the sign, the claim is
*undecided*.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from labkit.errors import OutOfRange

from ..comparison.answers import paired_difference
from .grid import Row, pick

THREE = ("workspace velocity", "joint velocity", "joint torque")
IMPEDANCE = ("joint impedance", "workspace impedance")


class Outcome(Enum):
    """What became of a claim."""

    HELD = "held"
    DID_NOT_HOLD = "did not hold"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class Finding:
    """A claim and its evidence.

    Attributes:
        claim: In the report's sense; a positive difference speaks for it.
        outcome: What became of it.
        difference: Mean over the pairs.
        half_width: Of the 95 % interval of the mean.
        unit: Of both.
        pairs: How many.
        by_seed: The mean for each seed.
    """

    claim: str
    outcome: Outcome
    difference: float
    half_width: float
    unit: str
    pairs: int
    by_seed: tuple[float, ...]

    def __str__(self) -> str:
        flips = "; it flips with the seed" if _flips(self.by_seed) else ""
        return (
            f"{self.claim}: {self.outcome.value} ({self.difference:+.3g} ± {self.half_width:.2g} "
            f"{self.unit} over {self.pairs} pairs{flips})"
        )


def judge(claim: str, unit: str, a: Mapping[Any, float], b: Mapping[Any, float]) -> Finding:
    """Does ``a`` exceed ``b``?

    Args:
        claim: What a positive difference would say.
        unit: Of the numbers.
        a: A number for each pair; the keys are (seed, ...).
        b: Its partner, under the same keys.

    Raises:
        OutOfRange: There are fewer than two pairs.
    """
    keys = sorted(a.keys() & b.keys())
    if len(keys) < 2:
        raise OutOfRange(
            f"{len(keys)} pair cannot show a spread, so {claim!r} cannot be judged; take two seeds"
        )
    mean, half = paired_difference([a[k] for k in keys], [b[k] for k in keys])
    seeds = sorted({k[0] for k in keys})
    by_seed = tuple(float(np.mean([a[k] - b[k] for k in keys if k[0] == s])) for s in seeds)
    if abs(mean) <= half or _flips(by_seed):
        outcome = Outcome.UNDECIDED
    else:
        outcome = Outcome.HELD if mean > 0.0 else Outcome.DID_NOT_HOLD
    return Finding(claim, outcome, mean, half, unit, len(keys), by_seed)


def _flips(by_seed: Sequence[float]) -> bool:
    return min(by_seed) < 0.0 < max(by_seed)


def verdicts(rows: Sequence[Row], gains: Sequence[Row], noise: Sequence[Row]) -> list[Finding]:
    """The report's claims (sections 5.2 and 6) from the campaign's rows.

    Args:
        rows: Of `campaign.numbers`.
        gains: Of `campaign.converge`.
        noise: Of `campaign.derivative`.
    """
    found = [
        judge(
            f"{joint} tracks better than {workspace}",
            "mm",
            _mean(rows, (workspace,)),
            _mean(rows, (joint,)),
        )
        for joint, workspace in (
            ("joint velocity", "workspace velocity"),
            ("joint impedance", "workspace impedance"),
        )
    ]
    planned = [row for row in rows if row["task"] != "tag"]  # it cannot follow what moves
    found += [
        judge(
            "the impedance controllers track worse than the other three",
            "mm",
            _mean(rows, IMPEDANCE),
            _mean(rows, THREE),
        )
    ]
    found += [
        judge(
            f"MoveIt tracks better than {way}",
            "mm",
            _mean(planned, (way,)),
            _mean(planned, ("baseline",)),
        )
        for way in (*THREE, *IMPEDANCE)
    ]
    found += [
        judge(
            f"four times the gain converges faster on the {arm} arm",
            "s",
            _by_seed(gains, "tenth_s", plant=plant, Kp=3.0),
            _by_seed(gains, "tenth_s", plant=plant, Kp=12.0),
        )
        for plant, arm in (("ideal", "ideal"), ("baxter", "realistic"))
    ]
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
            )
        )
    return found


def _mean(rows: Iterable[Row], ways: Sequence[str]) -> dict[Any, float]:
    """Error of tracking on Baxter's plant, mean over some ways, for each (seed, task)."""
    here = [row for row in pick(rows, plant="baxter") if row["way"] in ways and not row["failed"]]
    keys = {(row["seed"], row["task"]) for row in here}
    each = {key: [r["late_rms_mm"] for r in here if (r["seed"], r["task"]) == key] for key in keys}
    return {key: float(np.mean(x)) for key, x in each.items() if len(x) == len(ways)}


def _by_seed(rows: Iterable[Row], number: str, **names: Any) -> dict[Any, float]:
    return {(r["seed"],): r[number] for r in pick(rows, **names) if not r["failed"]}


def _minus(a: Mapping[Any, float], b: Mapping[Any, float]) -> dict[Any, float]:
    return {key: a[key] - b[key] for key in a.keys() & b.keys()}
