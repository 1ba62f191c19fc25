"""Mistakes that people make in notebook 07."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import control
import numpy as np
from scipy.stats import t as student

from .answers import paired_difference


@dataclass(frozen=True)
class LoopWithout:
    """The loop with a factor omitted or inverted.

    Attributes:
        kp: Power of the gain.
        lag: Power of the lag.
        delay: Factor of the delay; a negative one inverts it.
        order: Order of Padé's approximation.
    """

    kp: float = 1.0
    lag: float = 1.0
    delay: float = 1.0
    order: int = 4

    def __call__(self, kp: float, lag: float, delay: float) -> Any:
        """The transfer function."""
        loop = control.tf([kp**self.kp], [1.0, 0.0]) * control.tf([1.0], [lag * self.lag, 1.0])
        if not delay * self.delay:
            return loop
        late = control.tf(*control.pade(delay * abs(self.delay), self.order))
        return loop * late if self.delay > 0.0 else loop / late


def no_integrator(kp: float, lag: float, delay: float) -> Any:
    """The loop from command to speed, without the integrator to the angle."""
    loop = control.tf([kp], [lag, 1.0])
    return loop * control.tf(*control.pade(delay, 4)) if delay else loop


def closed_loop(kp: float, lag: float, delay: float) -> Any:
    """The closed loop, from which margins cannot be read."""
    loop = control.tf([kp], [lag, 1.0, 0.0] if lag else [1.0, 0.0])
    return control.feedback(loop * control.tf(*control.pade(delay, 4)) if delay else loop)


def delay_as_a_lag(kp: float, lag: float, delay: float) -> Any:
    """The delay as another lag, with 45 degrees at 1/delay and never more than 90."""
    return control.tf([kp], [1.0, 0.0]) * control.tf([1.0], [lag, 1.0]) * control.tf(1, [delay, 1])


@dataclass(frozen=True)
class Lowest:
    """The gain with the lowest error on the line, of its worst seed.

    Attributes:
        share: Factor of the gain.
    """

    share: float = 1.0

    def __call__(self, runner: Callable[..., float]) -> tuple[float, float]:
        """The gains."""
        tried = {
            Kp: max(runner(Kp, 0.0, seed) for seed in range(5)) for Kp in (14.0, 22.0, 34.0, 50.0)
        }
        return self.share * min(tried, key=lambda Kp: tried[Kp]), 0.0


def unpaired(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """Ignores the pairs, so the spread of the seeds hides the difference."""
    a, b = np.asarray(errors_a, dtype=float), np.asarray(errors_b, dtype=float)
    n = len(a)
    spread = np.sqrt(a.var(ddof=1) / n + b.var(ddof=1) / n)
    return float(a.mean() - b.mean()), float(student.ppf(0.975, n - 1) * spread)


def deviation_of_one(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """The spread of one difference, not of their mean."""
    d = np.asarray(errors_a, dtype=float) - np.asarray(errors_b, dtype=float)
    return float(d.mean()), float(student.ppf(0.975, len(d) - 1) * d.std(ddof=1))


def normal_quantile(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """The normal quantile, 1.96, as if five seeds were many."""
    d = np.asarray(errors_a, dtype=float) - np.asarray(errors_b, dtype=float)
    return float(d.mean()), float(1.96 * d.std(ddof=1) / np.sqrt(len(d)))


@dataclass(frozen=True)
class Interval:
    """A paired interval with other parts.

    Attributes:
        quantile: The quantile of Student's t.
        given: The number subtracted from n in the standard deviation.
        freedom: The number subtracted from n for the degrees of freedom.
        sign: Factor of the difference.
        share: Factor of the half width.
    """

    quantile: float = 0.975
    given: int = 1
    freedom: int = 1
    sign: float = 1.0
    share: float = 1.0

    def __call__(self, errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
        """Mean and half width."""
        d = self.sign * np.subtract(errors_a, errors_b)
        t = student.ppf(self.quantile, len(d) - self.freedom)
        width = t * d.std(ddof=self.given) / np.sqrt(len(d))
        return float(d.mean()), float(self.share * width)


@dataclass(frozen=True)
class Loop:
    """The loop with another factor instead of the lag and the integrator.

    Attributes:
        rest: Numerator and denominator, given kp and lag.
        delay: The delay, given delay and lag.
        close: A function of the finished loop.
    """

    rest: Callable[[float, float], tuple[list[float], list[float]]]
    delay: Callable[[float, float], float] = lambda delay, lag: delay
    close: Callable[[Any], Any] = lambda loop: loop

    def __call__(self, kp: float, lag: float, delay: float) -> Any:
        """The transfer function."""
        loop = control.tf(*self.rest(kp, lag))
        late = self.delay(delay, lag)
        return self.close(loop * control.tf(*control.pade(late, 4)) if late else loop)


@dataclass(frozen=True)
class Judged:
    """The verdict with another rule.

    Attributes:
        interval: Mean and half width, given two rows.
        units: The rows, given errors of shape (tasks, seeds).
        says: The verdict, given mean and half width; None is the right one.
    """

    interval: Callable[..., tuple[float, float]] = paired_difference
    units: Callable[[Any], Any] = lambda errors: np.mean(errors, axis=1)
    says: Callable[[float, float], str] | None = None

    def __call__(self, a: Any, b: Any) -> tuple[float, float, str]:
        """Mean, half width and verdict."""
        mean, half = self.interval(self.units(np.array(a)), self.units(np.array(b)))
        right = "undecided" if abs(mean) <= half else "holds" if mean > 0 else "does not hold"
        return mean, half, self.says(mean, half) if self.says else right
