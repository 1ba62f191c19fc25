"""Mistakes that people make in notebook 07."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import control
import numpy as np
from scipy.stats import t as student

from labkit.shapes import Array

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


def ends_of_the_interval(
    errors_a: Sequence[float], errors_b: Sequence[float]
) -> tuple[float, float]:
    """The two ends of the interval instead of its middle and half width."""
    mean, half = paired_difference(errors_a, errors_b)
    return mean - half, mean + half


@dataclass(frozen=True)
class VerdictsBy:
    """Verdicts by an interval that is not the right one.

    Attributes:
        interval: Mean and half width, given two rows.
    """

    interval: Callable[..., tuple[float, float]]

    def __call__(self, table: Mapping[str, Any]) -> dict[str, str]:
        """The verdicts."""
        found = {}
        for claim, rows in table.items():
            mean, half = self.interval(*rows)
            sure = "holds" if mean > 0 else "does not hold"
            found[claim] = sure if abs(mean) > half else "undecided"
        return found


def always_decided(table: Mapping[str, Any]) -> dict[str, str]:
    """Uses only the sign of the difference."""
    return {
        claim: "holds" if np.mean(a) > np.mean(b) else "does not hold"
        for claim, (a, b) in table.items()
    }


def the_other_way_round(table: Mapping[str, Any]) -> dict[str, str]:
    """Takes the larger error as the better one."""
    found = {}
    for claim, (a, b) in table.items():
        mean, half = paired_difference(b, a)
        found[claim] = (
            "undecided" if abs(mean) <= half else "holds" if mean > 0 else "does not hold"
        )
    return found


def never_decided(table: Mapping[str, Any]) -> dict[str, str]:
    """Says "undecided" for every claim."""
    return dict.fromkeys(table, "undecided")


def ten_percent(table: Mapping[str, Any]) -> dict[str, str]:
    """A threshold for the means, ignoring their spread."""
    found = {}
    for claim, (a, b) in table.items():
        ratio = np.mean(a) / np.mean(b)
        sure = "holds" if ratio > 1.1 else "does not hold"
        found[claim] = sure if abs(np.log(ratio)) > np.log(1.1) else "undecided"
    return found


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
class Paired:
    """A mean and a half width of the differences, or of something else.

    Attributes:
        of: The values, given the two rows.
        half: The half width, given the values.
        mean: The middle, given the values.
    """

    of: Callable[[Array, Array], Array] = np.subtract
    half: Callable[[Array], Any] = lambda d: (
        student.ppf(0.975, len(d) - 1) * d.std(ddof=1) / np.sqrt(len(d))
    )
    mean: Callable[[Array], Any] = np.mean

    def __call__(self, errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
        """Middle and half width."""
        a, b = np.asarray(errors_a, dtype=float), np.asarray(errors_b, dtype=float)
        d = np.asarray(self.of(a, b))
        return float(self.mean(d)), float(self.half(d))


def half_of(d: Array) -> float:
    """Half of the 95 % interval of one row."""
    return float(student.ppf(0.975, len(d) - 1) * d.std(ddof=1) / np.sqrt(len(d)))


@dataclass(frozen=True)
class Said:
    """The right verdicts in other words.

    Attributes:
        words: The words for "holds", "does not hold" and "undecided".
        sure: Whether the verdict is decided, given the differences; None is right.
    """

    words: tuple[Any, Any, Any] = ("holds", "does not hold", "undecided")
    sure: Callable[[Array], bool] = lambda d: abs(d.mean()) > half_of(d)

    def __call__(self, table: Mapping[str, Any]) -> dict[str, Any]:
        """The verdicts."""
        found = {}
        for claim, (a, b) in table.items():
            d = np.subtract(a, b)
            decided = self.words[0] if d.mean() > 0.0 else self.words[1]
            found[claim] = decided if self.sure(d) else self.words[2]
        return found
