"""Mistakes that people make in notebook 07."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import atan, pi, radians, sqrt
from typing import Any

import control
import numpy as np
from scipy.optimize import brentq
from scipy.stats import t as student

import labkit as lk
from labkit.shapes import Array

from .answers import open_loop, paired_difference


def mean_of_components(log: lk.Log, model: lk.Model) -> float:
    """The mean over the three components, too, which is too small by the root of three."""
    e = [
        T[:3, 3] - model.pose(q)[:3, 3]
        for q, T in zip(log.q, log.target.pose, strict=True)  # type: ignore[union-attr]
    ]
    return float(np.sqrt(np.mean(np.square(e))))


def last_row_for_all(log: lk.Log, model: lk.Model) -> float:
    """The tip from the last joint angles in every row, as in the plots of the report."""
    p = model.pose(log.q[-1])[:3, 3]
    e = [T[:3, 3] - p for T in log.target.pose]  # type: ignore[union-attr]
    return float(np.sqrt(np.mean(np.sum(np.square(e), axis=1))))


def mean_of_lengths(log: lk.Log, model: lk.Model) -> float:
    """The mean error, not the root of the mean square."""
    e = [
        np.linalg.norm(T[:3, 3] - model.pose(q)[:3, 3])
        for q, T in zip(log.q, log.target.pose, strict=True)  # type: ignore[union-attr]
    ]
    return float(np.mean(e))


def _errors(log: lk.Log, model: lk.Model) -> Array:
    """The error of each row, shape (rows, 3) in [m]."""
    poses = log.target.pose  # type: ignore[union-attr]
    return np.array([T[:3, 3] - model.pose(q)[:3, 3] for q, T in zip(log.q, poses, strict=True)])


def largest(log: lk.Log, model: lk.Model) -> float:
    """The largest error."""
    return float(np.linalg.norm(_errors(log, model), axis=1).max())


def without_the_root(log: lk.Log, model: lk.Model) -> float:
    """The mean square, in square metres."""
    return float(np.mean(np.sum(_errors(log, model) ** 2, axis=1)))


def in_millimetres(log: lk.Log, model: lk.Model) -> float:
    """The error in millimetres, a thousand times too large."""
    return 1e3 * float(np.sqrt(without_the_root(log, model)))


def not_a_mean(log: lk.Log, model: lk.Model) -> float:
    """The root of the sum, which grows with the length of the run."""
    return float(np.linalg.norm(_errors(log, model)))


def whole_poses(log: lk.Log, model: lk.Model) -> float:
    """The difference of whole poses, in which nine of sixteen numbers are those of a rotation."""
    poses = log.target.pose  # type: ignore[union-attr]
    e = [T - model.pose(q) for q, T in zip(log.q, poses, strict=True)]
    return float(np.sqrt(np.mean(np.sum(np.square(e), axis=(1, 2)))))


def one_row_late(log: lk.Log, model: lk.Model) -> float:
    """Compares the target of each row with the tip of the previous row."""
    poses = log.target.pose  # type: ignore[union-attr]
    e = [T[:3, 3] - model.pose(q)[:3, 3] for q, T in zip(log.q[:-1], poses[1:], strict=True)]
    return float(np.sqrt(np.mean(np.sum(np.square(e), axis=1))))


def length_of_the_mean(log: lk.Log, model: lk.Model) -> float:
    """The length of the mean error, in which errors cancel."""
    return float(np.linalg.norm(_errors(log, model).mean(axis=0)))


def always_the_left_arm(log: lk.Log, model: lk.Model) -> float:
    """Uses its own model and ignores the given one."""
    return float(np.sqrt(without_the_root(log, _LEFT)))


_LEFT = lk.Model("left")


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


def delay_forgotten(kp: float, lag: float, delay: float) -> Any:
    """Returns the integrator at once where there is no lag."""
    return open_loop(kp, lag, delay if lag else 0.0)


def delay_as_a_lag(kp: float, lag: float, delay: float) -> Any:
    """The delay as another lag, with 45 degrees at 1/delay and never more than 90."""
    return control.tf([kp], [1.0, 0.0]) * control.tf([1.0], [lag, 1.0]) * control.tf(1, [delay, 1])


def _kp(lag: float, delay: float, margin: float) -> float:
    def left(w: float) -> float:
        return pi / 2 - atan(lag * w) - delay * w - margin

    high = 1.0
    while left(high) > 0.0 and high < 1e9:
        high *= 2.0
    w = brentq(left, -1e3, high)
    return float(w * sqrt(1.0 + (lag * w) ** 2))


def margin_in_radians(lag: float, delay: float, margin_deg: float) -> float:
    """Takes the margin for radians."""
    return _kp(lag, delay, margin_deg)


def without_the_delay(lag: float, delay: float, margin_deg: float) -> float:
    """Forgets the delay, so the gain is too large."""
    return _kp(lag, 0.0, radians(margin_deg))


def lag_free_gain(lag: float, delay: float, margin_deg: float) -> float:
    """Finds the right frequency, and returns it as the gain."""

    def left(w: float) -> float:
        return pi / 2 - atan(lag * w) - delay * w - radians(margin_deg)

    return float(brentq(left, 1e-9, 1e4))


@dataclass(frozen=True)
class GainAt:
    """The right frequency with another gain.

    Attributes:
        power: Power of the right gain; -1 is the gain of the loop itself.
        lag: Power of the contribution of the lag.
        integrator: Power of the contribution of the integrator.
    """

    power: float = 1.0
    lag: float = 1.0
    integrator: float = 1.0

    def __call__(self, lag: float, delay: float, margin_deg: float) -> float:
        """The gain."""
        w = lag_free_gain(lag, delay, margin_deg)
        gain = w**self.integrator * sqrt(1.0 + (lag * w) ** 2) ** self.lag
        return float(gain**self.power)


def phase_mixed(lag: float, delay: float, margin_deg: float) -> float:
    """Adds the phase of the delay in radians to degrees."""

    def left(w: float) -> float:
        return float(90.0 - np.degrees(atan(lag * w)) - delay * w - margin_deg)

    w = brentq(left, 1e-9, 1e6)
    return float(w * sqrt(1.0 + (lag * w) ** 2))


def in_hertz(lag: float, delay: float, margin_deg: float) -> float:
    """Divided by 2 pi."""
    return float(_kp(lag, delay, radians(margin_deg)) / (2.0 * pi))


def best_on_the_training_path(runner: Callable[..., float]) -> tuple[float, float]:
    """Searches a grid with one seed and takes the winner, at the edge of the cliff."""
    tried = {
        (Kp, Kd): runner(Kp, Kd, 0)
        for Kp in (14.0, 22.0, 34.0, 50.0, 70.0, 100.0)
        for Kd in (0.0, 0.4, 1.0)
    }
    return min(tried, key=lambda gains: tried[gains])


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


@dataclass(frozen=True)
class Typed:
    """Gains that were not tried.

    Attributes:
        Kp: Proportional gain.
        Kd: Derivative gain.
    """

    Kp: float
    Kd: float

    def __call__(self, runner: Callable[..., float]) -> tuple[float, float]:
        """The gains."""
        return self.Kp, self.Kd


def as_soft_as_possible(runner: Callable[..., float]) -> tuple[float, float]:
    """Gains so small that the arm does not follow."""
    return 2.0, 0.0


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


def without_students_t(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """Only the standard error."""
    d = np.subtract(errors_a, errors_b)
    return float(d.mean()), float(d.std(ddof=1) / np.sqrt(len(d)))


def plain_deviation(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """Only the standard deviation."""
    d = np.subtract(errors_a, errors_b)
    return float(d.mean()), float(d.std(ddof=1))


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


def by_majority(table: Mapping[str, Any]) -> dict[str, str]:
    """Counts the seeds on which the first is larger."""
    return {
        claim: "holds" if np.mean(np.greater(a, b)) > 0.5 else "does not hold"
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


def t_of_five(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """The quantile 2.776 for any number of pairs."""
    d = np.subtract(errors_a, errors_b)
    return float(d.mean()), float(2.776 * d.std(ddof=1) / np.sqrt(len(d)))


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


def sorted_first(table: Mapping[str, Any]) -> dict[str, str]:
    """Pairs the best with the best."""
    ordered = {claim: [sorted(row) for row in rows] for claim, rows in table.items()}
    return VerdictsBy(paired_difference)(ordered)


@dataclass(frozen=True)
class Rms:
    """Another number from the right errors.

    Attributes:
        number: The number, given the errors, shape (rows, 3).
    """

    number: Callable[[Array], Any]

    def __call__(self, log: lk.Log, model: lk.Model) -> float:
        """The number."""
        return float(self.number(_errors(log, model)))


def rms(errors: Array) -> Any:
    """Root of the mean squared length of rows."""
    return np.sqrt(np.mean(np.sum(np.square(errors), axis=1)))


def from_the_first_target(log: lk.Log, model: lk.Model) -> float:
    """The distance of every row from the first target."""
    p = log.target.pose[0][:3, 3]  # type: ignore[union-attr]
    return float(rms(np.array([p - model.pose(q)[:3, 3] for q in log.q])))


def from_the_last_target(log: lk.Log, model: lk.Model) -> float:
    """The distance of every row from the last target."""
    p = log.target.pose[-1][:3, 3]  # type: ignore[union-attr]
    return float(rms(np.array([p - model.pose(q)[:3, 3] for q in log.q])))


def from_the_first_tip(log: lk.Log, model: lk.Model) -> float:
    """The distance that the tip moved, ignoring its target."""
    p = model.pose(log.q[0])[:3, 3]
    return float(rms(np.array([p - model.pose(q)[:3, 3] for q in log.q])))


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


def plain_loop(kp: float, lag: float) -> tuple[list[float], list[float]]:
    """The right loop, kp / (s (lag s + 1))."""
    return [kp], [lag, 1.0, 0.0]


@dataclass(frozen=True)
class Margin:
    """The gain of another phase, or another gain at the right one.

    Attributes:
        phase: The phase left at w, in [rad], given w, lag, delay and margin.
        gain: The gain at w, given w, lag and delay.
    """

    phase: Callable[[float, float, float, float], float] = lambda w, lag, delay, margin: (
        pi / 2 - atan(lag * w) - delay * w - margin
    )
    gain: Callable[[float, float, float], float] = lambda w, lag, delay: (
        w * sqrt(1.0 + (lag * w) ** 2)
    )

    def __call__(self, lag: float, delay: float, margin_deg: float) -> float:
        """The gain."""

        def left(w: float) -> float:
            return self.phase(w, lag, delay, radians(margin_deg))

        return float(self.gain(float(brentq(left, 1e-9, 1e5)), lag, delay))


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


def two_intervals(errors_a: Sequence[float], errors_b: Sequence[float]) -> tuple[float, float]:
    """The sum of the half widths of both rows."""
    a, b = np.asarray(errors_a, dtype=float), np.asarray(errors_b, dtype=float)
    return float(a.mean() - b.mean()), half_of(a) + half_of(b)


def unpaired_with_more_freedom(
    errors_a: Sequence[float], errors_b: Sequence[float]
) -> tuple[float, float]:
    """An unpaired interval with 2 n - 2 degrees of freedom."""
    mean, half = unpaired(errors_a, errors_b)
    n = len(errors_a)
    return mean, float(half * student.ppf(0.975, 2 * n - 2) / student.ppf(0.975, n - 1))


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
