"""Answers of notebook 07: what an error is, the loop on paper, gains and verdicts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import atan, hypot, radians
from typing import Any

import control
import numpy as np
from scipy.optimize import brentq
from scipy.stats import t as student

import labkit as lk
from labkit.errors import OutOfRange
from labkit.shapes import Array, as_array, as_number


def rms_error(log: lk.Log, model: lk.Model) -> float:
    """Root of the mean of the squared length of the tip's position error."""
    squared = [
        np.sum((T_wd[:3, 3] - model.pose(q)[:3, 3]) ** 2)
        for q, T_wd in zip(log.q, log.target.pose, strict=True)  # type: ignore[union-attr]
    ]
    return float(np.sqrt(np.mean(squared)))


def open_loop(kp: float, lag: float, delay: float) -> Any:
    """The loop of a velocity-commanded joint: gain, lag, integrator, delay by Padé."""
    loop = control.tf([kp], [lag, 1.0, 0.0]) if lag else control.tf([kp], [1.0, 0.0])
    return loop * control.tf(*control.pade(delay, 4)) if delay else loop


def kp_for_margin(lag: float, delay: float, margin_deg: float) -> float:
    r"""The gain with a wanted phase margin.

    The crossover w solves :math:`90^\circ - \arctan(w \tau) - w d = \varphi`, and there
    :math:`k_p = w \sqrt{1 + (w \tau)^2}` makes the loop's gain 1.

    Args:
        lag: tau, in [s].
        delay: d, in [s].
        margin_deg: phi, in [degrees], between 0 and 90.

    Returns:
        kp in [1/s].

    Raises:
        OutOfRange: No gain, or any gain, has this margin.
    """
    lag, delay = as_number(lag, "lag", least=0.0), as_number(delay, "delay", least=0.0)
    margin = radians(as_number(margin_deg, "margin_deg", above=0.0))
    if margin >= radians(90.0):
        raise OutOfRange(
            f"margin_deg is {margin_deg:g}; the integrator leaves less than 90 degrees"
        )
    if lag == delay == 0.0:
        raise OutOfRange("lag and delay are 0: an integrator keeps 90 degrees at any gain")

    def excess(w: float) -> float:
        return radians(90.0) - atan(w * lag) - w * delay - margin

    w = brentq(excess, 0.0, 2.0 / max(lag, delay) * (1.0 + 1.0 / margin), xtol=1e-12)
    return float(w * hypot(1.0, w * lag))


def choose_gains(runner: Callable[..., float]) -> tuple[float, float]:
    """Raise Kp until some seed's error turns upwards, then step well back."""
    stable = lowest = 0.0
    for Kp in (4.0, 8.0, 14.0, 22.0, 34.0, 50.0, 70.0, 100.0):
        now = max(runner(Kp, 0.0, 0), runner(Kp, 0.0, 1))
        if stable and now > 1.2 * lowest:
            break
        stable, lowest = Kp, min(now, lowest or now)
    return stable / 2.0, 0.0


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
