"""Due dates, extensions and late rules: one file of the course that all pages and tables keep."""

from __future__ import annotations

import csv
import io
from datetime import UTC, datetime

import pytest
from downloaded import bare_course
from made import NAME, graded, result_of

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader.gradebook import open_gradebook
from labkit.grader.rules import Late, read_rules
from labkit.grader.submission import read_time

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
    """Ada in time, Bob and Cleo 25 hours late."""
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
    assert scores(late, capsys) == {"(full marks)": "24.0", "ada": "22.0", "bob": "17.6",
                                    "cleo": "22.0"}  # fmt: skip
    assert verb(late, capsys, "feedback", NAME)[0] == 0
    page = (late.root / "feedback/bob" / NAME / f"{NAME}.html").read_text()
    assert "17.6 of 24 points." in page and "25 hours" in page
    with open_gradebook(late) as book:
        assert book.find_submission(NAME, "bob").late_submission_penalty == 4.4
        assert book.find_submission(NAME, "cleo").late_submission_penalty == 0.0
    rows = {r["student"]: r for r in csv.DictReader(io.StringIO(verb(late, capsys, "export")[1]))}
    assert rows["(weight)"][NAME] == "2.0"
    assert (rows["ada"]["percent"], rows["bob"]["percent"]) == ("91.67", "73.33")


def test_a_rule_that_changes_changes_marks_that_are_there(late, capsys):
    """An extension granted later counts at once; a misspelt student in one is named, exit 1."""
    text = RULES.replace("cleo", "bob").replace("percent_per_day = 10", "percent_per_day = 20")
    (late.root / "course.toml").write_text(text)
    found = scores(late, capsys)
    assert (found["bob"], found["cleo"]) == ("22.0", "13.2")
    (late.root / "course.toml").write_text(RULES.replace('"cleo"', '"Cleo"'))
    for words in (["export", NAME], ["export"]):
        code, _, err = verb(late, capsys, *words)
        assert code == 1 and "'Cleo'" in err


def test_a_time_that_cannot_be_read_is_said_and_costs_nothing(late, capsys):
    """The due date that was set in formgrader counts where the file has none."""
    (late.submitted / "bob" / NAME / "timestamp.txt").write_text("yesterday or so")
    (note,) = graded(late, result_of(late, "bob"))
    assert note.startswith("bob: ") and "is not a time" in note
    assert scores(late, capsys)["bob"] == "22.0"
    (late.root / "course.toml").write_text("[late]\npercent_per_day = 50")
    with open_gradebook(late) as book:
        book.update_or_create_assignment(NAME, duedate="2026-11-02 12:00:00 UTC")
    assert scores(late, capsys)["ada"] == "11.0"


def test_who_handed_in_nothing_is_listed(late, tmp_path, capsys):
    """With an empty cell; the command does not fail."""
    people = tmp_path / "people.csv"
    people.write_text("login,first name,last name\nada,Ada,L\nbob,Bob,M\ncleo,C,N\nfrank,F,O\n")
    assert verb(late, capsys, "roster", str(people))[0] == 0
    code, _, err = verb(late, capsys, "export", NAME)
    assert code == 0 and "1 handed in nothing: frank" in err
    assert scores(late, capsys)["frank"] == ""
    assert verb(late, capsys, "feedback", NAME)[0] == 0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("zone = 'Mars'", "Mars"),
        (f"zone = '{'x' * 5000}'", "zone"),
        ("[late]\npercent_per_dy = 3", "percent_per_dy"),
        ("[late]\nat_most = 200", "100"),
        ("[late]\ngrace_minutes = inf", "<= 10000.0"),
        ("[[extensions]]\nstudent = 'ada'\ndays = 1e8", "days"),
        ("[assignments.01_curves]\ndue = 'tomorrow'", "datetime"),
        ("[assignments.99_no]", "99_no"),
        ("due =\n", "line 1"),
        ("x = " + "[" * 100_000, "recursion"),
        ('id = "a\\n"', "matching regex"),
    ],
)
def test_what_nobody_can_follow_is_a_sentence(tmp_path, text, says):
    """The file, what is wrong, and where; a byte order mark is read."""
    course = bare_course(tmp_path)
    (tmp_path / "course.toml").write_text(text)
    with pytest.raises(LabkitError) as error:
        read_rules(course)
    assert says in str(error.value) and "course.toml" in str(error.value)
    (tmp_path / "course.toml").write_text("zone = 'Europe/Berlin'", "utf-8-sig")
    assert read_rules(course).zone == "Europe/Berlin"


@pytest.mark.parametrize(("minutes", "lost"), [(15, 0.0), (16, 2.0), (1440, 2.0), (1441, 4.0),
                                               (14400, 10.0)])  # fmt: skip
def test_what_is_lost_by_when(minutes, lost):
    """Nothing within the grace, then a share for each day begun, up to a limit."""
    assert Late(10, 50, 15).penalty(20.0, 60 * minutes) == lost


@pytest.mark.parametrize(
    ("text", "hour"),
    [
        ("2026-11-06 10:00:00.123456 UTC", 10),
        ("2026-11-06T10:00:00Z", 10),
        ("2026-11-06 10:00:00+02:00", 8),
        ("2026-11-06 10:00", 10),
        ("06.11.2026 10:00", None),
        ("1" * 5000, None),
        ("0001-01-01 00:00:00+14:00", None),
        ("", None),
    ],
)
def test_a_time_is_nbgraders_own_or_iso(text, hour):
    """Any other text is no time."""
    when = read_time(text)
    assert when == (hour and datetime(2026, 11, 6, hour, 0, when.second, when.microsecond, UTC))
