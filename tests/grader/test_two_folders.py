"""Two folders of one student: the import of a list names them and joins nothing."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest
from downloaded import NAME, bare_course, counting, from_moodle, kept
from labkit.grader.terms.by_hand import left_by_hand

from labkit.__main__ import main
from labkit.grader.students.class_list import Student
from labkit.grader.students.collect import collect
from labkit.grader.students.enrol import import_list
from labkit.grader.students.identity import lms_users
from labkit.grader.students.roster import Roster, save_roster


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
def test_two_folders_of_one_student_are_named_and_collecting_again_keeps_both(
    bare, tmp_path, rule, expected
):
    """The import joins nothing, for a name may be another's; the downloads know whose they are."""
    rules = f"counts = '{rule}'\n[assignments.{NAME}]\ndue = 2026-03-02T00:00:00\n"
    (bare.root / "course.toml").write_text(rules)
    handed_in_twice(bare, tmp_path, "1", "2")
    assert counting(bare) == {"Ada-Lovelace-42": "1", "ada": "2"}
    _, (said,) = import_list(bare, tmp_path / "list.csv")
    assert "Ada-Lovelace-42/01_paths: left there, because it belongs in ada, which has" in said
    assert counting(bare) == {"Ada-Lovelace-42": "1", "ada": "2"}
    known = {folder: one.key for folder, one in lms_users(bare, NAME).items()}
    assert known == {"Ada-Lovelace-42": ("moodle", "42"), "ada": ("files", "ada")}
    take(bare, tmp_path / "1.zip")
    assert lms_users(bare, NAME)["ada"].key == ("moodle", "42")
    assert counting(bare)["ada"] == expected
    assert kept(bare, "ada") == {"1", "2"}
    _, (said,) = import_list(bare, tmp_path / "list.csv")
    assert said.startswith("work in folders that belong to nobody in the roster: Ada-Lovelace-42; ")


@pytest.mark.parametrize(
    ("listed", "name"),
    [
        (
            "Identifier,Full name,Email address,Username\nParticipant 42,Ada Lovelace,a@x,ada\n",
            NAME,
        ),
        ("name,login\nAda Lovelace,ada\n", ""),
    ],
)
def test_work_that_is_there_is_mixed_with_nobodys(bare, tmp_path, listed, name):
    """A notebook that was copied by hand stays, and no attempt or page of another joins it."""
    take(bare, from_moodle(tmp_path / "1.zip", [(("Ada Lovelace", 42), "x.ipynb", "42's")]))
    page = bare.root / "feedback" / "Ada-Lovelace-42" / NAME / "page.html"
    page.parent.mkdir(parents=True)
    page.touch()
    by_hand = bare.submitted / "ada" / NAME / f"{NAME}.ipynb"
    by_hand.parent.mkdir(parents=True)
    by_hand.write_text("ada's")
    (tmp_path / "list.csv").write_text(listed)
    _, said = import_list(bare, tmp_path / "list.csv", name)
    assert "Ada-Lovelace-42/01_paths: left there" in " ".join(said)
    assert counting(bare) == {"Ada-Lovelace-42": "42's", "ada": "ada's"}
    assert page.exists() and not (bare.root / "feedback" / "ada").exists()
    assert not (bare.root / "attempts" / "ada").exists()


def test_files_named_by_two_identifiers_of_one_student_are_two_attempts(bare, tmp_path):
    """The login first, the number in the list later: the later one counts, and both are kept."""
    ada = Student("ada", "Ada", "Lovelace", login="ada", id_number="4711")
    save_roster(bare, Roster((ada, Student("bo", "Bo", "Li"))))
    for day, (who, text) in enumerate((("ada", "first"), ("4711", "second")), start=1):
        (tmp_path / who / who).mkdir(parents=True)
        (tmp_path / who / who / "x.ipynb").write_text(text)
        at = datetime(2026, 3, day, tzinfo=UTC)
        take(bare, tmp_path / who, named="{student}/*.ipynb", at=at)
    assert counting(bare) == {"ada": "second"}
    assert kept(bare, "ada") == {"first", "second"}


@pytest.mark.parametrize("other", ["Ada Lovelace", "ada-on-github", "lovelace"])
def test_a_name_or_an_account_that_anybody_can_take_is_not_joined(bare, tmp_path, other):
    """Beside a file named by her number, what may be another person's stays apart and is told."""
    ada = Student("ada", "Ada", "Lovelace", "lovelace@mail.org", "", "4711", github="ada-on-github")
    save_roster(bare, Roster((ada,)))
    for who, text in (("4711", "hers"), (other, "whose?")):
        (tmp_path / "files" / who).mkdir(parents=True)
        (tmp_path / "files" / who / "x.ipynb").write_text(text)
    said = take(bare, tmp_path / "files", named="{student}/*.ipynb")
    assert counting(bare)["ada"] == "hers" and kept(bare, "ada") == {"hers"}
    (doubt,) = [str(one) for one in said if "kept apart" in str(one)]
    assert "until the file is named by the student's login" in doubt


def test_an_empty_folder_is_no_work(bare, tmp_path):
    """What was collected goes to the student although a folder without a file is there."""
    take(bare, from_moodle(tmp_path / "1.zip", [(("Ada Lovelace", 42), "x.ipynb", "hers")]))
    (bare.submitted / "ada" / NAME / "figures").mkdir(parents=True)
    (tmp_path / "list.csv").write_text("name,login\nAda Lovelace,ada\n")
    assert import_list(bare, tmp_path / "list.csv")[1] == []
    assert counting(bare) == {"ada": "hers"}


def test_two_students_of_the_roster_are_never_joined(bare, tmp_path):
    """A worksheet that gives one's number to another leaves both as they are, and says so."""
    save_roster(bare, Roster((Student("li1", "Li", "Wei"), Student("li2", "Bo", "Li", "li2@x"))))
    people = [(("Li Wei", 5), "x.ipynb", "5"), (("Bo Li", 6), "x.ipynb", "6")]
    take(bare, from_moodle(tmp_path / "1.zip", people))
    worksheet = tmp_path / "worksheet.csv"
    worksheet.write_text("Identifier,Full name,Email address\nParticipant 5,Bo Li,li2@x\n")
    said, *_ = import_list(bare, worksheet, NAME)[1]
    assert "submitted/li1/01_paths: left there, because it belongs in li2, which has" in said
    assert counting(bare) == {"li1": "5", "li2": "6"}


def test_two_students_who_have_each_others_work_get_it_by_collecting_again(bare, tmp_path):
    """A worksheet that swaps two numbers moves nothing, and nobody is told to delete anything."""
    save_roster(bare, Roster((Student("li1", "Li", "Wei"), Student("li2", "Bo", "Li", "li2@x"))))
    people = [(("Li Wei", 5), "x.ipynb", "5"), (("Bo Li", 6), "x.ipynb", "6")]
    source = from_moodle(tmp_path / "1.zip", people)
    take(bare, source)
    rows = "Participant 5,Bo Li,li2@x\nParticipant 6,Li Wei,\n"
    (tmp_path / "worksheet.csv").write_text(f"Identifier,Full name,Email address\n{rows}")
    said = " ".join(import_list(bare, tmp_path / "worksheet.csv", NAME)[1])
    assert said.count("left there") == 2 and "collect the same downloads again" in said
    assert "delete" not in said
    take(bare, source)
    assert counting(bare) == {"li1": "6", "li2": "5"}


def test_a_folder_of_nobody_in_the_roster_is_named(bare, tmp_path, capsys):
    """At import, with exit code 1, and not by `term forget` of somebody with another name."""
    people = [(("Ada Lovelace", 1), "x.ipynb", "1"), (("Ada King", 2), "x.ipynb", "2")]
    take(bare, from_moodle(tmp_path / "1.zip", people))
    (tmp_path / "list.csv").write_text("name,login\nAda Lovelace,ada\n")
    words = ["students", "import", str(tmp_path / "list.csv"), "--course", str(bare.root)]
    assert main(words) == 1
    said = capsys.readouterr().err
    assert said.startswith("work in folders that belong to nobody in the roster: Ada-King-2; where")
    assert "perhaps theirs too" not in " ".join(left_by_hand(bare, [bare], "ada"))


def test_two_participants_of_one_name_stay_apart_until_the_worksheet_comes(bare, tmp_path):
    """As the guide says: neither a list nor collecting again says whose the two folders are."""
    people = [(("Kim Lee", number), "x.ipynb", str(number)) for number in (11, 12)]
    source = from_moodle(tmp_path / "1.zip", people)
    take(bare, source)
    (tmp_path / "list.csv").write_text("name,login\nKim Lee,kl\n")
    _, (said,) = import_list(bare, tmp_path / "list.csv")
    assert "Kim-Lee-11, Kim-Lee-12; where it is a listed student's, import Moodle's grading" in said
    doubts = [str(one) for one in take(bare, source) if not one.fine]
    assert sum("until you import the assignment's grading worksheet" in one for one in doubts) == 2
    assert counting(bare) == {"Kim-Lee-11": "11", "Kim-Lee-12": "12"}
    rows = "Participant 11,Kim Lee,kl2\nParticipant 12,Kim Lee,kl\n"
    (tmp_path / "worksheet.csv").write_text(f"Identifier,Full name,Username\n{rows}")
    import_list(bare, tmp_path / "worksheet.csv", NAME)
    assert counting(bare) == {"kl2": "11", "kl": "12"}


def test_a_folder_is_named_though_a_sentence_has_its_name(bare, tmp_path):
    """A time that nobody can read, 01/03/2026, says nothing of the folder 03."""
    save_roster(bare, Roster((Student("ada", "Ada", "Lovelace", login="ada"),)))
    take(bare, from_moodle(tmp_path / "1.zip", [(("Ada Lovelace", 42), "x.ipynb", "hers")]))
    (bare.submitted / "03" / NAME).mkdir(parents=True)
    worksheet = tmp_path / "worksheet.csv"
    heads = "Identifier,Full name,Username,Last modified (submission)"
    worksheet.write_text(f"{heads}\nParticipant 42,Ada Lovelace,ada,01/03/2026 10:00\n")
    _, (time, folder) = import_list(bare, worksheet, NAME)
    assert "01/03/2026" in time
    assert folder.startswith("work in folders that belong to nobody in the roster: 03;")


def test_without_a_list_forget_names_who_is_called_alike(bare, tmp_path):
    """Moodle gives one student another number, and so another folder, in each assignment."""
    for number, name in enumerate((NAME, "02_model")):
        people = [(("Ada Lovelace", number), "x.ipynb", "1"), (("Bo Li", 9), "x.ipynb", "1")]
        take(bare, from_moodle(tmp_path / f"{name}.zip", people), name)
    said = " ".join(left_by_hand(bare, [bare], "Ada-Lovelace-0"))
    assert "perhaps theirs too: Ada-Lovelace-1; look" in said
