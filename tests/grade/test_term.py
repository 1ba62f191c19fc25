"""The rest of the term: pages, tables, regrading, the class report, collecting."""

from __future__ import annotations

import csv
import io
import json
import os
import zipfile
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from handmade import QUICK, ROOT

from labkit.check.codec import encode
from labkit.cli import main
from labkit.errors import LabkitError
from labkit.grade.batch import Graded, How, grade_class
from labkit.grade.class_report import report
from labkit.grade.collect import collect
from labkit.grade.engines import students
from labkit.grade.export import LAYOUTS, Row, as_csv, left_out, rows
from labkit.grade.feedback import page
from labkit.grade.gradebook import record
from labkit.grade.limits import Limits
from labkit.grade.lms import FILE, Known, known
from labkit.grade.pseudonyms import pseudonyms
from labkit.grade.regrade import accept, moves
from labkit.grade.results import Results
from labkit.grade.synthetic import make_class
from labkit.grade.term import archive

pytestmark = pytest.mark.slow  # whole classes are graded

NAME = "01_paths"


@pytest.fixture(scope="module")
def term(released, tmp_path_factory):
    """A course with a small class, graded and recorded."""
    import shutil

    from labkit.grade.course import Course

    root = tmp_path_factory.mktemp("term") / "course"
    shutil.copytree(released.root, root, symlinks=True)
    course = Course(root)
    make_class(course, NAME, seed=4, count=9)
    done = grade_class(course, NAME, students(course, NAME), How(jobs=2, limits=QUICK))
    record(course, NAME, [one.result for one in done if isinstance(one, Graded)])
    return course


class Page(HTMLParser):
    """The elements and texts of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.words = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.words.append(data)


def test_feedback_page_shows_text_as_text(term):
    """Whatever a student's code said, the page holds no element but its own, and a policy."""
    result = max(Results(term, NAME), key=lambda r: len(r.cells) + sum(
        q["outcome"] == "wrong" for q in r.questions))  # fmt: skip
    evil = "<script>alert(1)</script><img src=x onerror=alert(1)>"
    worst = replace(
        result,
        notes=(evil,),
        cells=({"cell": 3, "kind": evil, "error": evil, "output": evil, "seconds": 0.0},),
        questions=tuple(
            dict(q, source=evil, notes=[evil], tests=[dict(t, says=evil) for t in q["tests"]])
            for q in result.questions
        ),
    )
    found = Page(page(worst, {"circle": evil}))
    tags = {tag for tag, _ in found.tags}
    assert not tags & {"script", "img", "iframe", "a", "object", "link"}
    policy = [a for t, a in found.tags if t == "meta" and "http-equiv" in a]
    assert "default-src 'none'" in policy[0]["content"]
    assert any(evil in words for words in found.words)


def numbers(data):
    """All long numbers in encoded data, as they are printed."""
    if isinstance(data, float):
        return {repr(data)} if len(repr(data)) > 8 else set()
    inner = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    return {x for part in inner for x in numbers(part)}


def test_feedback_has_no_hidden_case(term, bundle):
    """No hidden input stands in any page, though every page says what class of case failed."""
    cases = [case for q in bundle.questions for test in q.tests for case in test.cases]
    hidden = {x for c in cases if c.hidden for x in numbers(encode(c.args))}
    hidden -= {x for c in cases if not c.hidden for x in numbers(encode(c.args))}
    assert len(hidden) > 50
    text = "".join(page(r) for r in Results(term, NAME))
    assert not [x for x in hidden if x in text]
    assert "a hidden case (" in text or "failed" in text


def test_feedback_lies_where_nbgrader_looks(term, capsys):
    """One page for each student, as feedback/STUDENT/ASSIGNMENT/ASSIGNMENT.html."""
    assert main(["feedback", NAME, "--course", str(term.root)]) == 0
    made = list((term.root / "feedback").glob(f"*/{NAME}/{NAME}.html"))
    assert len(made) == 9
    assert "release_feedback" not in capsys.readouterr().out  # nothing came through the exchange


def test_tables(term, capsys):
    """Every layout has a row for each student and the gradebook's scores."""
    marks = list(rows(term, NAME))
    scores = {r.student: r.score for r in Results(term, NAME)}
    assert {r.student: r.score for r in marks} == scores
    for layout, extra in (("nbgrader", 1), ("questions", 2), ("canvas", 2), ("moodle", 1)):
        table = list(csv.reader(io.StringIO(as_csv(LAYOUTS[layout](NAME, marks)))))
        assert len(table) == len(marks) + extra
        assert len({len(row) for row in table}) == 1
    assert main(["export", NAME, "--course", str(term.root)]) == 0
    head, full, *_ = capsys.readouterr().out.splitlines()
    assert head.startswith("student,bang_bang,trapezoid")
    assert full.endswith("20.0,")


def test_nothing_becomes_a_formula():
    """A name that a spreadsheet would run is written as text."""
    row = Row("=1+1", "@a", "+b", "-c", "1", "", "", {"q": (1.0, 2.0)}, 1.0, 0.0, 2.0)
    for layout in LAYOUTS.values():
        for cells in csv.reader(io.StringIO(as_csv(layout("x", [row])))):
            assert not [c for c in cells if c[:1] in set("=+@")]


def test_regrade_says_first_and_never_lowers_unasked(course, capsys):
    """After a threshold moves, --diff names who moves; marks fall only with --lower."""
    make_class(course, NAME, seed=4, count=5)
    who = students(course, NAME)
    how = How(jobs=2, limits=QUICK)
    before = {one.result.student: one.result for one in grade_class(course, NAME, who, how)}
    path = course.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    data["hash"] = "0" * 64
    for question in data["questions"]:
        if question["name"] == "witness":
            question["points"] = 1
    path.write_text(json.dumps(data))
    moved = list(moves(course, NAME, who, how))
    assert {m.by for m in moved} == {-1.0, 0.0}
    assert {r.student: r.score for r in Results(course, NAME)} == {
        s: r.score for s, r in before.items()
    }
    accepted = {result.student for result in accept(course, NAME, moved, lower=False)}
    left = [m for m in moved if m.after.student not in accepted]
    assert {m.after.student for m in left} == {m.after.student for m in moved if m.by < 0}
    kept = [one for one in grade_class(course, NAME, who, how) if one.says.startswith("kept")]
    assert len(kept) == len(left)
    assert len(accept(course, NAME, moved, lower=True)) == len(moved)
    assert {r.score for r in Results(course, NAME)} == {m.after.score for m in moved}
    assert list((Results(course, NAME).folder / "old").iterdir())


def test_class_report(term):
    """The report counts misconceptions by name, and names nobody unless asked."""
    results = list(Results(term, NAME))
    problems = {p.name: p for p in term.problems(NAME)}
    text = report(NAME, results, problems, pseudonyms(term))
    mistakes = [q["mistake"]["name"] for r in results for q in r.questions if q["mistake"]]
    assert mistakes
    assert all(name in text for name in mistakes)
    assert not [r.student for r in results if r.student in text]
    named = report(NAME, [replace(r, rejected="x") for r in results], problems, str)
    assert all(r.student in named for r in results)


def test_pseudonyms_last_a_term_and_are_nobody_elses(course):
    """A student keeps a pseudonym until the term ends; another course cannot make it again."""
    first = pseudonyms(course)("ada")
    assert pseudonyms(course)("ada") == first != pseudonyms(course)("bob")
    archive(course)
    assert pseudonyms(course)("ada") != first


def test_look_alikes(term):
    """Two who handed in the same unusual work are listed together, with what to ask."""
    results = list(Results(term, NAME))
    one = next(r for r in results if sum(q["outcome"] == "wrong" for q in r.questions) > 2)
    text = report(NAME, [*results, replace(one, student="zz")], {}, str)
    assert "Look-alikes" in text
    assert f"{one.student} and zz" in text


def test_collect_from_downloads(course, tmp_path):
    """Moodle's, Canvas's and nbgrader's own layouts end in submitted/, the last file of each."""
    moodle, canvas = tmp_path / "moodle.zip", tmp_path / "canvas.zip"
    with zipfile.ZipFile(moodle, "w") as archive:
        archive.writestr("Ada Lovelace_101_assignsubmission_file/notebook.ipynb", "1")
        archive.writestr("Ada Lovelace_101_assignsubmission_file/notebook(3).ipynb", "2")
        archive.writestr("Bob_102_assignsubmission_file/readme.txt", "x")
        archive.writestr("../../evil.ipynb", "x")
    with zipfile.ZipFile(canvas, "w") as archive:
        archive.writestr("hoppergrace_LATE_7_99_01_paths-1.ipynb", "3")
    inbound = tmp_path / "inbound"
    folder = inbound / f"carl+{NAME}+2026-03-01 10:00:00 UTC+abc"
    folder.mkdir(parents=True)
    (folder / f"{NAME}.ipynb").write_text("4")
    (inbound / f"eve+{NAME}+2026-03-01 10:00:00 UTC+abc").symlink_to("/etc")
    said = [str(x) for source in (moodle, canvas, inbound) for x in collect(course, NAME, source)]
    taken = {p.parent.parent.name: p.read_text() for p in course.submitted.glob("*/*/*.ipynb")}
    assert taken == {"Ada-Lovelace": "2", "hoppergrace-7": "3", "carl": "4"}
    assert (course.submitted / "carl" / NAME / "timestamp.txt").read_text().startswith("2026-03-01")
    assert [x for x in said if "late" in x and "hopper" in x]
    assert [x for x in said if "no student can be told" in x]
    assert [x for x in said if "notebook.ipynb: not taken; notebook(3).ipynb counts" in x]
    assert [str(x) for x in collect(course, NAME, moodle) if "there already" in str(x)]
    with pytest.raises(LabkitError, match="neither a folder nor a zip"):
        list(collect(course, NAME, Path(__file__)))
    with pytest.raises(LabkitError, match="there is no"):
        list(collect(course, NAME, tmp_path / "none.zip"))


def test_collect_takes_the_notebook_that_is_called_as_the_assignment(course, tmp_path):
    """A sketch beside it is not taken for it; what came later is, whatever its number."""
    file = "Ada_101_assignsubmission_file/{}.ipynb"
    names = [f"{NAME}", f"{NAME}(2)", "zz-sketch-9", "zz"]
    zipped = download(tmp_path / "a.zip", [file.format(name) for name in names])
    said = [str(x) for x in collect(course, NAME, zipped)]
    taken = course.submitted / "Ada" / NAME / f"{NAME}.ipynb"
    assert taken.read_text() == file.format(f"{NAME}(2)")
    assert f"Ada: zz.ipynb: not taken; {NAME}(2).ipynb counts" in said


def test_collect_keeps_the_names_of_the_exchange(course, tmp_path):
    """The exchange hands back under the name that it took; none can lead out of the folder."""
    for who in ("ada.l@uni.org", "..", ".hidden"):
        folder = tmp_path / "in" / f"{who}+{NAME}+2026-03-01 10:00:00 UTC"
        folder.mkdir(parents=True)
        (folder / f"{NAME}.ipynb").write_text(who)
    assert [x.student for x in collect(course, NAME, tmp_path / "in")] == ["ada.l@uni.org"]
    assert [path.name for path in course.submitted.iterdir()] == ["ada.l@uni.org"]


def test_collect_waits_for_nothing_and_follows_nobody(course, tmp_path, monkeypatch):
    """A pipe, a link or a huge file in a download costs its own student, in words."""
    monkeypatch.setattr("labkit.grade.collect.Limits", lambda: Limits(notebook=1))
    for who in ("ada", "bob", "carl"):
        (tmp_path / "in" / f"{who}+{NAME}+2026-03-01 10:00:00 UTC").mkdir(parents=True)
    pipe, link, huge = (path / f"{NAME}.ipynb" for path in sorted((tmp_path / "in").iterdir()))
    os.mkfifo(pipe)
    link.symlink_to("/etc/passwd")
    huge.write_bytes(b" " * 2**21)
    said = [str(x) for x in collect(course, NAME, tmp_path / "in")]
    words = ("is not a file", "is a link or cannot be opened", "has 2 MB, the limit is 1 MB")
    assert [word in x for word, x in zip(words, said, strict=True)] == [True] * 3
    path = tmp_path / "big.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Ada_1_assignsubmission_file/n.ipynb", b" " * 2**21)
    (one,) = collect(course, NAME, path)
    assert str(one) == "Ada: n.ipynb: not taken; the file has 2 MB, the limit is 1 MB"
    assert not course.submitted.exists()


def test_a_damaged_download_is_a_sentence(course, tmp_path):
    """A zip with a broken file in it says so, and nothing of it is taken."""
    path = download(tmp_path / "a.zip", ["Ada_1_assignsubmission_file/n.ipynb"])
    path.write_bytes(path.read_bytes().replace(b"n.ipynbAda", b"n.ipynbBda"))
    with pytest.raises(LabkitError, match="damaged or locked"):
        list(collect(course, NAME, path))
    assert not course.submitted.exists()


def download(path, names):
    with zipfile.ZipFile(path, "w") as archive:
        for name in names:
            archive.writestr(name, name)
    return path


def test_collect_tells_people_of_one_name_apart(course, tmp_path):
    """Moodle's number is in a folder's name only where it must be, and stays there."""
    file = "{}_{}_assignsubmission_file_{}n.ipynb"
    first = [file.format("Li Wei", 7, "/"), file.format("Bob", 8, "")]
    later = [file.format("Li Wei", 7, "/"), file.format("Li Wei", 9, "/sub/")]
    other = [file.format("Kim", 1, "/"), file.format("Kim", 2, "/")]
    for number, names in enumerate((first, later, other)):
        said = [str(x) for x in collect(course, NAME, download(tmp_path / f"{number}.zip", names))]
    assert "Kim: 2 students are called so; told apart by their number" in said
    folders = {path.name for path in course.submitted.iterdir()}
    assert folders == {"Li-Wei", "Li-Wei-9", "Bob", "Kim-1", "Kim-2"}
    assert known(course, NAME)["Li-Wei-9"] == Known("moodle", "9", "Li Wei")
    assert not known(course, "02_model")


def test_numbers_go_with_the_term(course, tmp_path):
    """What a platform calls its students lies in a folder of no repository, and is archived."""
    names = ["hoppergrace_LATE_7_99_n.ipynb"]
    list(collect(course, NAME, download(tmp_path / "a.zip", names)))
    assert (course.root / FILE).exists()
    assert "/course_private/" in (ROOT / ".gitignore").read_text().split()
    assert FILE.startswith("course_private/")
    folder = archive(course)
    assert not (course.root / FILE).exists()
    assert (folder / "lms.json").exists()


def test_canvas_layout():
    """Canvas' five columns in its order, full marks below, students by Canvas' own number."""
    canvas = row("hoppergrace-7", known=Known("canvas", "7", "hoppergrace"))
    table = LAYOUTS["canvas"]("Paths (4711)", [canvas, row("ada", lms="42", first="A", last="L")])
    assert table[0] == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Paths (4711)"]
    assert "Points Possible" in table[1][0]
    assert table[1][5] == 2.0
    assert table[2] == ["hoppergrace-7", "7", "", "", "", 1.0]
    assert table[3] == ["L, A", "42", "", "ada", "", 1.0]
    assert not left_out("canvas", [canvas, row("ada")])


def test_moodle_layouts():
    """The gradebook knows users by address, the worksheet by the number of the download."""
    moodle = row("Ada-Lovelace", known=Known("moodle", "101", "Ada Lovelace"))
    table = LAYOUTS["moodle-worksheet"]("Paths", [moodle, row("carl")])
    assert {"Identifier", "Grade", "Last modified (grade)"} <= set(table[0])
    assert table[1:] == [["Participant 101", "Ada Lovelace", 1.0, 2.0, ""]]
    assert left_out("moodle-worksheet", [moodle, row("carl")]).startswith("1 of 2 cannot be told")
    table = LAYOUTS["moodle"]("Paths", [row("carl", email="c@x.org", lms="9")])
    assert table[0][2:] == ["ID number", "Username", "Email address", "Paths"]
    assert table[1][2:] == ["9", "carl", "c@x.org", 1.0]
    assert "Ada-Lovelace" in left_out("moodle", [moodle])


def row(student, *, first="", last="", email="", lms="", known=None):
    return Row(student, first, last, email, lms, "", "", {"q": (1.0, 2.0)}, 1.0, 0.0, 2.0, known)
