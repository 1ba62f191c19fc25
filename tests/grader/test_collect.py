"""Collecting: whose work it is says the platform, and nobody's is lost for another's sake."""

from __future__ import annotations

import os
import re
import shutil
import struct
import subprocess
import tempfile
import zipfile
from functools import partial
from pathlib import Path

import pytest
from downloaded import (
    MOODLE,
    NAME,
    bare_course,
    canvas_writes,
    counting,
    from_moodle,
    handed_in,
    kept,
    moodle_writes,
    sentences,
    written_at,
    zipped,
)
from handmade import ROOT
from hypothesis import given, settings
from hypothesis import strategies as st
from made import notebook_of, result_of
from test_platforms import FILES, TEXTS

from labkit.__main__ import main
from labkit.course.authoring.layout import DEFENCE
from labkit.errors import LabkitError
from labkit.grader.defence.mark import await_mark, give_mark
from labkit.grader.grading.results import Results
from labkit.grader.marks.table import marks_of
from labkit.grader.nbgrader.gradebook import open_gradebook, record
from labkit.grader.students.class_list import read_list
from labkit.grader.students.collect import collect
from labkit.grader.students.enrol import enrol, import_list
from labkit.grader.students.exchange import SECRET
from labkit.grader.students.identity import FILE, all_lms_users, lms_users, record_users
from labkit.grader.students.move import move_to_owners
from labkit.grader.students.platforms import LmsUser
from labkit.grader.students.roster import FILE as ROSTER
from labkit.grader.students.roster import read_roster, save_roster
from labkit.grader.students.worksheet import keep_numbers
from labkit.grader.submission import read_file

NOBODY = 64990
"""A user number that this machine does not know."""


@pytest.fixture
def bare(tmp_path):
    return bare_course(tmp_path / "course")


def take(course, source, **options):
    return sentences(collect(course, NAME, source, **options))


def troubles(course, source, **options):
    return [str(one) for one in collect(course, NAME, source, **options) if not one.fine]


# Whose it is


def test_no_name_of_a_file_replaces_anothers_work(bare, tmp_path):
    """Eve calls her file as Moodle would call Ada's: it is Eve's, and Ada's stays."""
    ada = ("Ada Lovelace", 42)
    take(bare, from_moodle(tmp_path / "1.zip", [(ada, f"{NAME}.ipynb", "ada's")]))
    file = "x_42_assignsubmission_file_01_paths(9).ipynb"
    entry = moodle_writes("Eve Mallory", 77, file, in_folders=False)
    take(bare, zipped(tmp_path / "2.zip", [(entry, "eve's")], (2026, 3, 9, 1, 1, 0)))
    assert counting(bare) == {"Ada-Lovelace-42": "ada's", "Eve-Mallory-77": "eve's"}
    assert lms_users(bare, NAME)["Ada-Lovelace-42"] == LmsUser("moodle", "42", "Ada Lovelace")
    assert lms_users(bare, NAME)["Eve-Mallory-77"] == LmsUser("moodle", "77", "Eve Mallory")


@settings(max_examples=20, deadline=None)
@given(st.dictionaries(st.integers(1, 99), st.tuples(TEXTS, FILES), min_size=1, max_size=5))
def test_everybodys_work_is_under_their_own_number(people):
    """Whatever a class and its files are called, each number has a folder with its own work."""
    with tempfile.TemporaryDirectory() as folder:
        course = bare_course(Path(folder, "course"))
        entries = [
            (moodle_writes(name, number, f"{number} {file}"), str(number))
            for number, (name, file) in people.items()
        ]
        entries = [entry for entry in entries if not {"", ".", ".."} & set(entry[0].split("/"))]
        found = list(collect(course, NAME, zipped(Path(folder, "1.zip"), entries)))
        refused = sum(not one.fine for one in found)
        folders = {who.number: folder for folder, who in lms_users(course, NAME).items()}
        assert {folders[n]: n for _, n in entries if n in folders} == counting(course)
        assert len(counting(course)) == len(entries) - refused
        assert len({folder.casefold() for folder in folders.values()}) == len(folders)


def test_people_of_one_name_are_told_apart(bare, tmp_path):
    """Moodle's number is in each folder's name; that nobody is known by a name is said once."""
    downloads = (
        [(("Li Wei", 7), "n.ipynb", "7"), (("Bob", 8), "n.ipynb", "8")],
        [(("Li Wei", 7), "n.ipynb", "7"), (("Li Wei", 9), "sub/n.ipynb", "9")],
        [(("KIM", 3), "n.ipynb", "3"), (("Kim.", 4), "n.ipynb", "4")],
        [(("Li Wei-7", 10), "n.ipynb", "10"), (("Li", 11), "n.ipynb", "11")],
    )
    for number, files in enumerate(downloads):
        found = [*collect(bare, NAME, from_moodle(tmp_path / f"{number}.zip", files))]
        assert all(one.fine for one in found)
        assert sum("no class list" in str(one) for one in found) == 1
    assert counting(bare) == {
        **{"Li-Wei-7": "7", "Bob-8": "8", "Li-Wei-9": "9", "KIM-3": "3", "Kim-4": "4"},
        **{"Li-Wei-7-10": "10", "Li-11": "11"},
    }
    assert not lms_users(bare, "02_model")


def test_a_name_does_not_join_the_work_of_two_assignments(bare, tmp_path):
    """Eve takes Ada's name where Ada hands nothing in; without a roster they are two."""
    for name, number in ((NAME, 42), ("02_model", 77)):
        source = from_moodle(
            tmp_path / f"{name}.zip", [(("Ada Lovelace", number), "x.ipynb", name)]
        )
        assert all(one.fine for one in collect(bare, name, source))
    assert counting(bare) == {"Ada-Lovelace-42": NAME}
    assert counting(bare, "02_model") == {"Ada-Lovelace-77": "02_model"}


@pytest.mark.parametrize("first", ["moodle", "exchange"])
def test_two_platforms_make_nobody_share_a_folder(bare, tmp_path, first):
    """A login that is called as another platform's folder is somebody else."""
    moodle = from_moodle(tmp_path / "1.zip", [(("ada", 42), "x.ipynb", "moodle's")])
    exchange = handed_in(tmp_path / "in", "ada-42", "the exchange's").parent
    for source in (moodle, exchange) if first == "moodle" else (exchange, moodle):
        assert not troubles(bare, source, unverified=True)
    other = "exchange" if first == "moodle" else "moodle"
    found = {"moodle": "moodle's", "exchange": "the exchange's"}
    assert counting(bare) == {"ada-42": found[first], f"ada-42-{other}": found[other]}


def test_downloads_of_moodle_canvas_and_the_exchange(bare, tmp_path):
    """Each layout ends in submitted/, and what is nobody's or no notebook is said."""
    ada, bob = (MOODLE.format(*who) for who in (("Ada Lovelace", 101), ("Bob", 102)))
    moodle = [(f"{ada}/notebook.ipynb", "1"), (f"{ada}/notebook(3).ipynb", "2")]
    moodle += [(f"{bob}/readme.txt", "x"), ("../../evil.ipynb", "x"), ("essay.ipynb", "x")]
    told = take(bare, zipped(tmp_path / "moodle.zip", moodle))
    assert "Ada-Lovelace-101: notebook.ipynb: kept, but notebook(3).ipynb counts" in told
    assert "Bob-102: readme.txt: not taken; it is not a notebook" in told
    assert "essay.ipynb: not taken; its name does not say who handed it in" in told
    entry = "hoppergrace_LATE_7_99_01_paths-1.ipynb"
    told = take(bare, zipped(tmp_path / "canvas.zip", [(entry, "3")]))
    assert told == [f"hoppergrace-7: 01_paths-1.ipynb: taken, as {NAME}.ipynb, late"]
    handed_in(tmp_path / "in", "root", "4")
    assert take(bare, tmp_path / "in") == [f"root: {NAME}.ipynb: taken"]
    assert counting(bare) == {"Ada-Lovelace-101": "2", "hoppergrace-7": "3", "root": "4"}
    with pytest.raises(LabkitError, match="neither a folder nor a zip"):
        take(bare, Path(__file__))
    with pytest.raises(LabkitError, match="there is no"):
        take(bare, tmp_path / "none.zip")


def test_a_folder_that_somebody_made_by_hand_is_not_given_to_a_namesake(bare, tmp_path):
    """Without a roster nobody knows whose it is; it stays as it is."""
    work = bare.submitted / "zoe" / NAME / f"{NAME}.ipynb"
    work.parent.mkdir(parents=True)
    work.write_text("zoe's")
    take(bare, from_moodle(tmp_path / "1.zip", [(("zoe", 9), "x.ipynb", "another's")]))
    assert counting(bare) == {"zoe": "zoe's", "zoe-9": "another's"}


# The roster


def roster(course, *lines):
    path = course.root / ROSTER
    path.parent.mkdir(exist_ok=True)
    head = "id,first_name,last_name,email,lms_user_id,login,id_number"
    path.write_text("\n".join([head, *lines]) + "\n")


def enrolled(course, path, assignment=None):
    """What `labkit students import` does, but for the gradebook."""
    done = enrol(read_roster(course), read_list(path), all_lms_users(course))
    save_roster(course, done.roster)
    left = move_to_owners(course, done.roster)
    return left + (keep_numbers(course, assignment, done.roster, done.rows) if assignment else [])


def test_the_same_person_has_one_folder_in_all_assignments(bare, tmp_path):
    """By Moodle's name, Canvas's number, the exchange's login or address: the roster's folder."""
    roster(bare, "ada,Ada,O'Lovelace,ada@uni.org,7,root,")
    names = [NAME, "02_model", "03_velocity_control", "00_warmup"]
    sources = [
        from_moodle(tmp_path / "1.zip", [(("OLovelace Ada", 42), "x.ipynb", "1")]),
        from_moodle(tmp_path / "2.zip", [(("Ada OLovelace", 99), "x.ipynb", "1")]),
        zipped(tmp_path / "3.zip", [("lovelaceada_7_9_x.ipynb", "1")]),
        handed_in(tmp_path / "in", "root", "1", name="00_warmup").parent,
    ]
    for name, source in zip(names, sources, strict=True):
        assert all(one.fine for one in collect(bare, name, source))
    assert [path.name for path in bare.submitted.iterdir()] == ["ada"]
    assert {path.name for path in (bare.submitted / "ada").iterdir()} == set(names)


def test_who_is_not_in_the_roster_is_merged_with_nobody(bare, tmp_path):
    """They get a folder of their own, even if it would be called as somebody's, and are named."""
    roster(bare, "Zoe-Park,Ada,Lovelace,,,,", "Kim,Kim,,,,,")
    people = [("Zoe Park", 5), ("Kim", 6), ("Kim", 7), ("Ada Lovelace", 8)]
    files = [(who, "x.ipynb", str(who[1])) for who in people]
    said = troubles(bare, from_moodle(tmp_path / "1.zip", files))
    assert counting(bare) == {"Zoe-Park-5": "5", "Kim-6": "6", "Kim-7": "7", "Zoe-Park": "8"}
    assert len(said) == 3
    assert said[0].startswith("Zoe-Park-5: participant 5 (Zoe Park) is not in the roster, so")
    assert "participant 6 (Kim) has the name of a student, and so has another u" in said[1]


def test_who_has_another_surname_by_now_is_perhaps_a_student(bare, tmp_path):
    """Two words of the name are the same: the worksheet knows, and then the work goes to them."""
    roster(bare, "fay,Fay,Okonkwo-Smith,fay@x,,,", "bo,Fay,Li,bo@x,,,")
    source = from_moodle(tmp_path / "1.zip", [(("Fay Okonkwo", 5), "x.ipynb", "hers")])
    (said,) = troubles(bare, source)
    assert "and collect again; if they are Fay Okonkwo-Smith (fay), import the assign" in said
    worksheet = tmp_path / "worksheet.csv"
    worksheet.write_text("Identifier,Full name,Email address\nParticipant 5,Fay Okonkwo,fay@x\n")
    enrolled(bare, worksheet, NAME)
    assert counting(bare) == {"fay": "hers"}
    assert not troubles(bare, source)


def test_a_name_that_the_roster_has_twice_is_not_guessed(bare, tmp_path):
    """Both are kept apart until somebody says who is who; then their work goes to them."""
    roster(bare, "li1,Li,Wei,li1@uni.org,,,", "li2,Wei,Li,li2@uni.org,,,")
    source = from_moodle(tmp_path / "1.zip", [(("Li Wei", k), "x.ipynb", str(k)) for k in (5, 6)])
    said = troubles(bare, source)
    assert "Li-Wei-5: participant 5 (Li Wei) has the name of 2 students of the roster" in said[0]
    worksheet = tmp_path / "worksheet.csv"
    worksheet.write_text(
        "Identifier,Full name,Email address\nParticipant 5,Li Wei,li2@uni.org\n"
        "Participant 6,Wei Li,li1@uni.org\n"
    )
    enrolled(bare, worksheet, NAME)
    assert counting(bare) == {"li2": "5", "li1": "6"}
    assert kept(bare, "li2") == {"5"}
    assert not troubles(bare, source)
    assert counting(bare) == {"li2": "5", "li1": "6"}


def test_a_second_participant_of_a_students_name_is_not_that_student(bare, tmp_path):
    """Eve calls herself Ada Lovelace in Moodle: Ada's folder stays Ada's."""
    roster(bare, "ada,Ada,Lovelace,,,,")
    take(bare, from_moodle(tmp_path / "1.zip", [(("Ada Lovelace", 42), "x.ipynb", "ada's")]))
    eve = from_moodle(tmp_path / "2.zip", [(("Ada Lovelace", 77), "x.ipynb", "eve's")])
    assert "and so has another user on record" in troubles(bare, eve)[0]
    assert counting(bare) == {"ada": "ada's", "Ada-Lovelace-77": "eve's"}


def test_a_canvas_name_with_a_number_is_settled_by_the_roster(bare, tmp_path):
    """eve_7 is user 8; without a roster nobody's work is guessed, with one it is Eve's."""
    source = zipped(tmp_path / "1.zip", [("eve_7_8_100_x.ipynb", "eve's")])
    (said,) = troubles(bare, source)
    assert "Canvas's user 7 (eve) or Canvas's user 8 (eve_7)" in said
    assert not counting(bare)
    roster(bare, "grace,Grace,Hopper,,7,,", "eve,,eve_7,,8,,")
    assert not troubles(bare, source)
    assert counting(bare) == {"eve": "eve's"}


def test_a_cup_entry_from_canvas_needs_no_list(bare, tmp_path):
    """Its name begins with a number, which is not taken for that of Canvas's attachment."""
    source = zipped(tmp_path / "1.zip", [("hoppergrace_7_4711_10_cup.ipynb", "g")])
    assert all(one.fine for one in collect(bare, "10_cup", source))
    assert counting(bare, "10_cup") == {"hoppergrace-7": "g"}


def test_one_who_hands_in_before_they_are_in_the_roster_is_brought_there(bare, tmp_path):
    """A late enrolment: the next list has them, and their work goes to their folder."""
    source = from_moodle(tmp_path / "1.zip", [(("Zoe Park", 5), "x.ipynb", "z")])
    (tmp_path / "1.csv").write_text("name,login\nAda Lovelace,ada\n")
    (tmp_path / "2.csv").write_text("name,login\nAda Lovelace,ada\nZoe Park,zpark\n")
    enrolled(bare, tmp_path / "1.csv")
    assert troubles(bare, source)
    enrolled(bare, tmp_path / "2.csv")
    assert not troubles(bare, source)
    assert counting(bare) == {"zpark": "z"}


def test_what_was_collected_before_it_was_known_whose_it_is_is_brought_to_them(bare, tmp_path):
    """Canvas's number comes with a later list: all of the term's work moves to the folder."""
    roster(bare, "grace,Grace,Hopper,g@uni.org,,,")
    for name in (NAME, "02_model"):
        entry = [("hoppergrace_7_99_x.ipynb", name)]
        assert [
            x for x in collect(bare, name, zipped(tmp_path / f"{name}.zip", entry)) if not x.fine
        ]
    assert counting(bare) == {"hoppergrace-7": NAME}
    lst = tmp_path / "list.csv"
    lst.write_text('Student,ID,SIS Login ID,Section\n"Hopper, Grace",7,ghopper,\n')
    assert not enrolled(bare, lst)
    assert counting(bare) == {"grace": NAME} and counting(bare, "02_model") == {"grace": "02_model"}
    assert kept(bare, "grace") == {NAME}
    assert list(lms_users(bare, NAME)) == ["grace"]
    assert not troubles(bare, tmp_path / f"{NAME}.zip")


def test_an_older_labkits_folders_stay_their_owners(bare, tmp_path):
    """Of two who were called alike, neither becomes a student by the name of their folder."""
    known = {
        NAME: {
            "Ada-Lovelace": LmsUser("moodle", "77", "Ada Lovelace"),
            "Ada-Lovelace-42": LmsUser("moodle", "42", "Ada Lovelace"),
        }
    }
    for assignment, people in known.items():
        record_users(bare, assignment, people)
    files = [(("Ada Lovelace", k), "x.ipynb", str(k)) for k in (42, 77)]
    assert take(bare, from_moodle(tmp_path / "1.zip", files))
    assert counting(bare) == {"Ada-Lovelace": "77", "Ada-Lovelace-42": "42"}
    (tmp_path / "list.csv").write_text("name,email\nAda Lovelace,ada@x\n")
    assert not enrolled(bare, tmp_path / "list.csv")
    assert [x.id for x in read_roster(bare).students] == ["Ada-Lovelace-ada"]
    assert len(troubles(bare, tmp_path / "1.zip")) == 2
    assert counting(bare) == {"Ada-Lovelace": "77", "Ada-Lovelace-42": "42"}


def test_marks_go_with_the_work(course, tmp_path):
    """Graded before there was a roster: the result and a mark by hand are the student's."""
    data = notebook_of("ada")
    source = from_moodle(tmp_path / "1.zip", [(("Ada Lovelace", 42), f"{NAME}.ipynb", data)])
    assert take(course, source)
    results = Results(course, NAME)
    results.keep(result_of(course, "Ada-Lovelace-42", data=notebook_of("an earlier one")))
    results.keep(result := result_of(course, "Ada-Lovelace-42", data=data))
    results.provisional.keep(result)
    record(course, NAME, [result])
    with open_gradebook(course) as book:
        book.find_grade("circle-check", NAME, NAME, "Ada-Lovelace-42").manual_score = 1.5
        book.db.commit()
    await_mark(course, "Ada-Lovelace-42", ())
    give_mark(course, "Ada-Lovelace-42", (3, 2, 1))
    (before,) = marks_of(course, NAME)
    path = course.build / "explain/Ada-Lovelace-42/circle.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("[]")
    (tmp_path / "list.csv").write_text("name,login\nAda Lovelace,ada\n")
    _, left = import_list(course, tmp_path / "list.csv")
    assert not left
    (mark,) = marks_of(course, NAME)
    assert (before.student, mark.student) == ("Ada-Lovelace-42", "ada")
    assert mark.score == before.score != result.score and not mark.missing
    assert [results.students(), (results.read("ada") or result).score] == [["ada"], result.score]
    assert (course.root / "autograded" / "ada" / NAME / f"{NAME}.ipynb").exists()
    assert len(list(results.folder.glob("old/ada/*.json"))) == 1
    assert not list(results.folder.rglob("Ada-Lovelace-42*")), "forget finds all by the name"
    (defence,) = marks_of(course, DEFENCE)
    assert (defence.student, defence.score) == ("ada", 6.0)
    assert not [*course.root.rglob("Ada-Lovelace-42*")], "forget finds all by the new name"
    assert (course.build / "explain/ada/circle.html").exists()
    with open_gradebook(course) as book:
        assert [one.id for one in book.students] == ["ada"]


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_two_of_one_name_change_places_with_their_marks(course, tmp_path, order):
    """Who was taken for the other student of the name makes room first, in any order of rows."""
    people = [(("Ada Lovelace", k), "x.ipynb", notebook_of(f"{k}'s")) for k in (42, 43)]
    (tmp_path / "list.csv").write_text("name,login\nAda Lovelace,ada\n")
    assert not enrolled(course, tmp_path / "list.csv")
    for files in (people[:1], people):
        take(course, from_moodle(tmp_path / "1.zip", files))
    folders = {"ada": 42, "Ada-Lovelace-43": 43}
    made = [result_of(course, x, data=notebook_of(f"{k}'s")) for x, k in folders.items()]
    for one in made:
        Results(course, NAME).keep(one)
    record(course, NAME, made)
    with open_gradebook(course) as book:
        book.find_grade("circle-check", NAME, NAME, "ada").manual_score = 1.5
        book.db.commit()
    rows = ["Participant 42,Ada Lovelace,ada2", "Participant 43,Ada Lovelace,ada"][order]
    text = "\n".join(["Identifier,Full name,Username", *rows])
    (tmp_path / "worksheet.csv").write_text(f"{text}\n")
    _, left = import_list(course, tmp_path / "worksheet.csv", NAME)
    assert "left there" not in " ".join(left)
    for who, number in (("ada", 43), ("ada2", 42)):
        assert counting(course)[who] == notebook_of(f"{number}'s").decode()
    marks = {mark.student: mark for mark in marks_of(course, NAME)}
    assert not any(mark.missing for mark in marks.values())
    given = {x: [line.by_hand for line in mark.lines if line.by_hand] for x, mark in marks.items()}
    assert given == {"ada": [], "ada2": [1.5]}


def test_what_cannot_be_moved_is_named(bare, tmp_path):
    """A mark under the old name, or other work under the new one, wants a look."""
    take(bare, zipped(tmp_path / "1.zip", [("hoppergrace_7_99_x.ipynb", "moodle's")]))
    other = bare.submitted / "grace" / NAME / f"{NAME}.ipynb"
    other.parent.mkdir(parents=True)
    other.write_text("another")
    (bare.results / NAME).mkdir(parents=True)
    (bare.results / NAME / "hoppergrace-7.json").write_text("{}")
    roster(bare, "grace,Grace,Hopper,,7,,")
    (said,) = troubles(bare, tmp_path / "1.zip")
    assert f"submitted/hoppergrace-7/{NAME} and results/{NAME}/hoppergrace-7.json" in said
    assert counting(bare)["hoppergrace-7"] == "moodle's"
    assert kept(bare, "grace") == {"another", "moodle's"}


# The exchange


def test_a_folder_in_the_exchange_must_belong_to_whom_it_names(bare, tmp_path):
    """Who hands in under another's name replaces nothing, and is named; so with the secret."""
    handed_in(tmp_path / "in", "root", "mine")
    take(bare, tmp_path / "in")
    handed_in(tmp_path / "in", "root", "forged", "2026-03-05 10:00:00 UTC", owner=NOBODY)
    (said,) = troubles(bare, tmp_path / "in", unverified=True)
    assert "it belongs to user number 64990 and not to root; possibly an attempt to cheat" in said
    assert counting(bare) == {"root": "mine"}
    assert (bare.submitted / "root" / NAME / SECRET).read_text() == "secret of mine"
    assert kept(bare, "root") == {"mine"}


def test_a_user_whom_the_machine_does_not_know_is_taken_only_if_asked(bare, tmp_path):
    """The owner of such a folder says nothing; two owners under one name say that one lies."""
    handed_in(tmp_path / "in", "grace", "1", owner=NOBODY)
    (said,) = troubles(bare, tmp_path / "in")
    assert said.startswith("grace: not taken; this machine has no such users")
    assert "--unverified" in said
    assert not counting(bare)
    assert not troubles(bare, tmp_path / "in", unverified=True)
    assert counting(bare) == {"grace": "1"}
    handed_in(tmp_path / "in", "grace", "2", "2026-03-05 10:00:00 UTC", owner=NOBODY + 1)
    both = troubles(bare, tmp_path / "in", unverified=True)
    assert len(both) == 2
    assert "user number 64990 and user number 64991 handed in as grace" in both[0]
    assert counting(bare) == {"grace": "1"}


@pytest.mark.parametrize("who", [" grace ", "grace\x1b", "grace\u202e", "zoe\u0308", ""])
def test_a_name_that_only_looks_like_anothers_is_nobodys(bare, tmp_path, who):
    """Cleaned it would be another's: white space, what a terminal obeys, another composed form."""
    looks_like = {"zoe\u0308": "zoë", "": "x"}.get(who, "grace")
    handed_in(tmp_path / "in", looks_like, "right", owner=NOBODY)
    handed_in(tmp_path / "in", who, "forged", "2026-03-05 10:00:00 UTC", owner=NOBODY + 1)
    (said,) = troubles(bare, tmp_path / "in", unverified=True)
    assert "no user can have such a name" in said
    assert counting(bare) == {looks_like: "right"}


def test_names_of_the_exchange_are_names_of_folders(bare, tmp_path):
    """An address stays as it is; no name leads out, hides, or is taken for an option."""
    people = ("ada.l@uni.org", "..", ".hidden", "-rf", "con", "a" * 200, "RF", "rf")
    for who in people:
        handed_in(tmp_path / "in", who, who)
    take(bare, tmp_path / "in", unverified=True)
    found = {who: folder for folder, who in counting(bare).items()}
    starts = ["ada.l@uni.org", "student-", "hidden-", "rf-", "student-con-", "a" * 80, "RF-", "rf"]
    assert [found[who].startswith(x) for who, x in zip(people, starts, strict=True)] == [True] * 8
    assert found["ada.l@uni.org"] == "ada.l@uni.org" and found["rf"] == "rf"
    assert len({folder.casefold() for folder in found.values()}) == len(people)


@pytest.mark.parametrize("who", ["zoe.", "_zoe", "zo'e"])
def test_a_user_of_nearly_anothers_name_has_another_folder(bare, tmp_path, who):
    """What nbgrader collected is the user's whose name it has as it stands, not once cleaned."""
    for owner in ("zoe", "ada"):
        folder = bare.submitted / owner / NAME
        folder.mkdir(parents=True)
        (folder / f"{NAME}.ipynb").write_text(owner)
    handed_in(tmp_path / "in", who, "forged", "2099-03-05 10:00:00 UTC")
    handed_in(tmp_path / "in", "ada", "ada again", "2099-03-05 10:00:00 UTC")
    take(bare, tmp_path / "in", unverified=True)
    (other,) = {folder for folder, text in counting(bare).items() if text == "forged"}
    assert re.fullmatch(r"zoe-[0-9a-f]{8}", other)
    assert counting(bare) == {"zoe": "zoe", other: "forged", "ada": "ada again"}


def test_what_is_not_a_hand_in_is_named(bare, tmp_path):
    """A link, a file, a folder without time or notebook; others' work is taken all the same."""
    inbound = handed_in(tmp_path / "in", "root", "1").parent
    handed_in(inbound, "root", "2", when="soon")
    (inbound / f"root+{NAME}+2026-03-02 10:00:00 UTC+a").mkdir()
    (inbound / f"root+{NAME}+2026-03-02 10:00:00 UTC+b").symlink_to("/etc")
    (inbound / f"root+{NAME}+2026-03-02 10:00:00 UTC+c").write_text("x")
    (inbound / os.fsdecode(b"\xff+" + NAME.encode() + b"+2026-03-02 10:00:00 UTC+d")).mkdir()
    said = " ".join(troubles(bare, inbound))
    for words in ("it states no time", "it holds no notebook", "it is a link or a file"):
        assert words in said
    assert "\ufffd+01_paths+2026-03-02 10:00:00 UTC+d: not taken; no user can have such a" in said
    assert counting(bare) == {"root": "1"}


def test_a_secret_that_is_a_link_is_not_followed(bare, tmp_path):
    """A student cannot have another's file copied to where feedback is made."""
    folder = handed_in(tmp_path / "in", "root", "1")
    (folder / SECRET).unlink()
    (folder / SECRET).symlink_to("/etc/passwd")
    written_at(folder, "2026-03-01 10:00:00 UTC")
    (said,) = troubles(bare, folder.parent)
    assert f"not taken; {SECRET} is a link" in said
    assert not counting(bare)


def test_collect_waits_for_nothing_and_follows_nobody(bare, tmp_path, monkeypatch):
    """A pipe, a link or a huge file costs its own student, in words."""
    monkeypatch.setattr("labkit.grader.students.exchange.read_file", partial(read_file, most=1))
    folders = [handed_in(tmp_path / "in", who, "x") for who in ("ada", "bob", "carl")]
    pipe, link, huge = (folder / f"{NAME}.ipynb" for folder in folders)
    pipe.unlink()
    os.mkfifo(pipe)
    link.unlink()
    link.symlink_to("/etc/passwd")
    huge.write_bytes(b" " * 2**21)
    for folder in folders:
        written_at(folder, "2026-03-01 10:00:00 UTC")
    said = troubles(bare, tmp_path / "in", unverified=True)
    words = ("is not a file", "is a link or cannot be opened", "has 2 MiB, the limit is 1 MiB")
    assert [word in x for word, x in zip(words, said, strict=True)] == [True] * 3
    assert not counting(bare)


# Zips

BOB = (f"{MOODLE.format('Bob', 2)}/{NAME}.ipynb", "bob's")
ADA = f"{MOODLE.format('Ada', 1)}/n.ipynb"


def spoilt(path, change):
    """A zip with Ada's entry, which somebody changed, and Bob's."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        info = zipfile.ZipInfo(ADA, (2026, 3, 1, 12, 0, 0))
        change(info)
        archive.writestr(info, b"ada's" * 1000)
        archive.writestr(*BOB)
    return path


def linked(info):
    info.external_attr = 0o120777 << 16


def outside(info):
    info.filename = f"{MOODLE.format('Ada', 1)}/../../evil.ipynb"


def absolute(info):
    info.filename = "/" + info.filename


def backwards(info):
    info.filename = info.filename.replace("/", "/..\\")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (linked, "it is a link"),
        (outside, "it leads out of the download"),
        (absolute, "it leads out of the download"),
        (backwards, "it leads out of the download"),
    ],
)
def test_an_entry_that_is_a_trap_is_named(bare, tmp_path, change, words):
    """It is not taken, nothing is written outside, and the next student's work is taken."""
    said = troubles(bare, spoilt(tmp_path / "1.zip", change))
    assert len(said) == 1 and words in said[0] and "ipynb" in said[0]
    assert counting(bare) == {"Bob-2": "bob's"}
    assert not list(tmp_path.rglob("evil*"))


def changed(path, *changes):
    """A zip in which bytes were changed: (where, by what), from the first central entry on."""
    data = bytearray(spoilt(path, lambda info: None).read_bytes())
    central = data.index(b"PK\1\2")
    for at, form, value in changes:
        struct.pack_into(form, data, central + at if at >= 0 else -at, value)
    path.write_bytes(data)
    return path


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([(8, "<H", 1)], "it is locked with a password"),
        ([(24, "<L", 10)], "damaged: Bad CRC-32"),  # says it is smaller than it is
        ([(24, "<L", 2**31)], "has 2048 MiB, the limit is 200 MiB"),
        ([(16, "<L", 0)], "damaged: Bad CRC-32"),
        ([(10, "<H", 99)], "damaged: "),  # an unknown way of packing
        ([(-30, "<B", 90)], "damaged: File name in directory"),  # another name in its own header
        ([(42, "<L", 10**6)], "damaged: "),  # lies elsewhere
    ],
)
def test_an_entry_that_lies_is_named(bare, tmp_path, changes, words):
    """Locked, of another size, another sum, another name, another place: the others are taken."""
    said = troubles(bare, changed(tmp_path / "1.zip", *changes))
    assert (
        len(said) == 1 and said[0].startswith("Ada-1: n.ipynb: not taken; ")
    ) or "locked" in words
    assert words in said[0]
    assert counting(bare) == {"Bob-2": "bob's"}


def test_a_bomb_is_not_unpacked(bare, tmp_path, monkeypatch):
    """However small it says it is, and however small it is packed."""
    monkeypatch.setattr("labkit.grader.students.platforms.NOTEBOOK", 1)
    path = tmp_path / "1.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(ADA, b" " * 2**22)
        archive.writestr(*BOB)
    assert "has 4 MiB, the limit is 1 MiB" in troubles(bare, path)[0]
    data = bytearray(path.read_bytes())
    struct.pack_into("<L", data, data.index(b"PK\1\2") + 24, 2**19)
    path.write_bytes(data)
    assert "damaged" in troubles(bare, path)[0]
    assert counting(bare) == {"Bob-2": "bob's"}


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_an_entry_that_is_there_twice_is_named_and_kept_twice(bare, tmp_path):
    """Neither is lost, and somebody looks which one counts."""
    said = troubles(bare, zipped(tmp_path / "1.zip", [(ADA, "1"), (ADA, "2"), BOB]))
    assert len(said) == 1 and "it is in the zip twice" in said[0]
    assert kept(bare, "Ada-1") == {"1", "2"}


def test_names_in_any_encoding(bare, tmp_path):
    """UTF-8 that is not announced is read; what is announced as UTF-8 and is not is damaged."""
    name = f"{MOODLE.format('Zoë', 3)}/n.ipynb"
    silent = zipped(tmp_path / "1.zip", [(name, "z"), BOB])
    data = silent.read_bytes()
    for at in (data.index(b"PK\3\4") + 7, data.index(b"PK\1\2") + 9):
        assert data[at] == 8
        data = data[:at] + b"\0" + data[at + 1 :]
    silent.write_bytes(data)
    assert not troubles(bare, silent)
    assert counting(bare) == {"Zoë-3": "z", "Bob-2": "bob's"}
    broken = zipped(tmp_path / "2.zip", [(name, "y"), BOB])
    broken.write_bytes(broken.read_bytes().replace("ë".encode(), b"\xff\xfe"))
    with pytest.raises(LabkitError, match=r"2\.zip is damaged: .*; download it again"):
        take(bare, broken)


def test_a_zip_in_a_zip_is_not_opened(bare, tmp_path):
    """It is said that this student handed in a zip."""
    inner = from_moodle(tmp_path / "inner.zip", [(("Eve", 9), "n.ipynb", "x")]).read_bytes()
    source = zipped(tmp_path / "1.zip", [(f"{MOODLE.format('Ada', 1)}/work.zip", inner), BOB])
    (said,) = troubles(bare, source)
    assert said == "Ada-1: work.zip: not taken; it is a zip; ask for the notebook itself"
    assert counting(bare) == {"Bob-2": "bob's"}


def test_a_damaged_download_is_a_sentence(bare, tmp_path):
    """Where the zip has no end, or nothing in it, nothing is taken."""
    path = zipped(tmp_path / "1.zip", [BOB])
    data = path.read_bytes()
    path.write_bytes(data.replace(b"PK\1\2", b"PK\1\3"))
    with pytest.raises(LabkitError, match=r"is damaged: .*; download it again"):
        take(bare, path)
    path.write_bytes(data[:-30])
    with pytest.raises(LabkitError, match="neither a folder nor a zip"):
        take(bare, path)
    with pytest.raises(LabkitError, match=f"nothing in .* was handed in for {NAME}"):
        take(bare, zipped(tmp_path / "2.zip", []))


# Records


def test_what_an_older_labkit_knew_is_read(bare, tmp_path):
    """A term in progress goes on: numbers stay, and one that was read greedily is put right."""
    import json

    old = {
        "Ada-Lovelace": {"system": "moodle", "number": "42", "name": "Ada Lovelace"},
        "Eve": {
            "system": "moodle",
            "number": "42",
            "name": "Eve Mallory_77_assignsubmission_file_x",
        },
    }
    (bare.root / "course_private").mkdir()
    (bare.root / FILE).write_text(json.dumps({NAME: old}))
    assert lms_users(bare, NAME)["Eve"] == LmsUser("moodle", "77", "Eve Mallory")
    people = [(("Ada Lovelace", 42), "x.ipynb", "a"), (("Eve Mallory", 77), "x.ipynb", "e")]
    take(bare, from_moodle(tmp_path / "1.zip", people))
    assert counting(bare) == {"Ada-Lovelace": "a", "Eve": "e"}


@pytest.mark.parametrize(
    ("file", "text"),
    [(FILE, text) for text in ("", "[]", '{"01_paths": 1}', '{"01_paths": {"ada": {"x": 1}}}')]
    + [(FILE, '{"01_paths": {"ada": {"system": "moodle", "number": 1, "name": ""}}}')]
    + [(ROSTER, text) for text in ("", "name\nada\n", "id\n../x\n", "id\nada\nADA\n", 'id\n"a\n')],
)
def test_a_damaged_record_is_a_sentence(bare, tmp_path, file, text, capsys):
    """Nothing is collected on a record that cannot be read, and the sentence says what to do."""
    (bare.root / "course_private").mkdir()
    (bare.root / file).write_text(text)
    source = zipped(tmp_path / "1.zip", [BOB])
    assert main(["collect", NAME, str(source), "--course", str(bare.root)]) == 2
    said = capsys.readouterr().err
    assert "is damaged" in said and "Traceback" not in said and "move it away" in said
    assert not counting(bare)


def test_the_command_says_what_wants_a_look_at_the_end(bare, tmp_path, capsys):
    """Exit 0 if nothing does, 1 if something does; no name speaks to the terminal."""
    name = MOODLE.format("Mona\x1b[2J", 3) + "/\x1b]0;owned\x07.ipynb"
    words = ["collect", NAME, "--course", str(bare.root)]
    assert main([*words, str(zipped(tmp_path / "1.zip", [(name, "m")]))]) == 0
    assert main([*words, str(zipped(tmp_path / "2.zip", [("\x1b[2J.ipynb", ""), BOB]))]) == 1
    said = capsys.readouterr()
    assert "\x1b" not in said.out + said.err and "\x07" not in said.out + said.err
    assert "[2J.ipynb: not taken; its name does not say who handed it in" in said.err
    assert f"Bob-2: {NAME}.ipynb: taken" in said.out


@pytest.mark.parametrize("platform", ["moodle", "canvas"])
def test_the_time_of_a_platforms_zip_makes_nobody_late(bare, tmp_path, platform):
    """--at is when the zip was made: Moodle's shows nobody late, Canvas's those marked LATE."""
    (bare.root / "course.toml").write_text(f"[assignments.{NAME}]\ndue = 2026-03-02T12:00:00\n")
    who = ("Ada", 1), ("Bob", 2)
    if platform == "moodle":
        source = from_moodle(tmp_path / "1.zip", [(x, f"{NAME}.ipynb", x[0]) for x in who])
    else:
        entries = [canvas_writes(*x, 9, f"{NAME}.ipynb", late=x[0] == "Bob") for x in who]
        source = zipped(tmp_path / "1.zip", [(entry, entry) for entry in entries])
    words = ["collect", NAME, str(source), "--course", str(bare.root), "--at", "2026-03-05 12:00"]
    assert main(words) == 0
    stamps = [x.read_text() for x in bare.submitted.glob("*/*/timestamp.txt")]
    assert stamps == ["2026-03-05 12:00:00+00:00"] * (platform == "canvas")
    assert '"exact": true' not in "".join(
        x.read_text() for x in bare.root.glob("attempts/**/*.json")
    )


def test_what_a_mac_puts_beside_files_is_passed_over(bare, tmp_path):
    """It is neither named nor taken, in a zip or in a folder; a file that begins alike is named."""
    mine = f"{MOODLE.format('Bob Hope', 102)}/{NAME}.ipynb"
    beside = ["__MACOSX/._x", ".DS_Store", "Bob Hope_102_assignsubmission_file/.DS_Store"]
    beside += [f"{mine[: -len(NAME) - 6]}__MACOSX/._{NAME}.ipynb", f"__MACOSX/{mine}"]
    odd = "x.DS_Store"
    source = zipped(tmp_path / "1.zip", [(name, "{}") for name in (mine, *beside, odd)])
    assert take(bare, source) == [
        f"{odd}: not taken; its name does not say who handed it in",
        f"Bob-Hope-102: {NAME}.ipynb: taken",
    ]
    for name in ("bob/x.ipynb", "__MACOSX/._x.ipynb", "bob/.DS_Store"):
        (tmp_path / "in" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "in" / name).write_text(name)
    said = take(bare, tmp_path / "in", named="{student}/*.ipynb")
    assert said == ["bob: x.ipynb: taken, as 01_paths.ipynb"]


def test_what_a_folder_has_for_a_student_and_is_no_notebook_is_named(bare, tmp_path):
    """As in a zip: a name in capitals is a notebook, and what a student handed in instead is named.

    Other files of a clone are passed over where the pattern asks for notebooks.
    """
    names = (f"cap/{NAME}.IPYNB", f"txt/{NAME}.ipynb.txt", f"jsn/{NAME}.json", "cap/README.md")
    for name in names:
        (tmp_path / "in" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "in" / name).write_text(name)
    source = zipped(tmp_path / "1.zip", [(name, name) for name in names])
    told = [
        "cap: README.md: not taken; it is not a notebook",
        f"cap: {NAME}.IPYNB: taken, as {NAME}.ipynb",
        f"jsn: {NAME}.json: not taken; it is not a notebook",
        f"txt: {NAME}.ipynb.txt: not taken; it is not a notebook",
    ]
    assert sorted(take(bare, tmp_path / "in", named="{student}/*")) == sorted(told)
    again = [x.replace(f"taken, as {NAME}.ipynb", "there already") for x in told]
    assert sorted(take(bare, source, named="{student}/*")) == sorted(again)
    assert sorted(take(bare, tmp_path / "in", named="{student}/*.ipynb")) == [
        f"cap: {NAME}.IPYNB: there already",
        f"txt/{NAME}.ipynb.txt: not taken; its name does not say who handed it in",
    ]


def test_who_handed_in_another_assignment_alone_is_named(bare, tmp_path):
    """In the clone of a whole term the other notebooks are passed over beside the right one."""
    for name in (f"ada/{NAME}.ipynb", "ada/00_warmup.ipynb", "hal/00_warmup.ipynb"):
        (tmp_path / "in" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "in" / name).write_text(name)
    assert take(bare, tmp_path / "in", named="{student}/*.ipynb") == [
        "hal: not taken; named after another assignment: 00_warmup.ipynb",
        f"ada: {NAME}.ipynb: taken",
    ]
    shutil.rmtree(tmp_path / "in/ada")
    with pytest.raises(LabkitError, match=f"nothing in .*in is for {NAME} and fits '{{student}}/"):
        take(bare, tmp_path / "in", named="{student}/*.ipynb")


def test_a_file_with_the_name_of_two_students_is_named_with_a_cure_that_helps(bare, tmp_path):
    """The roster is right, so the file needs another name: that of a student's folder, say."""
    roster(bare, "kim1,Kim,Lee,,,,", "kim2,Kim,Lee,,,,")
    for name, told in (
        ("Kim Lee", "Kim Lee/x.ipynb: not taken; 'Kim Lee' matches 2 students of the roster; name "
         "the file or folder by kim1 or kim2, or by a login or number, and collect again"),
        ("kim2", "kim2: x.ipynb: taken, as 01_paths.ipynb"),
        ("Jo", "Jo/x.ipynb: not taken; 'Jo' matches 0 students of the roster; correct the roster "
         "with labkit students import LIST.csv, and collect again"),
    ):  # fmt: skip
        work = tmp_path / name / name / "x.ipynb"
        work.parent.mkdir(parents=True)
        work.write_text("{}")
        assert take(bare, tmp_path / name, named="{student}/*.ipynb") == [told]


def test_a_time_to_come_is_refused(bare, tmp_path, capsys):
    """A year too late by a slip of the finger: the time, now, and what to write."""
    source = zipped(tmp_path / "1.zip", [BOB])
    words = ["collect", NAME, str(source), "--course", str(bare.root), "--at", "2098-03-05 12:00"]
    assert main(words) == 2 and not counting(bare)
    said = capsys.readouterr().err
    assert "'2098-03-05 12:00' is in the future, it is now 20" in said
    assert "write when the download was made" in said


def test_the_time_given_is_the_hand_in_time_of_loose_files(bare, tmp_path):
    """No platform says when they came, so --at does."""
    for name in ("ada", "bob"):
        (tmp_path / "in" / name).mkdir(parents=True)
        (tmp_path / "in" / name / f"{NAME}.ipynb").write_text(name)
    words = ["collect", NAME, str(tmp_path / "in"), "--named", "{student}/*.ipynb"]
    assert main([*words, "--course", str(bare.root), "--at", "2026-03-05 12:00"]) == 0
    stamps = [x.read_text() for x in bare.submitted.glob("*/*/timestamp.txt")]
    assert stamps == ["2026-03-05 12:00:00+00:00"] * 2


def test_two_do_not_collect_at_once(bare, tmp_path):
    """Two assistants do not write into one another's records."""
    source = zipped(tmp_path / "1.zip", [BOB])
    one = collect(bare, NAME, source)
    next(one)
    with pytest.raises(LabkitError, match="another command is collecting"):
        take(bare, source)
    one.close()


def test_names_and_work_go_with_the_term(bare, tmp_path):
    """The roster, the numbers and the attempts are ignored by git, and archived."""
    from labkit.grader.terms.term import archive

    roster(bare, "bob,Bob,,,,,")
    take(bare, zipped(tmp_path / "1.zip", [BOB]))
    ignored = (ROOT / ".gitignore").read_text().split()
    assert {"/attempts/", "/course_private/", "/submitted/"} <= set(ignored)
    written = ("term.csv", "01.csv", "class_report_01.md", "moodle.zip", "board.html")
    found = subprocess.run(["git", "-C", str(ROOT), "check-ignore", "--no-index", *written],
                           capture_output=True, text=True)  # fmt: skip
    assert found.stdout.split() == list(written), "under any name that a lecturer may give"
    folder = archive(bare)
    names = {x.name for x in folder.rglob("*")}
    assert {"attempts", "submitted", "roster.csv", "lms.json"} <= names
    assert not (bare.root / "attempts").exists() and not (bare.root / ROSTER).exists()


def test_a_download_without_an_end_is_refused(bare, tmp_path):
    """A pipe, and what leads to a device, are not waited for."""
    os.mkfifo(tmp_path / "pipe.zip")
    (tmp_path / "device.zip").symlink_to("/dev/zero")
    for name in ("pipe.zip", "device.zip"):
        with pytest.raises(LabkitError, match="is neither a file nor a folder; give the download"):
            list(collect(bare, NAME, tmp_path / name))
