"""Nothing that was handed in is lost, and the latest hand-in counts."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import zipfile
from pathlib import Path

import pytest
from downloaded import NAME, bare_course, counting, from_moodle, handed_in, kept, sentences, zipped
from hypothesis import given, settings
from hypothesis import strategies as st
from made import notebook_of, result_of

from labkit.errors import LabkitError
from labkit.grader.grading.results import Results
from labkit.grader.nbgrader.gradebook import open_gradebook, record, timestamp
from labkit.grader.students import attempts as attempts_module
from labkit.grader.students.attempts import attempts, perhaps_late
from labkit.grader.students.collect import collect
from labkit.grader.students.exchange import SECRET
from labkit.grader.students.installed import install, settle
from labkit.grader.students.roster import FILE as ROSTER

ADA = ("Ada Lovelace", 101)
plain = attempts_module._read


@pytest.fixture
def bare(tmp_path):
    return bare_course(tmp_path / "course")


def shown(path, day, *files):
    """A download that was made on a day of March, with files of Ada's."""
    return from_moodle(path, [(ADA, *file) for file in files], (2026, 3, day, 12, 0, 0))


def take(course, source, **options):
    return sentences(collect(course, NAME, source, **options))


def listed(course, *lines):
    """A roster: id, first and last name."""
    path = course.root / ROSTER
    path.parent.mkdir()
    path.write_text("\n".join(["id,first_name,last_name", *lines]) + "\n")


HISTORIES = st.lists(
    st.dictionaries(
        st.sampled_from(["Ada", "Bob", "Carl"]), st.sampled_from("abcd"), min_size=1, max_size=3
    ),
    min_size=1,
    max_size=5,
)


@settings(max_examples=12, deadline=None)
@given(st.data())
def test_in_any_order_the_latest_hand_in_counts(data):
    """Downloads of a class as it was on several days, taken in any order, any of them twice."""
    history = data.draw(HISTORIES)
    order = data.draw(st.permutations(range(len(history))))
    order += data.draw(st.lists(st.sampled_from(order), max_size=2))
    last: dict[str, str] = {}
    numbers = {"Ada": 65, "Bob": 66, "Carl": 67}
    with tempfile.TemporaryDirectory() as folder:
        course, sources = bare_course(Path(folder, "course")), []
        for day, handed_in_that_day in enumerate(history, start=1):
            last = last | handed_in_that_day
            files = [((who, numbers[who]), f"{NAME}.ipynb", text) for who, text in last.items()]
            when = (2026, 3, day, 12, 0, 0)
            sources.append(from_moodle(Path(folder, f"{day}.zip"), files, when))
        for number in order:
            take(course, sources[number])
        assert counting(course) == {f"{who}-{numbers[who]}": text for who, text in last.items()}
        for who in last:
            wrote = {that_day[who] for that_day in history if who in that_day}
            assert kept(course, f"{who}-{numbers[who]}") == wrote


def test_an_older_download_takes_no_newer_hand_ins_place(bare, tmp_path):
    """The lecturer finds last week's zip and collects it; this week's work still counts."""
    new = shown(tmp_path / "new.zip", 8, (f"{NAME}.ipynb", "new"))
    old = shown(tmp_path / "old.zip", 1, (f"{NAME}(2).ipynb", "old"))
    assert take(bare, new) == [f"Ada-Lovelace-101: {NAME}.ipynb: taken"]
    another = "another one, of 2026-03-08 12:00 UTC, counts"
    assert take(bare, old) == [f"Ada-Lovelace-101: {NAME}(2).ipynb: kept, but {another}"]
    assert counting(bare) == {"Ada-Lovelace-101": "new"}
    assert kept(bare, "Ada-Lovelace-101") == {"new", "old"}


def test_a_newer_hand_in_counts_and_the_earlier_one_is_kept(bare, tmp_path):
    """What was collected first lies where a person can look at it."""
    take(bare, shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "first")))
    said = take(bare, shown(tmp_path / "2.zip", 2, (f"{NAME}.ipynb", "second")))
    assert said == [
        f"Ada-Lovelace-101: {NAME}.ipynb: taken, in place of an earlier one, which is kept"
    ]
    first, _ = attempts(bare, "Ada-Lovelace-101", NAME)
    assert first.file.name == f"{NAME}.ipynb"
    assert first.file.parent.name.startswith("2026-03-01T")
    assert first.file.read_text() == "first"


def test_the_same_download_twice_changes_nothing(bare, tmp_path):
    """All files are as they were, to the byte."""
    download = shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "a"), ("sketch.ipynb", "b"))

    def everything():
        files = [path for path in sorted(bare.root.rglob("*")) if path.is_file()]
        return {path: path.read_bytes() for path in files if "solutions" not in path.parts}

    take(bare, download)
    before = everything()
    said = take(bare, download)
    assert everything() == before
    assert all("there already" in line for line in said)


def test_many_hand_ins_of_one_student_take_no_more_than_their_number(bare, tmp_path, monkeypatch):
    """The records are read a few times for each hand-in, however many there are."""
    read, names = [], [f"{NAME}({number}).ipynb" for number in range(40)]
    monkeypatch.setattr(attempts_module, "_read", lambda path: read.append(path) or plain(path))
    source = shown(tmp_path / "1.zip", 1, *((name, name) for name in names))
    for _ in range(2):
        said = take(bare, source)
        assert len(said) == len(names) == len(kept(bare, "Ada-Lovelace-101"))
    assert len(read) <= 10 * len(names)
    assert counting(bare) == {"Ada-Lovelace-101": names[-1]}


def test_collected_anew_a_hand_in_loses_a_time_that_nobody_knew(course, tmp_path):
    """As the changelog says: an older labkit took --at for the hand-in's own time."""
    data = notebook_of("ada")
    download = shown(tmp_path / "1.zip", 5, (f"{NAME}.ipynb", data))
    record_of, who = "attempts/Ada-Lovelace-101/01_paths/*/attempt.json", "Ada-Lovelace-101"

    def in_the_gradebook():
        take(course, download)
        result = result_of(course, who, data=data)
        Results(course, NAME).keep(result)
        record(course, NAME, [result])
        with open_gradebook(course) as book:
            return book.find_submission(NAME, who).timestamp

    take(course, download)
    (path,) = course.root.glob(record_of)
    path.write_text(path.read_text().replace('"exact": false', '"exact": true'))
    assert in_the_gradebook().day == 5, "collecting once more is not enough"
    for folder in ("attempts", "submitted"):
        (course.root / folder / who / NAME).rename(tmp_path / folder)
    assert in_the_gradebook() is None


def test_an_earlier_work_that_is_handed_in_again_counts_again(bare, tmp_path):
    """A, then B, then A: the platform shows A, so A counts; in any order of collecting."""
    days = {1: "A", 2: "B", 3: "A"}
    for day in (3, 2, 1):
        take(bare, shown(tmp_path / f"{day}.zip", day, (f"{NAME}.ipynb", days[day])))
    assert counting(bare) == {"Ada-Lovelace-101": "A"}
    assert kept(bare, "Ada-Lovelace-101") == {"A", "B"}


def test_a_hand_in_is_as_old_as_the_first_download_that_shows_it(bare, tmp_path):
    """A download after the deadline does not make late what an earlier one showed."""
    for day in (5, 2):
        take(bare, shown(tmp_path / f"{day}.zip", day, (f"{NAME}.ipynb", "a")))
    assert install(bare, "Ada-Lovelace-101", NAME).first.when.day == 2


def test_of_several_that_were_handed_in_together_the_one_called_as_the_assignment_counts(
    bare, tmp_path
):
    """A sketch beside it is not taken for it, and is kept; the highest number is the last."""
    names = [f"{NAME}.ipynb", f"{NAME}(2).ipynb", "zz-sketch-9.ipynb", "zz.ipynb"]
    said = take(bare, shown(tmp_path / "1.zip", 1, *((name, name) for name in names)))
    assert counting(bare) == {"Ada-Lovelace-101": f"{NAME}(2).ipynb"}
    assert f"Ada-Lovelace-101: zz.ipynb: kept, but {NAME}(2).ipynb counts" in said
    assert kept(bare, "Ada-Lovelace-101") == set(names)


def test_files_of_one_download_are_of_one_time(bare, tmp_path):
    """Platforms write a class's files one after the other; the last of them is not a newer one."""
    entries = [(f"Ada_1_assignsubmission_file/{name}.ipynb", name) for name in (NAME, "sketch")]
    zipped(tmp_path / "1.zip", entries[:1])
    with zipfile.ZipFile(tmp_path / "1.zip", "a") as archive:
        archive.writestr(zipfile.ZipInfo(entries[1][0], (2026, 3, 1, 12, 0, 30)), "sketch")
    take(bare, tmp_path / "1.zip")
    assert counting(bare) == {"Ada-1": NAME}


def test_what_lay_there_before_is_kept_too(bare, tmp_path):
    """An older labkit's, nbgrader's or a person's file makes room for a newer one, and stays."""
    listed(bare, "Ada-Lovelace,Ada,Lovelace")
    place = bare.submitted / "Ada-Lovelace" / NAME
    place.mkdir(parents=True)
    (place / f"{NAME}.ipynb").write_text("brought by mail")
    (place / "notes.txt").write_text("beside it")
    (place / SECRET).write_text("secret")
    os.utime(place / f"{NAME}.ipynb", (1e9, 1e9))
    take(bare, shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "handed in")))
    assert counting(bare) == {"Ada-Lovelace": "handed in"}
    assert kept(bare, "Ada-Lovelace") == {"brought by mail", "handed in"}
    assert (place / "notes.txt").exists() and not (place / SECRET).exists()
    (one,) = bare.root.glob(f"attempts/*/*/*/{SECRET}")
    assert one.read_text() == "secret"


def test_what_a_person_puts_there_counts_until_something_newer_is_handed_in(bare, tmp_path):
    """A lecturer lets the earlier attempt count by copying it back; a download shows no more."""
    take(bare, shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "first")))
    take(bare, shown(tmp_path / "2.zip", 2, (f"{NAME}.ipynb", "second")))
    path = bare.submitted / "Ada-Lovelace-101" / NAME / f"{NAME}.ipynb"
    path.write_text("first")
    take(bare, shown(tmp_path / "3.zip", 3, (f"{NAME}.ipynb", "second")))
    assert counting(bare) == {"Ada-Lovelace-101": "first"}
    later = from_moodle(
        tmp_path / "4.zip", [(ADA, f"{NAME}.ipynb", "third")], (2099, 1, 1, 0, 0, 0)
    )
    take(bare, later)
    assert counting(bare) == {"Ada-Lovelace-101": "third"}
    assert kept(bare, "Ada-Lovelace-101") == {"first", "second", "third"}


def test_only_the_exchange_says_when_work_was_handed_in(bare, tmp_path):
    """A zip has the time of the download; nobody is late by it, and no old time stays behind."""

    class Result:
        student, assignment = "root", NAME

    handed_in(tmp_path / "in", "root", "1", "2026-03-01 10:00:00 UTC")
    take(bare, tmp_path / "in")
    assert timestamp(bare, Result)[0].day == 1
    (bare.root / "course_private" / "lms.json").write_text(
        json.dumps({NAME: {"root": {"system": "moodle", "number": "101", "name": "root"}}})
    )
    zipped(
        tmp_path / "2.zip", [("root_101_assignsubmission_file/x.ipynb", "2")], (2026, 3, 2, 9, 0, 0)
    )
    take(bare, tmp_path / "2.zip")
    assert counting(bare) == {"root": "2"}
    assert timestamp(bare, Result) == (None, "")


def test_an_earlier_hand_in_that_is_put_back_keeps_its_time_and_secret(bare, tmp_path):
    """A lecturer lets the one in time count: it is in time, and its feedback goes back to it."""
    for day in (1, 2):
        handed_in(tmp_path / "in", "root", f"of day {day}", f"2026-03-0{day} 10:00:00 UTC")
    take(bare, tmp_path / "in")
    place = bare.submitted / "root" / NAME
    (place / f"{NAME}.ipynb").write_text("of day 1")
    take(bare, tmp_path / "in")
    assert counting(bare) == {"root": "of day 1"}
    assert (place / "timestamp.txt").read_text().startswith("2026-03-01")
    assert (place / SECRET).read_text() == "secret of of day 1"


DUE = f"[assignments.{NAME}]\ndue = 2026-03-03T00:00:00Z\n"
IN_TIME, LATEST = f'counts = "latest in time"\n{DUE}', f'counts = "latest"\n{DUE}'


def two_attempts(course, tmp_path, when="2026-03-01 10:00:00 UTC"):
    """Two hand-ins through the exchange, the second after the due date."""
    (course.root / "course.toml").write_text(LATEST)
    for data, time in (("first", when), ("second", "2026-03-05 10:00:00 UTC")):
        handed_in(tmp_path / "in", "root", data, time)
    take(course, tmp_path / "in")
    return course.submitted / "root" / NAME


@pytest.mark.parametrize("copy", [shutil.copy, shutil.copy2])
def test_an_attempt_that_is_put_back_has_its_own_time_without_collecting(bare, tmp_path, copy):
    """Also with the modification time of the copy's source; under either rule, the file stays."""
    place = two_attempts(bare, tmp_path)
    (kept_one,) = (x for x in bare.root.glob("attempts/*/*/*/*.ipynb") if x.read_text() == "first")
    os.utime(kept_one, (1e9, 1e9))
    copy(kept_one, place / f"{NAME}.ipynb")
    assert settle(bare, "root", NAME) == ""
    assert (place / "timestamp.txt").read_text().startswith("2026-03-01")
    for rule in (IN_TIME, LATEST):
        (bare.root / "course.toml").write_text(rule)
        assert (settle(bare, "root", NAME), counting(bare)) == ("", {"root": "first"})


def test_a_late_attempt_that_is_put_back_stays_where_only_work_in_time_counts(bare, tmp_path):
    """A person decided so, and it is as late as it was."""
    place = two_attempts(bare, tmp_path)
    (bare.root / "course.toml").write_text(IN_TIME)
    assert settle(bare, "root", NAME).startswith("now the file of 2026-03-01")
    (place / f"{NAME}.ipynb").write_text("second")
    assert (settle(bare, "root", NAME), counting(bare)) == ("", {"root": "second"})
    assert (place / "timestamp.txt").read_text().startswith("2026-03-05")


def test_an_attempt_of_unknown_time_that_is_put_back_has_no_time_of_another(bare, tmp_path):
    """A download before the due date shows it, so it is in time; after it, nobody knows."""
    (bare.root / "course.toml").write_text(LATEST)
    take(bare, shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "first")))
    take(bare, shown(tmp_path / "5.zip", 5, (f"{NAME}.ipynb", "second")))
    who = "Ada-Lovelace-101"
    place = bare.submitted / who / NAME
    (place / "timestamp.txt").write_text("2026-03-05 12:00:00+00:00")
    (place / f"{NAME}.ipynb").write_text("first")
    assert settle(bare, who, NAME) == "" and not (place / "timestamp.txt").exists()
    assert perhaps_late(bare, who, NAME) == ""
    (bare.root / "course.toml").write_text(DUE.replace("03-03", "02-01"))
    assert "only that it was there at 2026-03-01" in perhaps_late(bare, who, NAME)


def test_a_rule_that_changes_what_counts_is_never_silent(bare, tmp_path):
    """Grading names both files and changes nothing with --diff; so does collecting again."""
    two_attempts(bare, tmp_path)
    first = "now the file of 2026-03-01 10:00 UTC counts, instead of that of 2026-03-05 10:00 UTC"
    second = "now the file of 2026-03-05 10:00 UTC counts, instead of that of 2026-03-01 10:00 UTC"
    (bare.root / "course.toml").write_text(IN_TIME)
    would = first.removeprefix("now ").replace(" counts", " would count")
    assert settle(bare, "root", NAME, change=False) == would
    assert counting(bare) == {"root": "second"}
    assert settle(bare, "root", NAME) == first
    assert (settle(bare, "root", NAME), counting(bare)) == ("", {"root": "first"})
    (bare.root / "course.toml").write_text(LATEST)
    assert f"root: {second}" in take(bare, tmp_path / "in")
    assert counting(bare) == {"root": "second"}
    (bare.root / "course.toml").write_text(IN_TIME)
    said = take(bare, tmp_path / "in")
    assert said[-1] == f"root: {first}"
    assert "there already, but another" in "".join(said) and "a later one" not in "".join(said)


def test_a_file_that_was_never_collected_stays_and_counts(bare, tmp_path):
    """A mail's notebook in place of an attempt is what is graded."""
    place = two_attempts(bare, tmp_path)
    (place / f"{NAME}.ipynb").write_text("by mail")
    assert (settle(bare, "root", NAME), counting(bare)) == ("", {"root": "by mail"})


def test_a_collection_that_was_stopped_is_made_good(bare, tmp_path, monkeypatch):
    """Stopped between keeping and copying, the next one ends where this one would have."""
    take(bare, shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "first")))
    new = shown(tmp_path / "2.zip", 2, (f"{NAME}.ipynb", "second"))
    with monkeypatch.context() as patch:
        patch.setattr("labkit.grader.students.collect.install", lambda *_: 1 / 0)
        assert take(bare, new) == [
            "Ada-Lovelace-101: not taken; ZeroDivisionError: division by zero"
        ]
    assert counting(bare) == {"Ada-Lovelace-101": "first"}
    take(bare, new)
    assert counting(bare) == {"Ada-Lovelace-101": "second"}


def test_a_record_of_an_older_labkit_is_read(bare):
    """A term goes on with a newer one; the record calls what it holds as it did."""
    folder = bare.root / "attempts" / "ada" / NAME / "2026-03-01T120000Z-0"
    folder.mkdir(parents=True)
    when = {"when": "2026-03-01T12:00:00Z", "origin": "moodle", "number": "1", "file": "x.ipynb"}
    record = {"file": "x.ipynb", "sha256": "0", "seen": [when]}
    (folder / "attempt.json").write_text(json.dumps(record))
    (one,) = attempts(bare, "ada", NAME)
    assert (one.file, one.hand_ins[0].number) == (folder / "x.ipynb", "1")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"seen": [{"when": "soon"}]}', "\x00"])
def test_a_damaged_record_is_a_sentence_and_costs_nobody_else(bare, tmp_path, text):
    """The student whose record cannot be read is named; the others' work is taken."""
    take(bare, shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "first")))
    (record,) = bare.root.glob("attempts/*/*/*/attempt.json")
    record.write_text(text)
    both = [(ADA, f"{NAME}.ipynb", "second"), (("Bob", 102), f"{NAME}.ipynb", "bob's")]
    found = list(collect(bare, NAME, from_moodle(tmp_path / "2.zip", both, (2026, 3, 2, 1, 1, 0))))
    (bad,) = [one for one in found if not one.fine]
    assert bad.student == "Ada-Lovelace-101" and "is damaged; restore it" in bad.says
    assert counting(bare) == {"Ada-Lovelace-101": "first", "Bob-102": "bob's"}


def test_an_attempt_that_was_changed_does_not_count_as_handed_in(bare, tmp_path):
    """Somebody edits a file under attempts/; that is said before it gets a mark."""
    source = shown(tmp_path / "1.zip", 1, (f"{NAME}.ipynb", "first"))
    take(bare, source)
    (path,) = bare.root.glob("attempts/*/*/*/*.ipynb")
    path.write_text("better")
    with pytest.raises(LabkitError, match="was changed after it was handed in"):
        install(bare, "Ada-Lovelace-101", NAME)


def test_a_place_that_cannot_be_written_is_a_sentence(bare, tmp_path):
    """A folder where the notebook belongs, or a link where the folder does."""
    listed(bare, "Ada-Lovelace,Ada,Lovelace", "Bob,Bob,", "Carl,Carl,")
    (bare.submitted / "Ada-Lovelace" / NAME / f"{NAME}.ipynb").mkdir(parents=True)
    (bare.submitted / "Bob").symlink_to(tmp_path)
    both = [(ADA, f"{NAME}.ipynb", "1"), (("Bob", 2), f"{NAME}.ipynb", "2")]
    both += [(("Carl", 3), f"{NAME}.ipynb", "3")]
    found = list(collect(bare, NAME, from_moodle(tmp_path / "1.zip", both)))
    assert [one.student for one in found if not one.fine] == ["Ada-Lovelace", "Bob"]
    assert (bare.submitted / "Carl" / NAME / f"{NAME}.ipynb").read_text() == "3"
    assert not (tmp_path / NAME).exists()
