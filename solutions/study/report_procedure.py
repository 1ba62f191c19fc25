"""The report's tuning procedure (section 5.1) as an algorithm, with a measurement for each step.

1. Try feed-forward alone.
2. Raise the proportional gain until the loop oscillates.
3. Take half of that gain.
4. Raise the derivative gain until the error no longer decays faster.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit.errors import Diverged, OutOfRange
from labkit.shapes import as_array, as_number

Trial = Callable[[float, float], tuple[Any, Any]]
"""Tries gains (Kp, Kd); returns times (N,) [s] and a joint's error (N,), target minus actual."""

OSCILLATES = 0.9
"""If a swing has at least this share of the previous one, the oscillation is sustained."""


@dataclass(frozen=True)
class Step:
    """One trial of the procedure.

    Attributes:
        Kp: Proportional gain.
        Kd: Derivative gain.
        decay: The ratio of one swing to the previous one; 0 without swings, unstable from 1 on.
        rms: The RMS of the error, in its unit; infinite if the run was stopped.
        why: What the procedure concluded from it.
    """

    Kp: float
    Kd: float
    decay: float
    rms: float
    why: str


@dataclass(frozen=True)
class Tuning:
    """The outcome of the procedure.

    Attributes:
        Kp: The proportional gain to use.
        Kd: The derivative gain to use.
        ultimate: The proportional gain at which the loop oscillated.
        steps: Every trial, in order.
    """

    Kp: float
    Kd: float
    ultimate: float
    steps: tuple[Step, ...]


def report_procedure(
    trial: Trial,
    *,
    Kp: float = 1.0,
    Kd: float = 0.05,
    growth: float = 1.3,
    most: int = 40,
) -> Tuning:
    """Tune by the report's four steps.

    Args:
        trial: Tries gains; the joint should start off its target.
        Kp: The first proportional gain to try.
        Kd: The first derivative gain to try, as a share of the chosen Kp.
        growth: The factor from one trial to the next.
        most: The number of trials after which to give up.

    Returns:
        The gains, and how they were found.

    Raises:
        OutOfRange: The loop never oscillated, so there is no gain to halve.
    """
    as_number(Kp, "Kp", above=0.0)
    as_number(growth, "growth", above=1.0)
    steps = [_try(trial, 0.0, 0.0, "feed-forward alone")]
    gain = Kp
    while True:
        step = _try(trial, gain, 0.0, "more")
        if step.decay >= OSCILLATES:
            steps.append(Step(step.Kp, 0.0, step.decay, step.rms, "oscillates"))
            break
        steps.append(step)
        if len(steps) > most:
            raise OutOfRange(
                f"no oscillation up to Kp = {gain:.3g} in {most} trials: raise growth, or, if the "
                "loop has no delay and no lag, choose the gain by the noise and the torque instead"
            )
        gain *= growth
    chosen, ultimate = gain / 2.0, gain
    best = _try(trial, chosen, 0.0, "half of that")
    steps.append(best)
    derivative = Kd * chosen
    while len(steps) <= most:
        step = _try(trial, chosen, derivative, "more damping")
        if step.decay >= OSCILLATES or step.rms >= best.rms:
            steps.append(Step(chosen, derivative, step.decay, step.rms, "no better: stop"))
            break
        steps.append(step)
        best, derivative = step, derivative * growth
    return Tuning(chosen, best.Kd, ultimate, tuple(steps))


def _try(trial: Trial, Kp: float, Kd: float, why: str) -> Step:
    try:
        t, e = trial(Kp, Kd)
    except Diverged:
        return Step(Kp, Kd, float("inf"), float("inf"), why)
    e = as_array(e, (len(t),), "the trial's error")
    return Step(Kp, Kd, decay_ratio(e), float(np.sqrt(np.mean(e * e))), why)


def decay_ratio(error: Any) -> float:
    """The ratio of a swing to the previous one, which has the other sign.

    Args:
        error: The error of a joint over time, shape (N,).

    Returns:
        The geometric mean over all swings except the first, which is the start, and the last,
        which may be incomplete; 0 if fewer than two remain.  Swings below a thousandth of the
        largest are noise and do not count.
    """
    e = np.asarray(error, dtype=float)
    edges = np.flatnonzero(np.diff(np.signbit(e))) + 1
    peaks = np.array([np.abs(part).max() for part in np.split(e, edges)])
    peaks = peaks[: int(np.argmax(peaks < 1e-3 * peaks.max())) or len(peaks)]
    swings = peaks[1:-1]
    if len(swings) < 2:
        return 0.0
    return float((swings[-1] / swings[0]) ** (1.0 / (len(swings) - 1)))
