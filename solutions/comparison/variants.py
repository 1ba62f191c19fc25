"""Right answers to notebook 07 in other forms."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
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


def verdict_by_scipy(a: Any, b: Any) -> Any:
    """With scipy's paired test, in a list."""
    d = np.mean(a, axis=1) - np.mean(b, axis=1)
    test = stats.ttest_1samp(d, 0.0)
    low, high = test.confidence_interval(0.95)
    word = "undecided" if test.pvalue >= 0.05 else ("does not hold", "holds")[int(d.mean() > 0)]
    return [d.mean(), (high - low) / 2, word]
