"""A term: its secret, the record of what was released, its archive, what is deleted."""

from __future__ import annotations

import glob
import json
import secrets
import shutil
from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from ..course.authoring.layout import Course
from ..course.own_arm import FILE as ARMS
from ..course.own_arm import HANDLES
from ..errors import LabkitError
from . import collect, roster
from .clean import how_many
from .files import write
from .release import release
from .rules import FILE as RULES
from .seeds import PSEUDONYMS, seed_of
from .submission import is_name

PERSONAL_FILES = (
    *("submitted", "autograded", "feedback", "results", "gradebook.db", "build/course/bundle"),
    *("build/course/defence", "build/course/explain"),
    *(collect.FOLDER, roster.FILE, HANDLES, collect.PARTICIPANTS, PSEUDONYMS),
)
"""The files that belong to one term, with students' names or keys to them, and hidden cases.

Git ignores all of them.
"""
_TERM = "course_private/term.json"
_OF_A_STUDENT = (
    *("submitted/{}", "attempts/{}", "autograded/{}", "feedback/{}"),
    *("results/*/{}.json", "build/course/defence/{}.html", "build/course/explain/{}"),
)
"""One student's files and folders within a term."""
_OF_THE_CLASS = (
    *(
        RULES,
        "gradebook.db",
        "course_private/*.*",
        "assignments/*/arms.json",
        "feedback/*/*/*.html",
    ),
)
"""Files that may name a student beside others."""


def running(course: Course) -> str:
    """The students, submissions and marks of the current term, in words; "" if none."""
    enrolled = len(roster.read_roster(course).students)
    submitted = len({path.parent for path in course.submitted.glob("*/*/*")})
    graded = len(list(course.results.glob("*/*.json")))
    counts = ((enrolled, "student"), (submitted, "submission"), (graded, "graded mark"))
    return ", ".join(how_many(n, what) for n, what in counts if n)


def new_term(course: Course, names: tuple[str, ...] = ()) -> dict[str, Any]:
    """Begin a term: archive the last one, release with a new secret, keep a record.

    Args:
        course: The course.
        names: The assignments to release; all by default.

    Returns:
        The record: the secret of 128 random bits, the date, the archive of the last term, and each
        bundle's hash, by which every result identifies its release.

    Raises:
        UnknownName: There is no such assignment.
    """
    names = names or course.names()
    for name in names:
        course.notebook_source(name)
    old = archive(course)
    record = {
        "secret": secrets.token_hex(16),
        "begun": datetime.now(UTC).date().isoformat(),
        "bundles": {},
    }
    record["archived"] = old.name if old else ""
    _keep(course, record)  # first, so that a failed release is repeated with this secret
    for name in names:
        release(course, name, seed_of(course))
    record["bundles"] = {
        path.stem: json.loads(path.read_text(encoding="utf-8"))["hash"]
        for path in sorted(course.bundle.glob("*.json"))
    }
    _keep(course, record)
    return record


def _keep(course: Course, record: dict[str, Any]) -> None:
    write(course.term, json.dumps(record, indent=1) + "\n")


def archive(course: Course) -> Path | None:
    """Move the personal files of the last term to an archive; None if there are none.

    The archive has the layout of the course.  The rules are copied, as most of them are used again;
    the students' arms are deleted from the students' notebooks.
    """
    for path in course.release.glob(f"*/{ARMS}"):
        path.unlink()
    there = [name for name in PERSONAL_FILES if (course.root / name).exists()]
    if not there:
        return None
    folder = course.root / "course_private" / datetime.now(UTC).strftime("archive-%Y-%m-%d-%H%M%S")
    while folder.exists():  # two in one second
        folder = folder.with_name(f"{folder.name}-2")
    folder.mkdir(parents=True)
    for name in (*there, *[_TERM] * course.term.exists()):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.move(course.root / name, folder / name)
    if (course.root / RULES).exists():
        shutil.copy(course.root / RULES, folder)
    return folder


def ended(course: Course, years: float) -> list[Path]:
    """The archives that were made at least ``years`` years ago, by the date in their names."""
    last = (datetime.now(UTC) - timedelta(days=365.25 * years)).date().isoformat()
    return [x for x in _archives(course) if x.name.removeprefix("archive-")[:10] <= last]


def of_student(course: Course, student: str) -> tuple[list[Path], list[Path]]:
    """What all terms hold about a student: files named after them, and files that name them.

    Raises:
        LabkitError: No student can have this name.
    """
    if not is_name(student) or "/" in student or student[:1] in {"", "."}:
        raise LabkitError(f"{student!a} is not the name of a student's folder")
    theirs, others = list[Path](), list[Path]()
    for term in (course.root, *_archives(course)):
        for pattern in _OF_A_STUDENT:
            theirs += sorted(term.glob(pattern.format(glob.escape(student))))
        shared = [x for pattern in _OF_THE_CLASS for x in sorted(term.glob(pattern))]
        shared = [x for x in shared if not set(theirs) & {x, *x.parents}]
        others += [x for x in shared if student.encode() in x.read_bytes()]
    return theirs, others


def delete(paths: Iterable[Path]) -> None:
    """Delete files and folders; links are deleted, not followed."""
    for path in paths:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def _archives(course: Course) -> list[Path]:
    return sorted((course.root / "course_private").glob("archive-*"))
