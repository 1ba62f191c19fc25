"""Each student's steps are their own: what fails for one is named, and the others have theirs."""

from __future__ import annotations

import errno
import json
import os

import pytest
from handmade import QUICK, add, hand_in
from made import NAME, changed, graded, result_of

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader import batch, gradebook
from labkit.grader import feedback as feedback
from labkit.grader.each import Failure, Failures
from labkit.grader.gradebook import open_gradebook, record
from labkit.grader.results import Results

CLASS = ("ada", "bob", "carl")


@pytest.fixture
def marked(course):
    """Three with full marks, recorded."""
    graded(course, *(result_of(course, student) for student in CLASS))
    return course


def verb(course, capsys, *words):
    code = main([words[0], NAME, "--course", str(course.root), *words[1:]])
    return code, *capsys.readouterr()


def scores(course):
    with open_gradebook(course) as book:
        return {s.student.id: s.score for s in book.assignment_submissions(NAME)}


def spoil(monkeypatch, where, name, error, *, sign="bob"):
    """Let a function fail where its first argument is of one student."""
    function = getattr(where, name)

    def spoiled(first, *rest):
        if sign in str(first):
            raise error
        return function(first, *rest)

    monkeypatch.setattr(where, name, spoiled)


@pytest.mark.slow
def test_a_lone_surrogate_costs_nobody_a_mark(course, solved, capsys, monkeypatch):
    """In a comment, a cell of one's own or an output: all are graded, recorded, told, exported."""
    monkeypatch.setattr(batch, "Limits", lambda: QUICK)
    hand_in(course, NAME, "ada", json.dumps(solved).encode())
    add(solved, "# \ud800\nprint('\\ud800')")
    text = {"cell_type": "markdown", "id": "t", "metadata": {}, "source": "\udfff <script>"}
    solved["cells"].append(text)
    hand_in(course, NAME, "bob", json.dumps(solved).encode())
    assert verb(course, capsys, "grade")[0] == 0
    assert scores(course) == {"ada": 22.0, "bob": 22.0}
    assert verb(course, capsys, "feedback", "--unmarked")[0] == 0
    assert verb(course, capsys, "class-report")[0] == 0
    written = course.root / "autograded" / "bob" / NAME / f"{NAME}.ipynb"
    page = course.root / "feedback" / "bob" / NAME / f"{NAME}.html"
    assert written.read_text("utf-8").count("\ufffd") == 2
    assert page.read_text("utf-8")
    assert "ufffd" in Results(course, NAME).path("bob").read_text("ascii")


@pytest.mark.parametrize("part", [{"source": "x = 1 # \ud800"}, {"notes": ("\ud800",)}])
def test_a_notebook_that_cannot_be_written_is_named_alone(course, part):
    """Of a class of three, two are recorded and one is named; a rerun with a good one adds it."""
    done = [result_of(course, student) for student in CLASS]
    done[1] = changed(done[1], **part)
    bad = graded(course, *done, recorded=False) or record(course, NAME, done)
    if "source" in part:
        (failed,) = bad
        assert str(failed).startswith("bob: UnicodeEncodeError")
    assert record(course, NAME, list(Results(course, NAME))) == []  # read from the disk: clean
    assert scores(course) == dict.fromkeys(CLASS, 22.0)


@pytest.mark.slow
def test_a_row_that_fails_leaves_the_others_and_is_mended(marked, capsys, monkeypatch):
    """`grade` names whom it could not record, exit 1; typed again, all are there."""
    for student in CLASS:
        with open_gradebook(marked) as book:
            book.remove_submission(NAME, student)
    with monkeypatch.context() as spoiled:
        spoil(spoiled, gradebook, "write", PermissionError(errno.EACCES, "Permission denied"))
        code, out, err = verb(marked, capsys, "grade")
    assert code == 1
    assert out.count("as before") == 3
    assert err.splitlines()[-1].startswith("not in the gradebook: bob: ")
    assert verb(marked, capsys, "grade")[0] == 0
    assert scores(marked) == dict.fromkeys(CLASS, 22.0)


def test_a_page_that_fails_is_named_and_the_others_are_written(marked, capsys, monkeypatch):
    """A student who comes later in the alphabet has a page all the same."""
    spoil(monkeypatch, feedback, "page", OverflowError("cannot convert float \x1b infinity"))
    code, _, err = verb(marked, capsys, "feedback")
    assert (code, err) == (1, "no page: bob: OverflowError: cannot convert float infinity\n")
    pages = (marked.root / "feedback").glob(f"*/{NAME}/{NAME}.html")
    assert {x.parents[1].name for x in pages} == {"ada", "carl"}


def test_failures_are_told_at_the_end(capsys):
    """Sifting passes on what was done; the exit code and stderr have the rest, also on an error."""
    with pytest.raises(LabkitError, match="later"), Failures() as failures:
        assert list(failures.sift([1, Failure("ada", "why"), 2], "not done")) == [1, 2]
        assert (failures.code, capsys.readouterr().err) == (1, "")
        raise LabkitError("later")
    assert capsys.readouterr().err == "not done: ada: why\n"


@pytest.mark.parametrize("text", ["c = get_config(\n", "1 / 0\n", "raise SystemExit\n"])
def test_a_config_that_cannot_be_run_is_a_sentence(marked, capsys, text):
    """It is the instructor's own program: exit 2, and what it failed with."""
    (marked.root / "nbgrader_config.py").write_text(text)
    code, _, err = verb(marked, capsys, "feedback")
    assert (code, err.count("\n")) == (2, 1)
    assert "nbgrader_config.py" in err


@pytest.mark.parametrize("damage", [b"no database at all" * 90, None])
def test_a_damaged_gradebook_is_a_sentence(marked, capsys, damage):
    """Garbage or half a file: exit 2, what to do, results kept; restored, all is as it was."""
    path = marked.root / "gradebook.db"
    before = path.read_bytes()
    path.write_bytes(before[: len(before) // 2] if damage is None else damage)
    kept = {x: x.read_bytes() for x in Results(marked, NAME).folder.glob("*.json")}
    for words in (["export"], ["feedback"], ["grade"]):
        code, _, err = verb(marked, capsys, *words)
        assert (code, err.count("\n")) == (2, 1)
        assert "gradebook.db" in err
    assert {x: x.read_bytes() for x in kept} == kept
    path.write_bytes(before)
    assert scores(marked) == dict.fromkeys(CLASS, 22.0)


HOSTILE = (
    b"\x1b]0;owned\x07\x1b[2J",
    b"\xff\xfe",
    "\u202egpj".encode(),
    b"<script>alert(1)<",
    b"\r",
)


def test_no_name_of_a_folder_reaches_a_terminal(marked, capsys, monkeypatch):
    """Every verb names such a folder in plain letters, exit 1, and does the others."""
    monkeypatch.setattr(batch, "_graded", lambda *args: iter(()))
    for name in HOSTILE:
        folder = os.path.join(os.fsencode(marked.submitted), name, NAME.encode())
        os.makedirs(folder)
        with open(os.path.join(folder, f"{NAME}.ipynb".encode()), "wb") as file:
            file.write(b"{}")
    with open_gradebook(marked) as book:  # nbgrader's autograde adds whom it then refuses
        book.update_or_create_student(HOSTILE[0].decode())
        book.update_or_create_submission(NAME, HOSTILE[0].decode())
    for words in (["grade"], ["feedback", "--unmarked"], ["export"], ["class-report"]):
        code, out, err = verb(marked, capsys, *words)
        assert code == 1, words
        assert err.count("rename the folder and grade again") == len(HOSTILE), words
        assert not [x for x in out + err if not (x.isprintable() or x == "\n")], (out, err)


def test_nobody_who_handed_in_is_passed_over(course, capsys):
    """A folder that is a link, even one that leads nowhere, is a submission and is named."""
    (course.submitted / "ada").mkdir(parents=True)
    (course.submitted / "ada" / NAME).symlink_to("/nowhere")
    code, out, err = verb(course, capsys, "export")
    assert (code, err.count("no mark: ada: handed in but not graded")) == (1, 1)
    assert "\nada," in out
