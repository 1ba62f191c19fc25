"""Collect hand-ins from a platform's download into ``submitted/``, by one rule.

Each file has an owner by what the platform itself says: Moodle a full name, Canvas its number of
the user, nbgrader's exchange a login whose user owns the folder.  The owner is the one student of
the roster with this value.  A file that fits none or several is listed and left where it is.

The newest file counts.  Every file that was collected is kept in ``attempts/STUDENT/ASSIGNMENT/``.

Moodle writes ``NAME_PARTICIPANT_assignsubmission_file`` and then ``/FILE`` or ``_FILE``, with no
underscore in NAME (github.com/moodle/moodle, ``mod/assign/classes/downloader.php``).  Canvas writes
``NAME_[LATE_]USER_ATTACHMENT_FILE`` (github.com/instructure/canvas-lms, ``lib/content_zipper.rb``);
NAME or FILE may hold numbers too, and what could be read in two ways is left.

A student's own process makes the folder ``USER+ASSIGNMENT+TIME+RANDOM`` of the exchange, so USER is
only a claim: the folder must belong to that user of this machine.  The exchange identifies a
hand-in by a secret that came with it (``nbgrader.exchange``).
"""

from __future__ import annotations

import os
import pwd
import re
import zipfile
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from zoneinfo import ZoneInfo

import msgspec

from ..course.authoring.layout import Course
from ..errors import LabkitError
from .clean import clean_line
from .each import Failure, for_student
from .files import write
from .roster import Roster, known_as, read_roster
from .rules import read_rules
from .submission import NOTEBOOK, TIMESTAMP, check_size, digest, read_file, read_stamp, read_time

SECRET = "submission_secret.txt"
FOLDER = "attempts"
PARTICIPANTS = "course_private/lms.json"
"""Moodle's number of each student by assignment; it goes back with their page."""
LONGEST = 1000
"""The longest path in a download of which an owner is read."""
_MOODLE = re.compile(
    r"(?P<name>[^_/]*)_(?P<number>[0-9]+)_assignsubmission_"
    r"[a-z]+(?:_?/(?:[^/]+/)*|_)(?P<file>[^/]+)"
)
_CANVAS = re.compile(r"(?<!_LATE)(?=_(?P<late>LATE_)?(?P<user>[0-9]+)_[0-9]{3,}_(?P<file>[^/]+)$)")
"""Each place where a user's and an attachment's number may be; attachments have large numbers."""
_NEVER = datetime.min.replace(tzinfo=UTC)
_UNCLEAR = "whose they are is not clear; for unknown users of the exchange see --unverified"


@dataclass(frozen=True)
class File:
    """One file of a download.

    Attributes:
        label: Its name there, safe to show.
        when: When it was handed in, or when the download shows it.
        read: Reads its bytes when called.
        column: The column of the roster that has its owner, or "name"; "" if nothing is clear.
        value: What the owner's row has there.
        name: The name that the student gave the file.
        exact: Whether ``when`` is the time of the hand-in itself.
        moodle: The number of Moodle's participant; empty elsewhere.
        folder: The hand-in's folder in the exchange; None elsewhere.
    """

    label: str
    when: datetime
    read: Callable[[], bytes]
    column: str = ""
    value: str = ""
    name: str = ""
    exact: bool = False
    moodle: str = ""
    folder: Path | None = None


class Taken(NamedTuple):
    """A file, or several, and what was done with them; ``fine`` if nobody needs to look."""

    student: str
    file: str
    says: str
    fine: bool = True

    def __str__(self) -> str:
        return ": ".join(filter(None, (self.student, self.file, self.says)))


def collect(
    course: Course, assignment: str, source: Path, at: datetime | None, unverified: bool
) -> Iterator[Taken]:
    """Collect notebooks from a download; collecting it again changes nothing.

    Args:
        course: The course.
        assignment: The assignment.
        source: A zip from Moodle or Canvas, or the inbound folder of nbgrader's exchange.
        at: When the files were handed in, in the course's time zone, if the source does not say.
        unverified: Whether to collect from users of the exchange whom this machine does not know.

    Yields:
        What was done with each file; at the end what was left.

    Raises:
        LabkitError: There is no roster, or the source is not of these kinds or holds nothing.
    """
    roster, rules = read_roster(course), read_rules(course)
    if not roster:
        raise LabkitError("there is no list of students yet; first type: labkit roster LIST.csv")
    read = in_exchange(source, assignment, unverified) if source.is_dir() else in_zip(source)
    if not (files := [*read]):
        raise LabkitError(f"nothing in {source} was handed in for {assignment}")
    if at:
        when = at.replace(tzinfo=ZoneInfo(rules.zone)).astimezone(UTC)
        files = [x if x.exact else replace(x, when=when, exact=True) for x in files]
    mine, left = _by_owner(course, assignment, roster, files)
    for student, theirs in sorted(mine.items()):
        kept = _keep(course, assignment, student, theirs)
        done: list[Taken] | Failure = for_student(student, list, kept)
        if isinstance(done, Failure):
            done = [Taken(student, "", f"not taken; {done.why}", fine=False)]
        yield from done
    for why, labels in left.items():
        yield Taken("", ", ".join(labels), f"left there; {why}", fine=False)
    if rules.due(assignment) and not any(x.exact for x in files):
        yield Taken("", "", "no hand-in times in it, so nobody is late; --at TIME gives one")


def _by_owner(
    course: Course, assignment: str, roster: Roster, files: Sequence[File]
) -> tuple[Mapping[str, list[File]], Mapping[str, list[str]]]:
    """The files by the id of their owner, and the names of those that are left, by the reason."""
    mine, left = defaultdict[str, list[File]](list), defaultdict[str, list[str]](list)
    for file in files:
        owner = known_as(roster, file.column, file.value) if file.column else None
        if owner:
            mine[owner.id].append(file)
        else:
            why = f"no one student of the roster has this {file.column}"
            left[why if file.column else _UNCLEAR].append(file.label)
    known = participants(course)
    recorded = known.setdefault(assignment, {})
    pairs = {(student, x.moodle) for student in mine for x in mine[student] if x.moodle}
    people, numbers = (Counter(pair[k] for pair in {*pairs, *recorded.items()}) for k in (0, 1))
    for student, number in pairs:
        if people[student] == numbers[number] == 1:
            recorded[student] = number
        else:
            why = f"Moodle knows more than one {student}, or this number as somebody else"
            left[why] += [x.label for x in mine.pop(student, [])]
    if pairs:
        data = msgspec.json.encode(known, order="sorted")
        write(course.root / PARTICIPANTS, msgspec.json.format(data, indent=1) + b"\n")
    return mine, left


def participants(course: Course) -> dict[str, dict[str, str]]:
    """Moodle's number of each student whose work was collected, by assignment.

    Raises:
        LabkitError: The record is damaged.
    """
    path = course.root / PARTICIPANTS
    try:
        return msgspec.json.decode(path.read_bytes(), type=dict[str, dict[str, str]])
    except FileNotFoundError:
        return {}
    except msgspec.DecodeError:
        says = f"{path} is damaged; move it away, and collect the downloads again"
        raise LabkitError(says) from None


def _keep(course: Course, assignment: str, student: str, theirs: Sequence[File]) -> Iterator[Taken]:
    """Keep one student's files, and let the newest count."""
    kept = course.root / FOLDER / student / assignment
    folder = course.submitted / student / assignment
    path, newest, data = folder / f"{assignment}.ipynb", None, b""
    for file in sorted(theirs, key=lambda x: _rank(x, path.name)):
        if file.name.lower().endswith(".ipynb"):
            if newest and newest.name != file.name:
                yield Taken(student, newest.name, f"in attempts/; {file.name} counts", fine=False)
            newest, data = file, file.read()
            _store(kept, file.when, data)
        else:
            yield Taken(student, file.name, "not taken; it is no notebook", fine=False)
    if newest is None:
        return
    secret = read_secret(newest.folder) if newest.folder else b""
    there = read_file(path) if path.exists() else b""
    before = (read_time(read_stamp(folder)) or _written(path)) if there else _NEVER
    says = "there already"
    if newest.when > before and (there != data or newest.folder):  # students ask about the newest
        if there:
            _store(kept, before, there)
        write(path, data)
        os.utime(path, (newest.when.timestamp(),) * 2)
        stamp = str(newest.when).encode() if newest.exact else b""
        for name, content in ((TIMESTAMP, stamp), (SECRET, secret)):
            (folder / name).unlink(missing_ok=True)
            if content:
                write(folder / name, content)
        says = "taken"
    elif there != data:
        says = f"kept, but the one of {before:%Y-%m-%d %H:%M} UTC counts"
    yield Taken(student, newest.name, says)


def _rank(file: File, name: str) -> tuple[bool, datetime, bool]:
    """The file with the right name comes last, then the newest, then a copy of that name."""
    return file.name == name, file.when, file.name.startswith(name.partition(".")[0])


def _written(path: Path) -> datetime:
    return datetime.fromtimestamp(int(path.lstat().st_mtime), UTC)


def _store(kept: Path, when: datetime, data: bytes) -> None:
    """Keep a notebook in ``attempts/``, if it is not there already."""
    name = digest(data)[:16]
    if not any(kept.glob(f"*-{name}.ipynb")):
        write(kept / f"{when.astimezone(UTC):%Y-%m-%dT%H%M%SZ}-{name}.ipynb", data)


def reading(entry: str) -> dict[str, Any]:
    """What an entry of Moodle's or Canvas's zip says of its owner; nothing if that is not clear."""
    if len(entry) > LONGEST:
        return {}
    moodle = _MOODLE.fullmatch(entry)
    canvas = [] if "/" in entry else [*_CANVAS.finditer(entry)]
    if bool(moodle) + len(canvas) != 1:  # a name or a file that could be read as somebody else's
        return {}
    if moodle:
        owner = {"column": "name", "value": clean_line(moodle["name"], 200)}
        return owner | {"name": clean_line(moodle["file"]), "moodle": moodle["number"]}
    about = {"column": "lms_user_id", "value": canvas[0]["user"], "exact": bool(canvas[0]["late"])}
    return about | {"name": clean_line(canvas[0]["file"])}


def in_zip(source: Path) -> Iterator[File]:
    """The files of a zip, with the times at which the download shows them.

    Raises:
        LabkitError: It is damaged, or no zip.
    """
    try:
        archive = zipfile.ZipFile(source, metadata_encoding="utf-8")
    except (zipfile.BadZipFile, ValueError, OSError) as error:
        raise LabkitError(f"{source} is no zip, or damaged: {clean_line(str(error))}") from None
    for entry in archive.infolist():
        if not entry.is_dir():
            when, name = _written(source), entry.orig_filename
            with suppress(ValueError):  # some zips have no times
                when = datetime(*entry.date_time).astimezone(UTC)
            label = clean_line(name[-LONGEST:])[-120:]
            yield File(label, when, partial(_read, archive, entry), **reading(name))


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """Unpack an entry in memory up to the size limit, whatever size it states."""
    with archive.open(entry) as file:
        data = file.read(NOTEBOOK * 2**20 + 1)
    check_size(len(data), NOTEBOOK)
    return data


def in_exchange(folder: Path, assignment: str, unverified: bool) -> Iterator[File]:
    """The notebooks in the inbound folder of nbgrader's exchange.

    Args:
        folder: The inbound folder.
        assignment: The assignment to collect.
        unverified: Whether to take folders of users whom this machine does not know.
    """
    for path in sorted(folder.iterdir()):
        user, name, stated, *_ = (*path.name.rsplit("+", 3), "", "")
        if name == assignment:
            try:
                owned = path.lstat().st_uid == pwd.getpwnam(user).pw_uid
            except (KeyError, ValueError):
                owned = unverified
            file, *_ = *sorted(path.glob("*.ipynb"), key=lambda x: x.stem != name), path
            when, column = read_time(stated), "email" if "@" in user else "login"
            if not (owned and when and file != path) or path.is_symlink():
                column = ""
            label, read, called = clean_line(path.name), partial(read_file, file), file.name
            yield File(
                label, when or _NEVER, read, column, user, clean_line(called), True, "", path
            )


def read_secret(folder: Path) -> bytes:
    """The secret beside a submission; empty if it did not come through the exchange.

    Raises:
        LabkitError: The file is a link, or too large.
    """
    return read_file(folder / SECRET, 1) if os.path.lexists(folder / SECRET) else b""


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
        if secret := read_secret(submitted):
            (page.parent / SECRET).write_bytes(secret)
            (page.parent / TIMESTAMP).write_text(read_stamp(submitted))
        return bool(secret)

    of = [(page.parents[1].name, page) for page in pages]
    return [for_student(x, lay, page, course.submitted / x / assignment) for x, page in of]
