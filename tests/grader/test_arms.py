"""Arms of one's own: the roster gives them, the notebooks open them, the grader knows them."""

from __future__ import annotations

import json

import pytest
from courses import synthetic
from handmade import hand_in, put

from labkit.__main__ import main
from labkit.course import my_arm
from labkit.course.authoring.bundle import Bundle
from labkit.course.own_arm import FILE, HANDLES, Arms
from labkit.errors import LabkitError
from labkit.grader.explain import explain
from labkit.grader.release import release
from labkit.grader.roster import without_arms

NAME = "02_essays"
CLASS = "Login,First name,Last name,Team\nada,Ada,L,one\nbob,Bob,M,one\neve,Eve,N,\n"


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A released notebook that asks about one's own arm, and a class of three with one team."""
    root = tmp_path_factory.mktemp("arms")
    course = synthetic(root)
    release(course, NAME, 7)
    (root / "class.csv").write_text(CLASS)
    assert main(["roster", str(root / "class.csv"), "--course", str(root)]) == 0
    return course


def test_a_student_opens_their_arm_beside_the_notebook(course, monkeypatch):
    """Two of a team have the same arm, another student has another, a stranger has none."""
    monkeypatch.chdir(course.release / NAME)
    arms = Arms.of(course.root)
    assert arms.arm("ada") == arms.arm("bob") != arms.arm("eve")
    assert arms.arm("mallory") is None
    for student in ("ada", "eve"):
        with my_arm(student) as mine:
            assert mine._engine is not None
    assert "ada" not in (course.release / NAME / FILE).read_text()


def test_the_grader_asks_for_ones_own_number(course):
    """Judged against another arm, a result is another; who has no arm has the demonstration's."""
    bundle = Bundle.of(course, NAME)
    expected = {}
    for student in ("ada", "bob", "eve", "mallory"):
        mine = bundle.of_student(student)
        assert mine.arms == bundle.arms
        (asked,) = (q for q in mine.questions if q.name == "my_payload")
        (hidden,) = (c for test in asked.tests for c in test.cases if c.hidden)
        expected[student] = (hidden.expected, mine.data["hash"])
    assert expected["ada"] == expected["bob"]
    assert len(set(expected.values())) == 3
    assert expected["mallory"][1] == bundle.data["hash"]
    payload = Arms.of(course.root).arm("ada").payload
    assert expected["ada"][0] == pytest.approx(payload, abs=0.01)


def test_an_explanation_asks_for_ones_own_number(course):
    """What is right of a student's own arm is right when it is explained, and else it is not.

    The number may be a fraction, because its cell is run when it is marked.
    """
    work = json.loads((course.release / NAME / f"{NAME}.ipynb").read_text())
    payload = {who: Arms.of(course.root).arm(who).payload for who in ("ada", "eve")}
    for student, number in (("eve", payload["eve"]), ("ada", payload["ada"] - 0.2)):
        hand_in(course, NAME, student, put(work, "my_payload", f"my_payload = {2 * number!r} / 2"))
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    right, wrong = (explain(course, NAME, student, "my_payload") for student in ("eve", "ada"))
    assert "my_payload: right" in right and "my_payload: right" not in wrong
    numbers = f"expected {payload['ada']:.6g}, got {payload['ada'] - 0.2:.6g}"
    assert numbers in " ".join(wrong.split())
    assert "ATTENTION" not in right + wrong
    assert "Judged by the arm that the course gave ada, within 0.07 kg." in wrong


def test_an_arm_stays_when_others_join_and_after_a_new_release(course, capsys):
    """A student who enrols late changes nobody's arm; a release lays the arms out again."""
    before = json.loads((course.release / NAME / FILE).read_text())
    late = course.root / "late.csv"
    late.write_text(CLASS + "zoe,Zoe,O,\n")
    assert main(["roster", str(late), "--course", str(course.root)]) == 0
    after = json.loads((course.release / NAME / FILE).read_text())
    assert before.items() < after.items() and len(after) == len(before) + 1
    release(course, NAME, 7)
    assert json.loads((course.release / NAME / FILE).read_text()) == after


def test_a_notebook_without_its_students_arms_is_named(course):
    """Before the list is imported all have the public arm; who asks for none is not named."""
    assert not without_arms(course, (NAME, "01_curves"))
    (course.release / NAME / FILE).unlink()
    assert without_arms(course, (NAME, "01_curves")).startswith(NAME)


def test_a_damaged_file_of_arms_is_a_sentence(tmp_path):
    """It is named, with what to do."""
    (tmp_path / "course_private").mkdir()
    (tmp_path / HANDLES).write_text("[]")
    with pytest.raises(LabkitError, match="is damaged; delete it, and import the list"):
        Arms.of(tmp_path)
