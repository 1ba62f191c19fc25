"""One student is forgotten, and nobody else, in the terms in which they were."""

import pytest
from courses import copied

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.grader.students.class_list import Student
from labkit.grader.students.identity import record_users
from labkit.grader.students.platforms import LmsUser
from labkit.grader.students.roster import Roster, read_roster, save_roster
from labkit.grader.terms.term import archive

KIM = Student("Kim-Lee", "Kim", "Lee", "kim1@x.test", id_number="800001")
OTHER = Student("Kim-Lee", "Kim", "Lee", "other@x.test", id_number="900009")


@pytest.fixture
def course(tmp_path):
    """A course of its own, with nothing released yet."""
    return copied(tmp_path)


def enrolled(course, *people):
    """Students of the term, who have handed in."""
    save_roster(course, Roster(people))
    for one in people:
        (course.submitted / one.id / "01_paths").mkdir(parents=True)


def forget(course, *words):
    return main(["term", "forget", *words, "--course", str(course.root)])


def test_two_people_with_one_folder_in_two_terms_are_told_apart(course, capsys):
    """Nothing is deleted until a person has named the terms of the one who is meant."""
    enrolled(course, KIM)
    old = Course(archive(course))
    enrolled(course, OTHER)
    for more in ([], ["--yes"]):
        assert forget(course, "--student", "Kim-Lee", *more) == 2
        said = capsys.readouterr().err
        assert f"now: Kim Lee, other@x.test, 900009; {old.root.name}: Kim Lee, kim1@x.test" in said
        assert f"is meant: labkit term forget {old.root.name} --student Kim-Lee" in said
    assert forget(course, "nope", "--student", "Kim-Lee", "--yes") == 2
    assert f"no term 'nope'; there are now, {old.root.name}" in capsys.readouterr().err
    assert forget(course, "now", "--older", "0", "--yes") == 2
    assert "name none beside it" in capsys.readouterr().err
    assert forget(course, old.root.name, "--student", "Kim-Lee", "--yes") == 0
    assert not (old.submitted / "Kim-Lee").exists() and "Kim-Lee" not in read_roster(old)
    assert (course.submitted / "Kim-Lee").exists() and "Kim-Lee" in read_roster(course)
    capsys.readouterr()
    assert forget(course, old.root.name, "--student", "Kim-Lee") == 2
    assert f"no student 'Kim-Lee' in {old.root.name}; did you" in capsys.readouterr().err
    assert forget(course, "--student", "Kim-Lee", "--yes") == 0
    assert not (course.submitted / "Kim-Lee").exists()


def test_another_address_makes_no_other_person(course):
    """One who is the same by number is forgotten in both terms at once."""
    enrolled(course, KIM)
    old = Course(archive(course))
    enrolled(course, Student("Kim-Lee", "Kim", "Lee", "kim.lee@x.test", id_number="800001"))
    assert forget(course, "--student", "Kim-Lee", "--yes") == 0
    assert not (old.submitted / "Kim-Lee").exists() and not (course.submitted / "Kim-Lee").exists()


def test_the_same_person_under_another_folder_in_another_term_is_named(course, capsys):
    """By number, or by name if nothing contradicts it, in a roster or among those who handed in."""
    (login, outside, namesake, user) = ("kl17", "Kim-Lee-7", "Kim-Lee-2", "Lee-55")
    enrolled(course, Student(login, "K", "Lee", id_number="800001"), Student("eve", "Eve", "Li"))
    record_users(course, "01_paths", {outside: LmsUser("moodle", "7", "Kim Lee")})
    first = Course(archive(course))
    enrolled(course, Student(namesake, "Kim", "Lee", id_number="3"), Student("kim", "Lee", "Kim"))
    record_users(course, "01_paths", {user: LmsUser("canvas", "55", "K. Lee")})
    second = Course(archive(course))
    enrolled(course, KIM, Student("Kim-Lee-9", "Kim", "Lee", id_number="9"))
    record_users(course, "02_model", {"Kim-Lee": LmsUser("canvas", "55", "Kim Lee")})
    assert forget(course, "--student", "Kim-Lee") == 0
    said = [x for x in capsys.readouterr().out.splitlines() if "perhaps theirs too" in x]
    assert [x.partition(": ")[2].partition(";")[0] for x in said] == [
        f"{outside}, {login}", f"{user}, kim"
    ]  # fmt: skip
    for term, line in zip((first, second), said, strict=True):
        assert line.startswith(f"in {term.submitted.relative_to(course.root)}, ")
