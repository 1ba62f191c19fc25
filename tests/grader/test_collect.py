"""Collecting: whose work it is says the platform, and nobody's is lost for another's sake."""

from __future__ import annotations

import struct
import tempfile
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import pytest
from downloaded import (
    CLASS,
    NAME,
    bare_course,
    canvas_writes,
    counting,
    from_moodle,
    handed_in,
    kept,
    moodle_writes,
    take,
    zipped,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader.collect import SECRET, participants, reading
from labkit.grader.roster import FILE, Student, save_roster

NOBODY = 64990
"""A user number that this machine does not know."""
ADA, EVE = ("Ada Lovelace", 101), ("Eve Mallory", 102)
PIECES = st.sampled_from(
    ["_42_assignsubmission_file", "_", "_7_99_", "LATE_", "_1", "9_", "42_", " ", "/", "Ada",
     "assignsubmission_onlinetext", "-", ".", "é", "०१", "\x1b[2J", "(3)", "01_curves"]
)  # fmt: skip
TEXTS = st.lists(PIECES | st.text(max_size=3), max_size=8).map("".join)
FILES = TEXTS.map(lambda text: text.replace("/", "") + ".ipynb")


@pytest.fixture
def bare(tmp_path):
    return bare_course(tmp_path / "course")


# Whose it is


@given(TEXTS, st.integers(1, 10**15), FILES, st.booleans())
@example("Eve Mallory", 77, "x_42_assignsubmission_file_01_curves(9).ipynb", False)
def test_a_file_from_moodle_is_the_participants(name, number, file, in_folders):
    """Whatever people and files are called, the first number is the participant's."""
    found = reading(moodle_writes(name, number, file, in_folders))
    assert not found or (found["moodle"], found["column"]) == (str(number), "name")
    assert found or not in_folders


@given(TEXTS, st.integers(1, 10**15), st.integers(10**6, 10**9), FILES, st.booleans())
@example("a_1", 77, 10**6, "x.ipynb", False)
def test_a_file_from_canvas_is_the_users_or_nobodys(name, user, attachment, file, late):
    """Whatever people and files are called; a name that could be read in two ways is left."""
    found = reading(canvas_writes(name, user, attachment, file, late))
    assert not found or (found["value"], found["exact"]) == (str(user), late)


@settings(max_examples=20, deadline=None)
@given(st.dictionaries(st.integers(1, 99), st.tuples(TEXTS, FILES), min_size=1, max_size=5))
def test_everybody_has_their_own_work_or_none(people):
    """Whatever a class and its files are called: what counts for one has their number in it."""
    with tempfile.TemporaryDirectory() as folder:
        listed = [Student(f"s{k}", name[:30]) for k, (name, _) in people.items()]
        course = bare_course(Path(folder, "course"), *listed)
        entries = [
            (moodle_writes(name, k, f"{k} {file}"), str(k)) for k, (name, file) in people.items()
        ]
        list(take(course, zipped(Path(folder, "1.zip"), entries)))
        assert participants(course).get(NAME, {}).items() >= counting(course).items()


def test_two_who_are_called_alike_are_left(bare, tmp_path):
    """In one download, or after one of them was collected; nothing that is there changes."""
    both = [(ADA, "x.ipynb", "ada's"), (("Ada Lovelace", 103), "x.ipynb", "another's")]
    _, left = take(bare, from_moodle(tmp_path / "1.zip", both))
    assert left and not counting(bare)
    take(bare, from_moodle(tmp_path / "2.zip", both[:1]))
    for files in (both, both[1:], [(("Eve Mallory", 101), "x.ipynb", "eve's")]):
        _, left = take(bare, from_moodle(tmp_path / "3.zip", files, (2026, 3, 9, 12, 0, 0)))
        assert left and counting(bare) == {"ada": "ada's"}
    save_roster(bare, [*CLASS, Student("ada-2", "Ada", "Lovelace")])
    _, left = take(bare, from_moodle(tmp_path / "2.zip", both[:1]))
    assert left and kept(bare, "ada") == {"ada's"} and not kept(bare, "ada-2")


def test_who_is_not_in_the_roster_is_listed_and_left(bare, tmp_path):
    """On every platform, once for all files; without a roster nothing is collected."""
    zoe = [
        (("Zoe Kay", 9), "x.ipynb", "z"),
        (("Zoe May", 8), "x.ipynb", "z"),
        (ADA, "x.ipynb", "a"),
    ]
    source = from_moodle(tmp_path / "1.zip", zoe)
    taken, left = take(bare, source)
    assert len(left) == 1 and "Zoe Kay" in left[0] and "Zoe May" in left[0]
    assert counting(bare) == {"ada": "a"} and any(x.startswith("ada") for x in taken)
    words = ["collect", NAME, str(source), "--course", str(bare.root)]
    assert main(words) == 1
    (bare.root / FILE).unlink()
    assert main(words) == 2


def test_canvas_knows_its_users_by_number(bare, tmp_path):
    """Never by a name."""
    entries = [
        ("lovelaceada_42_900_x.ipynb", "ada's"),
        ("lovelaceada_99_901_x.ipynb", "no one's"),
        ("lovelaceada_42_77_902_x.ipynb", "eve's, who calls herself so"),
        ("malloryeve_LATE_77_903_42_90_01_curves.ipynb", "eve's"),
    ]
    _, left = take(bare, zipped(tmp_path / "1.zip", entries))
    assert counting(bare) == {"ada": "ada's", "eve": "eve's"}
    copy, stranger = left
    assert copy.startswith("eve: ") and "lovelaceada_99" in stranger
    stamp = (bare.submitted / "eve" / NAME / "timestamp.txt").read_text()
    assert datetime.fromisoformat(stamp).date().isoformat() == "2026-03-01", "late by Canvas's word"
    assert not (bare.submitted / "ada" / NAME / "timestamp.txt").exists()


# nbgrader's exchange


def test_a_folder_of_the_exchange_belongs_to_the_user_who_owns_it(bare, tmp_path):
    """The name alone is a claim: Eve's folder with another's name is left."""
    save_roster(bare, [Student("root", login="root"), *CLASS])
    inbound = tmp_path / "inbound"
    handed_in(inbound, "root", "mine")
    handed_in(inbound, "root", "eve's", "2026-03-02 10:00:00 UTC", owner=NOBODY)
    handed_in(inbound, "ada", "ada's")
    handed_in(inbound, "root", "other", name="02_essays")
    (inbound / f"eve+{NAME}+2026-03-01 10:00:00 UTC").mkdir()
    _, left = take(bare, inbound)
    assert counting(bare) == {"root": "mine"} and len(left) == 1
    take(bare, inbound, unverified=True)
    assert counting(bare) == {"root": "mine", "ada": "ada's"}
    beside = bare.submitted / "root" / NAME
    assert (beside / SECRET).read_text() == "secret of mine"
    assert datetime.fromisoformat((beside / "timestamp.txt").read_text()) == datetime(
        2026, 3, 1, 10, tzinfo=UTC
    )


@pytest.mark.parametrize("name", [f"{NAME}.ipynb", SECRET])
def test_a_link_in_the_exchange_leads_nowhere(bare, tmp_path, name):
    """Neither as a notebook nor as a secret."""
    folder = handed_in(tmp_path / "in", "ada", "x")
    (folder / name).unlink()
    (folder / name).symlink_to(bare.root / FILE)
    handed_in(tmp_path / "in", "eve", "eve's")
    _, left = take(bare, folder.parent, unverified=True)
    assert left and counting(bare) == {"eve": "eve's"}


# Which one counts


def test_the_newest_counts_and_every_one_is_kept(bare, tmp_path):
    """An older download replaces nothing, and the same one again changes nothing."""
    days = {k: (2026, 3, k, 12, 0, 0) for k in (1, 2, 3)}
    zips = {
        k: from_moodle(tmp_path / f"{k}.zip", [(ADA, "x.ipynb", str(k))], days[k]) for k in days
    }
    for k, count in ((2, "2"), (1, "2"), (2, "2"), (3, "3"), (1, "3")):
        take(bare, zips[k])
        assert counting(bare) == {"ada": count}
    assert kept(bare, "ada") == {"1", "2", "3"}


def test_of_several_files_the_one_named_for_the_assignment_counts(bare, tmp_path):
    """Also with the number that a browser adds."""
    names = ("notes.txt", f"{NAME}(2).ipynb", "zz.ipynb")
    take(bare, from_moodle(tmp_path / "1.zip", [(ADA, x, x) for x in names]))
    assert counting(bare) == {"ada": f"{NAME}(2).ipynb"}
    assert kept(bare, "ada") == set(names[1:])


def test_what_a_person_put_there_counts_until_something_newer_comes(bare, tmp_path):
    """It is kept too, when a new hand-in takes its place."""
    source = partial(from_moodle, tmp_path / "1.zip")
    take(bare, source([(ADA, "x.ipynb", "first")]))
    path = bare.submitted / "ada" / NAME / f"{NAME}.ipynb"
    path.write_text("by hand")
    take(bare, source([(ADA, "x.ipynb", "first")]))
    assert counting(bare) == {"ada": "by hand"}
    take(bare, source([(ADA, "x.ipynb", "second")], (2035, 3, 10, 12, 0, 0)))
    assert counting(bare) == {"ada": "second"}
    assert kept(bare, "ada") == {"first", "by hand", "second"}


def test_the_time_is_the_platforms_or_the_instructors(bare, tmp_path):
    """Moodle's zip has none, so that nobody is late; --at gives one to all."""
    (bare.root / "course.toml").write_text("[assignments.01_curves]\ndue = 2026-02-01T12:00:00\n")
    source = from_moodle(tmp_path / "1.zip", [(ADA, "x.ipynb", "1")])
    stamp = bare.submitted / "ada" / NAME / "timestamp.txt"
    taken, _ = take(bare, source)
    assert not stamp.exists() and "nobody is late" in taken[-1]
    source = from_moodle(tmp_path / "1.zip", [(ADA, "x.ipynb", "2")])
    words = ["collect", NAME, str(source), "--course", str(bare.root)]
    assert main([*words, "--at", "2026-03-02 12:00"]) == 0
    assert datetime.fromisoformat(stamp.read_text()) == datetime(2026, 3, 2, 12, tzinfo=UTC)
    assert main([*words, "--at", "noon"]) == 2


# What a download may hold


def test_a_file_too_large_or_damaged_costs_its_owner_alone(bare, tmp_path, monkeypatch):
    """Whatever size the zip states."""
    monkeypatch.setattr("labkit.grader.collect.NOTEBOOK", 1)
    source = from_moodle(tmp_path / "1.zip", [(EVE, "x.ipynb", "e" * 2**21), (ADA, "x.ipynb", "a")])
    data = bytearray(source.read_bytes())
    at = data.index(b"PK\x01\x02") + 24
    data[at : at + 4] = struct.pack("<I", 10)
    source.write_bytes(data)
    taken, left = take(bare, source)
    assert counting(bare) == {"ada": "a"} and len(left) == 1 and len(taken) == 1


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04", b"no zip", b"PK\x05\x06" + bytes(18)])
def test_what_is_no_download_is_a_sentence(bare, tmp_path, data):
    """An empty file, half a zip, another file, a zip of nothing, nothing, a folder."""
    path = tmp_path / "x.zip"
    path.write_bytes(data)
    for source in (path, tmp_path / "nowhere", tmp_path / "course"):
        with pytest.raises(LabkitError):
            take(bare, source)
