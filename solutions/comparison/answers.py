"""Answers of notebook 07: the loop on paper, a recipe for gains, and a verdict."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import control
import numpy as np
from scipy.stats import t as student

from labkit.errors import OutOfRange
from labkit.shapes import as_array


def open_loop(kp: float, lag: float, delay: float) -> Any:
    """The loop of a velocity-commanded joint: gain, lag, integrator, delay by Padé."""
    loop = control.tf([kp], [lag, 1.0, 0.0]) if lag else control.tf([kp], [1.0, 0.0])
    return loop * control.tf(*control.pade(delay, 4)) if delay else loop


def recipe(runner: Callable[..., float]) -> tuple[float, float]:
    """Raise Kp until some seed's arm is about to be lost, then take a third of it."""
    stable, error = 4.0, runner(4.0, 0.0, 0)
    for Kp in (8.0, 14.0, 22.0, 34.0, 50.0, 70.0, 100.0):
        now = runner(Kp, 0.0, 0)
        if max(now, runner(Kp, 0.0, 1)) > 1.5 * error:
            break
        stable, error = Kp, now
    return stable / 3.0, 0.0


def paired_difference(a: Any, b: Any) -> tuple[float, float]:
    """Mean of a - b over pairs, and the half width of its 95 % interval.

    Args:
        a: One number for each pair, shape (n,).
        b: Its partner, shape (n,).

    Returns:
        Mean, and Student's t times the standard error of the differences.

    Raises:
        OutOfRange: There are fewer than two pairs, so nothing is known of the spread.
    """
    a = as_array(a, (len(a),), "a")
    d = a - as_array(b, (len(a),), "b")
    n = len(d)
    if n < 2:
        raise OutOfRange(f"{n} pair cannot show a spread; take at least two seeds or tasks")
    return float(d.mean()), float(student.ppf(0.975, n - 1) * d.std(ddof=1) / np.sqrt(n))


def verdict(a: Any, b: Any) -> tuple[float, float, str]:
    """Is a's error the larger one?  The tasks are the units, each with the mean over its seeds."""
    mean, half = paired_difference(np.mean(a, axis=1), np.mean(b, axis=1))
    if abs(mean) <= half:
        return mean, half, "undecided"
    return mean, half, "holds" if mean > 0.0 else "does not hold"
