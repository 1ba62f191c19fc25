"""Predictions: what a student commits to before the arm shows what it does.

The form of a prediction is its judge: it takes whatever a person could mean, right or wrong, for
the point is given for committing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .verdict import Difference, Kind

if TYPE_CHECKING:
    from .question import Question

COMMITTED = "committed before the arm answers"
"""The one test of a prediction."""


class _Form:
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
        return bool(answer == other)

    def distance(self, answer: Any, expected: Any) -> float:
        """Zero for one of this form, else infinite."""
        return float("inf") if self.problem(answer) else 0.0


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
        if isinstance(said, str) and said in self.options:
            return ""
        return f"it is {said!r}; choose one of {', '.join(map(repr, self.options))}"

    def words(self, said: Any) -> str:
        """A prediction as a sentence's object."""
        return f"({said}) {self.options[said]}"


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
        if isinstance(said, str) and sorted(said) == sorted(self.options):
            return ""
        return f"it is {said!r}; write each of the letters {''.join(self.options)} once"

    def words(self, said: Any) -> str:
        """A prediction as a sentence's object."""
        return ", ".join(self.options[letter] for letter in said)


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
        return f"a number from {self.least:g} to {self.most:g}, in {self.unit}"

    def problem(self, said: Any) -> str:
        """What is wrong with the form of a prediction; "" if nothing is."""
        if isinstance(said, bool) or not isinstance(said, int | float):
            return f"it is {said!r}; write one number, in {self.unit}"
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
        return f"a list of its {len(self.at)} heights at {places} ({self.along}), in {self.height}"

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
class Prediction:
    """Something to predict, as its author writes it.

    Attributes:
        name: Of the value that the student commits to.
        asks: What will the arm do?
        form: In which form.
        truth: What it does, as a prediction that would have been right; for the solved notebook.
        points: For committing.
    """

    name: str
    asks: str
    form: Form
    truth: Any
    points: float = 1.0

    def question(self) -> Question:
        """The question that gives the point, in a notebook as in a grader."""
        from .question import Call, Question, Test  # which know the forms as judges

        test = Test(COMMITTED, (Call((), expected=True),))
        return Question(self.name, self.points, self.asks, self.form, (test,))

    def brief(self) -> str:
        """The text above the place for the prediction."""
        form = self.form
        options = form.options.items() if isinstance(form, Choose | Rank) else ()
        head = f"**Predict first: `{self.name}`** · 1 point for committing, right or wrong"
        lines = [head, "", self.asks, "", *(f"- ({letter}) {text}" for letter, text in options)]
        how = f"Write {form.how}, in place of `None`; or use the controls and run the cell again."
        return "\n".join([*lines, "", how])

    def cell(self) -> str:
        """The cell that the student fills in."""
        return f'{self.name} = predict("{self.name}", None)'

    def solved(self) -> str:
        """The cell with a prediction that turns out right."""
        return f'{self.name} = predict("{self.name}", {self.truth!r})'
