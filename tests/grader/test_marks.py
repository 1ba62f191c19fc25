"""No zero that nobody earned: a cell without a mark is empty, and somebody says why."""

from __future__ import annotations

import csv
import io
import json
import shutil
from dataclasses import replace

import pytest
from made import NAME, graded, handed_in, notebook_of, result_of

from labkit.__main__ import main
from labkit.course.authoring.layout import DEFENCE
from labkit.grader.batch import common_failures
from labkit.grader.export import LAYOUTS, as_csv, of_term, remarks, unmatched
from labkit.grader.gradebook import open_gradebook
from labkit.grader.marks import Mark, MarkLine, marks_of
from labkit.grader.results import Results
from labkit.grader.roster import Student, save_roster


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


def handed_in_again(course):
    path = course.submitted / "ada" / NAME / f"{NAME}.ipynb"
    path.write_bytes(notebook_of("ada, later"))


FAULTS = [ungraded, unrecorded, half_recorded, recorded_otherwise, damaged, handed_in_again]


@pytest.mark.parametrize("fault", FAULTS)
def test_a_mark_that_is_missing_is_an_empty_cell(marked, capsys, fault):
    """No table says 0; page and report do the others, name the one with a remedy, and exit 1."""
    remedy = f"type: labkit grade {NAME} --student ada"
    save_roster(marked, [Student(x, login=x) for x in ("ada", "bob", "carl")])
    tables = {layout: [NAME, "--layout", layout] for layout in LAYOUTS} | {"term": []}
    fault(marked)
    ada, bob, carl = marks_of(marked, NAME)
    assert (ada.raw, ada.score, ada.absent) == (None, "", False)
    assert (bob.score, carl.score) == (11.0, 0.0)
    for words in tables.values():
        assert main(["export", *words, "--course", str(marked.root)]) == 1
        out, err = capsys.readouterr()
        (line,) = [x for x in err.splitlines() if "no mark: ada: " in x]
        assert line.endswith(remedy)
        assert not [x for x in out.splitlines() if x.startswith("ada") and "22.0" in x]
    for words, says in ((["feedback"], "no page: "), (["class-report"], "left out: ")):
        code, out, err = verb(marked, capsys, *words)
        assert (code, err.count(f"{says}ada: ")) == (1, 1) and err.strip().endswith(remedy)
    assert "3 handed in, 1 graded, 1 rejected, 1 left out" in out
    assert sorted(x.name for x in (marked.root / "feedback").iterdir()) == ["bob", "carl"]


@pytest.mark.parametrize("change", [{"points": 5}, {"points": 1}, {"name": "ellipse"}])
def test_a_mark_of_an_earlier_release_is_an_empty_cell(marked, capsys, change):
    """Between a release with other points or questions and the next grading, no mark counts.

    A rejected file has no question that could be another one: its 0 stays.
    """
    path = marked.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    (circle,) = [q for q in data["questions"] if q["name"] == "circle"]
    circle.update(change)
    path.write_text(json.dumps(data))
    assert verb(marked, capsys, "export")[0] == 1
    assert [mark.score for mark in marks_of(marked, NAME)] == ["", "", 0.0]
    code, _, err = verb(marked, capsys, "feedback")
    assert (code, err.count("no page: ")) == (1, 2)


def test_a_class_that_is_whole(marked, capsys):
    """Exit 0 and no mark missing; a file that was rejected has 0 everywhere, explained."""
    code, out, err = verb(marked, capsys, "export")
    rows = table(out)
    assert code == 0 and "no mark" not in err
    assert [rows[x]["score"] for x in ("(full marks)", "ada", "bob", "carl")] == [
        "24.0", "22.0", "11.0", "0.0"
    ]  # fmt: skip
    assert "the file is empty" in rows["carl"]["remark"] and rows["ada"]["remark"] == ""
    assert verb(marked, capsys, "feedback")[0] == 0
    page = (marked.root / "feedback" / "carl" / NAME / f"{NAME}.html").read_text()
    assert "0 of 24 points" in page and "the file is empty" in page
    with open_gradebook(marked) as book:
        grades = book.find_submission_notebook(NAME, NAME, "carl").grades
        assert {(g.auto_score, bool(g.needs_manual_grade)) for g in grades} == {(0.0, False)}
    written = (marked.root / "autograded" / "carl" / NAME / f"{NAME}.ipynb").read_text()
    assert "the file is empty" in written


def test_before_anything_is_graded_every_cell_is_empty(course, capsys):
    """And each student is named; full marks are the release's."""
    handed_in(course, "ada", "bob")
    code, out, err = verb(course, capsys, "export")
    assert code == 1 and err.count("handed in but not graded") == 2
    scores = {name: row["score"] for name, row in table(out).items()}
    assert scores == {"(full marks)": "24.0", "ada": "", "bob": ""}


def test_a_submission_that_vanished_keeps_its_mark(marked, capsys):
    """The table says that it vanished."""
    shutil.rmtree(marked.submitted / "ada")
    code, out, err = verb(marked, capsys, "export")
    assert code == 0 and "ada: nothing of theirs is in submitted/" in err
    assert table(out)["ada"]["score"] == "22.0"
    assert verb(marked, capsys, "feedback", "--student", "ada")[0] == 0


def test_many_failures_of_one_test_are_named(course):
    """If at least five students and more than 30 % of those who tried it fail it."""
    right, wrong = (result_of(course, "ada", share=share) for share in (1.0, 0.5))
    asked = [answer.verdict.name for answer in right.questions]
    assert len(list(common_failures([wrong] * 5))) == len(asked)
    assert not list(common_failures([wrong] * 4))
    assert not list(common_failures([wrong] * 5 + [right] * 12))
    assert len(list(common_failures([wrong] * 5 + [right] * 11))) == len(asked)


def of(name, **about):
    who, line = Student(name, **about), MarkLine("q", 2.0, 1.0)
    return Mark(who, lines=(line,), raw=1.0, points=2.0)


def test_platforms_tables():
    """Canvas' columns in its order; Moodle's users by address."""
    ada = of("ada", lms_user_id="42", first_name="A", last_name="L", email="a@x.org", login="a1")
    carl = of("carl")
    canvas = LAYOUTS["canvas"]("Paths (4711)", [ada, carl])
    assert canvas[0] == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Paths (4711)"]
    assert canvas[1][5] == 2.0 and canvas[2] == ["L, A", "42", "", "a1", "", 1.0]
    moodle = LAYOUTS["moodle"]("Paths", [ada, carl])
    assert moodle[1:] == [["A", "L", "", "a1", "a@x.org", 1.0]], "nobody's mark stays out"
    for layout in LAYOUTS:
        assert unmatched(layout, [ada, carl]) == ["carl"] * (layout != "questions")


def test_nothing_becomes_a_formula():
    """A name that a spreadsheet would run is written as text."""
    row = of("=1+1", first_name="@a", last_name="+b", email="-c", login="=d")
    for layout in LAYOUTS.values():
        for cells in csv.reader(io.StringIO(as_csv(layout("x", [row])))):
            assert not [c for c in cells if c[:1] in set("=+@-")]


def test_who_had_no_defence_yet_has_the_percentage_of_all_else():
    """The first defence takes nobody else's, and gives nobody a 0; no hand-in is a 0."""
    ada, bob, eve = (Mark(Student(name), points=10.0, raw=5.0) for name in ("ada", "bob", "eve"))
    held, waits = replace(ada, raw=8.0), replace(bob, raw=None, missing="no mark for question_1")
    absent, nothing = replace(eve, raw=None), Mark(Student("zoe"), points=10.0)
    weights = {NAME: 1.0, DEFENCE: 2.0}

    def percent(*defences):
        table = of_term({NAME: [ada, bob, eve, nothing], DEFENCE: defences}, weights)
        return [row[-1] for row in table[3:]]

    assert percent(held, waits, absent, nothing) == [70.0, 50.0, 50.0, 0.0]
    assert percent(held, waits, replace(absent, raw=0.0))[2] == 16.67
    assert list(remarks("questions", [held, absent], DEFENCE)) == ["1 with no defence yet: eve"]


def test_where_a_score_comes_from():
    """A mark by hand counts instead of the grader's, and extra credit on top."""
    line = MarkLine("circle", 4.0, automatic=2.0, by_hand=4.0, extra=0.5)
    assert (line.score, line.origin) == (4.5, "4 by hand, instead of 2; 0.5 extra credit")
    assert (MarkLine("circle", 4.0).score, MarkLine("circle", 4.0, 2.0).origin) == (None, "")
