"""Judges, which say whether an answer agrees with the expected one, and if not, how it differs.

A judge is a frozen value, so it can be stored with its question as data.  A `Form` is the judge of
a prediction: it accepts every plausible value, because the point is given for committing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..control import COMMANDS, JointTorque
from ..errors import LabkitError, OutOfRange
from ..robot import robot
from ..servo import Memory, Motion
from ..shapes import Array, as_array, as_gains
from ..trajectory import PoseSample, Sample
from .verdict import Difference, Kind, Value

COMMITTED = "committed before the arm answers"
"""The one test of a prediction."""

UNSAID = "?"
"""What stands in the place of a prediction until a student writes one."""


def letters(said: Any) -> str:
    """A text, or texts in a list, in lower case, without spaces and commas; "" for other values."""
    if isinstance(said, list | tuple):
        return "".join(map(letters, said))
    return "".join(said.lower().replace(",", " ").split()) if isinstance(said, str) else ""


def shown(said: Any) -> str:
    """What a student wrote down, cut short."""
    try:
        return f"{said!r:.200}"
    except ValueError:
        return "an integer of thousands of digits"


class _Form:
    """The base of the three forms: a prediction of the right form is accepted, whatever it says."""

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction, or ""."""
        raise NotImplementedError

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the answer has this form, else what is wrong with it."""
        found = self.problem(answer)
        return Difference(Kind.REFUSED, found=found) if found else None

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two predictions are the same."""
        if said := letters(answer):
            return said == letters(other)
        return np.array_equal(answer, other)


@dataclass(frozen=True)
class Choose(_Form):
    """One of several options, by its letter.

    Attributes:
        options: What each letter stands for.
    """

    options: Mapping[str, str] = field(hash=False)

    @property
    def how(self) -> str:
        """How to write the prediction down."""
        return f"a letter, such as {next(iter(self.options))!r}"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction, or ""."""
        if letters(said) in self.options:
            return ""
        return f"it is {shown(said)}; choose one of {', '.join(map(repr, self.options))}"

    def words(self, said: Any) -> str:
        """The prediction in words, as the object of a sentence."""
        return f"({letters(said)}) {self.options[letters(said)]}"


@dataclass(frozen=True)
class Number(_Form):
    """A number with a unit.

    Attributes:
        unit: Its unit.
        least: The smallest plausible value.
        most: The largest plausible value.
    """

    unit: str
    least: float
    most: float

    @property
    def how(self) -> str:
        """How to write the prediction down."""
        return f"a number from {self.least:g} to {self.most:g} ({self.unit})"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction, or ""."""
        if isinstance(said, bool) or not isinstance(said, int | float | np.integer | np.floating):
            example = "with a point, such as 8.5" if "," in shown(said) else f"({self.unit})"
            if isinstance(said, str) and said.replace(".", "", 1).lstrip("-").isdecimal():
                example = "without quotes"
            return f"it is {shown(said)}; write one number {example}"
        if not self.least <= said <= self.most:
            return f"it is {shown(said)} {self.unit}; write {self.how}"
        return ""

    def words(self, said: Any) -> str:
        """The prediction in words, as the object of a sentence."""
        return f"{said:.3g} {self.unit}"


@dataclass(frozen=True)
class Curve(_Form):
    """A curve, as its heights at some places.

    Attributes:
        at: The places.
        along: The quantity on the horizontal axis, with its unit.
        height: The quantity on the vertical axis, with its unit.
        least: The lower end of the vertical axis.
        most: The upper end of the vertical axis.
    """

    at: tuple[float, ...]
    along: str
    height: str
    least: float
    most: float

    @property
    def how(self) -> str:
        """How to write the prediction down."""
        places = ", ".join(f"{x:g}" for x in self.at)
        what = f"the {self.height} where the {self.along} is {places}"
        return f"a list of {len(self.at)} numbers: {what}"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction, or ""."""
        if not isinstance(said, list | tuple) or len(said) != len(self.at):
            return f"it is {shown(said)}; write {self.how}"
        one = Number(self.height, self.least, self.most)
        return next(filter(None, map(one.problem, said)), "")

    def words(self, said: Any) -> str:
        """The prediction in words, as the object of a sentence."""
        return ", ".join(f"{y:.3g} at {x:g}" for x, y in zip(self.at, said, strict=True))


Form = Choose | Number | Curve


@dataclass(frozen=True)
class Letter(_Form):
    """The judge of one letter, which is not told; where `UNSAID` is expected, any one will do.

    Attributes:
        options: The letters.
    """

    options: str

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the answer is the letter that is expected, else what is wrong."""
        said = letters(answer)
        if said not in tuple(self.options):
            found = f"it is {shown(answer)}; write one of {', '.join(self.options)}"
            return Difference(Kind.REFUSED, found=found)
        if expected in (said, UNSAID):
            return None
        return Difference(Kind.REFUSED, found=f"it is not {said}")


FEW = 9
"""The most numbers that are shown together; of a longer answer only the worst is shown."""


@dataclass(frozen=True)
class Close:
    """Every number must be within ``atol + rtol |expected|``, with the same shape and command type.

    A list is accepted as an array, any sequence of three values as a `Sample`, and a text in any
    order of its letters.

    Attributes:
        rtol: Relative tolerance.
        atol: Absolute tolerance, in the answer's unit.
        parts: Names for the parts of an answer that is a tuple.
        only: The one part that counts; empty for all of them.
    """

    rtol: float = 1e-6
    atol: float = 1e-9
    parts: tuple[str, ...] = ()
    only: str = ""

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if they agree, else how they differ."""
        return self._differ(answer, expected, "")

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two answers, right or wrong, are the same; 1.96 equals 1.959964 here.

        NaN equals NaN here, because some mistakes return it.
        """
        alike = replace(self, rtol=max(self.rtol, 1e-4))
        try:
            a, b = numbers(answer), numbers(other)
        except (LabkitError, TypeError, ValueError):
            a = b = np.empty(0)
        try:
            if np.isnan(b).any():
                return a.shape == b.shape and np.allclose(
                    a, b, alike.rtol, alike.atol, equal_nan=True
                )
            return alike(answer, other) is None
        except (LabkitError, TypeError, ValueError):
            return False

    def _differ(self, answer: Any, expected: Any, part: str) -> Difference | None:
        if isinstance(expected, COMMANDS):
            kind = type(expected)
            if type(answer) is not kind:
                found = _instead(answer, expected)
                return Difference(Kind.TYPE, part, expected=kind.__name__, found=found)
            return self._differ(answer.value, expected.value, part)
        if isinstance(expected, dict):
            return self._differ_dict(answer, expected)
        if isinstance(expected, Motion):
            return self._differ_motion(answer, expected)
        if isinstance(expected, Sample | PoseSample | Memory):
            if isinstance(answer, np.ndarray) and answer.ndim == 1:  # the position alone
                return Difference(Kind.PARTS, part, found=value(answer), parts=expected._fields)
            return self._differ_each(answer, expected, expected._fields)
        if isinstance(expected, tuple | list):
            names = self.parts or tuple(f"part {k + 1}" for k in range(len(expected)))
            return self._differ_each(answer, expected, names)
        if isinstance(expected, str | bool) or expected is None:
            said, asked = (sorted(letters(x)) or x for x in (answer, expected))
            if type(answer) is type(expected) and said == asked:
                return None
            return Difference(Kind.VALUE, part, expected=repr(expected), found=value(answer))
        return self._differ_numbers(answer, expected, part)

    def _differ_dict(self, answer: Any, expected: dict[str, Any]) -> Difference | None:
        if not isinstance(answer, dict):
            return Difference(Kind.TYPE, expected="dict", found=value(answer))
        for key in expected:
            if key not in answer:
                return Difference(Kind.KEY, key)
            if found := self._differ(answer[key], expected[key], key):
                return found
        return None

    def _differ_motion(self, answer: Any, expected: Motion) -> Difference | None:
        """How two motions differ at six times, the last one after the end."""
        if not isinstance(answer, Motion):
            return Difference(Kind.TYPE, "line", expected="motion", found=value(answer))
        for t in np.linspace(0.0, 1.25 * expected.duration, 6):
            if found := replace(self, only="")._differ(answer(t), expected(t), ""):
                return replace(found, part=f"{found.part} of the line at {t:.2g} s")
        return None

    def _differ_each(
        self, answer: Any, expected: Sequence[Any], names: tuple[str, ...]
    ) -> Difference | None:
        try:
            items = list(answer)
        except TypeError:
            return Difference(Kind.PARTS, found=value(answer), parts=names)
        if len(items) != len(expected):
            return Difference(Kind.PARTS, found=float(len(items)), parts=names)
        for name, a, b in zip(names, items, expected, strict=True):
            if self.only in ("", name) and (found := self._differ(a, b, name)):
                return found
        return None

    def _differ_numbers(self, answer: Any, expected: Any, part: str) -> Difference | None:
        b = np.asarray(expected, dtype=float)
        if isinstance(answer, COMMANDS):
            return Difference(Kind.TYPE, part, expected="", found=type(answer).__name__)
        try:
            a = as_array(answer, b.shape, part or "the answer")
        except LabkitError as error:
            return _refused(error)
        off = np.abs(a - b)
        bad = off > self.atol + self.rtol * np.abs(b)
        if not bad.any():
            return None
        times = factor(a, b)
        if b.size <= FEW:
            return Difference(Kind.NUMBERS, part, expected=value(b), found=value(a), times=times)
        at = np.unravel_index(int(np.argmax(np.where(bad, off, -1.0))), b.shape)
        index = tuple(map(float, at))
        return Difference(Kind.NUMBERS, part, index, value(b[at]), value(a[at]), times)


@dataclass(frozen=True)
class AtMost:
    """The judge of a run, each measure of which has an upper limit."""

    def __call__(self, answer: dict[str, float], expected: dict[str, float]) -> Difference | None:
        """None if every measure is within its limit, else the first that is not."""
        for name, limit in expected.items():
            if not answer[name] <= limit:
                return Difference(Kind.MEASURE, name, (), float(limit), value(answer[name]))
        return None


@dataclass(frozen=True)
class Gains:
    """The judge of the form of a pair (kp, kd); a run then tells how good the gains are.

    Each gain is one number or one for each joint, and no number is negative.
    """

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the answer is such a pair, else how it differs."""
        try:
            self._read(answer)
        except LabkitError as error:
            return _refused(error)
        except (TypeError, ValueError):
            return Difference(Kind.PARTS, found=value(answer), parts=("kp", "kd"))
        return None

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two pairs are similar, with every gain within a factor of 1.5."""
        try:
            a, b = self._read(answer), self._read(other)
        except (LabkitError, TypeError, ValueError):
            return False
        return bool(((a <= 1.5 * b) & (b <= 1.5 * a)).all())

    @staticmethod
    def _read(answer: Any) -> Array:
        kp, kd = answer
        n = robot("left").n  # the course is about Baxter's arms
        return np.concatenate([as_gains(kp, n, "kp"), as_gains(kd, n, "kd")])


def numbers(value: Any) -> Array:
    """All numbers of an answer, part by part, shape (n,).

    Raises:
        TypeError, ValueError: The answer does not consist of numbers.
    """
    return np.concatenate([x.ravel() for x in _flat(value)])


def _flat(value: Any) -> list[Array]:
    if hasattr(value, "value"):  # a command or a `TipTorque`
        value = value.value
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple) and any(np.ndim(x) != 0 for x in value):
        return [a for x in value for a in _flat(x)]
    return [np.asarray(value, dtype=float)]


def value(x: Any) -> Value:
    """A few finite numbers as numbers; anything else as its shortened `repr`."""
    if isinstance(x, np.ndarray | int | float | np.number) and not isinstance(x, bool):
        a = np.asarray(x)
        if a.dtype.kind in "fiu" and a.ndim <= 2 and a.size <= FEW and np.isfinite(a).all():
            listed = a.astype(float).tolist()
            if a.ndim == 0:
                return float(listed)
            return tuple(tuple(row) if isinstance(row, list) else row for row in listed)
    text = " ".join(repr(x).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


def _instead(answer: Any, expected: Any) -> Value:
    """What was returned instead of a command; "" for plain numbers of the same shape."""
    if isinstance(answer, COMMANDS):
        return type(answer).__name__
    return "" if np.shape(answer) == np.shape(getattr(expected, "value", 0)) else value(answer)


def _refused(error: LabkitError) -> Difference:
    return Difference(Kind.REFUSED, found=str(error))


def factor(a: Array, b: Array) -> float | None:
    """The factor by which all numbers of b are multiplied to give a, or None."""
    size = float(np.vdot(b, b))
    if not size:
        return None
    times = float(np.vdot(b, a)) / size
    near = 1e-9 * float(np.abs(b).max())
    return times if np.allclose(a, times * b, rtol=1e-6, atol=near) else None


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


Judge = Close | Response | Gains | AtTip | Form | Letter


def accepts(judge: Judge, answer: Any, expected: Any) -> bool:
    """Whether a judge finds an answer right; an answer that makes it raise is not."""
    try:
        return judge(answer, expected) is None
    except Exception:
        return False


def shares_error(judge: Judge, answer: Any, mistake: Any, expected: Any) -> bool:
    """Whether an answer is wrong on a call, or the known mistake is right on it."""
    return accepts(judge, mistake, expected) or not accepts(judge, answer, expected)
