"""Judges of what several answers do alike: a frequency response, the tip's acceleration."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..control import JointTorque
from ..errors import OutOfRange
from ..shapes import Array
from .bugs import Found, Telling
from .forms import Form, Measured
from .judges import Close, Gains, Within, value
from .verdict import Difference, Kind, Value

MOST_COEFFICIENTS = 50
"""Of a polynomial that is judged."""


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
                f"a polynomial has {most} coefficients, the limit is {MOST_COEFFICIENTS}; "
                "cancel what numerator and denominator have in common"
            )

    def __call__(self, s: complex) -> complex:
        """Its value at ``s``."""
        return complex(np.polyval(self.num, s) / np.polyval(self.den, s))


@dataclass(frozen=True)
class Response:
    """A transfer function judged by its frequency response, whatever its form.

    Attributes:
        omega: Where to compare, in [rad/s].
        rtol: Largest difference, as a share of the expected value.
    """

    omega: tuple[float, ...]
    rtol: float = 0.02

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if they agree, else where they do not."""
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
        """Whether two answers, right or wrong, respond alike."""
        return self(answer, other) is None

    def distance(self, answer: Any, expected: Any) -> float:
        """How far the answer is off, in tolerances."""
        try:
            return max(
                abs(complex(answer(1j * w)) / complex(expected(1j * w)) - 1.0) / self.rtol
                for w in self.omega
            )
        except (TypeError, ValueError, ZeroDivisionError):
            return float("inf")


def _polar(z: complex) -> Value:
    """Magnitude and phase, in [degrees]."""
    return value(np.array([abs(z), np.degrees(np.angle(z))]))


@dataclass(frozen=True, eq=False)
class TipTorque:
    """A torque as far as the tip feels it: the expected answer that `AtTip` compares with.

    Attributes:
        value: One such torque, shape (n,) in [N m].
        accelerates: J M^-1, what a torque adds to the tip's acceleration, shape (6, n).
        elbow: The joints' motion of which the tip sees nothing, a unit vector, shape (n,).
    """

    value: Array
    accelerates: Array
    elbow: Array = field(default_factory=lambda: np.zeros(1))  # older files have none


@dataclass(frozen=True)
class AtTip:
    """A `JointTorque` judged by what it does: it must accelerate the tip as the expected one does.

    Seven joints can move in one way that the tip does not feel, so that many torques are right.

    Attributes:
        rtol: Tolerance relative to the expected torque.
        atol: Tolerance of the tip's acceleration, in [m/s^2] and [rad/s^2].
    """

    rtol: float = 1e-6
    atol: float = 1e-6

    def __call__(self, answer: Any, expected: TipTorque) -> Difference | None:
        """None if the tip moves alike, else how the torques differ."""
        if self.distance(answer, expected) <= 1.0:
            return None
        found = Close(self.rtol, self.atol)(answer, JointTorque(expected.value))
        return replace(found, several=True) if found else Difference(Kind.OTHER)

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two torques, right or wrong, move the tip alike.

        They may differ by a torque along the elbow's motion: a damper behind ``I - pinv(J) J`` is
        one, the tip feels it, and any mistake may come with it.
        """
        if isinstance(other, TipTorque) and type(answer) is JointTorque:
            loose = replace(self, rtol=max(self.rtol, 1e-4))
            along = other.elbow * np.sum(other.elbow * (answer.value - other.value))
            less = (answer.value, answer.value - along)
            return any(loose.distance(JointTorque(tau), other) <= 1.0 for tau in less)
        return Close(self.rtol, self.atol).same(answer, other)

    def distance(self, answer: Any, expected: TipTorque) -> float:
        """How far the tip's acceleration is off, in tolerances; infinite for any other command."""
        if type(answer) is not JointTorque:
            return float("inf")
        off = np.abs(expected.accelerates @ (answer.value - expected.value))
        scale = np.abs(expected.accelerates) @ np.abs(expected.value)
        return float(np.max(off / (self.atol + self.rtol * scale)))


def as_expected(known: Any, expected: Any) -> Any:
    """What a mistake gives on a call, in the form of what is expected there."""
    if isinstance(expected, TipTorque) and type(known) is JointTorque:
        return replace(expected, value=known.value)
    return known


Judge = Close | Within | Response | Gains | AtTip | Form | Measured | Found | Telling


def accepts(judge: Judge, answer: Any, expected: Any) -> bool:
    """Whether a judge takes an answer; there is no end to what an answer can be."""
    try:
        return judge(answer, expected) is None
    except Exception:
        return False


def shares_error(judge: Judge, answer: Any, mistake: Any, expected: Any) -> bool:
    """Whether an answer is wrong where a mistake is."""
    return accepts(judge, mistake, expected) or not accepts(judge, answer, expected)
