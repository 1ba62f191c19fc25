"""Downloads in the formats of platforms, and courses that collect them."""

from __future__ import annotations

import os
import re
import zipfile

from courses import synthetic
from handmade import NAME

from labkit.grader.collect import collect
from labkit.grader.roster import Student, save_roster

MOODLE = "{}_{}_assignsubmission_file"
CLASS = (
    Student("ada", "Ada", "Lovelace", "ada@x.test", "42", "ada", "4711"),
    Student("eve", "Eve", "Mallory", "eve@x.test", "77", "eve", "4712"),
)


def bare_course(root, *students):
    """A course without a release, which is enough for collecting, with a roster."""
    course = synthetic(root)
    save_roster(course, students or CLASS)
    return course


def zipped(path, entries, when=(2026, 3, 1, 12, 0, 0)):
    """Write a zip whose entries all have the same time."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in entries:
            archive.writestr(zipfile.ZipInfo(name, when), data)
    return path


def from_moodle(path, files, when=(2026, 3, 1, 12, 0, 0)):
    """Write Moodle's zip of files, each given as ((name, number), file, data)."""
    entries = [(f"{MOODLE.format(*who)}/{file}", data) for who, file, data in files]
    return zipped(path, entries, when)


def moodle_writes(name, number, file, in_folders=True):
    """Moodle's name for an entry (``mod/assign/classes/downloader.php``)."""
    name = re.sub(r"[\x00-\x1f\x7f&<>\"`|':\\/]", "", name.replace("_", " "))
    name = re.sub(r"\.\.+", "", name)
    return MOODLE.format(name, number) + ("/" if in_folders else "_") + file


def canvas_writes(name, user, attachment, file, late):
    """Canvas's name for an entry (``lib/content_zipper.rb``)."""
    name = re.sub(r"_([0-9]+)_", r"\1", name).lower()
    name = re.sub(r"\W", "", "_".join([name, *["LATE"] * late, str(user)]))
    return f"{name}_{attachment}_" + re.sub(r'[\x00/\\:*?"<>|]+', "_", file)


def handed_in(inbound, user, data, when="2026-03-01 10:00:00 UTC", name=NAME, owner=None):
    """A hand-in in the form of nbgrader's exchange."""
    folder = inbound / f"{user}+{name}+{when}+{len(list(inbound.glob('*')))}"
    folder.mkdir(parents=True)
    (folder / f"{name}.ipynb").write_text(data)
    (folder / "submission_secret.txt").write_text(f"secret of {data}")
    if owner is not None:
        os.chown(folder, owner, owner)
    return folder


def take(course, source, at=None, unverified=False):
    """Collect a source: what was taken, and the sentences that want a look."""
    found = list(collect(course, NAME, source, at, unverified))
    return [str(x) for x in found if x.fine], [str(x) for x in found if not x.fine]


def counting(course, name=NAME):
    """The contents of the notebooks that count, by student."""
    found = course.submitted.glob(f"*/{name}/{name}.ipynb")
    return {path.parents[1].name: path.read_text() for path in found}


def kept(course, student, name=NAME):
    """The contents of all notebooks of a student that were collected."""
    return {x.read_text() for x in (course.root / "attempts" / student / name).glob("*.ipynb")}
