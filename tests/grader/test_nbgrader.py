"""nbgrader's own command with the isolated engine in its steps."""

from __future__ import annotations

import os

import pytest
from attacks import CLASSES
from handmade import FULL, NAME, cell_of, hand_in, nbgrader

from labkit.__main__ import main
from labkit.grader.grading.results import Results
from labkit.grader.nbgrader.gradebook import open_gradebook


@pytest.mark.slow
def test_autograde_of_nbgrader_is_safe(course, blank, solved):
    """It grades in the sandbox: cheats earn 0, doubled cells abort nothing, no link is followed.

    A folder whose name nobody can have is named, and so is a student who is a link.
    """
    for kind, name in (("patched comparison", "check_returns"), ("files", "checks.json")):
        next(x for k, x in CLASSES[kind].items() if name in k).planted(blank, at=4)
    hand_in(course, NAME, "mallory", blank)
    secret = course.solution / NAME / f"{NAME}.ipynb"
    for student in ("ada", "was-bob", "<b>", "a\nzoe"):
        hand_in(course, NAME, student, solved)
    solved["cells"].append(cell_of(solved, "circle"))
    hand_in(course, NAME, "zoe", solved)
    ada = course.submitted / "ada" / NAME
    (ada / "mine.txt").write_text("my own")
    (ada / "notes.txt").symlink_to(secret)
    (ada / "all").symlink_to(secret.parent)
    (ada / "sub").mkdir()
    (ada / "sub" / "zero").symlink_to("/dev/zero")
    os.mkfifo(ada / "pipe")
    (course.submitted / "bob").symlink_to(course.submitted / "was-bob")
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code == 1, said[-2000:]
    assert f"error processing assignment '{NAME}' for student 'bob'" in said
    assert [said.count(f"not graded: {x!a}: a folder in") for x in ("<b>", "a\nzoe")] == [1, 1]
    nbgrader(course.root, "generate_feedback", NAME)
    for made in ("autograded", "feedback"):
        folder = course.root / made / "ada" / NAME
        assert (folder / "mine.txt").read_text() == "my own"
        assert (folder / "notes.txt").read_text().startswith("Here was a link to")
        assert not [x for x in folder.rglob("*") if x.is_symlink() or x.name == f"{NAME}.py"]
        assert not (folder / "all").is_dir()
    with open_gradebook(course) as book:
        scores = {s.student.id: s.score for s in book.assignment_submissions(NAME)}
    assert {k: v >= FULL for k, v in scores.items()} == {
        "mallory": False, "bob": False, "zoe": True, "ada": True, "was-bob": True
    }  # fmt: skip
    assert scores["mallory"] == 0
    assert "HIDDEN" not in (course.root / "autograded/zoe" / NAME / f"{NAME}.ipynb").read_text()


@pytest.mark.slow
def test_nbgrader_and_labkit_agree(course, solved, capsys):
    """What nbgrader's button graded has a result, so page and table have the same mark."""
    hand_in(course, NAME, "ada", solved)
    hand_in(course, NAME, "bob", b"{")
    code, said = nbgrader(course.root, "autograde", NAME, "--create", "--student", "ada")
    assert code == 0, said[-2000:]
    assert Results(course, NAME).get("ada").score == FULL
    assert main(["export", NAME, "--course", str(course.root)]) == 1
    out, err = capsys.readouterr()
    assert "\nada," in out and out.split("\nada,")[1].splitlines()[0].endswith(",24.0,")
    assert "no mark: bob: handed in but not graded" in err
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    out = capsys.readouterr().out
    assert "ada: 22 of 22 (as before)" in out
    assert "not included: 2 points by hand; 0 students still to be marked\n" in out
