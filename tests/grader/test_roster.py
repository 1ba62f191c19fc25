"""The roster: any list of students, and whom it means."""

from __future__ import annotations

import pytest
from downloaded import bare_course
from hypothesis import given
from hypothesis import strategies as st

from labkit.errors import LabkitError
from labkit.grader.clean import LONGEST, safe_name
from labkit.grader.gradebook import open_gradebook
from labkit.grader.roster import (
    FILE,
    Student,
    import_list,
    known_as,
    read_list,
    read_roster,
    same_name,
    save_roster,
)

MOODLE = (
    "First name,Last name,ID number,Email address,Groups,Roles\n"
    "Ada,Lovelace,4711,ada@x.test,Monday,Student\n"
    "Grace,Hopper,,grace@x.test,No groups,Student\n"
    "Alan,Turing,,alan@x.test,Monday,Non-editing teacher\n"
)
CANVAS = (
    "Student,ID,SIS User ID,SIS Login ID,Section\n"
    "    Points Possible,,,,\n"
    '"Lovelace, Ada",7,4711,ada,A\n'
    '"Student, Test",9,,,A\n'
)


@pytest.fixture
def course(tmp_path):
    made = bare_course(tmp_path / "course")
    (made.root / FILE).unlink()
    return made


def imported(course, text, encoding="utf-8", **options):
    path = course.root / "list.csv"
    path.write_bytes(text.encode(encoding))
    return import_list(course, path, **options)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_a_list_of_moodles(course, encoding, mark):
    """Teachers are left out by their role and named."""
    found = imported(course, MOODLE.replace(",", mark), encoding)
    assert found.others == ["Alan Turing (Non-editing teacher)"]
    ada, grace = read_roster(course).values()
    assert ada == Student("Ada-Lovelace", "Ada", "Lovelace", "ada@x.test", id_number="4711")
    assert grace.id == "Grace-Hopper"
    with open_gradebook(course) as book:
        assert {x.id: x.email for x in book.students} == {ada.id: ada.email, grace.id: grace.email}


def test_canvas_adds_its_numbers_to_who_is_there(course):
    """By a number that both lists have; the folder stays, and the test student is nobody."""
    imported(course, MOODLE)
    found = imported(course, CANVAS)
    assert found.others == ["Test Student (of Canvas)"] and not found.new
    assert found.absent == ["Grace Hopper (Grace-Hopper)"]
    ada, grace = read_roster(course).values()
    assert ada == Student("Ada-Lovelace", "Ada", "Lovelace", "ada@x.test", "7", "ada", "4711")
    assert grace.id == "Grace-Hopper", "who is not in a list stays"
    assert imported(course, "name,login\nZoe Kay,zoe\n").new == ["Zoe Kay (zoe)"]


def test_a_plain_table_and_namesakes(course):
    """The folder is the login or else the name, with a number for the second of one name."""
    imported(course, "name,login\nAda Lovelace,ada\nBob Hope,\n")
    imported(course, "name,email\nKim Lee,k1@x\nKim Lee,k2@x\nBob Hope,\n")
    assert [*read_roster(course)] == ["ada", "Bob-Hope", "Kim-Lee", "Kim-Lee-2"]


@pytest.mark.parametrize(
    "text",
    [
        *("", "phone\n1\n", "name\n"),
        "name\nAda\nAda\n",  # nothing tells them apart
        "name,login,email\nAda,ada,a@x\nBob,ada,b@x\n",  # one login for two
        "name,login,email\nZoe,ada,g@x\n",  # one's login and another's address
        'name,login\n"Ada,ada\n',
        "name,login\nLovelace, Ada,ada\n",  # a comma without quotation marks
        "name,login\nZoë,zoe\n",  # in an encoding in which the name would be wrong
    ],
)
def test_a_list_that_cannot_be_followed_changes_nothing(course, text):
    """It is an error, and the roster stays as it was."""
    imported(course, "name,login,email\nAda,ada,a@x\nGrace,grace,g@x\n")
    before = (course.root / FILE).read_bytes()
    with pytest.raises(LabkitError):
        imported(course, text, "cp1252")
    assert (course.root / FILE).read_bytes() == before


TEXT = st.text(st.characters(exclude_categories=("Cs", "Cc", "Cf", "Zl", "Zp")), max_size=12)


@given(st.lists(st.tuples(TEXT, TEXT), max_size=4))
def test_a_roster_is_read_as_it_was_written(tmp_path_factory, names):
    """Whatever people are called, also what a spreadsheet would take for a formula."""
    course = bare_course(tmp_path_factory.mktemp("roster"))
    people = [Student(f"s{k}", a.strip(), b.strip()) for k, (a, b) in enumerate(names)]
    save_roster(course, people)
    found = read_roster(course)
    assert [same_name(found[x.id].name) for x in people] == [same_name(x.name) for x in people]
    cells = (course.root / FILE).read_text().replace("\n", ",").split(",")
    assert not any(cell[:1] in "=+-@" for cell in cells if cell)


@given(st.text())
def test_names_of_folders_are_safe(name):
    """Of any text: one level, not hidden, no option, short, the same when made again."""
    made = safe_name(name)
    assert made and made == safe_name(made) and len(made.encode()) <= LONGEST
    assert not set(made) & set("/\\\0\n") and made[0] not in ".-"


def test_spellings_of_a_name():
    """Order, case and commas make no difference; another word does."""
    others = ("Lovelace Ada", "Lovelace, Ada", "ADA LOVELACE", "Ada_Lovelace", "ada  lovelace")
    assert {*map(same_name, others)} == {same_name("Ada Lovelace")} != {same_name("Ada B Lovelace")}


def test_only_one_student_is_meant():
    """By a column, or by the name, in any spelling; nobody by an empty cell or two of a name."""
    lee, kim = Student("a", "Kim", "Lee", login="K1"), Student("b", "Lee", "Kim", "k@x")
    roster = {"a": lee, "b": kim}
    assert known_as(roster, "login", "k1") is lee and known_as(roster, "email", "K@x") is kim
    assert not known_as(roster, "name", "Kim Lee") and not known_as(roster, "id_number", "")


@pytest.mark.parametrize(
    ("heads", "column"),
    [
        *(("Student,ID,Section", "lms_user_id"), ("Name,ID,Section", "login")),
        *(("Student,ID,Group", "login"), ("Full name,ID,Username", "id_number")),
    ],
)
def test_what_an_id_is_depends_on_the_other_columns(tmp_path, heads, column):
    """Canvas's own number, a login, or a number of the university."""
    path = tmp_path / "x.csv"
    path.write_text(f"{heads}\nAda Lovelace,7,9\n")
    ((one,), others) = read_list(path)
    assert (one.first_name, one.last_name, getattr(one, column)) == ("Ada", "Lovelace", "7")
    assert not others


@pytest.mark.parametrize("ids", ["ada\nADA", "../x", "-x"])
def test_two_students_in_one_folder_or_one_outside_are_an_error(course, ids):
    """The roster is a file that a person may have edited."""
    (course.root / FILE).write_text(f"id\n{ids}\n")
    with pytest.raises(LabkitError):
        read_roster(course)
