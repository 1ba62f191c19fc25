"""nbgrader's exchange: the hand-ins in its inbound folder, and feedback on its way back.

A student's own process makes the folder ``USER+ASSIGNMENT+TIME+RANDOM``, so USER is only a claim:
the folder must belong to that user of this machine.  TIME is taken as nbgrader takes it.  The
exchange identifies a hand-in by a secret that came with it (``nbgrader.exchange``).
"""

from __future__ import annotations

import os
import pwd
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...course.authoring.layout import Course
from ..clean import clean_line
from ..each import Failure, for_student
from ..submission import read_file
from ..timestamp import TIMESTAMP, read_time

if TYPE_CHECKING:
    from .collect import File

SECRET = "submission_secret.txt"


def in_exchange(folder: Path, assignment: str, unverified: bool) -> Iterator[File]:
    """The notebooks in the inbound folder of nbgrader's exchange.

    Args:
        folder: The inbound folder.
        assignment: The assignment to collect.
        unverified: Whether to take folders of users whom this machine does not know.
    """
    from .collect import File

    def of(path: Path, user: str, stated: str) -> Iterator[File]:
        label, when = clean_line(path.name), read_time(stated)
        refused = _not_theirs(user, path, unverified)
        notebooks = [] if refused else sorted(path.glob("*.ipynb"))
        if when is None or not notebooks:
            why = refused or "they state no time, or hold no notebook"
            yield File(label, datetime.now(UTC), bytes, refused=why)
            return
        for notebook in notebooks:
            column = "email" if "@" in user else "login"
            about: dict[str, Any] = {"column": column, "value": user, "exact": True}
            about |= {"name": clean_line(notebook.name), "secret": partial(read_secret, path)}
            yield File(label, when, partial(read_file, notebook), **about)

    for path in sorted(folder.iterdir()):
        user, name, stated, *_ = (*path.name.rsplit("+", 3), "", "")
        if name == assignment:
            found: list[File] | Failure = for_student(user, list, of(path, user, stated))
            if isinstance(found, Failure):
                label, now = clean_line(path.name), datetime.now(UTC)
                found = [File(label, now, bytes, refused=found.why)]
            yield from found


def _not_theirs(user: str, path: Path, unverified: bool) -> str:
    """Why a folder does not belong to the user in its name; "" if it does."""
    if path.is_symlink() or not path.is_dir() or not os.access(path, os.R_OK | os.X_OK):
        return "they are links, or cannot be read"
    try:
        known = pwd.getpwnam(user).pw_uid
    except (KeyError, ValueError):
        return "" if unverified else "this machine does not know these users; see --unverified"
    if path.lstat().st_uid == known:
        return ""
    return "another user than the one in the name owns them; possibly an attempt to cheat"


def read_secret(folder: Path) -> bytes | None:
    """The secret beside a submission; None if it did not come through the exchange.

    Raises:
        LabkitError: The file is a link, or too large.
    """
    path = folder / SECRET
    return read_file(path, 1) if os.path.lexists(path) else None


def for_exchange(course: Course, assignment: str, pages: Iterable[Path]) -> list[bool | Failure]:
    """Put the files that ``nbgrader release_feedback`` needs beside the students' pages.

    Args:
        course: The course.
        assignment: The assignment.
        pages: The pages, as ``feedback/STUDENT/ASSIGNMENT/NAME.html``.

    Returns:
        For each page, whether the submission came through the exchange; or what failed.
    """

    def lay(page: Path, submitted: Path) -> bool:
        secret = read_secret(submitted)
        if secret is not None:
            (page.parent / SECRET).write_bytes(secret)
            stamp = submitted / TIMESTAMP
            (page.parent / TIMESTAMP).write_bytes(read_file(stamp, 1) if stamp.exists() else b"")
        return secret is not None

    of = {page: page.parents[1].name for page in pages}
    return [
        for_student(student, lay, page, course.submitted / student / assignment)
        for page, student in of.items()
    ]
