"""Marks go back to the platform under the identity by which it knows a student."""

from __future__ import annotations

import csv
import io

import pytest

from labkit.grader.marks.export import LAYOUTS, as_csv, left_out, remarks
from labkit.grader.marks.mark import Mark
from labkit.grader.students.class_list import Student
from labkit.grader.students.platforms import LmsUser

ADA = Student("ada", "Ada", "Lovelace", "ada@uni.org", "7", "alovelace", "1001")


def row(student="ada", known=None, person=None, email="", first="", last=""):
    who = person or Student(student, first, last, email)
    return Mark(who, person is not None, raw=1.0, points=2.0, user=known)


def table(layout, *marks):
    return list(csv.DictReader(io.StringIO(as_csv(LAYOUTS[layout]("Paths", marks)))))


def test_the_roster_says_who_a_student_is():
    """Also for one whose work came from another platform, or was brought by hand."""
    mark = row(person=ADA, known=LmsUser("moodle", "42", "Ada Lovelace"), email=ADA.email)
    canvas = table("canvas", mark)[-1]
    assert [canvas[x] for x in ("ID", "SIS User ID", "SIS Login ID")] == ["7", "1001", "alovelace"]
    moodle = table("moodle", mark)[-1]
    names = ("ID number", "Username", "Email address")
    assert [moodle[x] for x in names] == ["1001", "alovelace", "ada@uni.org"]


def test_a_login_of_the_exchange_is_one():
    """A folder that was named after a person in a download does not count as one."""
    assert row("ada-2", LmsUser("exchange", "ada", "ada")).login == "ada"
    assert row("Ada-Lovelace", LmsUser("moodle", "1", "Ada Lovelace")).login == ""
    assert row("ada").login == "ada"
    assert row("Ada", person=Student("Ada", "Ada")).login == ""


def test_no_participant_has_two_marks():
    """Where an older labkit gave one number to two students, neither gets the other's mark."""
    marks = [
        row(who, LmsUser("moodle", n, who)) for who, n in (("a", "42"), ("b", "42"), ("c", "3"))
    ]
    assert [line["Identifier"] for line in table("moodle-worksheet", *marks)] == ["Participant 3"]
    assert left_out("moodle-worksheet", marks) == (
        "2 of the 3 who handed in cannot be matched by this table: a, b"
    )


def test_who_has_no_number_of_canvas_is_named():
    """Such a row may match nobody, so the export says whose it is."""
    marks = [row("ada", person=ADA), row("bob", person=Student("bob", login="bob"))]
    (said,) = remarks("canvas", marks)
    assert said.startswith("1 has no Canvas ID") and ": bob; import Canvas's own list" in said
    assert not list(remarks("canvas", marks[:1])) and not list(remarks("moodle-worksheet", []))


@pytest.mark.parametrize("login", ["+491234", "-ada", "@ada", "+a-b.c@x.org"])
def test_a_login_reaches_the_platform_as_it_is(login):
    """No quotation mark comes before what a platform compares, and no formula is in it."""
    mark = row(login)
    assert table("canvas", mark)[-1]["SIS Login ID"] == login
    assert not left_out("canvas", [mark])


@pytest.mark.parametrize("login", ["=1+1", "+cmd|x!A1", "@SUM(A1)", "-1;2"])
def test_what_could_be_a_formula_is_quoted_and_named(login):
    """A spreadsheet runs nothing, and the lecturer knows whom the platform will not know."""
    mark = row(login, email=login, first=login)
    assert table("canvas", mark)[-1]["SIS Login ID"] == f"'{login}"
    assert table("moodle", mark)[-1]["First name"] == f"'{login}"
    assert table("moodle", mark)[-1]["Email address"] == f"'{login}"
    other = row("bob", email="bob@x")
    assert "1 of the 2 who handed in cannot be matched" in left_out("moodle", [mark, other])
