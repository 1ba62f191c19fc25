"""Answers of notebook 07: what an error is, the loop on paper, gains and verdicts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import control
import numpy as np
from scipy.stats import t as student

from labkit.errors import OutOfRange
from labkit.shapes import Array, as_array


def open_loop(kp: float, lag: float, delay: float) -> Any:
    """The loop of a velocity-commanded joint: gain, lag, integrator, delay by Padé."""
    loop = control.tf([kp], [lag, 1.0, 0.0]) if lag else control.tf([kp], [1.0, 0.0])
    return loop * control.tf(*control.pade(delay, 4)) if delay else loop


def choose_gains(runner: Callable[..., float]) -> tuple[float, float]:
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
    return _interval(a - as_array(b, (len(a),), "b"))


def _interval(d: Array) -> tuple[float, float]:
    """Mean of the differences, and half of its 95 % interval."""
    n = len(d)
    if n < 2:
        raise OutOfRange(f"{n} pair cannot show a spread; take at least two seeds or tasks")
    return float(d.mean()), float(student.ppf(0.975, n - 1) * d.std(ddof=1) / np.sqrt(n))


def verdicts(table: Mapping[str, Any]) -> dict[str, str]:
    """For each claim: does the first error exceed the second, beyond the seeds' spread?"""
    found = {}
    for claim, (errors_a, errors_b) in table.items():
        mean, half = _interval(np.subtract(errors_a, errors_b))
        if abs(mean) <= half:
            found[claim] = "undecided"
        else:
            found[claim] = "holds" if mean > 0.0 else "does not hold"
    return found
