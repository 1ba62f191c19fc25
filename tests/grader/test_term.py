"""The rest of the term: pages, tables, regrading, the class report, collecting."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from handmade import QUICK
from made import said_by_hand, saying

from labkit.__main__ import main
from labkit.course.authoring.layout import OUTCOMES
from labkit.course.serialize import encode
from labkit.course.verdict import Outcome
from labkit.grader.batch import GradedSubmission, GradeOptions, changes, grade_class
from labkit.grader.class_report import report
from labkit.grader.collect import Participant
from labkit.grader.export import LAYOUTS, as_csv, left_out
from labkit.grader.feedback import page
from labkit.grader.gradebook import record
from labkit.grader.marks import Mark, MarkLine, mark_of, marks_of
from labkit.grader.results import Results
from labkit.grader.roster import Student
from labkit.grader.seeds import pseudonyms
from labkit.grader.submission import students
from labkit.grader.term import archive
from tests.synthetic import make_class

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("term")]  # whole classes are graded

NAME = "01_curves"


@pytest.fixture(scope="module")
def term(released, tmp_path_factory):
    """A course with a small class, graded and recorded."""
    import shutil

    from labkit.course.authoring.layout import Course

    root = tmp_path_factory.mktemp("term") / "course"
    shutil.copytree(released.root, root, symlinks=True)
    course = Course(root)
    make_class(course, NAME, seed=4, count=9)
    done = grade_class(course, NAME, students(course, NAME), GradeOptions(jobs=2, limits=QUICK))
    record(course, NAME, [one.result for one in done if isinstance(one, GradedSubmission)])
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
        q.verdict.outcome is Outcome.WRONG for q in r.questions))  # fmt: skip
    evil = "<script>alert(1)</script><img src=x onerror=alert(1)>"
    worst = replace(
        result,
        notes=(evil,),
        cells=({"cell": 3, "kind": evil, "error": evil, "output": evil, "seconds": 0.0},),
        questions=tuple(
            replace(q, source=evil, notes=(evil,), verdict=saying(q.verdict, evil))
            for q in result.questions
        ),
    )
    found = Page(page(worst, said_by_hand(worst, circle=evil)))
    tags = {tag for tag, _ in found.tags}
    assert not tags & {"script", "img", "iframe", "object", "link"}
    leads = {a["href"] for t, a in found.tags if t == "a"}
    assert leads <= {f"#{q.verdict.name}" for q in worst.questions}
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
    assert len(hidden) > 8
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
    marks = list(marks_of(term, NAME))
    scores = {r.student: r.score for r in Results(term, NAME)}
    assert {r.student: r.score for r in marks} == scores
    for layout, extra in (("nbgrader", 1), ("questions", 2), ("canvas", 2), ("moodle", 1)):
        table = list(csv.reader(io.StringIO(as_csv(LAYOUTS[layout](NAME, marks)))))
        assert len(table) == len(marks) + extra
        assert len({len(row) for row in table}) == 1
    assert main(["export", NAME, "--course", str(term.root)]) == 0
    head, full, *_ = capsys.readouterr().out.splitlines()
    assert head.startswith("student,bang_bang,circle,length")
    assert full.endswith("24.0,")


def test_nothing_becomes_a_formula():
    """A name that a spreadsheet would run is written as text."""
    who, line = Student("=1+1", "@a", "+b", "-c", "1", id_number="1"), MarkLine("q", 2.0, 1.0)
    row = Mark(who, lines=(line,), raw=1.0, points=2.0)
    for layout in LAYOUTS.values():
        for cells in csv.reader(io.StringIO(as_csv(layout("x", [row])))):
            assert not [c for c in cells if c[:1] in set("=+@")]


def test_grade_says_first_and_never_lowers_unasked(course):
    """--diff changes nothing and names whose mark would fall; marks fall only with --lower."""
    make_class(course, NAME, seed=4, count=5)
    who = students(course, NAME)
    how = GradeOptions(jobs=2, limits=QUICK)
    before = {one.result.student: one.result for one in grade_class(course, NAME, who, how)}
    path = course.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    data["hash"] = "0" * 64
    (first, *_) = data["questions"]
    first["points"] = 1
    hidden = first["tests"]["items"][1]["cases"]["items"][-1]
    hidden["expected"] = [0.0, 0.1, 0.0]  # so that the right answer is wrong
    path.write_text(json.dumps(data))
    moved = list(grade_class(course, NAME, who, how, change=False))
    lose = {m.now.student for m in moved if m.now.score != m.before.score}
    assert lose and {m.now.score - m.before.score for m in moved} == {-3.0, 0.0}
    assert {m.result.student for m in moved if m.kept} == lose
    *each, last = changes(moved)
    assert len(each) == len(lose) and last.startswith(f"{len(lose)} of 5 marks")
    assert {r.student: r.score for r in Results(course, NAME)} == {
        s: r.score for s, r in before.items()
    }
    done = list(grade_class(course, NAME, who, replace(how, lower=True)))
    assert {r.score for r in Results(course, NAME)} == {m.now.score for m in moved}
    assert len(done) == len(moved) and not any(one.kept for one in done)


def test_class_report(term, capsys):
    """The report counts misconceptions by name, and names nobody unless asked."""
    results = list(Results(term, NAME))
    problems = {p.name: p for p in term.problems(NAME)}
    text = report(NAME, list(map(mark_of, results)), problems, pseudonyms(term))
    mistakes = [q.verdict.mistake.name for r in results for q in r.questions if q.verdict.mistake]
    assert mistakes
    assert all(name in text for name in mistakes)
    assert not [r.student for r in results if r.student in text]
    assert main(["class-report", NAME, "--names", "--course", str(term.root)]) == 0
    told = capsys.readouterr().out
    assert OUTCOMES["motion"] in told and "`bang_bang`" in told
    said = sum("twice_the_time" in r.text() and "predict(" in q.source for r in results
               for q in r.questions if q.verdict.name == "twice_the_time")  # fmt: skip
    believed = told.partition("**`twice_the_time`**")[2].partition("\n## ")[0]
    assert said > 0 and sum(map(int, re.findall(r"^- (\d+) (?:x|others)", believed, re.M))) == len(
        [r for r in results if not r.rejected]
    )
    named = report(NAME, [mark_of(replace(r, rejected="x")) for r in results], problems, str)
    assert all(r.student in named for r in results)


def test_pseudonyms_last_a_term_and_are_nobody_elses(course):
    """A student keeps a pseudonym until the term ends; another course cannot make it again."""
    first = pseudonyms(course)("ada")
    assert pseudonyms(course)("ada") == first != pseudonyms(course)("bob")
    archive(course)
    assert pseudonyms(course)("ada") != first


def test_canvas_layout():
    """Canvas' five columns in its order, full marks below, students by Canvas' own number."""
    canvas = row("hoppergrace-7", lms="7")
    table = LAYOUTS["canvas"]("Paths (4711)", [canvas, row("ada", lms="42", first="A", last="L")])
    assert table[0] == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Paths (4711)"]
    assert "Points Possible" in table[1][0]
    assert table[1][5] == 2.0
    assert table[2] == ["hoppergrace-7", "7", "", "hoppergrace-7", "", 1.0]
    assert table[3] == ["L, A", "42", "", "ada", "", 1.0]
    assert not left_out("canvas", [canvas, row("ada")])


def test_moodle_layouts():
    """The gradebook knows users by address, the worksheet by the number of the download."""
    moodle = row("Ada-Lovelace", known=Participant("101", "Ada Lovelace"))
    table = LAYOUTS["moodle-worksheet"]("Paths", [moodle, row("carl")])
    assert {"Identifier", "Grade", "Last modified (grade)"} <= set(table[0])
    assert table[1:] == [["Participant 101", "Ada Lovelace", 1.0, 2.0, ""]]
    assert left_out("moodle-worksheet", [moodle, row("carl")]).startswith(
        "1 of the 2 who handed in cannot be matched"
    )
    table = LAYOUTS["moodle"]("Paths", [row("carl", email="c@x.org", lms="9")])
    assert table[0][2:] == ["ID number", "Username", "Email address", "Paths"]
    assert table[1][2:] == ["9", "carl", "c@x.org", 1.0]
    assert "no address, ID number or login" in left_out("moodle", [moodle])
    assert LAYOUTS["moodle"]("Paths", [moodle]) == table[:1], "a mark that is nobody's stays out"


def row(student, *, first="", last="", email="", lms="", known=None):
    who, line = Student(student, first, last, email, lms, id_number=lms), MarkLine("q", 2.0, 1.0)
    listed = known is not None
    return Mark(who, listed, lines=(line,), raw=1.0, points=2.0, moodle=known)
