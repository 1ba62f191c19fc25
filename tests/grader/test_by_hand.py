"""What a person marks: nbgrader's manual answers and tasks, from release to the student's page."""

from __future__ import annotations

import csv
import io
import json
import shutil
from dataclasses import replace

import pytest
from by_hand import BLANK, REPORT, WHY, author, written_in
from courses import synthetic
from handmade import hand_in, raw
from made import NAME, notebook_of, result_of
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session

from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.errors import LabkitError
from labkit.grader import gradebook
from labkit.grader.gradebook import open_gradebook, record
from labkit.grader.marks import marks_of
from labkit.grader.plan import plan
from labkit.grader.release import release
from labkit.grader.results import Results
from labkit.grader.sandbox.parse import read

ESSAY = "Because *friction* <b>eats</b> it."


@pytest.fixture(scope="module")
def authored(tmp_path_factory):
    """The assignment with both cells, released; never written to again."""
    course = synthetic(tmp_path_factory.mktemp("by_hand") / "course")
    with pytest.MonkeyPatch.context() as monkeypatch:
        author(monkeypatch)
        assert release(course, NAME, 7).points == 28
    return course


@pytest.fixture
def written(authored, tmp_path):
    """A copy in which Ada wrote an answer, Bob left it as it was, and Carl's file is broken."""
    course = Course(shutil.copytree(authored.root, tmp_path / "course", symlinks=True))
    graded(course, "ada", **{WHY: ESSAY, REPORT: ""})
    graded(course, "bob", **{WHY: BLANK})
    carl = result_of(course, "carl", rejected="the file is empty")
    hand_in(course, NAME, "carl", notebook_of("carl"))
    Results(course, NAME).keep(carl)
    record(course, NAME, [carl])
    return course


def graded(course, student, data=None, **texts):
    """Keep and record what came of a submission, its words included."""
    data = notebook_of(student) if data is None else data
    hand_in(course, NAME, student, data)
    result = replace(result_of(course, student, share=0.5, data=data), written=texts)
    Results(course, NAME).keep(result)
    return record(course, NAME, [result])


def give(course, student, name, points, comment=None, extra=None):
    """What formgrader writes when somebody marks."""
    with open_gradebook(course) as book:
        grade = book.find_grade(name, NAME, NAME, student)
        grade.manual_score, grade.needs_manual_grade, grade.extra_credit = points, False, extra
        if comment:
            book.find_comment(name, NAME, NAME, student).manual_comment = comment
        book.db.commit()


def verb(course, capsys, *words):
    code = main([words[0], NAME, "--course", str(course.root), *words[1:]])
    return code, *capsys.readouterr()


def score(course, capsys, student):
    text = verb(course, capsys, "export")[1]
    return {r["student"]: r for r in csv.DictReader(io.StringIO(text))}[student]["score"]


def page(course, student):
    return (course.root / "feedback" / student / NAME / f"{NAME}.html").read_text()


def test_what_stands_in_a_manual_cell_is_found(authored):
    """By its name or its id, also where it was doubled; it does not count as the student's own."""
    given = json.loads((authored.release / NAME / f"{NAME}.ipynb").read_text())
    assert "MARK SCHEME" not in raw(given).decode() and "is short" not in raw(given).decode()
    notebook = written_in(given, WHY, "It is long.")
    notebook["cells"].append(dict(notebook["cells"][-2], source="Very."))
    del notebook["cells"][-2]["metadata"]["nbgrader"]  # the task's cell, known by its id
    found = plan(read(raw(notebook))["cells"], Bundle.of(authored, NAME).data["cells"])
    assert found.written[WHY] == "It is long.\n\nVery."
    assert set(found.written) == {WHY, REPORT} and not found.own


def test_formgrader_has_the_answer_and_the_scheme(written):
    """What nobody has read earns nothing by itself; an answer left as it was earns 0."""
    path = written.root / "autograded/ada" / NAME / f"{NAME}.ipynb"
    cells = {c["metadata"].get("nbgrader", {}).get("grade_id"): c["source"]
             for c in json.loads(path.read_text())["cells"]}  # fmt: skip
    assert "friction" in "".join(cells[WHY])
    assert "MARK SCHEME" in "".join(cells[REPORT])
    graded(written, "flo", **{WHY: "<!-- -->\u00a0\u200b"})
    with open_gradebook(written) as book:
        found = {s: {g.name: (g.auto_score, bool(g.needs_manual_grade))
                     for g in book.find_submission_notebook(NAME, NAME, s).grades}
                 for s in ("ada", "bob", "carl", "flo")}  # fmt: skip
    zero, waits = (0.0, False), (None, True)
    assert [found[s][WHY] for s in found] == [waits, zero, zero, zero]
    assert [found[s][REPORT] for s in found] == [waits, waits, zero, waits]


def test_no_page_before_all_is_marked(written, capsys):
    """Nobody's feedback goes out before everybody's is marked, unless one asks for it."""
    code, _, err = verb(written, capsys, "feedback")
    assert code == 2 and f"ada ({WHY}, {REPORT})" in err and f"bob ({REPORT})" in err
    assert not (written.root / "feedback").exists()
    assert verb(written, capsys, "feedback", "--student", "carl")[0] == 0, "nothing of Carl waits"
    assert verb(written, capsys, "feedback", "--student", "bob")[0] == 2
    assert verb(written, capsys, "feedback", "--unmarked")[0] == 0
    assert "Not marked in full yet." in page(written, "ada")
    assert verb(written, capsys, "export")[0] == 1
    assert [mark.open for mark in marks_of(written, NAME)] == [(WHY, REPORT), (REPORT,), ()]


def test_page_export_and_report_have_formgraders_mark(written, capsys):
    """Manual points, extra credit and comment are in all of them, and outlive grading again."""
    give(written, "ada", WHY, 1.5, "Say *why*.", extra=0.5)
    give(written, "ada", REPORT, 3.0)
    give(written, "bob", REPORT, 0.0)
    give(written, "bob", "circle-check", 4.0)
    assert not graded(written, "ada", **{WHY: ESSAY, REPORT: ""})
    assert verb(written, capsys, "feedback")[0] == 0
    assert [score(written, capsys, who) for who in ("ada", "bob")] == ["16.0", "13.0"]
    assert "16 of 28 points." in page(written, "ada")
    assert "1.5 by hand; 0.5 extra credit" in page(written, "ada")
    assert "4 by hand, instead of 2" in page(written, "bob")
    assert "Say *why*." in page(written, "ada")
    assert "Because <em>friction</em> <b>eats</b> it." in page(written, "ada")
    report = verb(written, capsys, "class-report")[1]
    assert "Mean of the 2 marked in full: 14.5, median 14.5 of 28 points; 13 to 16." in report


def test_another_answer_is_looked_at_again(written, capsys, monkeypatch):
    """No page or table has a mark until then, though the first try to record it failed."""
    for name in (WHY, REPORT):
        give(written, "ada", name, 1.0)
    new = {"data": b'{"cells": [], "again": 1}', WHY: "No.", REPORT: ""}

    def fail(*_):
        raise OperationalError("COMMIT", {}, Exception("database is locked"))

    with monkeypatch.context() as patch, pytest.raises(LabkitError, match="locked"):

        def score_and_lock(*args):
            patch.setattr(Session, "commit", fail)
            return write_scores(*args)

        write_scores = gradebook._write_scores
        patch.setattr(gradebook, "_write_scores", score_and_lock)
        graded(written, "ada", **new)
    for _ in range(2):
        (said,) = graded(written, "ada", **new)
        assert said.startswith(f"ada: {WHY} was marked 1 by hand"), "until it is looked at"
    assert f"ada ({WHY})" in verb(written, capsys, "feedback")[2]
    assert score(written, capsys, "ada") == "", "it waits, as the page does"
    give(written, "ada", WHY, 1.0)
    assert score(written, capsys, "ada") == "13.0"
