"""Judges, which say whether an answer agrees with the expected one, and if not, how it differs.

A judge is a frozen value, so it can be stored with its question as data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..baxter import robot
from ..control import COMMANDS
from ..errors import LabkitError
from ..servo import Memory, Motion
from ..shapes import Array, as_array, as_gains
from ..trajectory import PoseSample, Sample
from .forms import RightOrWrong
from .verdict import Difference, Kind, Value

FEW = 9
"""The most numbers that are shown together; of a longer answer only the worst is shown."""


@dataclass(frozen=True)
class Close:
    """Every number must be within ``atol + rtol |expected|``, with the same shape and command type.

    A list is accepted as an array, and any sequence of three values as a `Sample`.

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
                return Difference(
                    Kind.TYPE, part, expected=kind.__name__, found=_instead(answer, expected)
                )
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
            if type(answer) is type(expected) and answer == expected:
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
            if found := self._differ(answer(t), expected(t), ""):
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
class Gains(RightOrWrong):
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
