"""Predictions: what counts as one, what is shown when, and what a grader makes of it."""

from dataclasses import replace

import numpy as np
import pytest

from labkit.course import (
    Choose,
    Close,
    Curve,
    Found,
    Number,
    Outcome,
    Prediction,
    Rank,
    mark,
    predict,
)
from labkit.course import student as desk
from labkit.course.reply import LocalFunction
from labkit.course.serialize import question_data, read_question
from labkit.errors import LabkitError

TWO = {"a": "up", "b": "down"}
FORMS = [
    (Choose(TWO), "b", "c"),
    (Rank(TWO, "the first"), "ba", "bb"),
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
    monkeypatch.setattr("labkit.course.reveal.desk", lambda: made)
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


@pytest.mark.parametrize("said", ["x, z, y", "x z y", " XZY", ["x", "z", "y"], ("x", "z", "y")])
def test_an_order_may_have_commas(said):
    """Letters in order are the same order with commas or spaces, or in a list."""
    form = Rank({"x": "forwards", "y": "sideways", "z": "up"}, "the heaviest")
    assert verdict(form, said).earned == 1.0 and form.words(said) == "forwards, up, sideways"
    assert form.same(said, "xzy") and form.same("xzy", said) and not form.same(said, "xyz")
    assert "each of the letters xyz once" in form.problem("x, z")


def test_the_first_prediction_stays(place):
    """What is changed after the reveal is not what was committed to."""
    predict("x", "b")
    predict("x", truth="a")
    assert predict("x", "a") == "b"


def test_an_array_after_the_reveal_is_compared_with_the_first_prediction(place, monkeypatch):
    """It is another prediction, or the same one, and no error."""
    curve = FORMS[3][0]
    made = desk.Desk({"y": Prediction("y", "?", curve, [0.0, 0.0]).question()})
    monkeypatch.setattr("labkit.course.reveal.desk", lambda: made)
    made.committed["y"], made.revealed = [0.1, 0.2], {"y"}
    assert predict("y", np.array([0.3, 0.4])) == [0.1, 0.2]
    assert predict("y", [0.1, 0.2]) == [0.1, 0.2]


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
    assert Found(0)(("b", said), None) and Found(0)(said, None)


def test_one_run_after_the_mouse_commits_and_writes_it_down(place, monkeypatch, capsys):
    """What was chosen is the cell's answer, stands in its text and is said to be committed."""
    written = []

    class Shell:
        def set_next_input(self, text, replace):
            written.append((text, replace))

    monkeypatch.setattr("labkit.course.reveal.shell", Shell)
    place.chosen["x"] = "b"
    assert predict("x", None) == "b" == place.committed["x"]
    assert written == [('x = predict("x", "b")', True)]
    assert "You are committed to: (b) down." in capsys.readouterr().out


@pytest.mark.parametrize(("typed", "said"), [("0", 0.0), (" 2.5", 2.5), ("10", None), ("x", None)])
def test_any_number_can_be_typed(monkeypatch, typed, said):
    """The field begins empty, so that 0 can be chosen too; only a prediction is taken."""
    made = desk.Desk({"x": Prediction("x", "?", Number("mm", 0.0, 9.0), 3).question()})
    shown = []
    monkeypatch.setattr("labkit.course.reveal.desk", lambda: made)
    monkeypatch.setattr("labkit.course.reveal.shell", lambda: True)
    monkeypatch.setattr("IPython.display.display", shown.append)
    assert predict("x") is None
    box, note = shown[0].children
    box.children[0].value = "1"
    box.children[0].value = typed
    assert made.chosen == ({} if said is None else {"x": said})
    assert ("not committed yet" in note.value) == (said is not None)


def test_a_curve_waits_for_each_of_its_sliders(monkeypatch):
    """Nobody commits to a height that no hand has set; a slider may return to where it began."""
    curve = Curve((0.0, 1.0), "t [s]", "e [rad]", 0.0, 1.0)
    made = desk.Desk({"x": Prediction("x", "?", curve, [0.1, 0.2]).question()})
    shown = []
    monkeypatch.setattr("labkit.course.reveal.desk", lambda: made)
    monkeypatch.setattr("labkit.course.reveal.shell", lambda: True)
    monkeypatch.setattr("IPython.display.display", shown.append)
    predict("x")
    box, note = shown[0].children
    box.children[0].value = 0.2
    assert made.chosen == {} and note.value == "Still to set: the e [rad] at 1."
    predict("x")
    box, note = shown[1].children
    assert box.children[0].value == 0.2 and note.value.startswith("Still to set")
    box.children[1].value = 0.9
    box.children[1].value = 0.5
    assert made.chosen == {"x": [0.2, 0.5]} and "not committed yet" in note.value


def test_a_decimal_comma_is_told_how_to_be_written():
    """A student who types 8,3 has written one number, and reads how to write it."""
    form = Number("mm", 0.0, 9.0)
    assert form.problem("8.3") == "it is '8.3'; write one number without quotes"
    assert form.problem("far") == "it is 'far'; write one number (mm)"
    assert form.problem("8,3") == "it is '8,3'; write one number with a point, such as 8.5"
    assert form.problem("many").endswith("write one number (mm)")


def test_a_number_that_is_the_arms_own_is_told_so(monkeypatch, capsys):
    """Rather than that it is 1 times the arm's."""
    made = desk.Desk({"x": Prediction("x", "?", Number("mm", 0.0, 9.0), 8.3).question()})
    monkeypatch.setattr("labkit.course.reveal.desk", lambda: made)
    predict("x", 8.3)
    predict("x", truth=8.3)
    assert "Your number is the arm's." in capsys.readouterr().out


def test_a_prediction_has_no_hints(place, monkeypatch, capsys):
    """And nobody is sent to a forum for them."""
    monkeypatch.setattr("labkit.course.student.desk", lambda: place)
    monkeypatch.setattr("labkit.course.student.read_checks", lambda _: {"assignment": "01_paths"})
    desk.hint("x")
    assert capsys.readouterr().out == "x has no hints.\n"
