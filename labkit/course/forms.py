"""Forms of an answer that students write down: a letter, a number, or a curve.

A form is the judge of a prediction.  It accepts every plausible value, right or wrong, because the
point is given for committing.  `Measured` judges a number that was measured on an arm.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .verdict import Difference, Kind

COMMITTED = "committed before the arm answers"
"""The one test of a prediction."""

UNSAID = "?"
"""What stands in the place of a prediction until a student writes one."""

OWN_ARM = "it is right for your own arm"
"""The test of a number that a student measured; only the grader knows the arm."""


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


class RightOrWrong:
    """The base of judges without a tolerance: an answer is right or wrong, equal or not."""

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the answer is right, else how it differs."""
        raise NotImplementedError

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two answers, right or wrong, are the same."""
        return np.array_equal(answer, other)


class _Form(RightOrWrong):
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
        return super().same(answer, other)


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
class Measured(RightOrWrong):
    """The judge of a measured number, which must be within a tolerance of the arm's.

    Where no number is expected, every plausible number is accepted.

    Attributes:
        of: The name of the number, a field of `OwnArm`.
        unit: Its unit.
        least: The smallest plausible value.
        most: The largest plausible value.
        tolerance: Largest difference, in the same unit.
    """

    of: str
    unit: str
    least: float
    most: float
    tolerance: float

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if the number is near enough, else how it differs."""
        found = Number(self.unit, self.least, self.most).problem(answer)
        if found:
            return Difference(Kind.REFUSED, found=found)
        if expected is None or abs(answer - expected) <= self.tolerance:
            return None
        return Difference(Kind.NUMBERS, expected=float(expected), found=float(answer))

    def expected(self, arm: object) -> float:
        """The right number for a student's `OwnArm`."""
        return float(getattr(arm, self.of))
