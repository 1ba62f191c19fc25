"""Submissions: who handed in, and how their files are found and read safely."""

from __future__ import annotations

import hashlib
import os
import stat
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from ..course.authoring.layout import Course
from ..errors import LabkitError
from .clean import clean_line, few
from .each import Failure

TIMESTAMP = "timestamp.txt"
"""The name of the file with the time of a hand-in, which nbgrader's exchange writes."""
NOTEBOOK = 200
"""The largest notebook that is read, in [MiB]; pictures in it are not read."""


@dataclass(frozen=True)
class Submission:
    """One student's files for one assignment.

    Attributes:
        student: The student who handed it in.
        assignment: The assignment.
        folder: The folder of the files.
    """

    student: str
    assignment: str
    folder: Path

    @classmethod
    def of(cls, course: Course, assignment: str, student: str) -> Submission:
        """The submission in the folder where nbgrader keeps it."""
        return cls(student, assignment, course.submitted / student / assignment)

    def read(self) -> tuple[bytes, str, str]:
        """The notebook's bytes, a note, and why there are none; at least one is empty."""
        if self.folder.is_symlink() or self.folder.parent.is_symlink():
            return b"", "", "the folder is a link; hand in the file itself"
        found = sorted(x for x in self.folder.glob("*.ipynb") if not x.name.startswith("."))
        named = [x for x in found if x.stem == self.assignment] or found
        if len(named) != 1:
            names = ", ".join(x.name[:60] for x in named[:5]) or "none"
            return b"", "", f"one notebook counts, {self.assignment}.ipynb; there is {names}"
        path = named[0]
        note = "" if path.stem == self.assignment else f"the file is called {path.name[:80]}"
        try:
            return read_file(path), note, ""
        except LabkitError as error:
            return b"", "", str(error)


def students(course: Course, name: str) -> list[str]:
    """The students who handed in an assignment, sorted; only those with an allowed name."""
    return [student for student in _folders(course, name) if is_name(student)]


def misnamed(course: Course, name: str) -> list[Failure]:
    """A failure for each folder whose name is unsafe for a database, page or terminal."""
    why = "a folder in submitted/ has this name; rename the folder and grade again"
    return [Failure(ascii(x), why) for x in _folders(course, name) if not is_name(x)]


def is_name(student: str) -> bool:
    """Whether a student may have this name: one clean line, which is not markup."""
    return clean_line(student) == student and not set(student) & set('<>"\\')


def plain_name(student: str) -> str:
    """A name as it may be shown: in plain letters if it is not allowed."""
    return student if is_name(student) else ascii(student)


def none_of(course: Course, assignment: str, student: str | None = None) -> str:
    """The message that a student, or everybody, has handed in nothing, and what to do."""
    if student and (found := students(course, assignment)):
        return f"no submission of {student!r} for {assignment}; there are {few(found)}"
    return f"nothing was handed in for {assignment}; type: labkit collect {assignment} DOWNLOAD.zip"


def _folders(course: Course, name: str) -> list[str]:
    return sorted(p.name for p in course.submitted.glob("*") if os.path.lexists(p / name))


def read_file(path: Path, most: int = NOTEBOOK) -> bytes:
    """A file that somebody else may have put there.

    Links are not followed: they could lead to somebody else's file.

    Args:
        path: The path of the file.
        most: The largest size, in [MiB].

    Raises:
        LabkitError: The file is too large, is not a plain file, or cannot be read.
    """
    says = f"{path.name[:80]} is a link or no file; hand in the notebook itself"
    try:
        with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:
            about = os.fstat(file.fileno())
            if not stat.S_ISREG(about.st_mode):
                raise LabkitError(says)
            check_size(about.st_size, most)
            return file.read()
    except OSError:
        raise LabkitError(says) from None


def digest(data: bytes) -> str:
    """The SHA-256 digest of a file's contents."""
    return hashlib.sha256(data).hexdigest()


def check_size(size: int, most: int) -> None:
    """Refuse a file that is larger than ``most``, in [MiB]."""
    if size > most * 2**20:
        raise LabkitError(f"the file has {size / 2**20:.0f} MiB, the limit is {most} MiB")


def read_stamp(folder: Path) -> str:
    """The text of the time file beside a submission; empty if there is none."""
    try:
        return read_file(folder / TIMESTAMP, 1).decode(errors="replace")[:200].strip()
    except LabkitError:
        return ""


def read_time(text: str) -> datetime | None:
    """The time in a text, in UTC if the text names no zone; None if it is not clear.

    It is ISO 8601 or nbgrader's own form, ``2026-11-06 10:00:00.000000 UTC``.
    """
    try:
        when = datetime.fromisoformat(text.removesuffix(" UTC") + "Z" * text.endswith(" UTC"))
        when = (when if when.tzinfo else when.replace(tzinfo=UTC)).astimezone(UTC)
    except (ValueError, OverflowError):
        return None
    return when if 2000 <= when.year < 2100 else None
