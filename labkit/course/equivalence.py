"""Judges that compare what answers do: their frequency response, or the tip's acceleration."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..control import JointTorque
from ..errors import OutOfRange
from ..shapes import Array
from .bugs import Found
from .forms import Form, Measured
from .judges import Close, Gains, value
from .verdict import Difference, Kind, Value

MOST_COEFFICIENTS = 50
"""Limit for a polynomial in an answer."""


@dataclass(frozen=True)
class Ratio:
    """A transfer function as data: two polynomials, highest power first.

    Attributes:
        num: Numerator.
        den: Denominator.
    """

    num: tuple[float, ...]
    den: tuple[float, ...]

    def __post_init__(self) -> None:
        most = max(len(self.num), len(self.den))
        if most > MOST_COEFFICIENTS:
            raise OutOfRange(
                f"a polynomial has {most} coefficients, but the limit is {MOST_COEFFICIENTS}; "
                "cancel the common factors of the numerator and the denominator"
            )

    def __call__(self, s: complex) -> complex:
        """The value of the transfer function at ``s``."""
        return complex(np.polyval(self.num, s) / np.polyval(self.den, s))


@dataclass(frozen=True)
class Response:
    """The judge of a transfer function by its frequency response, whatever its form.

    Attributes:
        omega: Frequencies at which to compare, in [rad/s].
        rtol: Largest difference, relative to the expected value.
    """

    omega: tuple[float, ...]
    rtol: float = 0.02

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the responses agree, else the first frequency at which they differ, and how."""
        other = Difference(Kind.TYPE, expected="transfer function", found=value(answer))
        if not hasattr(answer, "num"):
            return other
        try:
            pairs = [(w, complex(answer(1j * w)), complex(expected(1j * w))) for w in self.omega]
        except (TypeError, ValueError):
            return other
        for w, a, b in pairs:
            if not abs(a - b) <= self.rtol * abs(b):
                return Difference(Kind.RESPONSE, "", (w,), _polar(b), _polar(a))
        return None

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two answers, right or wrong, have the same response."""
        return self(answer, other) is None


def _polar(z: complex) -> Value:
    """Magnitude and phase, in [degrees]."""
    return value(np.array([abs(z), np.degrees(np.angle(z))]))


@dataclass(frozen=True, eq=False)
class TipTorque:
    """An expected torque of which only the effect on the tip counts; `AtTip` compares with it.

    Attributes:
        value: One of the right torques, shape (n,) in [N m].
        accelerates: J M^-1, which maps a torque to the tip acceleration it adds, shape (6, n).
        elbow: The joint motion that does not move the tip, a unit vector, shape (n,).
    """

    value: Array
    accelerates: Array
    elbow: Array = field(default_factory=lambda: np.zeros(1))  # older files have none


@dataclass(frozen=True)
class AtTip:
    """The judge of a `JointTorque` by the acceleration that it gives to the tip.

    Seven joints have one motion that does not move the tip, so more than one torque is right.

    Attributes:
        rtol: Tolerance relative to the expected torque.
        atol: Tolerance of the tip's acceleration, in [m/s^2] and [rad/s^2].
    """

    rtol: float = 1e-6
    atol: float = 1e-6

    def __call__(self, answer: Any, expected: TipTorque) -> Difference | None:
        """None if the tip accelerates in the same way, else how the torques differ."""
        if self._off(answer, expected) <= 1.0:
            return None
        found = Close(self.rtol, self.atol)(answer, JointTorque(expected.value))
        return replace(found, several=True) if found else Difference(Kind.OTHER)

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two torques, right or wrong, move the tip in the same way.

        They may also differ by a torque along the elbow's motion.  A damper multiplied by
        ``I - pinv(J) J`` gives one, which does act on the tip, and any mistake may come with it.
        """
        if isinstance(other, TipTorque) and type(answer) is JointTorque:
            loose = replace(self, rtol=max(self.rtol, 1e-4))
            along = other.elbow * np.sum(other.elbow * (answer.value - other.value))
            less = (answer.value, answer.value - along)
            return any(loose._off(JointTorque(tau), other) <= 1.0 for tau in less)
        return Close(self.rtol, self.atol).same(answer, other)

    def _off(self, answer: Any, expected: TipTorque) -> float:
        """The error of the tip's acceleration, in tolerances; infinite for another command type."""
        if type(answer) is not JointTorque:
            return float("inf")
        off = np.abs(expected.accelerates @ (answer.value - expected.value))
        scale = np.abs(expected.accelerates) @ np.abs(expected.value)
        return float(np.max(off / (self.atol + self.rtol * scale)))


def as_expected(known: Any, expected: Any) -> Any:
    """The answer of a known mistake to a call, in the form of the expected answer."""
    if isinstance(expected, TipTorque) and type(known) is JointTorque:
        return replace(expected, value=known.value)
    return known


Judge = Close | Response | Gains | AtTip | Form | Measured | Found


def accepts(judge: Judge, answer: Any, expected: Any) -> bool:
    """Whether a judge finds an answer right; an answer that makes it raise is not."""
    try:
        return judge(answer, expected) is None
    except Exception:
        return False


def shares_error(judge: Judge, answer: Any, mistake: Any, expected: Any) -> bool:
    """Whether an answer is wrong on a call, or the known mistake is right on it."""
    return accepts(judge, mistake, expected) or not accepts(judge, answer, expected)
