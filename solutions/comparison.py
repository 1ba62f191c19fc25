"""Answers of notebook 07: what an error is, the loop on paper, gains and verdicts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import atan, pi, radians, sqrt
from typing import Any

import control
import numpy as np
from scipy.optimize import brentq
from scipy.stats import t as student

import labkit as lk


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
    """The gain at which the phase margin is as wanted: phase first, then the gain to be 1 there."""

    def margin(w: float) -> float:  # integrator, lag and delay each cost phase
        return pi / 2 - atan(lag * w) - delay * w - radians(margin_deg)

    high = 1.0
    while margin(high) > 0.0:
        high *= 2.0
    w = brentq(margin, 1e-9, high, xtol=1e-12)
    return float(w * sqrt(1.0 + (lag * w) ** 2))


def choose_gains(runner: Callable[..., float]) -> tuple[float, float]:
    """Raise Kp until some seed's arm is about to be lost, then step well back."""
    stable, error = 4.0, runner(4.0, 0.0, 0)
    for Kp in (8.0, 14.0, 22.0, 34.0, 50.0, 70.0, 100.0):
        now = runner(Kp, 0.0, 0)
        if max(now, runner(Kp, 0.0, 1)) > 1.5 * error:
            break
        stable, error = Kp, now
    return stable / 2.0, 0.0


def paired_difference(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """Mean of a - b over pairs, and half the width of its 95 % interval (Student's t)."""
    d = np.asarray(errors_a, dtype=float) - np.asarray(errors_b, dtype=float)
    n = len(d)
    return float(d.mean()), float(student.ppf(0.975, n - 1) * d.std(ddof=1) / np.sqrt(n))


def verdicts(table: Mapping[str, Any]) -> dict[str, str]:
    """For each claim: does the first error exceed the second, beyond the seeds' spread?"""
    found = {}
    for claim, (errors_a, errors_b) in table.items():
        mean, half = paired_difference(errors_a, errors_b)
        if abs(mean) <= half:
            found[claim] = "undecided"
        else:
            found[claim] = "holds" if mean > 0.0 else "does not hold"
    return found
