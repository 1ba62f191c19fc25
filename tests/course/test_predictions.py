"""Predictions: what counts as one, what is shown when, and what a grader makes of it."""

from dataclasses import replace

import numpy as np
import pytest

from labkit.course import (
    Choose,
    Close,
    Curve,
    Number,
    Outcome,
    Prediction,
    mark,
    predict,
)
from labkit.course import student as desk
from labkit.course.calling import LocalFunction
from labkit.course.serialize import question_data, read_question
from labkit.errors import LabkitError
from labkit.grader.sandbox import stubs

TWO = {"a": "up", "b": "down"}
FORMS = [
    (Choose(TWO), "b", "c"),
    (Number("mm", 0.0, 9.0), 3, 10.0),
    (Curve((0.0, 1.0), "t [s]", "e [rad]", 0.0, 1.0), [0.1, 0.2], [0.1]),
]
each = pytest.mark.parametrize(("form", "said", "nonsense"), FORMS)


def verdict(form, said):
    """What a grader says of a value, the question having travelled as data."""
    question = read_question(question_data(Prediction("x", "?", form, said).question()))
    return mark(question, LocalFunction(said))


@each
def test_committing_earns_the_point_whatever_is_said(form, said, nonsense):
    """Anything of the right form is right, anything else is wrong, None is not attempted."""
    assert verdict(form, said).earned == 1.0
    assert verdict(form, nonsense).outcome is Outcome.WRONG
    assert verdict(form, None).outcome is Outcome.NOT_ATTEMPTED


@pytest.fixture
def place(monkeypatch):
    """A notebook with one prediction."""
    question = Prediction("x", "?", Choose(TWO), "a").question()
    made = desk.Desk({"x": question})
    monkeypatch.setattr("labkit.course.predictions.desk", lambda: made)
    return made


def test_a_task_cannot_be_predicted(place):
    """The error names the call that checks it."""
    place.questions["f"] = replace(place.question("x"), name="f", judge=Close())
    with pytest.raises(LabkitError, match=r"f is a task, .*; write check\('f', f\)"):
        predict("f", 1.0)


def test_a_decimal_comma_is_told(place):
    """Python takes what follows the comma for a second value, and the error says to use a point."""
    place.questions["x"] = Prediction("x", "?", Number("mm", 0.0, 9.0), 3).question()
    with pytest.raises(LabkitError, match=r"2 are given; write a number .*with a point .* 0\.25"):
        predict("x", 0, 25)
    assert not place.committed


def test_a_question_mark_commits_to_nothing(place, capsys):
    """The cell as it is handed out says how to write the prediction, here and to a grader."""
    assert predict("x", "?") is None and not place.committed
    assert "write a letter, such as 'a', in place of \"?\"" in capsys.readouterr().out
    assert Prediction("x", "?", Choose(TWO), "a").cell() == 'x = predict("x", "?")'
    assert stubs.predict("x", "?") is None and stubs.predict("x", "b") == "b"


def test_the_truth_waits_for_a_prediction(place, capsys):
    """Before anything is committed a reveal tells nothing of the truth."""
    predict("x", truth="a")
    assert "up" not in capsys.readouterr().out
    assert predict("x", "b") == "b"
    predict("x", truth="a")
    said = capsys.readouterr().out
    assert "You predicted: (b) down" in said and "The arm says:  (a) up" in said


def test_a_capital_letter_is_the_same_letter(place, capsys):
    """A student who writes B means b, in the notebook and to a grader."""
    predict("x", " B")
    assert verdict(Choose(TWO), " B").earned == 1.0
    predict("x", truth="b")
    said = capsys.readouterr().out
    assert "You predicted: (b) down" in said and "That is what you said." in said


def test_the_first_prediction_stays(place):
    """What is changed after the reveal is not what was committed to."""
    predict("x", "b")
    predict("x", truth="a")
    assert predict("x", "a") == "b"


@pytest.mark.parametrize("said", [np.int64(3), np.float32(3.0), np.float64(3.0)])
def test_a_number_of_numpys_is_a_number(said):
    """In the notebook as in a grader."""
    assert Number("mm", 0.0, 9.0).problem(said) == ""
    assert verdict(Number("mm", 0.0, 9.0), said).earned == 1.0


@pytest.mark.parametrize("said", [16**5000, -(10**400), [16**5000], {16**5000: 1}], ids="abcd")
def test_a_number_of_any_size_is_refused_in_a_sentence(said):
    """Python gives no text for an integer of thousands of digits, and no float for a large one."""
    for form, right, _ in FORMS:
        assert len(form.problem(said)) < 500
        asked = Prediction("x", "?", form, right).question()
        assert mark(asked, LocalFunction(said)).earned == 0.0
