"""Judges: does an answer mean the same as the expected one?  If not, how does it differ?

A judge is a frozen value, so that it travels with its question as data.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..control import COMMANDS, JointTorque
from ..errors import LabkitError, OutOfRange
from ..robot import DOF
from ..shapes import Array, as_array, as_gains
from ..trajectory import PoseSample, Sample


@dataclass(frozen=True)
class Close:
    """Every number within ``atol + rtol |expected|``; shapes and command types must be the same.

    Lists pass for arrays, and any three things in order for a `Sample`.

    Attributes:
        rtol: Relative tolerance.
        atol: Absolute tolerance, in the answer's unit.
        parts: What to call the parts of an answer that is a tuple.
    """

    rtol: float = 1e-6
    atol: float = 1e-9
    parts: tuple[str, ...] = ()

    def __call__(self, answer: Any, expected: Any) -> str | None:
        """None if they agree, else how they differ."""
        return self._differ(answer, expected, "")

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two answers, right or wrong, are the same one; 1.96 is 1.959964 here.

        NaN is NaN here, for some mistakes give it.
        """
        alike = replace(self, rtol=max(self.rtol, 1e-4))
        try:
            a, b = numbers(answer), numbers(other)
        except (LabkitError, TypeError, ValueError):
            a = b = np.empty(0)
        try:
            if np.isnan(b).any():
                return np.allclose(a, b, alike.rtol, alike.atol, equal_nan=True)
            return alike(answer, other) is None
        except (LabkitError, TypeError, ValueError):
            return False

    def distance(self, answer: Any, expected: Any) -> float:
        """How far the answer is off, in tolerances; infinite where it has another form."""
        try:
            a, b = numbers(answer), numbers(expected)
        except (LabkitError, TypeError, ValueError):
            return float("inf")
        if a.shape != b.shape or not np.isfinite(a).all():
            return float("inf")
        off = float(np.max(np.abs(a - b) / (self.atol + self.rtol * np.abs(b)), initial=0.0))
        same_numbers = off <= 1.0
        return float("inf") if same_numbers and self(answer, expected) is not None else off

    def _differ(self, answer: Any, expected: Any, part: str) -> str | None:
        if isinstance(expected, COMMANDS):
            kind = type(expected)
            if type(answer) is not kind:
                return f"{_of(part)}it should be a {kind.__name__}, not {_other(answer, kind)}"
            return self._differ(answer.value, expected.value, part)
        if isinstance(expected, dict):
            return self._differ_dict(answer, expected)
        if isinstance(expected, Sample | PoseSample):
            return self._differ_each(answer, expected, expected._fields)
        if isinstance(expected, tuple | list):
            names = self.parts or tuple(f"part {k + 1}" for k in range(len(expected)))
            return self._differ_each(answer, expected, names)
        if isinstance(expected, str | bool) or expected is None:
            same = type(answer) is type(expected) and answer == expected
            return None if same else f"{_of(part)}it should be {expected!r}, not {_shown(answer)}"
        return self._differ_numbers(answer, expected, part)

    def _differ_dict(self, answer: Any, expected: dict[str, Any]) -> str | None:
        if not isinstance(answer, dict):
            return f"it should be a dict, not {_shown(answer)}"
        for key in expected:
            if key not in answer:
                return f"the key {key!r} is missing"
            if found := self._differ(answer[key], expected[key], key):
                return found
        return None

    def _differ_each(self, answer: Any, expected: Any, names: tuple[str, ...]) -> str | None:
        wanted = f"it should be {len(expected)} things ({', '.join(names)})"
        try:
            items = list(answer)
        except TypeError:
            return f"{wanted}, not {_shown(answer)}"
        if len(items) != len(expected):
            return f"{wanted}, not {len(items)}"
        for name, a, b in zip(names, items, expected, strict=True):
            if found := self._differ(a, b, name):
                return found
        return None

    def _differ_numbers(self, answer: Any, expected: Any, part: str) -> str | None:
        b = np.asarray(expected, dtype=float)
        name = part or "the answer"
        if isinstance(answer, COMMANDS):
            return f"{_of(part)}plain numbers are asked for, not a {type(answer).__name__}"
        try:
            a = as_array(answer, b.shape, name)
        except LabkitError as error:
            return str(error)
        off = np.abs(a - b)
        bad = off > self.atol + self.rtol * np.abs(b)
        if not bad.any():
            return None
        if b.ndim == 0:
            return f"{_of(part)}expected {_number(b)}, got {_number(a)}{_factor(a, b)}"
        at = np.unravel_index(int(np.argmax(np.where(bad, off, -1.0))), b.shape)
        index = str(int(at[0])) if b.ndim == 1 else str(tuple(map(int, at)))
        if b.size <= 9:
            return f"{_of(part)}expected {_shown(b)}, got {_shown(a)}{_factor(a, b)}"
        at_index = f"at index {index} expected {_number(b[at])}, got {_number(a[at])}"
        return f"{_of(part)}{at_index}{_factor(a, b)}"


@dataclass(frozen=True)
class Within:
    """A number of which several are right: it must lie in one of the expected intervals."""

    def __call__(self, answer: Any, expected: Any) -> str | None:
        """None if it does, else where it lies instead."""
        try:
            x = float(as_array(answer, (), "the answer"))
        except LabkitError as error:
            return str(error)
        if self.distance(x, expected) <= 1.0:
            return None
        return f"got {_number(x)}, which is none of the right ones"

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two answers, right or wrong, are the same number."""
        return Close().same(answer, other)

    def distance(self, answer: Any, expected: Any) -> float:
        """Below 1 inside an interval, above 1 outside, growing with the distance."""
        x = float(answer)
        return min(float(abs(x - (a + b) / 2) / ((b - a) / 2)) for a, b in expected)


_MEASURES = {
    "max_mm": ("the largest error of the tip is", " mm"),
    "rms_mm": ("the RMS error of the tip is", " mm"),
    "max_deg": ("the largest tilt of the tip is", " degrees"),
    "rms_velocity_mm_s": ("the RMS error of the tip's speed is", " mm/s"),
    "worst_mm": ("the worst error is", " mm"),
}
"""Measures of a run in words, with their units."""


@dataclass(frozen=True)
class AtMost:
    """The measures of a run, each at most its expected limit."""

    def __call__(self, answer: dict[str, float], expected: dict[str, float]) -> str | None:
        """None if all are, else the first that is not."""
        for name, limit in expected.items():
            if not answer[name] <= limit:
                what, unit = _MEASURES.get(name, (f"{name.replace('_', ' ')} is", ""))
                x = answer[name]
                much = f"{x:.3g}" if abs(x) < 1e3 else f"{x:.0f}"
                return f"{what} {much}{unit}, allowed {limit:.3g}{unit}"
        return None

    def same(self, answer: dict[str, float], other: dict[str, float]) -> bool:
        """Whether two runs measure the same."""
        return Close().same(answer, other)

    def distance(self, answer: dict[str, float], expected: dict[str, float]) -> float:
        """The largest ratio of a measure to its limit."""
        return max(answer[name] / limit for name, limit in expected.items())


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

    def __call__(self, answer: Any, expected: Any) -> str | None:
        """None if they agree, else where they do not."""
        if not hasattr(answer, "num"):
            return f"it should be a transfer function, not {_shown(answer)}"
        try:
            pairs = [(w, complex(answer(1j * w)), complex(expected(1j * w))) for w in self.omega]
        except (TypeError, ValueError):
            return f"it should be a transfer function, not {_shown(answer)}"
        for w, a, b in pairs:
            if not abs(a - b) <= self.rtol * abs(b):
                return f"at {w:g} rad/s expected {_polar(b)}, got {_polar(a)}"
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


def _polar(z: complex) -> str:
    return f"{abs(z):.4g} at {np.degrees(np.angle(z)):.4g} degrees"


@dataclass(frozen=True)
class Gains:
    """A pair (kp, kd) of which many are right; a run tells how good they are.

    Each is one number or one for each joint, none below 0.
    """

    def __call__(self, answer: Any, expected: Any) -> str | None:
        """None if it is such a pair, else what it is instead."""
        try:
            self._read(answer)
        except LabkitError as error:
            return str(error)
        except (TypeError, ValueError):
            return f"it should be two things (kp, kd), not {_shown(answer)}"
        return None

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two pairs are alike: every gain within a factor of 1.5."""
        try:
            a, b = self._read(answer), self._read(other)
        except (LabkitError, TypeError, ValueError):
            return False
        return bool(((a <= 1.5 * b) & (b <= 1.5 * a)).all())

    def distance(self, answer: Any, expected: Any) -> float:
        """Zero for such a pair, else infinite."""
        return 0.0 if self(answer, expected) is None else float("inf")

    @staticmethod
    def _read(answer: Any) -> Array:
        kp, kd = answer
        return np.concatenate([as_gains(kp, DOF, "kp"), as_gains(kd, DOF, "kd")])


@dataclass(frozen=True, eq=False)
class TipTorque:
    """A torque as far as the tip feels it: the expected answer that `AtTip` compares with.

    Attributes:
        value: One such torque, shape (7,) in [N m].
        accelerates: J M^-1, what a torque adds to the tip's acceleration, shape (6, 7).
    """

    value: Array
    accelerates: Array


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

    def __call__(self, answer: Any, expected: TipTorque) -> str | None:
        """None if the tip moves alike, else how the torques differ."""
        if self.distance(answer, expected) <= 1.0:
            return None
        differ = Close(self.rtol, self.atol)(answer, JointTorque(expected.value)) or ""
        return differ.replace(", got ", ", or any that moves the tip alike, got ")

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two torques, right or wrong, are the same."""
        return Close(self.rtol, self.atol).same(answer, other)

    def distance(self, answer: Any, expected: TipTorque) -> float:
        """How far the tip's acceleration is off, in tolerances; infinite for any other command."""
        if type(answer) is not JointTorque:
            return float("inf")
        off = np.abs(expected.accelerates @ (answer.value - expected.value))
        scale = np.abs(expected.accelerates) @ np.abs(expected.value)
        return float(np.max(off / (self.atol + self.rtol * scale)))


Judge = Close | Within | AtMost | Response | Gains | AtTip


def numbers(value: Any) -> Array:
    """All numbers of an answer, part by part, shape (n,).

    Raises:
        TypeError, ValueError: It is not made of numbers.
    """
    return np.concatenate([x.ravel() for x in _flat(value)])


def _flat(value: Any) -> list[Array]:
    if isinstance(value, (*COMMANDS, TipTorque)):
        value = value.value
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple) and any(np.ndim(x) != 0 for x in value):
        return [a for x in value for a in _flat(x)]
    return [np.asarray(value, dtype=float)]


def _of(part: str) -> str:
    return f"{part}: " if part else ""


def _number(x: Any) -> str:
    return f"{float(x):.6g}" if abs(float(x)) > 1e-10 else "0"


def in_brief(x: Any) -> str:
    """A number, or a vector or matrix of them, as one would write it by hand."""
    a = np.asarray(x, dtype=float)
    if a.ndim:
        tiny = 1e-9 * max(1.0, float(np.max(np.abs(a), initial=0.0)))
        return f"[{', '.join(map(in_brief, np.where(np.abs(a) < tiny, 0.0, a)))}]"
    return f"{float(a) + 0.0:.5g}"  # adding zero takes the sign from -0


_FACTORS = {
    -1.0: "the same with the other sign",
    float(np.degrees(1.0)): "these look like degrees, where radians belong",
    float(np.radians(1.0)): "these look like degrees taken for radians",
    1e3: "a thousand times too large: millimetres for metres?",
    1e-3: "a thousand times too small",
    2.0: "twice what is expected",
    0.5: "half of what is expected",
}
"""What it means that all numbers are off by one and the same factor."""


def _factor(a: Array, b: Array) -> str:
    """What to say where the answer is the expected one times a telling factor.

    A single number that is twice or half of what is expected may be so by chance.
    """
    for factor, means in _FACTORS.items():
        telling = b.ndim > 0 or factor not in (2.0, 0.5)
        near = 1e-9 * np.abs(b).max()
        if telling and b.any() and np.allclose(a, factor * b, rtol=1e-6, atol=near):
            return f"; {means}"
    return ""


def _other(answer: Any, kind: type) -> str:
    """What came instead of a command, and how to make one of it."""
    if isinstance(answer, COMMANDS):
        return f"a {type(answer).__name__}"
    what = "plain numbers" if np.shape(answer) == (DOF,) else _shown(answer)
    return f"{what}; give lk.{kind.__name__}(...) with the {DOF} numbers in it"


def _shown(x: Any) -> str:
    if isinstance(x, COMMANDS):
        return f"a {type(x).__name__}"
    if isinstance(x, np.ndarray) and x.dtype.kind in "fiub":
        return in_brief(x)
    if isinstance(x, int | float | np.number) and not isinstance(x, bool):
        return _number(x)
    text = " ".join(repr(x).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
