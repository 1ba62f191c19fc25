"""Downloads in the formats of platforms, and courses that collect them."""

from __future__ import annotations

import os
import re
import shutil
import zipfile
from pathlib import Path

from handmade import ROOT

from labkit.course.authoring.layout import Course
from labkit.grader.timestamp import read_time

NAME = "01_paths"
MOODLE = "{}_{}_assignsubmission_file"


def bare_course(root):
    """A course without a release, which is enough for collecting."""
    root.mkdir(parents=True, exist_ok=True)
    (root / "solutions").symlink_to(ROOT / "solutions")
    shutil.copy(ROOT / "nbgrader_config.py", root)
    return Course(root)


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
    written_at(folder, when)
    if owner is not None:
        os.chown(folder, owner, owner)
    return folder


def written_at(folder, when):
    """Set the times of last writing of a folder and its files to `when`, if that is a time."""
    if (time := read_time(when)) is not None:
        for path in (*folder.iterdir(), folder):
            os.utime(path, (time.timestamp(), time.timestamp()), follow_symlinks=False)


def counting(course, name=NAME):
    """The contents of the notebooks that count, by student."""
    found = course.submitted.glob(f"*/{name}/{name}.ipynb")
    return {path.parents[1].name: path.read_text() for path in found}


def sentences(found):
    """The sentences of `collect` about students and files, and those that need attention."""
    return [str(one) for one in found if one.student or one.file or not one.fine]


def kept(course, student, name=NAME):
    """The contents of a student's attempts."""
    folder = Path(course.root, "attempts", student, name)
    return {path.read_text() for path in folder.glob("*/*.ipynb")}
