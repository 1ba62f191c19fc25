"""Due dates, extensions and late rules: one file of the course that all pages and tables keep."""

from __future__ import annotations

import csv
import io
import re

import pytest
from downloaded import bare_course
from made import NAME, graded, result_of
from msgspec.structs import fields

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader.gradebook import open_gradebook
from labkit.grader.rules import Assignment, Extension, Late, Rules, read_rules, rules_in

RULES = f"""
name = "Robot control, winter 2026"
zone = "Europe/Berlin"

[late]
percent_per_day = 10
at_most = 50
grace_minutes = 15

[assignments.{NAME}]
due = 2026-11-02T23:59:00
weight = 2

[[extensions]]
student = "cleo"
assignment = "{NAME}"
days = 3
"""


@pytest.fixture
def late(course):
    """Ada in time, Bob and Cleo 25 hours late; nobody is ever told why."""
    (course.root / "course.toml").write_text(RULES)
    for student, when in (("ada", "2026-11-02 23:05"), ("bob", "2026-11-03 23:59"),
                          ("cleo", "2026-11-03 23:59")):  # fmt: skip
        graded(course, result_of(course, student), recorded=False)
        folder = course.submitted / student / NAME
        (folder / "timestamp.txt").write_text(f"{when} UTC")
        graded(course, result_of(course, student))
    return course


def verb(course, capsys, *words):
    code = main([*words, "--course", str(course.root)])
    return code, *capsys.readouterr()


def scores(course, capsys, *words):
    text = verb(course, capsys, "export", NAME, *words)[1]
    return {r["student"]: r["score"] for r in csv.DictReader(io.StringIO(text))}


def test_late_work_loses_its_share_everywhere(late, capsys):
    """Table, page and formgrader have one number; an extension is kept, a day begun is a day."""
    assert scores(late, capsys) == {"(full marks)": "24.0", "ada": "24.0", "bob": "19.2",
                                    "cleo": "24.0"}  # fmt: skip
    assert verb(late, capsys, "feedback", NAME)[0] == 0
    page = (late.root / "feedback/bob" / NAME / f"{NAME}.html").read_text()
    assert "19.2 of 24 points." in page
    assert "It came 1 day 1 hour after it was due: 4.8 points are taken from 24." in page
    with open_gradebook(late) as book:
        assert book.find_submission(NAME, "bob").late_submission_penalty == 4.8
        assert book.find_submission(NAME, "cleo").late_submission_penalty == 0.0


def test_the_class_report_says_how_many_lost_points_for_lateness(late, capsys):
    """Bob alone, as Cleo has an extension; without names a number below 5 is not told."""
    named, nameless = ("class-report", NAME, "--names"), ("class-report", NAME)
    start = "3 handed in, 3 graded"
    assert f"{start}, 1 with points taken for lateness.\n" in verb(late, capsys, *named)[1]
    assert f"{start}, <5 with points taken for lateness.\n" in verb(late, capsys, *nameless)[1]
    (late.root / "course.toml").write_text(RULES.replace("percent_per_day = 10", ""))
    assert f"{start}.\n" in verb(late, capsys, *named)[1]


def test_a_rule_that_changes_changes_marks_that_are_there(late, capsys):
    """An extension granted later counts at once, without grading again."""
    text = RULES.replace("cleo", "bob").replace("percent_per_day = 10", "percent_per_day = 20")
    (late.root / "course.toml").write_text(text)
    assert scores(late, capsys) | {"ada": ""} == {"(full marks)": "24.0", "ada": "", "bob": "24.0",
                                                  "cleo": "14.4"}  # fmt: skip


def test_a_time_that_becomes_known_after_grading_counts_at_once(late, capsys):
    """For the file that was graded; one that was put in its place since changes no time."""
    places = {who: late.submitted / who / NAME for who in ("ada", "bob", "cleo")}
    (places["ada"] / "timestamp.txt").write_text("2026-11-03 23:59 UTC")
    (places["bob"] / "timestamp.txt").unlink()
    (places["cleo"] / "timestamp.txt").write_text("2026-11-30 23:59 UTC")
    (places["cleo"] / f"{NAME}.ipynb").write_text("another")
    found = scores(late, capsys)
    assert (found["ada"], found["bob"]) == ("19.2", "24.0")
    with open_gradebook(late) as book:
        assert book.find_submission(NAME, "cleo").timestamp.day == 3


def test_the_term_in_one_table(late, capsys):
    """All assignments with their weights; a student who lacks a mark has no percentage."""
    code, out, _ = verb(late, capsys, "export")
    rows = {r["student"]: r for r in csv.DictReader(io.StringIO(out))}
    assert code == 0 and rows["(weight)"][NAME] == "2.0"
    assert (rows["ada"]["percent"], rows["bob"]["percent"]) == ("100.0", "80.0")


def test_who_handed_in_nothing_is_listed(late, tmp_path, capsys):
    """With an empty cell, or with 0 if that is asked for; the command does not fail."""
    people = tmp_path / "people.csv"
    people.write_text("login,first name,last name\nada,Ada,L\nbob,Bob,M\ncleo,C,N\nfrank,F,O\n")
    assert verb(late, capsys, "roster", str(people))[0] == 0
    code, _, err = verb(late, capsys, "export", NAME)
    assert code == 0 and "1 handed in nothing: frank" in err
    assert scores(late, capsys)["frank"] == ""
    assert scores(late, capsys, "--absent-zero")["frank"] == "0.0"
    assert verb(late, capsys, "feedback", NAME)[0] == 0


def test_an_extension_that_reaches_nobody_is_named(late, capsys):
    """A name that is misspelt costs its student the days; these commands end with exit 1."""
    (late.root / "course.toml").write_text(RULES.replace('"cleo"', '"Cleo"'))
    for words in (["export", NAME], ["export"], ["grade", NAME]):
        code, _, err = verb(late, capsys, *words)
        assert code == 1 and "'Cleo'" in err


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("zone = 'Europe'", "'Europe' is not a time zone; write one such as"),
        (f"zone = '{'x' * 5000}'", "is not a time zone"),
        ("[late]\ngrace_minutes = inf", "<= 10000.0 - at `$.late.grace_minutes`"),
        ("[[extensions]]\nstudent = 'ada'\ndays = 1e8", "`$.extensions[0].days`"),
        ("[assignments.01_curves]\nweight = inf", "`$.assignments[...].weight`"),
        ("[assignments.01_curves]\ndue = 9999-12-31T23:59:00", "due in the year 9999"),
        ("zone = 'Asia/Tokyo'\n[assignments.01_curves]\ndue = 0001-01-01T00:00:00", "year 1"),
        ("x = " + "[" * 100_000, "recursion"),
        ('id = "a\\n"', "matching regex"),
    ],
)
def test_what_nobody_can_follow_is_a_sentence(tmp_path, text, says):
    """No zone, no number that a clock can add, no depth that Python can read."""
    course = bare_course(tmp_path)
    (tmp_path / "course.toml").write_text(text)
    with pytest.raises(LabkitError) as error:
        read_rules(course)
    assert says in str(error.value)


def test_a_byte_order_mark_is_read(tmp_path):
    """Windows' editor writes one."""
    course = bare_course(tmp_path)
    (tmp_path / "course.toml").write_text("zone = 'Europe/Berlin'", "utf-8-sig")
    assert read_rules(course).zone == "Europe/Berlin"


def test_nbgraders_own_plugin_works_from_the_courses_folder(late, capsys):
    """A class in late.py beside nbgrader_config.py decides; without the file, a sentence."""
    with (late.root / "nbgrader_config.py").open("a") as file:
        file.write('c.AssignLatePenalties.plugin_class = "late.Half"\n')
    code, _, err = verb(late, capsys, "export", NAME)
    assert code == 2 and "put that module beside it" in err
    (late.root / "late.py").write_text(
        "from nbgrader.plugins import LateSubmissionPlugin\n"
        "class Half(LateSubmissionPlugin):\n"
        "    def late_submission_penalty(self, student, score, seconds):\n"
        "        return score / 2\n"
    )
    assert scores(late, capsys)["bob"] == "12.0"


@pytest.mark.parametrize(("minutes", "lost"), [(15, 0.0), (16, 2.0), (1440, 2.0), (1441, 4.0),
                                               (14400, 10.0)])  # fmt: skip
def test_what_is_lost_by_when(minutes, lost):
    """Nothing within the grace, then a share for each day begun, up to a limit."""
    assert Late(10, 50, 15).penalty(20.0, 60 * minutes) == lost


@pytest.mark.parametrize(("text", "says"), [
    ("[late]\npercent_per_dy = 3", "percent_per_dy"), ('zone = "Mars"', "Mars"),
    ("due =\n", "line 1"), ("[assignments.99_no]", "not an assignment"),
    ("[late]\nat_most = 200", "100"),
])  # fmt: skip
def test_a_rule_that_nobody_can_follow_is_a_sentence(course, text, says):
    """The file, what is wrong, and where."""
    (course.root / "course.toml").write_text(text)
    with pytest.raises(LabkitError, match=says):
        read_rules(course)


def test_a_wrong_key_or_date_is_answered_with_the_form_of_the_file(tmp_path):
    """Every key of every table is named, and how a due date is written."""
    file = tmp_path / "course.toml"
    for text in "naem = 'x'", '[assignments.01_curves]\ndue = "tomorrow"':
        file.write_text(text)
        with pytest.raises(LabkitError) as found:
            rules_in(file)
        form = str(found.value).partition("; correct that line. ")[2]
        for table in Rules, Late, Assignment, Extension:
            assert {x.name for x in fields(table)} - {"late", "assignments", "extensions"} <= {
                *re.findall(r"\w+", form)
            }
    file.write_text(f"[assignments.01_curves]\n{form.rpartition(': ')[2]}")
    assert rules_in(file).due("01_curves")
