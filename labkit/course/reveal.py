"""Predictions in a notebook: students commit to one, and later compare it with the truth."""

from __future__ import annotations

import json
from html import escape
from typing import Any

import numpy as np

from ..errors import LabkitError, listed
from .forms import Choose, Curve, Form, Number, Rank
from .messages import wrapped
from .student import desk, shell


def predict(name: str, said: Any = None, *more: Any, truth: Any = None) -> Any:
    """Commit to a prediction; or, with the truth, compare the prediction with it.

    Args:
        name: The prediction's name.
        said: What you predict; None shows controls for choosing it.
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
        _write_down(name, first)
        return first
    if said is None:
        said = place.chosen.pop(name, None)
        if said is None:
            _controls(name, form)
            return None
        _write_down(name, said)
    if found := form.problem(said):
        print(wrapped(f"{name}: {found}."))
    else:
        place.committed[name] = said
        print(wrapped(f"You are committed to: {form.words(said)}."))
    return said


def _write_down(name: str, said: Any) -> None:
    """Write the chosen value into the text of the running cell, where a grader reads it."""
    notebook = shell()
    if notebook is not None:
        text = f'{name} = predict("{name}", {json.dumps(said)})'
        notebook.set_next_input(text, replace=True)


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


def _controls(name: str, form: Form) -> None:
    """Show controls for mouse and keyboard; running the cell again commits to their value."""
    if shell() is None:
        return
    import ipywidgets as widgets
    from IPython.display import display

    again = "click into the cell above this line and press Shift+Enter once more to commit."
    note = widgets.HTML(f"{_what_to_do(form)}; then {again}")  # a label would not wrap its text
    parts = _inputs(form, widgets)
    draft = desk().drafts.setdefault(name, [None] * len(parts))  # None until it is set

    def show() -> None:
        """Take the value of the controls if all are set, and else say what is missing."""
        desk().chosen.pop(name, None)
        waiting = [part.description for part, x in zip(parts, draft, strict=True) if x is None]
        said = [*map(_number, draft)] if isinstance(form, Curve) else _number(draft[0])
        if isinstance(form, Curve) and waiting:
            note.value = f"Still to set: the {escape(form.height)} at {', '.join(waiting)}."
        elif found := form.problem(said):
            note.value = escape(found)
        else:
            desk().chosen[name] = said
            note.value = f"{escape(form.words(said))}: not committed yet; {again}"

    def changed(change: Any) -> None:
        draft[parts.index(change["owner"])] = change["new"]
        show()

    for part, value in zip(parts, draft, strict=True):
        if value is not None:
            part.value = value
        part.observe(changed, "value")
    if any(value is not None for value in draft):
        show()
    box = widgets.HBox if isinstance(form, Curve) else widgets.VBox
    display(widgets.VBox([box(parts), note]))


def _what_to_do(form: Form) -> str:
    match form:
        case Choose():
            return "Choose"
        case Curve(_, along, height):
            return escape(
                f"The number at each slider is the {along}: set the slider to the {height} there"
            )
    return escape(f"Type {form.how}")


def _number(said: Any) -> Any:
    """A number without the rounding errors of its last digits; any other value unchanged."""
    try:
        return round(float(said), 9)
    except (TypeError, ValueError):
        return said


def _inputs(form: Form, widgets: Any) -> list[Any]:
    """One control for each value of a prediction."""
    match form:
        case Choose(options):
            pairs = [(f"({letter}) {text}", letter) for letter, text in options.items()]
            layout = widgets.Layout(width="auto")
            return [widgets.RadioButtons(options=pairs, value=None, layout=layout)]
        case Rank() | Number():  # a numeric field would start with a number that nobody chose
            return [widgets.Text(placeholder=form.how, layout=widgets.Layout(width="30em"))]
        case Curve(at, _, height, least, most):
            middle, step = (least + most) / 2, (most - least) / 50
            return [
                widgets.FloatSlider(
                    middle, min=least, max=most, step=step, description=f"{x:g}",
                    orientation="vertical", tooltip=f"{height} at {x:g}",
                )
                for x in at
            ]  # fmt: skip
