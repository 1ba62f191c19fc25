"""Forms of an answer that is written down: a letter, an order, a number, a curve.

A form is the judge of a prediction: it takes whatever a person could mean, right or wrong, for the
point is given for committing.  `Measured` judges a number that was found out about an arm.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .verdict import Difference, Kind

COMMITTED = "committed before the arm answers"
"""The one test of a prediction."""

OWN_ARM = "it is true of your own arm"
"""The test of a number that a student found out; only who marks it knows the arm."""


def letters(said: Any) -> str:
    """What was written, in small letters and without spaces around it; "" if it is not a text."""
    return said.strip().lower() if isinstance(said, str) else ""


class RightOrWrong:
    """What judges share that measure no distance: an answer is right or wrong, equal or not."""

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if it is right, else how it differs."""
        raise NotImplementedError

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two answers, right or wrong, are the same one."""
        return np.array_equal(answer, other)

    def distance(self, answer: Any, expected: Any) -> float:
        """Zero if it is right, else infinite."""
        return 0.0 if self(answer, expected) is None else float("inf")


class _Form(RightOrWrong):
    """What the four forms share: a prediction of the right form is accepted, whatever it says."""

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction; "" if nothing is."""
        raise NotImplementedError

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if it is of this form."""
        found = self.problem(answer)
        return Difference(Kind.REFUSED, found=found) if found else None

    def same(self, answer: Any, other: Any) -> bool:
        """Whether two predictions are the same one."""
        if isinstance(answer, str):
            return letters(answer) == letters(other)
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
        """How to write it down."""
        return f"a letter, such as {next(iter(self.options))!r}"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction; "" if nothing is."""
        if letters(said) in self.options:
            return ""
        return f"it is {said!r}; choose one of {', '.join(map(repr, self.options))}"

    def words(self, said: Any) -> str:
        """A prediction as a sentence's object."""
        return f"({letters(said)}) {self.options[letters(said)]}"


@dataclass(frozen=True)
class Rank(_Form):
    """Several things in order, as a text of their letters.

    Attributes:
        options: What each letter stands for.
        first: What the first one has most of.
    """

    options: Mapping[str, str] = field(hash=False)
    first: str

    @property
    def how(self) -> str:
        """How to write it down."""
        return f"their letters in order, {self.first} first, such as {''.join(self.options)!r}"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction; "" if nothing is."""
        if sorted(letters(said)) == sorted(self.options):
            return ""
        return f"it is {said!r}; write each of the letters {''.join(self.options)} once"

    def words(self, said: Any) -> str:
        """A prediction as a sentence's object."""
        return ", ".join(self.options[letter] for letter in letters(said))


@dataclass(frozen=True)
class Number(_Form):
    """A number with a unit.

    Attributes:
        unit: Of the number.
        least: Less than this nobody could mean.
        most: More than this nobody could mean.
    """

    unit: str
    least: float
    most: float

    @property
    def how(self) -> str:
        """How to write it down."""
        return f"a number from {self.least:g} to {self.most:g} ({self.unit})"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction; "" if nothing is."""
        if isinstance(said, bool) or not isinstance(said, int | float | np.integer | np.floating):
            example = "with a point, such as 8.5" if "," in str(said) else f"({self.unit})"
            return f"it is {said!r}; write one number {example}"
        if not self.least <= said <= self.most:
            return f"it is {said:g} {self.unit}; write {self.how}"
        return ""

    def words(self, said: Any) -> str:
        """A prediction as a sentence's object."""
        return f"{said:.3g} {self.unit}"


@dataclass(frozen=True)
class Curve(_Form):
    """A curve, as its heights at some places.

    Attributes:
        at: The places.
        along: What they are, with their unit.
        height: What is drawn, with its unit.
        least: The lower edge of the paper.
        most: The upper edge.
    """

    at: tuple[float, ...]
    along: str
    height: str
    least: float
    most: float

    @property
    def how(self) -> str:
        """How to write it down."""
        places = ", ".join(f"{x:g}" for x in self.at)
        what = f"the {self.height} where the {self.along} is {places}"
        return f"a list of {len(self.at)} numbers: {what}"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction; "" if nothing is."""
        if not isinstance(said, list | tuple) or len(said) != len(self.at):
            return f"it is {said!r}; write {self.how}"
        one = Number(self.height, self.least, self.most)
        return next(filter(None, map(one.problem, said)), "")

    def words(self, said: Any) -> str:
        """A prediction as a sentence's object."""
        return ", ".join(f"{y:.3g} at {x:g}" for x, y in zip(self.at, said, strict=True))


Form = Choose | Rank | Number | Curve


@dataclass(frozen=True)
class Measured(RightOrWrong):
    """A measured number, within a tolerance of the arm's; without an expected one, any plausible.

    Attributes:
        of: Which number of an `OwnArm`.
        unit: Of it.
        least: Less than this nobody could measure.
        most: More than this nobody could measure.
        tolerance: Largest difference, in the same unit.
    """

    of: str
    unit: str
    least: float
    most: float
    tolerance: float

    def __call__(self, answer: Any, expected: Any) -> Difference | None:
        """None if it is near enough, else how it differs."""
        found = Number(self.unit, self.least, self.most).problem(answer)
        if found:
            return Difference(Kind.REFUSED, found=found)
        if expected is None or abs(answer - expected) <= self.tolerance:
            return None
        return Difference(Kind.NUMBERS, expected=float(expected), found=float(answer))

    def expected(self, arm: object) -> float:
        """What is right for somebody's `OwnArm`."""
        return float(getattr(arm, self.of))
