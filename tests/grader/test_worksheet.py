"""Moodle's grading worksheet: when each handed in, and why a time of it is not taken."""

from __future__ import annotations

import json
from datetime import UTC, datetime

import pytest
from downloaded import NAME, bare_course, counting, from_moodle

from labkit.__main__ import main
from labkit.grader.students.attempts import counted_attempt, perhaps_late
from labkit.grader.students.collect import collect
from labkit.grader.students.identity import lms_users
from labkit.grader.students.roster import FILE as ROSTER
from labkit.grader.timestamp import read_time

ADA, HEAD = ("Ada Lovelace", 101), "Identifier,Full name,Email address"
TIMED = f"{HEAD},Last modified (submission)"
IN_TIME = "Sunday, 1 March 2026, 11:30 AM"
LATER = "Sunday, 1 March 2026, 12:30 PM"


@pytest.fixture
def bare(tmp_path):
    return bare_course(tmp_path / "course")


def take(course, tmp_path, data="1", day=1, **options):
    zip = from_moodle(tmp_path / "1.zip", [(ADA, "x.ipynb", data)], (2026, 3, day, 12, 0, 0))
    return [str(one) for one in collect(course, NAME, zip, **options)]


def worksheet(course, tmp_path, capsys, when, head=TIMED):
    """Import a worksheet that says when Ada handed in: the exit code, and what was said."""
    path = tmp_path / "worksheet.csv"
    time = f',"{when}"' if head == TIMED else ""
    path.write_text(f"{head}\nParticipant 101,Ada Lovelace,ada@x{time}\n", "utf-8")
    words = ["students", "import", str(path), "--assignment", NAME, "--course", str(course.root)]
    capsys.readouterr()
    code = main(words)
    return code, *capsys.readouterr()


def handed_in(course, student="Ada-Lovelace"):
    seen = counted_attempt(course, student, NAME).first
    return f"{seen.when:%d %H:%M}" if seen.exact else ""


def test_the_worksheets_time_is_when_it_was_handed_in(bare, tmp_path, capsys):
    """It is counted in the summary; the same once more changes nothing and says nothing."""
    take(bare, tmp_path)
    code, out, err = worksheet(bare, tmp_path, capsys, IN_TIME)
    assert (code, err, handed_in(bare)) == (0, "", "01 11:30")
    assert "01_paths: 1 participant; 1 hand-in time set" in out
    code, out, err = worksheet(bare, tmp_path, capsys, IN_TIME)
    assert (code, err, handed_in(bare)) == (0, "", "01 11:30")


@pytest.mark.parametrize(
    ("when", "says"),
    [
        ("Sonntag, 1. März 2026, 11:30", "which is not a time that labkit can read"),
        (LATER, "the download that was collected is from 2026-03-01 12:00 UTC; collect a newer"),
        ("-", "says nothing; download the worksheet again"),
    ],
)
def test_a_time_that_is_not_taken_is_named(bare, tmp_path, capsys, when, says):
    """With the student, the reason and what to do; the exit code is 1, so no late rule is lost."""
    take(bare, tmp_path)
    code, out, err = worksheet(bare, tmp_path, capsys, when)
    assert (code, handed_in(bare)) == (1, "") and "; 0 hand-in times set" in out
    assert err.startswith("Ada Lovelace (Ada-Lovelace): no hand-in time is set; the worksheet")
    assert says in err


@pytest.mark.parametrize("options", [{"day": 2}, {"at": read_time("2026-03-01 18:00")}])
def test_no_late_rule_is_applied_to_the_same_file_handed_in_again(bare, tmp_path, capsys, options):
    """Only its second time is known; whom the first download does not show in time is named."""
    take(bare, tmp_path)
    assert worksheet(bare, tmp_path, capsys, LATER)[0] == 1
    take(bare, tmp_path, **options)
    for due, says in [("12:00", False), ("11:59", True)]:
        rules = f"[assignments.{NAME}]\ndue = 2026-03-01T{due}:00Z\n"
        (bare.root / "course.toml").write_text(rules)
        code, out, err = worksheet(bare, tmp_path, capsys, LATER)
        assert (code, err, handed_in(bare)) == (0, "", "")
        again = (
            f"Ada Lovelace (Ada-Lovelace) handed in the same file again, at {LATER}; nobody knows"
        )
        assert (again in out) is says


def test_a_time_that_was_wrong_is_named_and_can_be_taken_back(bare, tmp_path, capsys):
    """If the present worksheet's time is late and the same notebook has an earlier exact time."""
    take(bare, tmp_path, day=5)
    worksheet(bare, tmp_path, capsys, IN_TIME)
    (bare.root / "course.toml").write_text(f"[assignments.{NAME}]\ndue = 2026-03-02T12:00:00Z\n")
    late = "Wednesday, 4 March 2026, 11:30 AM"
    code, _, err = worksheet(bare, tmp_path, capsys, late)
    (record,) = (bare.root / "attempts" / "Ada-Lovelace" / NAME).glob("*/attempt.json")
    assert (code, handed_in(bare)) == (1, "01 11:30")
    assert "the hand-in time stays 2026-03-01 11:30 UTC, and the worksheet now says" in err
    assert f"delete the entry with this time from {record.relative_to(bare.root)}, and" in err
    told = json.loads(record.read_text())
    told["seen"] = [one for one in told["seen"] if not one["exact"]]
    record.write_text(json.dumps(told))
    assert worksheet(bare, tmp_path, capsys, late)[0] == 0 and handed_in(bare) == "04 11:30"


def test_a_worksheet_is_refused_whole_where_the_rules_are_damaged(bare, tmp_path, capsys):
    """No number is recorded before the rules are read."""
    take(bare, tmp_path)
    record = bare.root / "course_private/lms.json"
    before = record.read_text()
    (bare.root / "course.toml").write_text("[assignments.08_reprot]\ndue = 2026-03-02\n")
    assert worksheet(bare, tmp_path, capsys, IN_TIME)[0] == 2
    assert record.read_text() == before


def test_who_is_perhaps_late_is_named_until_the_time_is_known(bare, tmp_path, capsys):
    """When a download is collected, also where an earlier worksheet had a time for earlier work."""
    (bare.root / "course.toml").write_text(f"[assignments.{NAME}]\ndue = 2026-03-02T12:00:00Z\n")
    assert "perhaps late" not in "\n".join(take(bare, tmp_path))
    worksheet(bare, tmp_path, capsys, IN_TIME)
    again = "\n".join(take(bare, tmp_path, "2", day=5))
    assert "perhaps late: 1 (Ada-Lovelace); no late rule is applied" in again
    assert "was there at 2026-03-05 12:00 UTC" in perhaps_late(bare, "Ada-Lovelace", NAME)
    worksheet(bare, tmp_path, capsys, "Wednesday, 4 March 2026, 11:30 AM")
    assert (handed_in(bare), perhaps_late(bare, "Ada-Lovelace", NAME)) == ("04 11:30", "")


def test_who_came_late_is_named_and_so_is_feedback_that_does_not_say_so(bare, tmp_path, capsys):
    """With how late, the deadline and the deduction; once, when the time becomes known."""
    rules = "[late]\npercent_per_day = 10\ngrace_minutes = 15\n"
    due = f"[assignments.{NAME}]\ndue = 2026-03-02T12:00:00\n"
    (bare.root / "course.toml").write_text(f'zone = "Europe/Berlin"\n{rules}{due}')
    take(bare, tmp_path, day=5)
    page = bare.root / "feedback" / "Ada-Lovelace" / NAME / f"{NAME}.html"
    page.parent.mkdir(parents=True)
    page.touch()
    code, out, err = worksheet(bare, tmp_path, capsys, "Tuesday, 3 March 2026, 1:30 PM")
    late = "late: Ada Lovelace (Ada-Lovelace), 1 day 1 hour after the due date 2026-03-02 12:00 CET"
    assert f"1 hand-in time set\n{late}; 20 % of the points earned are deducted\n" in out
    says = "the feedback of 1 student does not say yet that they were late: "
    assert (code, err) == (1, f"{says}Ada Lovelace (Ada-Lovelace); type: labkit feedback {NAME}\n")
    assert worksheet(bare, tmp_path, capsys, "Tuesday, 3 March 2026, 1:30 PM")[0] == 0


def test_a_time_that_changes_which_file_counts_is_named(bare, tmp_path, capsys):
    """A download after the due date shows a second file, and the worksheet says it was in time."""
    due = f"[assignments.{NAME}]\ndue = 2026-03-02T12:00:00Z\n"
    (bare.root / "course.toml").write_text('counts = "latest in time"\n' + due)
    take(bare, tmp_path)
    take(bare, tmp_path, "2", day=5)
    code, _, err = worksheet(bare, tmp_path, capsys, "Monday, 2 March 2026, 11:30 AM")
    assert (code, handed_in(bare)) == (1, "02 11:30")
    assert "now the file of 2026-03-02 11:30 UTC counts, instead of that of 2026-03-01" in err
    assert f"to grade it, type: labkit grade {NAME}" in err


def test_a_worksheet_without_times_is_named_once(bare, tmp_path, capsys):
    """Where the column is missing or in another language, no student is named."""
    take(bare, tmp_path)
    code, _, err = worksheet(bare, tmp_path, capsys, "", HEAD)
    assert code == 1 and "not called 'Last modified (submission)'" in err
    assert "Ada" not in err


def test_times_of_what_was_not_collected_are_named(bare, tmp_path, capsys):
    """Who imports the worksheet before collecting is told to import it once more."""
    code, _, err = worksheet(bare, tmp_path, capsys, IN_TIME)
    assert code == 1 and err.startswith(
        "1 student handed in, and nothing of theirs was collected yet: Ada"
    )
    take(bare, tmp_path)
    assert worksheet(bare, tmp_path, capsys, IN_TIME)[0] == 0


def test_the_worksheet_is_nearer_than_the_time_of_the_download(bare, tmp_path, capsys):
    """Of what was collected with --at nobody knows when it came until the worksheet says so."""
    take(bare, tmp_path, at=read_time("2026-03-01 12:00"))
    assert handed_in(bare, "Ada-Lovelace-101") == ""
    assert worksheet(bare, tmp_path, capsys, IN_TIME)[0] == 0
    assert handed_in(bare) == "01 11:30"


def test_an_old_worksheet_makes_no_newer_hand_in_older(bare, tmp_path, capsys):
    """A download between the two shows that the time is an earlier hand-in's."""
    take(bare, tmp_path)
    take(bare, tmp_path, "2", day=3)
    code, _, err = worksheet(bare, tmp_path, capsys, IN_TIME)
    assert (code, handed_in(bare)) == (1, "")
    assert "shows an earlier notebook; download the worksheet again" in err


@pytest.mark.parametrize(
    "text",
    ["Sonntag, 1. März 2026, 11:30", "01.03.2026, 11:30", "3/1/26, 11:30", "11:30", "5", "",
     "Sunday, 1 March 1926", "2026-03-01 11:30 XYZ", "2026-03-01 11:30 +99:99"],
)  # fmt: skip
def test_what_could_be_another_time_is_none(text):
    """Another language, a day that may be a month, no year, a zone that is nobody's."""
    assert read_time(text) is None


@pytest.mark.parametrize(
    "text", [IN_TIME, "2026-03-01 11:30", "2026-03-01T12:30+01:00", "2026-03-01 12:30 CET"]
)
def test_what_can_be_one_time_alone_is_that_time(text):
    """As Moodle, a person and nbgrader's exchange write it, in the zone that it names."""
    assert read_time(text) == datetime(2026, 3, 1, 11, 30, tzinfo=UTC)


@pytest.mark.parametrize("listed", [True, False])
def test_the_worksheet_of_another_assignment_is_refused(bare, tmp_path, capsys, listed):
    """Nothing is changed, not even without a record, if a roster tells whose the work is."""
    path, record = tmp_path / "worksheet.csv", bare.root / "course_private/lms.json"
    words = ["students", "import", str(path), "--course", str(bare.root)]
    if listed:
        path.write_text("name,email\nAda Lovelace,ada@x\nBob Hope,bob@x\nEve Li,eve@x\n")
        assert main(words) == 0
    people = [(ADA, "x.ipynb", "1"), (("Bob Hope", 102), "x.ipynb", "2")]
    list(collect(bare, NAME, from_moodle(tmp_path / "1.zip", people)))
    row = "Participant {},{},{}@x,\n".format
    path.write_text(
        f"{TIMED}\n{row(501, 'Ada Lovelace', 'ada')}{row(502, 'Bob Hope', 'bob')}"
        f"{row(503, 'Eve Li', 'eve')}"
    )
    for before in (record.read_text(), "{}")[: 1 + listed]:
        record.write_text(before)
        capsys.readouterr()
        assert main([*words, "--assignment", NAME]) == 2
        said = capsys.readouterr().err
        assert "each student with a number in 01_paths (2) would get another" in said
        assert "delete the entry '01_paths' from course_private/lms.json, collect the" in said
        assert record.read_text() == before and (bare.root / ROSTER).exists() is listed
    record.write_text("{}")
    people = [(("Ada Lovelace", 501), "x.ipynb", "3")]
    list(collect(bare, NAME, from_moodle(tmp_path / "2.zip", people, (2026, 3, 9, 12, 0, 0))))
    assert main([*words, "--assignment", NAME]) == 1, "the worksheet gives no time"
    numbers = {folder: one.number for folder, one in lms_users(bare, NAME).items()}
    assert numbers == {"Ada-Lovelace": "501", "Bob-Hope": "502", "Eve-Li": "503"}


def test_the_right_worksheet_mends_what_a_wrong_one_left(bare, tmp_path):
    """Without a roster and a record, a wrong one is let in; each work still has its number."""
    path, words = tmp_path / "worksheet.csv", ["--assignment", NAME, "--course", str(bare.root)]
    take(bare, tmp_path)
    (bare.root / "course_private/lms.json").write_text("{}")
    for number in 501, 101:
        path.write_text(f"{HEAD}\nParticipant {number},Ada Lovelace,ada@x\n")
        main(["students", "import", str(path), *words])
        held = "Ada-Lovelace-101" if number == 501 else "Ada-Lovelace"
        assert counting(bare) == {held: "1"}
    assert {folder: x.number for folder, x in lms_users(bare, NAME).items()} == {
        "Ada-Lovelace": "101"
    }


@pytest.mark.parametrize("recorded", [True, False])
def test_work_follows_its_number_if_the_record_of_numbers_is_lost(bare, tmp_path, recorded):
    """Namesakes' work is theirs by the number with which it was collected."""
    path, record = tmp_path / "worksheet.csv", bare.root / "course_private/lms.json"
    words = ["students", "import", str(path), "--course", str(bare.root)]
    path.write_text("name,email\nKim Lee,1@x\nKim Lee,2@x\n")
    assert main(words) == 0
    people = [(("Kim Lee", k), "x.ipynb", str(k)) for k in (11, 12)]
    list(collect(bare, NAME, from_moodle(tmp_path / "1.zip", people)))
    if not recorded:
        record.write_text("{}")
    path.write_text(f"{HEAD}\nParticipant 12,Kim Lee,1@x\nParticipant 11,Kim Lee,2@x\n")
    main([*words, "--assignment", NAME])
    assert counting(bare) == {"Kim-Lee-1": "12", "Kim-Lee-2": "11"}
