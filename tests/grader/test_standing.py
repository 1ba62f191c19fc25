"""No zero that nobody earned: a cell without a mark is empty, and somebody says why."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
from dataclasses import replace

import pytest
from made import NAME, changed, graded, handed_in, notebook_of, result_of

from labkit.__main__ import main
from labkit.grader.batch import common_failures
from labkit.grader.export import LAYOUTS
from labkit.grader.gradebook import open_gradebook
from labkit.grader.results import OTHER_NOTEBOOK, Results

GRADE = f"type: labkit grade {NAME} --student ada"


@pytest.fixture
def marked(course):
    """Ada has full marks, Bob half of them, Carl's file is broken; all is in the gradebook."""
    graded(
        course,
        result_of(course, "ada"),
        result_of(course, "bob", share=0.5),
        result_of(course, "carl", rejected="the file is empty"),
    )
    return course


def verb(course, capsys, *words):
    """Run a verb on the assignment: exit code, stdout, stderr."""
    code = main([words[0], NAME, "--course", str(course.root), *words[1:]])
    return code, *capsys.readouterr()


def table(text):
    return {row["student"]: row for row in csv.DictReader(io.StringIO(text))}


def table_of(course, capsys):
    return table(verb(course, capsys, "export")[1])


def ungraded(course):
    Results(course, NAME).path("ada").unlink()


def unrecorded(course):
    with open_gradebook(course) as book:
        book.remove_submission(NAME, "ada")


def half_recorded(course):
    with open_gradebook(course) as book:  # as nbgrader leaves one who was created and not marked
        for grade in book.find_submission_notebook(NAME, NAME, "ada").grades:
            grade.auto_score = None
        book.db.commit()


def recorded_otherwise(course):
    with open_gradebook(course) as book:
        book.find_grade("circle-check", NAME, NAME, "ada").auto_score = 0.0
        book.db.commit()


def damaged(course):
    path = Results(course, NAME).path("ada")
    path.write_text(path.read_text()[:200])


def older(course):
    path = Results(course, NAME).path("ada")
    path.write_text(json.dumps(json.loads(path.read_text()) | {"format": 1}))


def handed_in_again(course):
    path = course.submitted / "ada" / NAME / f"{NAME}.ipynb"
    path.write_bytes(notebook_of("ada, later"))


FAULTS = {
    ungraded: "handed in but not graded",
    unrecorded: "graded, but not in the gradebook",
    half_recorded: "the result gives 3 for bang_bang, the gradebook nothing",
    recorded_otherwise: "the result gives 4 for circle, the gradebook 0",
    damaged: "ada.json is damaged",
    handed_in_again: "handed in again but not graded since",
}


def tables(course, capsys):
    """Every table of marks: by layout, and of the term, how it ended, its rows and its words."""
    at, found = ["--course", str(course.root)], {}
    words = {layout: [NAME, "--layout", layout] for layout in LAYOUTS} | {"term": []}
    for table, more in words.items():
        code = main(["export", *more, *at])
        out, err = capsys.readouterr()
        found[table] = code, list(csv.reader(io.StringIO(out))), err.splitlines()
    return found


@pytest.mark.parametrize("fault", FAULTS)
def test_a_mark_that_is_missing_is_an_empty_cell(marked, capsys, fault):
    """Where result and gradebook disagree, no table says 0, and stderr says what to type."""
    people = marked.root / "class.csv"
    numbers = marked.root / "course_private/lms.json"
    numbers.parent.mkdir(exist_ok=True)
    numbers.write_text(json.dumps({NAME: {"ada": ["4711", "ada"]}}))
    people.write_text("Username,Name,Email address\nada,ada,ada@example.org\n")
    assert main(["roster", str(people), "--course", str(marked.root)]) == 0
    capsys.readouterr()
    whole = tables(marked, capsys)
    fault(marked)
    for table, (code, rows, err) in tables(marked, capsys).items():
        _, before, _ = whole[table]
        (line,) = [x for x in err if "no mark: ada: " in x]
        assert code == 1 and FAULTS[fault] in line and line.endswith(GRADE)
        ((was, now),) = [pair for pair in zip(before, rows, strict=True) if pair[0] != pair[1]]
        lost = {old: new for old, new in zip(was, now, strict=True) if old != new and old}
        assert lost["24.0"] == "" and set(lost.values()) == {""}, table
    rows = table_of(marked, capsys)
    assert (rows["ada"]["score"], rows["ada"]["circle"]) == ("", "")
    assert (rows["bob"]["score"], rows["carl"]["score"]) == ("11.0", "0.0")


@pytest.mark.parametrize(
    "change",
    [
        {"points": 5},
        {"points": 1},
        {"name": "ellipse"},
    ],
)
def test_a_mark_of_an_earlier_release_is_an_empty_cell(marked, capsys, change):
    """Between a release with other points or questions and the next grading, no mark counts.

    A rejected file has no question that could be another one: its 0 stays.
    """
    path = marked.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    (circle,) = [q for q in data["questions"] if q["name"] == "circle"]
    circle.update(change)
    path.write_text(json.dumps(data))
    code, out, err = verb(marked, capsys, "export")
    assert code == 1
    remedy = f"type: labkit grade {NAME}, and add --lower"
    assert f"no mark: ada: graded before the last release; {remedy}" in err
    rows = table(out)
    assert [rows[who]["score"] for who in ("ada", "bob", "carl")] == ["", "", "0.0"]
    code, _, err = verb(marked, capsys, "feedback")
    assert (code, err.count("no page: ")) == (1, 2)


def test_a_mark_falls_by_the_share_of_what_both_releases_ask(course):
    """Other points are no fall; a rejection is one, and another file never."""
    full, half = result_of(course, "ada"), result_of(course, "ada", share=0.5)
    assert half.falls_from(full) and not full.falls_from(half)
    cheaper = changed(full, 0, {"points": 1.0, "earned": 1.0})
    dearer = changed(full, 0, {"points": 9.0, "earned": 9.0})
    for one in (cheaper, dearer):
        assert not one.falls_from(full) and not full.falls_from(one)
    assert changed(dearer, 0, {"earned": 8.0}).falls_from(full)
    before = changed(full, 1, {"points": 0.0, "earned": 0.0})  # it hides no fall of another
    assert changed(full, 0, {"earned": 0.0}).falls_from(before)
    rejected = result_of(course, "ada", rejected="the file is empty")
    assert rejected.falls_from(full) and not full.falls_from(rejected)
    assert not result_of(course, "ada", share=0.5, data=b"another").falls_from(full)


def test_tables_of_a_class_that_is_whole_say_nothing(marked, capsys):
    """Exit 0 and no word on stderr, but for a file that was rejected: its 0 is explained.

    A table by which a platform knows none of them is named, with what it lacks: exit 1.
    """
    for layout in LAYOUTS:
        code, _, err = verb(marked, capsys, "export", "--layout", layout)
        nobody = "nobody can import this table: it has no participant's number" in err
        assert code == nobody == (layout == "moodle-worksheet")
        assert "carl: rejected: the file is empty; ask for the file again" in err.splitlines()
        assert not [x for x in err.splitlines() if x.startswith("no mark")]
    rows = table(verb(marked, capsys, "export")[1])
    assert rows["carl"]["score"] == "0.0"
    assert rows["carl"]["remark"] == "rejected: the file is empty; ask for the file again"
    assert rows["ada"]["remark"] == ""


def test_full_marks_are_the_releases_where_the_gradebook_is_gone(marked, capsys):
    """With what a person marks; the results know the machine's part alone.  Else nobody knows."""
    data = json.loads((marked.bundle / f"{NAME}.json").read_text())
    machine = sum(question["points"] for question in data["questions"])
    full = machine + sum(cell.get("points", 0.0) for cell in data["cells"])
    (marked.root / "gradebook.db").unlink()
    rows = table(verb(marked, capsys, "export")[1])
    assert float(rows["(full marks)"]["score"]) == full > machine
    assert rows["ada"]["score"] == ""
    (marked.bundle / f"{NAME}.json").unlink()
    (marked.root / "gradebook.db").unlink()
    assert table(verb(marked, capsys, "export")[1])["(full marks)"]["score"] == ""


def test_only_handed_in_is_no_mark(course, capsys):
    """Before anything is graded every cell is empty and each student is named."""
    handed_in(course, "ada", "bob")
    code, out, err = verb(course, capsys, "export")
    assert code == 1
    assert {s: row["score"] for s, row in table(out).items() if s in {"ada", "bob"}} == {
        "ada": "",
        "bob": "",
    }
    assert err.count("handed in but not graded") == 2


@pytest.mark.parametrize("fault", FAULTS)
def test_page_and_report_name_whom_they_leave_out(marked, capsys, fault):
    """Feedback and class report do the others, name the one, and exit with 1."""
    fault(marked)
    code, out, err = verb(marked, capsys, "feedback")
    assert (code, err.count("no page: ada: ")) == (1, 1)
    assert FAULTS[fault] in err and err.strip().endswith(GRADE)
    assert "pages in" in out and ": 2\n" in out
    assert not (marked.root / "feedback" / "ada").exists()
    code, out, err = verb(marked, capsys, "class-report", "--names")
    assert (code, err.count("left out: ada: ")) == (1, 1)
    assert "3 handed in, 1 graded, 1 rejected, 1 left out" in out
    assert "carl: the file is empty" in out


def test_a_rejected_submission_is_the_same_everywhere(marked, capsys):
    """Page, gradebook and table all say 0, and page and table say why."""
    assert verb(marked, capsys, "feedback")[0] == 0
    page = (marked.root / "feedback" / "carl" / NAME / f"{NAME}.html").read_text()
    assert "0 of 24 points" in page and "the file is empty" in page
    with open_gradebook(marked) as book:
        grades = book.find_submission_notebook(NAME, NAME, "carl").grades
        assert {g.auto_score for g in grades} == {0.0}
        assert not any(g.needs_manual_grade for g in grades)
    written = (marked.root / "autograded" / "carl" / NAME / f"{NAME}.ipynb").read_text()
    assert "the file is empty" in written


def test_another_notebook_is_no_attempt_at_a_question(marked, capsys):
    """The class report lists it as rejected, and nothing in it counts among the answers."""
    note = f"{OTHER_NOTEBOOK}: only 2 of the 22 named cells are of {NAME}"
    graded(marked, result_of(marked, "dan", share=0.0, notes=(note,), data=notebook_of("dan")))
    report = verb(marked, capsys, "class-report", "--names")[1]
    assert "4 handed in, 2 graded, 2 rejected" in report and f"- dan: {note}" in report
    (row,) = re.findall(r"^\| circle \|(.*)", report, re.MULTILINE)
    assert row.replace(" ", "").startswith("1|1|0|0|0|")
    wrong = result_of(marked, "eve", share=0.0)
    assert list(common_failures([wrong] * 5))
    assert not list(common_failures([replace(wrong, notes=(note,))] * 5))


def test_a_submission_that_vanished_keeps_its_mark(marked, capsys):
    """Page, report, gradebook and table have it still, and the table says that it vanished."""
    shutil.rmtree(marked.submitted / "ada")
    code, out, err = verb(marked, capsys, "export")
    assert code == 0
    assert table(out)["ada"]["score"] == "24.0"
    assert "ada: nothing of theirs is in submitted/; the mark stays as it was" in err
    assert verb(marked, capsys, "feedback")[0] == 0
    assert (marked.root / "feedback" / "ada" / NAME / f"{NAME}.html").exists()
    report = verb(marked, capsys, "class-report")[1]
    assert "3 handed in, 2 graded, 1 rejected." in report
    assert "\nMean of the 2 graded: " in report, "a file that was rejected is not in the mean"
    Results(marked, NAME).path("ada").write_text("{")
    code, out, err = verb(marked, capsys, "export")
    assert (code, table(out)["ada"]["score"]) == (1, "")
    assert "nothing of theirs is in submitted/; restore" in err


def test_a_mark_by_hand_counts_and_a_question_without_one_is_missing(marked, capsys):
    """A manual mark stands over the automatic one; a cell that nobody marked leaves no 0."""
    from nbgrader.api import Grade, GradeCell

    with open_gradebook(marked) as book:
        book.find_grade("circle-check", NAME, NAME, "bob").manual_score = 4.0
        book.db.commit()
    code, out, _ = verb(marked, capsys, "export")
    assert (code, table(out)["bob"]["score"]) == (0, "13.0")
    with open_gradebook(marked) as book:
        notebook = book.find_notebook(NAME, NAME)
        book.db.add(
            essay := GradeCell(name="essay", notebook=notebook, max_score=3, cell_type="markdown")
        )
        book.db.flush()
        book.db.add_all([Grade(cell_id=essay.id, notebook=s) for s in notebook.submissions])
        book.db.commit()
    graded(marked, result_of(marked, "ada"), result_of(marked, "bob", share=0.5))
    with open_gradebook(marked) as book:
        grade = book.find_grade("essay", NAME, NAME, "ada")
        assert (grade.auto_score, grade.needs_manual_grade) == (None, True)
        bob = book.find_grade("essay", NAME, NAME, "bob")
        bob.manual_score, bob.needs_manual_grade = 2.0, False
        book.db.commit()
    code, out, err = verb(marked, capsys, "export")
    assert (code, table(out)["ada"]["score"], table(out)["bob"]["score"]) == (1, "", "15.0")
    assert "no mark: ada: still to be marked: essay; mark by hand, in formgrader" in err
