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
from labkit.grader.marks import MarkLine
from labkit.grader.plan import plan
from labkit.grader.release import release
from labkit.grader.results import Results
from labkit.grader.sandbox.parse import read


@pytest.fixture(scope="module")
def authored(tmp_path_factory):
    """The assignment with both cells, released; never written to again."""
    course = synthetic(tmp_path_factory.mktemp("by_hand") / "course")
    with pytest.MonkeyPatch.context() as monkeypatch:
        author(monkeypatch)
        made = release(course, NAME, 7)
    assert str(made).splitlines()[1:] == [
        f"  to be marked by hand: {WHY}, 2 points",
        f"  to be marked by hand: {REPORT}, 4 points",
    ]
    assert made.points == 28
    return course


@pytest.fixture
def written(authored, tmp_path):
    """A copy in which Ada wrote an answer, Bob left it as it was, and Carl's file is broken."""
    course = Course(shutil.copytree(authored.root, tmp_path / "course", symlinks=True))
    graded(course, "ada", **{WHY: "Because *friction* <b>eats</b> it.", REPORT: ""})
    graded(course, "bob", **{WHY: BLANK})
    results = Results(course, NAME)
    carl = result_of(course, "carl", rejected="the file is empty")
    hand_in(course, NAME, "carl", notebook_of("carl"))
    results.keep(carl)
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


def row(course, capsys, student):
    text = verb(course, capsys, "export")[1]
    return {r["student"]: r for r in csv.DictReader(io.StringIO(text))}[student]


def page(course, student):
    return (course.root / "feedback" / student / NAME / f"{NAME}.html").read_text()


def test_what_stands_in_a_manual_cell_is_found(authored):
    """By its name or its id, also where it was doubled; it does not count as the student's own."""
    given = json.loads((authored.release / NAME / f"{NAME}.ipynb").read_text())
    assert "MARK SCHEME" not in raw(given).decode() and "is short" not in raw(given).decode()
    notebook = written_in(given, WHY, "It is long.")
    notebook["cells"].append(dict(notebook["cells"][-2], source="Very."))
    del notebook["cells"][-2]["metadata"]["nbgrader"]  # the task's cell, known by its id
    manifest = Bundle.of(authored, NAME).data["cells"]
    found = plan(read(raw(notebook))["cells"], manifest)
    assert found.written[WHY] == "It is long.\n\nVery."
    assert set(found.written) == {WHY, REPORT} and not found.own


def test_formgrader_has_the_answer_and_the_scheme(written):
    """The notebook that formgrader opens shows both; an answer left as it was earns 0 by itself."""
    path = written.root / "autograded/ada" / NAME / f"{NAME}.ipynb"
    cells = {c["metadata"].get("nbgrader", {}).get("grade_id"): c["source"]
             for c in json.loads(path.read_text())["cells"]}  # fmt: skip
    assert "friction" in "".join(cells[WHY])
    assert "MARK SCHEME" in "".join(cells[REPORT])
    with open_gradebook(written) as book:
        found = {s: {g.name: (g.auto_score, g.needs_manual_grade)
                     for g in book.find_submission_notebook(NAME, NAME, s).grades}
                 for s in ("ada", "bob", "carl")}  # fmt: skip
    assert [found[s][WHY] for s in found] == [(None, True), (0.0, False), (0.0, False)]
    assert [found[s][REPORT] for s in found] == [(None, True), (None, True), (0.0, False)]


def test_no_page_before_all_is_marked(written, capsys):
    """Nobody's feedback goes out before everybody's is marked, unless one asks for it."""
    code, _, err = verb(written, capsys, "feedback")
    assert code == 2 and f"ada ({WHY}, {REPORT})" in err and f"bob ({REPORT})" in err
    assert not (written.root / "feedback").exists()
    assert verb(written, capsys, "feedback", "--student", "carl")[0] == 0, "nothing of Carl waits"
    assert verb(written, capsys, "feedback", "--unmarked")[0] == 0
    assert "Not marked in full yet." in page(written, "ada")
    assert "It is not marked yet." in page(written, "ada")
    code, _, err = verb(written, capsys, "export")
    assert code == 1 and f"no mark: ada: still to be marked: {WHY}, {REPORT}; mark by hand" in err


def test_a_students_page_waits_for_their_own_marks_alone(written, capsys):
    """A contested mark is answered with the page of one, whatever of the others still waits."""
    code, _, err = verb(written, capsys, "feedback", "--student", "bob")
    assert code == 2 and f"bob ({REPORT}): answers of 1 student still wait" in err
    give(written, "bob", REPORT, 0.0)
    assert verb(written, capsys, "feedback", "--student", "bob")[0] == 0
    assert "11 of 28 points." in page(written, "bob")
    assert not (written.root / "feedback/carl").exists()


def test_page_export_and_report_have_formgraders_mark(written, capsys):
    """Manual points, extra credit and comment are in all of them, and outlive grading again."""
    give(written, "ada", WHY, 1.5, "Say *why*.", extra=0.5)
    give(written, "ada", REPORT, 3.0)
    give(written, "bob", REPORT, 0.0)
    give(written, "bob", "circle-check", 4.0)
    assert not graded(written, "ada", **{WHY: "Because *friction* <b>eats</b> it.", REPORT: ""})
    assert verb(written, capsys, "feedback")[0] == 0
    assert row(written, capsys, "ada")["score"] == "16.0"
    assert row(written, capsys, "bob")["score"] == "13.0"
    assert "16 of 28 points." in page(written, "ada")
    assert "13 of 28 points." in page(written, "bob")
    assert "1.5 by hand; 0.5 extra credit" in page(written, "ada")
    assert "4 by hand, instead of 2" in page(written, "bob")
    line = MarkLine("circle", 4.0, automatic=4.0, by_hand=4.0)
    assert line.origin == "4 by hand", "instead of nothing else"
    assert "Say *why*." in page(written, "ada")
    assert "Because <em>friction</em> <b>eats</b> it." in page(written, "ada")
    report = verb(written, capsys, "class-report")[1]
    assert "Mean of the 2 graded: 14.5, median 14.5 of 28 points; 13 to 16." in report


def test_another_answer_is_looked_at_again(written, capsys):
    """Neither page nor table has a mark until somebody has looked at the new words."""
    for name in (WHY, REPORT):
        give(written, "ada", name, 1.0)
    (said,) = graded(written, "ada", b'{"cells": [], "again": 1}', **{WHY: "No.", REPORT: ""})
    assert said == (
        f"ada: {WHY} was marked 1 by hand, and the answer has changed since; look at it again"
    )
    (said,) = graded(written, "ada", b'{"cells": [], "again": 1}', **{WHY: "No.", REPORT: ""})
    assert said.startswith(f"ada: {WHY} was") and said.endswith("look at it again"), "until it is"
    assert f"ada ({WHY})" in verb(written, capsys, "feedback")[2]
    assert row(written, capsys, "ada")["score"] == "", "it waits, as the page does"
    code, _, err = verb(written, capsys, "export")
    assert code == 1 and f"no mark: ada: changed after the mark by hand: {WHY}; look at it" in err
    give(written, "ada", WHY, 1.0)
    assert row(written, capsys, "ada")["score"] == "13.0"


def test_another_answer_is_looked_at_though_the_gradebook_was_locked(written, monkeypatch):
    """A mark by hand does not count for new words because the first try to record them failed."""
    give(written, "ada", WHY, 1.0)
    write, new = gradebook.write, b'{"cells": [], "again": 1}'

    def fail(*_):
        raise OperationalError("COMMIT", {}, Exception("database is locked"))

    with monkeypatch.context() as patch:

        def write_and_lock(*args):
            write(*args)
            patch.setattr(Session, "commit", fail)

        patch.setattr(gradebook, "write", write_and_lock)
        with pytest.raises(LabkitError, match="locked; correct that and type the same again"):
            graded(written, "ada", new, **{WHY: "No.", REPORT: ""})
    (said,) = graded(written, "ada", new, **{WHY: "No.", REPORT: ""})
    assert "the answer has changed since; look at it again" in said


def scores(course):
    with open_gradebook(course) as book:
        grades = book.find_submission_notebook(NAME, NAME, "ada").grades
        return {g.name: (g.auto_score, g.needs_manual_grade) for g in grades}
