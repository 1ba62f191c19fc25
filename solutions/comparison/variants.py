"""Right answers to notebook 07 in other forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import sqrt
from statistics import mean, stdev
from typing import Any

import control
import numpy as np
from scipy import stats


def loop_from_s(kp: float, lag: float, delay: float) -> Any:
    """Written with the symbol s, and a Padé approximation of another order."""
    s = control.tf("s")
    loop = kp / (s * (lag * s + 1))
    num, den = control.pade(delay, 6) if delay else ([1.0], [1.0])
    return loop * control.tf(num, den)


def by_doubling(runner: Callable[..., float]) -> list[float]:
    """Doubles Kp while the error does not grow, and returns half of the last one."""
    Kp = 5.0
    while runner(2.0 * Kp, 0.0, 0) < 1.2 * runner(Kp, 0.0, 0):
        Kp *= 2.0
    return [Kp / 2.0, 0.0]


def by_bisection(runner: Callable[..., float]) -> Any:
    """Finds the limit by bisection on two seeds, and returns two fifths of it."""
    low, high = 4.0, 100.0
    for _ in range(8):
        middle = sqrt(low * high)
        safe = max(runner(middle, 0.0, seed) for seed in (0, 1)) < 4.0
        low, high = (middle, high) if safe else (low, middle)
    return np.array([0.4 * low, 0.0])


def paired_by_scipy(errors_a: Sequence[float], errors_b: Sequence[float]) -> Any:
    """With scipy's own confidence interval."""
    interval = stats.ttest_rel(errors_a, errors_b).confidence_interval(0.95)
    return np.array([(interval.low + interval.high) / 2, (interval.high - interval.low) / 2])


def paired_by_hand(errors_a: Sequence[float], errors_b: Sequence[float]) -> Any:
    """With the statistics module, and Student's t as a table has it."""
    d = [a - b for a, b in zip(errors_a, errors_b, strict=True)]
    return mean(d), round(stats.t.interval(0.95, len(d) - 1)[1], 3) * stdev(d) / sqrt(len(d))


def paired_by_interval(errors_a: Sequence[float], errors_b: Sequence[float]) -> Any:
    """With the interval of Student's t about the mean; scipy has none where nothing spreads."""
    d = np.subtract(errors_a, errors_b)
    low, high = stats.t.interval(0.95, len(d) - 1, loc=d.mean(), scale=stats.sem(d))
    return d.mean(), (high - low) / 2


def verdicts_by_comprehension(table: Mapping[str, Any]) -> Any:
    """In one expression, from the signs of the two ends of the interval."""
    words = {2: "holds", -2: "does not hold"}
    return {
        claim: words.get(
            int(sum(np.sign(stats.ttest_rel(a, b).confidence_interval()))), "undecided"
        )
        for claim, (a, b) in table.items()
    }
