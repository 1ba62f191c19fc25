"""Two folders of one student: the import of a list joins them, or names them."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest
from downloaded import NAME, bare_course, counting, from_moodle, kept
from made import notebook_of, result_of

from labkit.grader.grading.results import Results
from labkit.grader.marks.table import marks_of
from labkit.grader.nbgrader.gradebook import open_gradebook, record
from labkit.grader.students.attempts import attempts
from labkit.grader.students.class_list import Student
from labkit.grader.students.collect import collect
from labkit.grader.students.enrol import import_list
from labkit.grader.students.roster import Roster, save_roster
from labkit.grader.terms.forget import left_by_hand


@pytest.fixture
def bare(tmp_path):
    return bare_course(tmp_path / "course")


def take(course, source, name=NAME, **options):
    return list(collect(course, name, source, **options))


def handed_in_twice(course, tmp_path, first, second):
    """Without a list: Ada's first work from Moodle, and her second from a folder of mails."""
    take(course, from_moodle(tmp_path / "1.zip", [(("Ada Lovelace", 42), "x.ipynb", first)]))
    (tmp_path / "mails/ada").mkdir(parents=True)
    (tmp_path / "mails/ada/x.ipynb").write_text(second)
    day = datetime(2026, 3, 5, tzinfo=UTC)
    take(course, tmp_path / "mails", named="{student}/*.ipynb", at=day)
    (tmp_path / "list.csv").write_text("name,login\nAda Lovelace,ada\n")


@pytest.mark.parametrize(("rule", "expected"), [("latest", "2"), ("latest in time", "1")])
def test_two_folders_of_one_student_become_one(bare, tmp_path, rule, expected):
    """Once a list says whose they are, all attempts are kept, and one counts by the rule."""
    rules = f"counts = '{rule}'\n[assignments.{NAME}]\ndue = 2026-03-02T00:00:00\n"
    (bare.root / "course.toml").write_text(rules)
    handed_in_twice(bare, tmp_path, "1", "2")
    assert counting(bare) == {"Ada-Lovelace-42": "1", "ada": "2"}
    _, (said,) = import_list(bare, tmp_path / "list.csv")
    assert said.startswith(f"Ada-Lovelace-42 and ada are one student; {NAME}: of 2 attempts, the")
    assert counting(bare) == {"ada": expected}
    assert kept(bare, "ada") == {"1", "2"}
    assert not (bare.root / "attempts/Ada-Lovelace-42").exists()
    assert not import_list(bare, tmp_path / "list.csv")[1]


def test_the_same_work_in_two_folders_is_one_attempt(bare, tmp_path):
    """It has both times at which it was handed in."""
    handed_in_twice(bare, tmp_path, "1", "1")
    import_list(bare, tmp_path / "list.csv")
    (one,) = attempts(bare, "ada", NAME)
    assert {x.origin for x in one.hand_ins} == {"moodle", "files"}


@pytest.mark.parametrize("newer", [False, True])
def test_of_two_marks_that_of_the_work_that_counts_stays(course, tmp_path, newer):
    """A mark by hand of the other work is said once, and is in no table any more."""
    first, second = notebook_of("1"), notebook_of("2")
    handed_in_twice(course, tmp_path, first.decode(), second.decode())
    for student, data, points in [("Ada-Lovelace-42", first, 1.5), ("ada", second, 2.5)]:
        Results(course, NAME).keep(result := result_of(course, student, data=data))
        record(course, NAME, [result])
        with open_gradebook(course) as book:
            book.find_grade("circle-check", NAME, NAME, student).manual_score = points
            book.db.commit()
    rules = f"counts = 'latest in time'\n[assignments.{NAME}]\ndue = 2026-03-02T00:00:00\n"
    (course.root / "course.toml").write_text("" if newer else rules)
    _, said = import_list(course, tmp_path / "list.csv")
    gone, points = ("Ada-Lovelace-42", 1.5) if newer else ("ada", 2.5)
    assert f"{gone}: {NAME}: circle-check had {points:g} by hand, for an attempt that" in said[1]
    (mark,) = marks_of(course, NAME)
    assert (mark.student, mark.missing, Results(course, NAME).students()) == ("ada", "", ["ada"])
    assert {x.by_hand for x in mark.lines} == {None, 4.0 - points}
    with open_gradebook(course) as book:
        assert [one.id for one in book.students] == ["ada"]
    assert not list(course.root.glob("autograded/Ada*"))


def test_two_students_of_the_roster_are_never_joined(bare, tmp_path):
    """A worksheet that gives one's number to another leaves both as they are, and says so."""
    save_roster(bare, Roster((Student("li1", "Li", "Wei"), Student("li2", "Bo", "Li", "li2@x"))))
    people = [(("Li Wei", 5), "x.ipynb", "5"), (("Bo Li", 6), "x.ipynb", "6")]
    take(bare, from_moodle(tmp_path / "1.zip", people))
    worksheet = tmp_path / "worksheet.csv"
    worksheet.write_text("Identifier,Full name,Email address\nParticipant 5,Bo Li,li2@x\n")
    said, *_ = import_list(bare, worksheet, NAME)[1]
    assert "submitted/li1/01_paths of the same student stays" in said
    assert counting(bare) == {"li1": "5", "li2": "6"}


def test_a_folder_of_nobody_in_the_roster_is_named(bare, tmp_path):
    """At import, and by `term forget`, for it may be somebody's second one."""
    people = [(("Ada Lovelace", 1), "x.ipynb", "1"), (("Ada King", 2), "x.ipynb", "2")]
    take(bare, from_moodle(tmp_path / "1.zip", people))
    (tmp_path / "list.csv").write_text("name,login\nAda Lovelace,ada\n")
    (_, said), _ = import_list(bare, tmp_path / "list.csv")
    assert said.startswith("work of nobody in the roster: Ada-King-2; import a list")
    assert "perhaps theirs too: Ada-King-2; look" in " ".join(left_by_hand(bare, "ada"))


def test_without_a_list_forget_names_who_is_called_alike(bare, tmp_path):
    """Moodle gives one student another number, and so another folder, in each assignment."""
    for number, name in enumerate((NAME, "02_model")):
        people = [(("Ada Lovelace", number), "x.ipynb", "1"), (("Bo Li", 9), "x.ipynb", "1")]
        take(bare, from_moodle(tmp_path / f"{name}.zip", people), name)
    said = " ".join(left_by_hand(bare, "Ada-Lovelace-0"))
    assert "perhaps theirs too: Ada-Lovelace-1; look" in said
