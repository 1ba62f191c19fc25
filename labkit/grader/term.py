"""A term: its secret, its archive, and what is deleted of a student."""

from __future__ import annotations

import glob
import json
import secrets
import shutil
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from ..course.authoring.layout import Course
from ..errors import LabkitError
from . import collect, roster
from .files import write
from .release import Released, release
from .rules import FILE as RULES
from .seeds import seed_of
from .submission import is_name

PERSONAL_FILES = (
    *("submitted", "autograded", "feedback", "results", "gradebook.db", "build/course/bundle"),
    *("build/course/defence", "build/course/explain"),
    *(collect.FOLDER, roster.FILE, collect.PARTICIPANTS, "course_private/term.json"),
)
"""The files that belong to one term, with students' names or keys to them, and hidden cases.

Git ignores all of them.
"""
_OF_A_STUDENT = (
    *("submitted/{}", "attempts/{}", "autograded/{}", "feedback/{}"),
    *("results/*/{}.json", "build/course/defence/{}.html", "build/course/explain/{}"),
)
"""One student's files and folders within a term."""
_OF_THE_CLASS = (RULES, "gradebook.db", "course_private/*.*")
"""Files that may name a student beside others."""


def new_term(
    course: Course, names: Sequence[str] = (), even_with_work: bool = False
) -> tuple[Path | None, list[Released]]:
    """Begin a term: archive the last one, and release with a new secret of 128 random bits.

    Args:
        course: The course.
        names: The assignments to release; all by default.
        even_with_work: Whether the last term may have students, submissions or marks.

    Returns:
        The archive of the last term, if there was one, and what was released.

    Raises:
        UnknownName: There is no such assignment.
        LabkitError: The term under way has students, submissions or marks.
    """
    for name in names:
        course.notebook_source(name)
    there = [x for x in ("submitted", "results", roster.FILE) if (course.root / x).exists()]
    if there and not even_with_work:
        raise LabkitError(f"the term has {', '.join(there)}; add --yes to archive all this")
    old = archive(course)
    record = {"secret": secrets.token_hex(16), "begun": datetime.now(UTC).date().isoformat()}
    write(course.term, json.dumps(record) + "\n")  # first: a failed release keeps this secret
    return old, [release(course, name, seed_of(course)) for name in names or course.names()]


def archive(course: Course) -> Path | None:
    """Move the personal files of the last term to an archive; None if there are none.

    The archive has the layout of the course.  The rules are copied, as most of them are used again.
    """
    there = [name for name in PERSONAL_FILES if (course.root / name).exists()]
    if not there:
        return None
    now = datetime.now(UTC)
    folder = course.root / "course_private" / now.strftime("archive-%Y-%m-%d-%H%M%S-%f")
    for name in there:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.move(course.root / name, folder / name)
    if (course.root / RULES).exists():
        shutil.copy(course.root / RULES, folder)
    return folder


def forget(course: Course, student: str, delete: bool) -> tuple[list[Path], list[Path]]:
    """Find, or delete, the files named after a student in all terms; and those that name them.

    Raises:
        LabkitError: No student can have this name.
    """
    if not is_name(student) or "/" in student or student[:1] in {"", "."}:
        raise LabkitError(f"{student!r} names no folder in submitted/")
    theirs, others = list[Path](), list[Path]()
    for term in (course.root, *sorted((course.root / "course_private").glob("archive-*"))):
        for pattern in _OF_A_STUDENT:
            theirs += sorted(term.glob(pattern.format(glob.escape(student))))
        shared = {x for pattern in _OF_THE_CLASS for x in term.glob(pattern)}
        others += sorted(x for x in shared if student.encode() in x.read_bytes())
    for path in theirs if delete else ():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    return theirs, others
