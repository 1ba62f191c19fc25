"""nbgrader's exchange: collect from its inbound folder, and prepare feedback to return.

A student's own process makes the folder ``USER+ASSIGNMENT+TIME+RANDOM``, so USER and TIME are only
claims.  USER is checked against the owner of the folder, whom the system knows, and TIME against
the times on the disk (``exchange_times``).  The exchange identifies a hand-in by a secret that came
with it (``nbgrader.exchange``).
"""

from __future__ import annotations

import os
import pwd
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from ...course.authoring.layout import Course
from ..clean import clean_line, few
from ..each import Failure, for_student
from ..submission import read_file
from ..timestamp import TIMESTAMP, read_time
from .exchange_times import Times
from .platforms import File, LmsUser, Named, person

SECRET = "submission_secret.txt"
_LARGEST = 1
"""The largest size of a file beside a submission, in [MiB]."""
_STRANGERS = (
    "not taken; this machine has no such users, so it cannot be told whether they handed this in "
    "themselves; if your hub sees to that, add --unverified"
)
_BACKDATED = (
    "its name says {:%Y-%m-%d %H:%M} UTC, but it was last changed at {:%Y-%m-%d %H:%M} UTC, which "
    "counts; possibly an attempt to cheat (if you copied the exchange, keep its times: cp -a)"
)


def in_exchange(folder: Path, assignment: str, *, unverified: bool) -> Iterator[File]:
    """The notebooks in the inbound folder of nbgrader's exchange.

    A folder that was written later than its name says is dated by that later time, and is named.

    Args:
        folder: The inbound folder.
        assignment: The assignment to collect.
        unverified: Whether to collect from users whom this machine does not know, as long as all
            folders under that name have one owner.
    """
    parts = {path: path.name.rsplit("+", 3) for path in sorted(folder.iterdir())}
    mine = {path: x for path, x in parts.items() if len(x) > 2 and x[1] == assignment}
    owners: dict[str, set[int]] = {}
    for path, (user, *_) in mine.items():
        owners.setdefault(user, set()).add(path.lstat().st_uid)
    unknown = [user for user in owners if person(user) == user and _number(user) is None]
    strangers = [] if unverified else unknown
    if strangers:
        names = few([clean_line(name, 40) for name in strangers])
        yield File(names, (), datetime.now(UTC), bytes, refused=_STRANGERS)
    times = {
        path: Times.of(path, when)
        for path, (_, _, stated, *_) in mine.items()
        if (when := read_time(stated)) is not None
    }
    for path, (user, _, stated, *_) in mine.items():
        if user in strangers:
            continue
        label, when = clean_line(path.name), read_time(stated)
        refused = _not_a_hand_in(path) or _not_theirs(user, path, owners[user])
        notebooks = [] if refused else sorted(path.glob("*.ipynb"))
        if when is None or not notebooks:
            refused = refused or ("it states no time" if when is None else "it holds no notebook")
            yield File(label, (), datetime.now(UTC), bytes, refused=f"not taken; {refused}")
            continue
        if (came := times[path].contradicted(times.values())) is not None:
            yield File(label, (), came, bytes, refused=_BACKDATED.format(when, came))
            when = came
        who = LmsUser("exchange", user, user)
        for notebook in notebooks:
            yield File(
                clean_line(notebook.name),
                (Named(who, clean_line(notebook.name)),),
                when,
                partial(read_file, notebook),
                exact=True,
                secret=partial(read_secret, path),
            )


def _not_a_hand_in(path: Path) -> str:
    if path.is_symlink() or not path.is_dir():
        return "it is a link or a file, and not a folder"
    return "" if os.access(path, os.R_OK | os.X_OK) else "its mode does not let you read it"


def _not_theirs(user: str, path: Path, owners: set[int]) -> str:
    """Why a folder does not belong to the user in its name; empty if it does."""
    if not user or person(user) != user:
        return "no user can have such a name"
    uid, expected = path.lstat().st_uid, _number(user)
    if expected is not None and uid != expected:
        return (
            f"it belongs to {_user(uid)} and not to {clean_line(user)}; possibly an attempt to "
            "cheat (if you copied the exchange, keep the owners: cp -a)"
        )
    if expected is None and len(owners) > 1:
        several = " and ".join(map(_user, sorted(owners)))
        return f"{several} handed in as {clean_line(user)}; possibly an attempt to cheat"
    return ""


def _number(user: str) -> int | None:
    """The number of a user of this machine; None if there is no such user."""
    try:
        return pwd.getpwnam(user).pw_uid
    except KeyError:
        return None


def _user(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"user number {uid}"


def read_secret(folder: Path) -> bytes | None:
    """The secret beside a submission; None if it did not come through the exchange.

    Raises:
        LabkitError: The file is a link, or too large.
    """
    path = folder / SECRET
    return read_file(path, _LARGEST) if path.exists() or path.is_symlink() else None


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
            when = read_file(stamp, _LARGEST) if stamp.exists() else b""
            (page.parent / TIMESTAMP).write_bytes(when)
        return secret is not None

    of = {page: page.parents[1].name for page in pages}
    return [
        for_student(student, partial(lay, page, course.submitted / student / assignment))
        for page, student in of.items()
    ]
