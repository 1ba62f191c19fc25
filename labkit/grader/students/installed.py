"""The file in ``submitted/``: nbgrader reads there the attempt that counts.

What a person puts there is an attempt too, and counts until the student hands in a newer one.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..submission import digest, read_file, students
from ..timestamp import TIMESTAMP, read_stamp, read_time
from .attempts import (
    BY_HAND,
    FOLDER,
    Attempt,
    Counted,
    HandIn,
    attempts,
    by_digest,
    choose,
    counted_attempt,
    put,
    store,
)
from .exchange import SECRET, read_secret
from .identity import identity_lock


def store_submitted(course: Course, student: str, assignment: str, now: str) -> dict[str, Attempt]:
    """Store what a person, nbgrader or an older labkit put into ``submitted/``.

    Args:
        course: The course.
        student: The student whose folder is searched.
        assignment: The assignment.
        now: The present time, in ISO 8601.

    Returns:
        All attempts of the student, by SHA-256 digest.

    Raises:
        LabkitError: A file cannot be read, or a record is damaged.
    """
    folder = course.submitted / student / assignment
    for path in (folder.parent, folder):
        if path.is_symlink():
            raise LabkitError(f"{path.relative_to(course.root)} is a link; put a folder there")
    there = by_digest(course, student, assignment)
    chosen = counted_attempt(course, student, assignment)
    for path in sorted(folder.glob("*.ipynb")):
        if path.is_symlink() or not path.is_file():
            raise LabkitError(f"{path.relative_to(course.root)} is not a file; move it away")
        data = read_file(path)
        one = there.get(digest(data))
        if one is None:
            stated = read_time(read_stamp(folder))
            when = stated or datetime.fromtimestamp(int(path.stat().st_mtime), UTC)
            exact = stated is not None
            hand_in = HandIn(when, BY_HAND, "", path.name, exact=exact, collected=now)
            store(course, student, assignment, data, hand_in, read_secret(folder), there)
        elif path.name == f"{assignment}.ipynb" and chosen and one.sha256 != chosen.attempt.sha256:
            _record_put_back(course, student, assignment, path, one, there)
    return there


def in_place(
    course: Course, student: str, assignment: str, there: Mapping[str, Attempt]
) -> Counted | None:
    """The attempt whose copy is in ``submitted/``; None if the file there is of no attempt.

    Args:
        course: The course.
        student: The student.
        assignment: The assignment.
        there: The student's attempts by SHA-256 digest.

    Raises:
        LabkitError: The file cannot be read.
    """
    path = course.submitted / student / assignment / f"{assignment}.ipynb"
    one = there.get(digest(read_file(path))) if there and path.exists() else None
    return choose([one], assignment) if one else None


def settle(course: Course, student: str, assignment: str, *, change: bool = True) -> str:
    """Bring ``submitted/`` up to the rule that says which attempt counts.

    A file of no attempt stays, and counts; a known one that a person put back is recorded as such.

    Args:
        course: The course.
        student: The student.
        assignment: The assignment.
        change: False if nothing may be written.

    Returns:
        A sentence if another file counts than the one in ``submitted/``; else "".

    Raises:
        LabkitError: A file cannot be read, or a record is damaged.
    """
    lies = in_place(course, student, assignment, by_digest(course, student, assignment))
    if lies is None:
        return ""
    path = course.submitted / student / assignment / f"{assignment}.ipynb"
    counted = counted_attempt(course, student, assignment)
    if counted is None or counted.attempt.sha256 != lies.attempt.sha256:
        if _put_back(path, lies.attempt):
            counted = lies
        if change:
            _record_put_back(course, student, assignment, path, lies.attempt)
    return instead(lies, install(course, student, assignment) if change else counted, change)


def date_put_back(course: Course, assignment: str, only: str | None = None) -> None:
    """Give each known attempt that a person put back its own time, also if nbgrader graded it."""
    if not (course.root / FOLDER).exists():
        return
    for student in students(course, assignment) if only is None else [only]:
        with suppress(LabkitError):  # grading and collecting name what cannot be read
            there = by_digest(course, student, assignment)
            lies = in_place(course, student, assignment, there)
            path = course.submitted / student / assignment / f"{assignment}.ipynb"
            if lies is not None and _put_back(path, lies.attempt):
                with identity_lock(course):
                    settle(course, student, assignment)


def instead(before: Counted | None, after: Counted | None, change: bool = True) -> str:
    """The sentence that another attempt counts than before, or would count; "" if none does."""
    if before is None or after is None or before.attempt.sha256 == after.attempt.sha256:
        return ""
    says = f"now {after} counts" if change else f"{after} would count"
    return f"{says}, instead of that of {before.came.when:%Y-%m-%d %H:%M %Z}"


def install(course: Course, student: str, assignment: str) -> Counted | None:
    """Copy the attempt that counts to the folder where nbgrader reads it.

    Returns:
        The attempt that counts; None if there is none.

    Raises:
        LabkitError: An attempt or its record is damaged.
    """
    chosen = counted_attempt(course, student, assignment)
    if chosen is None:
        return None
    source, when = chosen.attempt.file, chosen.first.when
    data = source.read_bytes()
    if digest(data) != chosen.attempt.sha256:
        raise LabkitError(f"{source} was changed after it was handed in; restore it")
    folder = course.submitted / student / assignment
    path = folder / f"{assignment}.ipynb"
    same = path.is_file() and path.read_bytes() == data
    secret = read_secret(source.parent)
    stated = [x.when for x in (chosen.came, *chosen.attempt.hand_ins) if x.exact]
    if not stated and chosen.came.late:  # the platform gives no earlier time
        stated = [chosen.came.when]
    stamp = str(stated[0]).encode() if stated else None
    stale = not same or (stamp is None and _of_another(course, chosen, folder))
    for name, content in ((TIMESTAMP, stamp), (SECRET, secret)):
        if content is not None:
            put(folder / name, content)
        elif stale:
            (folder / name).unlink(missing_ok=True)  # its own attempt still has a copy
    if not same:
        put(path, data)
        os.utime(path, (when.timestamp(), when.timestamp()))
    return chosen


def _put_back(path: Path, one: Attempt) -> datetime | None:
    """When a person put a known attempt there; None if `install` did, which sets a hand-in's time.

    A copy may have the time of its source, and then the change of its inode is the later one.
    """
    about = path.stat()
    if int(about.st_mtime) in {int(x.when.timestamp()) for x in one.hand_ins}:
        return None
    return datetime.fromtimestamp(int(max(about.st_mtime, about.st_ctime)), UTC)


def _record_put_back(
    course: Course,
    student: str,
    assignment: str,
    path: Path,
    one: Attempt,
    there: dict[str, Attempt] | None = None,
) -> None:
    """Record a known attempt as put there by a person, if one did."""
    if back := _put_back(path, one):
        hand_in = HandIn(back, BY_HAND, "", path.name, collected=str(datetime.now(UTC)))
        store(course, student, assignment, path.read_bytes(), hand_in, None, there)


def _of_another(course: Course, chosen: Counted, folder: Path) -> bool:
    """Whether the time beside a file is that of another attempt of the student."""
    when = read_time(read_stamp(folder))
    theirs = attempts(course, folder.parent.name, folder.name) if when else ()
    others = (one for one in theirs if one.sha256 != chosen.attempt.sha256)
    return any(x.when == when for one in others for x in one.hand_ins)
