"""Predictions, to which students commit before the arm shows what it does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import LabkitError, listed
from .judges import COMMITTED, UNSAID, Choose, Curve, Form, Number
from .messages import Message, wrapped
from .question import Call, Question, Test, in_points
from .student import desk, say


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


def predict(name: str, said: Any = UNSAID, *more: Any, truth: Any = None) -> Any:
    """Commit to a prediction; or, with the truth, compare the prediction with it.

    Args:
        name: The prediction's name.
        said: What you predict; "?" if you have not yet.
        more: Nothing; what follows a decimal comma would be here.
        truth: The result: a letter, letters, a number, or a curve as (places, heights).

    Returns:
        Your prediction, also if its form is wrong, which does not commit you; None if there is no
        prediction, and always with the truth.

    Raises:
        UnknownName: There is no such question.
        LabkitError: The question asks for a function, or two values are given.
    """
    place = desk()
    form = place.question(name).judge
    if not isinstance(form, Form):
        raise LabkitError(f"{name} is a task, not a prediction; write check({name!r}, {name})")
    if more:
        raise LabkitError(
            f"{name} takes one value, but {len(more) + 1} are given; write {form.how}, with a "
            "point in a number such as 0.25"
        )
    if truth is not None:
        _reveal(name, form, truth)
        return None
    first = place.committed.get(name)
    if name in place.revealed and first is not None and not form.same(first, said):
        print(wrapped(f"The answer was shown, so your prediction stays: {first!r}."))
        return first
    if said is None or (isinstance(said, str) and said == UNSAID):
        print(wrapped(f'{name}: write {form.how}, in place of "{UNSAID}", and run the cell.'))
        return None
    if found := form.problem(said):
        print(wrapped(f"{name}: {found}."))
    else:
        place.committed[name] = said
        verdict, *_ = place.verdict(name, said)  # stored with the output, so no check need be run
        say(Message(f"You are committed to: {form.words(said)}."), verdict, None)
    return said


def _reveal(name: str, form: Form, truth: Any) -> None:
    """Show the prediction beside the truth, but not the truth without a prediction."""
    place = desk()
    said, wrong = place.committed.get(name), sorted(place.anyway)
    if said is None:
        again = "commit to a prediction above, then run the cells from there to here again"
        print(wrapped(f"{name}: {again}."))
    elif wrong:
        says = f"this notebook uses your wrong {listed(wrong)} anyway, so no truth is shown here"
        print(wrapped(f"{name}: {says}."))
    else:
        place.revealed.add(name)
        if isinstance(form, Curve):
            _overlay(form, said, truth)
        else:
            _compare(form, said, truth)


def _compare(form: Form, said: Any, truth: Any) -> None:
    """Print the prediction and the truth, and how they differ."""
    print(wrapped(f"You predicted: {form.words(said)}."))
    print(wrapped(f"The arm says:  {form.words(truth)}."))
    if isinstance(form, Number):
        times = f"{said / truth:.2g}" if said * truth > 0.0 else ""
        says = {"": "", "1": "Your number is the arm's."}
        print(wrapped(says.get(times, f"Your number is {times} times the arm's.")))
    else:
        agrees = form.same(said, truth)
        print("That is what you said." if agrees else "That is not what you said. Look again: why?")


def _overlay(form: Curve, said: Any, truth: Any) -> None:
    """Draw the predicted and the true curve."""
    import matplotlib.pyplot as plt

    from .. import plotting

    places, heights = (np.asarray(x, dtype=float) for x in truth)
    plt.figure(figsize=(7, 2.8), layout="constrained")
    plt.plot(places, heights, label="it was")
    plt.plot(form.at, said, "o--", mfc="none", label="you said")
    plt.xlabel(form.along)
    plt.ylabel(form.height)
    plt.legend(frameon=False)
    came = form.words(np.interp(form.at, places, heights))
    plotting.show(f"{form.height} over {form.along}. You said {form.words(said)}. It was {came}.")
