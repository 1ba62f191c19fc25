"""A course for nbgrader alone: its own commands give the marks of `labkit grade`."""

from __future__ import annotations

import shutil

import pytest
from handmade import NAME, hand_in, nbgrader, put
from nbgrader.api import Gradebook

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader.plain import write_plain
from tests.synthetic import make_class

HONEST = (
    *("perfect", "perfect, in other words", "blank", "emptied", "warns and prints"),
    *(f"mistakes, the {each} of each" for each in ("first", "second", "third")),
)
CHEAT = "bang_bang = len\ncheck = lambda *about: 1.0\n"


@pytest.mark.slow
def test_nbgrader_gives_the_same_marks_but_for_the_cheats(course, blank, tmp_path):
    """It is released, graded and returned by nbgrader's commands; a cheat is why we have our own.

    The marks that the class deserves are those of `labkit grade`; see test_class.
    """
    plain = tmp_path / "plain"
    words = ["release", NAME, "--plain", str(plain), "--course", str(course.root)]
    assert main(words) == 0
    expected = make_class(course, NAME, seed=3, count=40)
    chosen = {s: x for s, x in expected.items() if x["kind"] in HONEST}
    assert len(chosen) == len(HONEST)
    hand_in(course, NAME, "eve", put(blank, "bang_bang", CHEAT))
    chosen["eve"] = {"kind": CHEAT, "score": 0.0}
    for student in chosen:
        shutil.copytree(course.submitted / student, plain / "submitted" / student)
    for verb in ("generate_assignment", "autograde", "generate_feedback"):
        code, said = nbgrader(plain, verb, NAME, *["--create"] * (verb == "autograde"))
        assert code == 0, said[-2000:]
    text = (plain / "release" / NAME / f"{NAME}.ipynb").read_text()
    assert "HIDDEN" not in text and "b85decode" not in text and 'predict(\\"' in text
    assert len(list(plain.glob(f"feedback/*/{NAME}/{NAME}.html"))) == len(chosen)
    with Gradebook(f"sqlite:///{plain}/gradebook.db", "trajectory_tracking") as book:
        scores = {student: book.find_submission(NAME, student).score for student in chosen}
    for student, deserved in chosen.items():
        more = scores[student] - deserved["score"]
        assert more > 0 if deserved["kind"] == CHEAT else more == 0, deserved


def test_no_other_course_is_written_over(course, tmp_path):
    """A folder with settings of its own is left."""
    (tmp_path / "nbgrader_config.py").write_text("c = get_config()\n")
    with pytest.raises(LabkitError):
        write_plain(course, [NAME], tmp_path)
    assert not (tmp_path / "source").exists()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["source", "solution"])
def test_what_a_release_leaves_validates_as_it_lies(released, kind):
    """The first check that nbgrader offers passes on the source and on the solved notebook."""
    _, said = nbgrader(getattr(released, kind) / NAME, "validate", f"{NAME}.ipynb")
    assert "Success" in said, said[-1500:]


@pytest.mark.slow
def test_nbgraders_own_autograde_refuses(course, solved):
    """Outside such a course it would run students' code in its own process by mistake."""
    hand_in(course, NAME, "ada", solved)
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code and f"labkit grade {NAME}" in said
    assert not (course.root / "autograded/ada" / NAME / f"{NAME}.ipynb").exists()
