"""nbgrader's own command with the isolated engine in its steps."""

from __future__ import annotations

import json
import os

import pytest
from controls import CONTROLS
from handmade import FULL, cell_of, hand_in, nbgrader

from labkit.__main__ import main
from labkit.grader.grading.results import Results
from labkit.grader.nbgrader.gradebook import open_gradebook

NAME = "01_paths"


@pytest.mark.slow
def test_autograde_of_nbgrader_is_safe(course, blank, solved, tmp_path):
    """`nbgrader autograde` grades in the sandbox: cheats earn 0, doubled cells abort nothing."""
    for kind in ("patched comparison", "display and execution hooks", "files"):
        CONTROLS[kind].attack.planted(blank, at=4, loot=tmp_path)
    hand_in(course, NAME, "mallory", blank)
    solved["cells"].append(cell_of(solved, "circle"))
    hand_in(course, NAME, "zoe", solved)
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code == 0, said[-2000:]
    assert not (tmp_path / "files").exists()
    with open_gradebook(course) as book:
        scores = {s.student.id: s.score for s in book.assignment_submissions(NAME)}
    assert scores == {"mallory": 0, "zoe": FULL}
    written = json.loads((course.root / "autograded/zoe" / NAME / f"{NAME}.ipynb").read_text())
    assert "HIDDEN" not in json.dumps(written)


@pytest.mark.slow
def test_nbgrader_copies_no_link_and_no_special_file(course, solved, capsys):
    """What a student laid beside a notebook leads nowhere; one's own files come along as ever."""
    secret = course.solution / NAME / f"{NAME}.ipynb"
    for student in ("ada", "bob", "carl"):
        hand_in(course, NAME, student, solved)
    ada = course.submitted / "ada" / NAME
    (ada / "mine.txt").write_text("my own")
    (ada / "notes.txt").symlink_to(secret)
    (ada / "all").symlink_to(secret.parent)
    (ada / "sub").mkdir()
    (ada / "sub" / "zero").symlink_to("/dev/zero")
    os.mkfifo(ada / "pipe")
    (course.submitted / "bob").rename(course.submitted / "was-bob")
    (course.submitted / "bob").symlink_to(course.submitted / "was-bob")
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code != 0
    assert f"error processing assignment '{NAME}' for student 'bob'" in said
    assert not (course.root / "autograded" / "bob" / NAME).exists()
    nbgrader(course.root, "generate_feedback", NAME)
    for made in ("autograded", "feedback"):
        folder = course.root / made / "ada" / NAME
        assert (folder / "mine.txt").read_text() == "my own"
        assert (folder / "notes.txt").read_text().startswith("Here was a link to")
        assert not [x for x in folder.rglob("*") if x.is_symlink() or x.name == f"{NAME}.py"]
        assert not (folder / "all").is_dir()
    assert secret.exists()
    with open_gradebook(course) as book:
        assert book.find_submission(NAME, "carl").score >= FULL


@pytest.mark.slow
def test_nbgrader_names_a_folder_that_it_cannot_match_and_grades_the_others(course, solved):
    """A line break in a folder's name ends no class: it is named once, exit code 1."""
    for student in ("<b>", "a\nzoe", "zoe"):
        hand_in(course, NAME, student, solved)
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code == 1, said[-2000:]
    assert [said.count(f"not graded: {x!a}: a folder in") for x in ("<b>", "a\nzoe")] == [1, 1]
    assert "Traceback" not in said
    with open_gradebook(course) as book:
        assert {s.student.id: s.score for s in book.assignment_submissions(NAME)} == {"zoe": FULL}
        assert [student.id for student in book.students] == ["zoe"]
    assert [x.name for x in (course.root / "autograded").iterdir()] == ["zoe"]


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
