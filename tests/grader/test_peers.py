"""Peer review: two reports each, never one's own, and nobody's name on either way."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from collections import Counter
from dataclasses import replace

import pytest
from courses import copied
from downloaded import from_moodle
from handmade import ROOT, cell_of, hand_in, raw

from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.course.marking import all_alike
from labkit.course.verdict import Outcome
from labkit.errors import LabkitError
from labkit.grader.grading.grade import rejection
from labkit.grader.grading.results import Answer, Results
from labkit.grader.marks.table import marks_of
from labkit.grader.nbgrader.gradebook import open_gradebook, record
from labkit.grader.peers.readers import (
    handed_out,
    names_of_class,
    readers,
    reviews,
    sheet_of,
    without_names,
)
from labkit.grader.students.class_list import Student
from labkit.grader.submission import students
from labkit.grader.terms.release import release
from labkit.grader.terms.term import archive

pytestmark = pytest.mark.xdist_group("peers")

NAME = "08_report"
PNG = "iVBORw0KGgo="
CLASS = "Login,First name,Last name,Email address,Team\n" + "".join(
    f"{login},{login.title()},{login.title()}son,{login}@uni.org,{team}\n"
    for login, team in (("ada", "kestrel"), ("bob", "kestrel"), ("eve", "merlin"), ("zoe", "hobby"))
)


@pytest.mark.parametrize("teams", [3, 4, 7, 60])
def test_everybody_reads_two_reports_of_others_and_each_is_read_twice(teams):
    """In teams of one to three, with students who handed in nothing; the same seed, the same."""
    people = {f"s{k}-{m}": f"t{k}" for k in range(teams) for m in range(1 + k % 3)}
    people["late"] = "alone"
    reports = {f"t{k}": f"s{k}-0" for k in range(teams)}
    found = readers(7, reports, people)
    assert found.keys() == people.keys()
    for student, authors in found.items():
        assert len(set(authors)) == 2
        assert people[student] not in {people[author] for author in authors}
    read = Counter(author for authors in found.values() for author in authors)
    assert set(read) == set(reports.values()) and min(read.values()) >= 2
    assert found == readers(7, reports, dict(reversed(people.items())))
    assert teams < 5 or found != readers(8, reports, people)
    single = readers(7, reports, {author: team for team, author in reports.items()})
    assert set(Counter(a for two in single.values() for a in two).values()) == {2}


def test_two_reports_are_too_few():
    """It is said, with what it needs."""
    with pytest.raises(LabkitError, match="2 teams handed in a report; peer review needs 3"):
        readers(7, {"a": "x", "b": "y"}, {"x": "a", "y": "b"})


def test_names_go_from_a_text():
    """First, last and whole names, logins and addresses, in any case; words that hold one stay."""
    team = [Student("ada", "Ada", "Lovelace", "ada@uni.org"), Student("Bob-Hope")]
    text = 'ADA Lovelace and Bob (ada@uni.org): my_arm("ada") adapts, bobbing.'
    said = without_names(text, team, "author")
    assert said == 'author 1 and author 2 (author 1): my_arm("author 1") adapts, bobbing.'


def test_names_of_the_class_go_and_its_words_stay():
    """A word that is a login or a name too stays, unless it is written as a name; so do numbers."""
    people = [
        Student("force", "Mark", "Force", "m.force@uni.org", "300", id_number="1234567"),
        Student("in", "Eve", "Li", login="in", github="eve-codes"),
    ]
    text = (
        'The force in m; eve LI, Mark, EVE-CODES and m.force@uni.org mark 300 runs: my_arm("force")'
    )
    assert names_of_class(people).sub("X", f"{text}, 1234567") == (
        'The force in m; X, X, X and X mark 300 runs: my_arm("X"), X'
    )
    assert names_of_class([]).sub("X", text) == text


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A class of four in three teams whose reports are handed in, graded and marked."""
    course = copied(tmp_path_factory.mktemp("peers"))
    release(course, NAME, 7)
    (course.root / "class.csv").write_text(CLASS)
    assert typed(course, "students", "import", str(course.root / "class.csv")) == 0
    given = (course.release / NAME / f"{NAME}.ipynb").read_text()
    bundle = Bundle.of(course, NAME)
    for author in ("ada", "eve", "zoe"):
        notebook = json.loads(given)
        claim = f"We, {author.title()}, not Zoe: **our** arm <b>sags</b> ![x](http://e.org/p.png)"
        cell_of(notebook, "claim_and_prediction")["source"] = claim
        code = {"cell_type": "code", "id": "own-1", "metadata": {}, "execution_count": 1,
                "source": f'mine = lk.my_arm("{author}")',
                "outputs": [{"output_type": "display_data", "metadata": {}, "data": {
                    "image/png": PNG, "text/html": "<script>alert(1)</script>"}}]}  # fmt: skip
        notebook["cells"].append(code)
        hand_in(course, NAME, author, notebook)
        result = rejection("", author, bundle, "made by hand", raw(notebook))
        blank = [all_alike(q, Outcome.NOT_ATTEMPTED) for q in bundle.questions]
        result = replace(result, questions=tuple(Answer(verdict, source="") for verdict in blank),
                         written={"claim_and_prediction": claim})  # fmt: skip
        Results(course, NAME).keep(result)
        record(course, NAME, [result])
    return course


def typed(course, *words):
    return main([*words, "--course", str(course.root)])


def test_what_one_member_hands_in_counts_for_the_team(course, capsys):
    """Bob has Ada's mark, and his own page, and nobody of the team is called absent."""
    marks = {mark.student: mark for mark in marks_of(course, NAME)}
    assert {name: mark.author for name, mark in marks.items()} == {
        "ada": "", "bob": "ada", "eve": "", "zoe": ""
    }  # fmt: skip
    bob, ada = marks["bob"], marks["ada"]
    assert (bob.lines, bob.missing, bob.points) == (ada.lines, ada.missing, ada.points)
    assert bob.person.email == "bob@uni.org" and not bob.absent
    assert typed(course, "feedback", NAME, "--student", "bob") == 2
    assert "ada (" in capsys.readouterr().err, "the report that waits is Ada's"
    assert typed(course, "feedback", NAME, "--unmarked", "--student", "bob") == 0
    html = (course.root / "feedback/bob" / NAME / f"{NAME}.html").read_text()
    assert "feedback for Bob Bobson (bob)</h1>" in html
    assert "Handed in by ada for your team." in html
    capsys.readouterr()
    typed(course, "export", NAME, "--absent-zero")
    said = capsys.readouterr()
    assert "1 has the mark of a report that their team handed in: bob (ada)" in said.err
    assert "handed in nothing" not in said.err and "bob,0" not in said.out


def test_an_extension_of_a_member_who_did_not_hand_in_is_named(course, capsys):
    """The report is late by Ada's due date; who exports is told to give the days to Ada too."""
    rules, stamp = course.root / "course.toml", course.submitted / "ada" / NAME / "timestamp.txt"
    stamp.write_text("2026-11-04 12:00 UTC")
    due = f"[assignments.{NAME}]\ndue = 2026-11-02T12:00:00\n"
    granted = '[[extensions]]\nstudent = "bob"\ndays = 5\n'
    says = f"bob's extension of 5 days has no effect on {NAME}, which ada handed in for the team, "
    for text, named in (
        (due, False),
        (due + granted, True),
        (due + granted + granted.replace("bob", "ada"), False),
        (due.replace("-02T", "-05T") + granted, False),
    ):
        rules.write_text(text)
        for words in (["export", NAME], ["export"]):
            typed(course, *words)
            found = f"{says}2 days late; in course.toml, give it to ada too\n"
            assert (found in capsys.readouterr().err) is named
    rules.unlink()
    stamp.unlink()


def test_reports_go_out_and_reviews_come_back_without_names(course, monkeypatch, capsys):
    """By the commands that the guide shows: out, back, and onto the authors' pages."""
    monkeypatch.chdir(course.root)
    guide = (ROOT / "book/instructor_guide.md").read_text()
    shown = [x for x in guide.splitlines() if x.startswith("labkit ") and "--peer-review" in x]
    out, back = (shlex.split(line)[1:] for line in shown)
    assert main(out) == 0
    assert "4 new, 4 in all" in capsys.readouterr().out
    assert main(out) == 0
    assert "0 new, 4 in all" in capsys.readouterr().out
    files, read_by = [], Counter()
    for number, login in enumerate(("ada", "bob", "eve"), 100):
        sheet = handed_out(course, NAME, login).read_text()
        assert not re.findall(r"\b(?:ada|bob|eve|zoe)(?:son)?\b", sheet, re.IGNORECASE)
        for hidden in ("<b>", "![x]", "script", "kestrel"):
            assert hidden not in sheet
        assert "#*" not in sheet and "not somebody: **our**" in sheet
        assert "&lt;b>sags" in sheet and sheet.count(PNG) == 2 and "0 | 1 | 2 | 3" in sheet
        notebook = json.loads(sheet)
        forms = [cell for cell in notebook["cells"] if cell["cell_type"] == "raw"]
        assert len(forms) == 12
        for k, cell in enumerate(forms):
            cell["source"] = f"level: {k % 4}\ncomment: {login.title()} says <i>why</i>?"
        if login == "eve":
            forms[-1]["source"] = "level: \ncomment: "
        files.append(((f"{login.title()} {login.title()}son", number), f"{sheet_of(NAME)}.ipynb",
                      json.dumps(notebook).encode()))  # fmt: skip
    (course.root / "downloads").mkdir()
    from_moodle(course.root / "downloads/reviews.zip", files)
    assert main(back) == 0
    capsys.readouterr()
    assert typed(course, "feedback", NAME, "--unmarked") == 0
    said = capsys.readouterr().out
    assert "review missing: eve: 1 of 2 reviews" in said
    assert "review missing: zoe: handed in no review" in said
    assert "ada:" not in said and "bob:" not in said
    for author in ("ada", "eve", "zoe"):
        html = (course.root / "feedback" / author / NAME / f"{NAME}.html").read_text()
        heard = html.partition('id="readers"')[2].partition("</section>")[0]
        read_by[author] = heard.count("<h3>Reader ")
        assert "reader 1 says &lt;i&gt;why" in heard or not read_by[author]
        assert not re.findall("Ada|Bob|Eve", heard)
    assert read_by.total() == 5


def test_a_sheet_of_nobody_and_a_notebook_that_is_not_the_sheet_are_named(course):
    """Without these words, a student whose sheet is there would seem to have handed in none."""
    name = sheet_of(NAME)
    (other,) = (course.submitted / "ada" / NAME).glob("*.ipynb")
    for student, source in ("zoe", other), ("zoe-7", handed_out(course, NAME, "zoe")):
        sheet = course.submitted / student / name / f"{name}.ipynb"
        sheet.parent.mkdir(parents=True)
        sheet.write_bytes(source.read_bytes())
    said = reviews(course, NAME)[1]
    for student in ("zoe", "zoe-7"):
        shutil.rmtree(course.submitted / student / name)
    assert "zoe: the notebook that counts is not the sheet that they were given" in said
    assert said[-1].startswith(
        f"submitted/zoe-7/{name}: this sheet belongs to nobody in the roster"
    )
    assert said[-1].endswith(f"labkit students import WORKSHEET.csv --assignment {name}")


def test_who_is_forgotten_takes_no_extension_from_their_team(course, capsys):
    """The new owner of the report needs it, or a penalty for late work lowers the team's mark."""
    rules = course.root / "course.toml"
    granted = f'[[extensions]]\nstudent = "ada"\nassignment = "{NAME}"\ndays = 5\n'
    says = f"ada has an extension of 5 days for {NAME}; in course.toml, give it to bob too before"
    rules.write_text(granted)
    assert typed(course, "term", "forget", "--student", "ada") == 0
    assert says in capsys.readouterr().out
    assert typed(course, "term", "forget", "--student", "ada", "--yes") == 2
    assert says in capsys.readouterr().err and (course.submitted / "ada" / NAME).exists()
    rules.write_text(granted + granted.replace("ada", "bob"))
    assert typed(course, "term", "forget", "--student", "ada") == 0
    assert says not in capsys.readouterr().out
    rules.unlink()


def test_who_is_forgotten_takes_no_mark_from_their_team(course, capsys):
    """Bob has the mark of Ada's report; when she goes, report and mark become Bob's own."""
    with open_gradebook(course) as book:
        for cell in book.find_submission(NAME, "ada").notebooks[0].grades:
            if cell.auto_score is None:
                cell.manual_score, cell.needs_manual_grade = 1.5, False
        book.db.commit()
    before = {mark.student: mark for mark in marks_of(course, NAME)}["bob"]
    assert before.author == "ada" and before.score > 0
    page = course.root / f"feedback/bob/{NAME}/{NAME}.html"
    assert typed(course, "feedback", NAME, "--unmarked") == 0
    assert "Handed in by ada" in page.read_text()
    heard = page.read_text().partition('id="readers"')[2].partition("</section>")[0]
    assert "<h3>Reader 1" in heard
    capsys.readouterr()
    for more, says in ([], "would move"), (["--yes"], "moved"):
        assert typed(course, "term", "forget", "--student", "ada", *more) == 0
        said = capsys.readouterr().out
        assert f"{says} to bob, with its mark, which is the team's: submitted/ada/{NAME}\n" in said
        assert f": feedback/bob/{NAME}/{NAME}.html\n" in said
        assert f"write it again: labkit feedback {NAME} --student bob\n" in said
        assert f"reviews that they wrote go too (submitted/ada/{sheet_of(NAME)}); when" in said
    assert not page.exists()
    assert typed(course, "feedback", NAME, "--unmarked", "--student", "bob") == 0
    assert "Handed in by" not in page.read_text()
    assert heard in page.read_text(), "what the readers of the report say stays with it"
    marks = {mark.student: mark for mark in marks_of(course, NAME)}
    assert (marks["bob"].score, marks["bob"].author) == (before.score, "")
    assert marks["bob"].lines == before.lines and "ada" not in marks
    assert not list(course.root.glob("[!s]*/ada")) and not (course.submitted / "ada").exists()


def test_who_is_forgotten_after_the_term_takes_no_mark_from_their_team(tmp_path, capsys):
    """Report and mark become the mate's own, even if the archive's rules cannot be read."""
    course = copied(tmp_path)
    release(course, NAME, 7)
    (course.root / "class.csv").write_text(CLASS)
    assert typed(course, "students", "import", str(course.root / "class.csv")) == 0
    notebook = json.loads((course.release / NAME / f"{NAME}.ipynb").read_text())
    hand_in(course, NAME, "ada", notebook)
    result = rejection("", "ada", Bundle.of(course, NAME), "made by hand", raw(notebook))
    blank = [all_alike(q, Outcome.NOT_ATTEMPTED) for q in Bundle.of(course, NAME).questions]
    result = replace(result, questions=tuple(Answer(verdict, source="") for verdict in blank))
    Results(course, NAME).keep(result)
    record(course, NAME, [result])
    assert typed(course, "feedback", NAME, "--unmarked", "--student", "ada") == 0
    archived = Course(archive(course))
    (archived.root / "course.toml").write_text("late = 3 =")
    capsys.readouterr()
    for more, says in ([], "would move"), (["--yes"], "moved"):
        assert typed(course, "term", "forget", "--student", "ada", *more) == 0
        assert f"{says} to bob, with its mark, which is the team's: " in capsys.readouterr().out
    assert Results(archived, NAME).students() == students(archived, NAME) == ["bob"]
    with open_gradebook(archived) as book:
        assert [x.student.id for x in book.assignment_submissions(NAME)] == ["bob"]
        assert "ada" not in {one.id for one in book.students}
    assert not list(archived.root.glob("feedback/*/*/*")), "not Ada's page in Bob's folder"
