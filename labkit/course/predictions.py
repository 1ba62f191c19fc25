"""Predictions, to which students commit before the arm shows what it does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .forms import COMMITTED, UNSAID, Choose, Form
from .question import Call, Question, Test, in_points


@dataclass(frozen=True)
class Prediction:
    """Something to predict, as its author writes it.

    Attributes:
        name: Name of the value to which the student commits.
        asks: A question about what the arm will do.
        form: The form of the prediction.
        truth: The prediction that turns out right, for the solved notebook.
        points: Points for committing.
    """

    name: str
    asks: str
    form: Form
    truth: Any
    points: float = 1.0

    def question(self) -> Question:
        """The question that gives the points, in a notebook and in a grader."""
        test = Test(COMMITTED, (Call((), expected=True),))
        return Question(self.name, self.points, self.asks, self.form, (test,))

    def brief(self) -> str:
        """The text above the place for the prediction."""
        form = self.form
        options = form.options.items() if isinstance(form, Choose) else ()
        earns = f"{in_points(self.points)} for committing, right or wrong"
        head = f"**Predict first: `{self.name}`** · {earns}"
        lines = [head, "", self.asks, "", *(f"- ({letter}) {text}" for letter, text in options)]
        how = f'Write {form.how}, in place of `"{UNSAID}"`, and run the cell.'
        return "\n".join([*lines, "", how])

    def cell(self) -> str:
        """The cell that the student fills in."""
        return f'{self.name} = predict("{self.name}", "{UNSAID}")'

    def solved(self) -> str:
        """The cell with a prediction that turns out right."""
        return f'{self.name} = predict("{self.name}", {self.truth!r})'
