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
import stat
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
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
from .roster import Roster, read_roster
from .rules import read_rules
from .submission import NOTEBOOK, TIMESTAMP, check_size, digest, read_file, read_stamp, read_time

SECRET = "submission_secret.txt"
FOLDER = "attempts"
PARTICIPANTS = "course_private/lms.json"
"""Moodle's participants by assignment and student; their numbers go back with marks and pages."""
LONGEST = 1000
"""The longest path of a file in a download."""
_MOODLE = re.compile(
    r"(?P<name>[^_/]*)_(?P<number>0|[1-9][0-9]{0,18})_assignsubmission_"
    r"(?P<kind>[a-z]+)(?:_?/(?:[^/]+/)*|_)(?P<file>[^/]+)"
)
_CANVAS = re.compile(r"(?<!_LATE)(?=_(?P<late>LATE_)?(?P<user>[0-9]+)_[0-9]{3,}_(?P<file>[^/]+)$)")
"""Each place where a user's and an attachment's number may be; attachments have large numbers."""
_REPEATED = re.compile(r" ?[(-]\d{1,9}\)?\.ipynb$")
"""What a browser or a platform adds to the name of a file that is handed in again."""


class Participant(NamedTuple):
    """What Moodle calls a student: the number in one assignment, and the name."""

    number: str
    name: str


@dataclass(frozen=True)
class File:
    """One file of a download.

    Attributes:
        label: Its name there, safe to show.
        when: When it was handed in, or when the download shows it.
        read: Reads its bytes when called.
        column: The column of the roster that has its owner, or "name".
        value: What the owner's row has there.
        name: The name that the student gave the file.
        exact: Whether ``when`` is the time of the hand-in itself.
        late: Whether the platform marks it as late.
        moodle: Moodle's participant; None elsewhere.
        refused: Why it is not taken; "" if it can be.
        folder: The hand-in's folder in the exchange; None elsewhere.
    """

    label: str
    when: datetime
    read: Callable[[], bytes]
    column: str = ""
    value: str = ""
    name: str = ""
    exact: bool = False
    late: bool = False
    moodle: Participant | None = None
    refused: str = ""
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
    course: Course,
    assignment: str,
    source: Path,
    *,
    at: str | None = None,
    unverified: bool = False,
) -> Iterator[Taken]:
    """Collect notebooks from a download; collecting it again changes nothing.

    Args:
        course: The course.
        assignment: The assignment.
        source: A zip from Moodle or Canvas, or the inbound folder of nbgrader's exchange.
        at: When the files were handed in, if the source does not say.
        unverified: Whether to collect from users of the exchange whom this machine does not know.

    Yields:
        What was done with each file; at the end what was left.

    Raises:
        LabkitError: There is no roster, or the source is not of these kinds or holds nothing.
    """
    roster, rules = read_roster(course), read_rules(course)
    when = read_time(at, ZoneInfo(rules.zone)) if at else None
    if at and (when is None or when > datetime.now(UTC)):
        raise LabkitError(f"{at!r} is no time, or in the future; write 2026-11-02 23:59")
    if not roster.students:
        raise LabkitError("there is no list of students yet; first type: labkit roster LIST.csv")
    if not (source.is_file() or source.is_dir()):  # a device or a pipe may never end
        raise LabkitError(f"{source} is neither a file nor a folder; give the download as it is")
    read = in_zip(source) if source.is_file() else in_exchange(source, assignment, unverified)
    if not (files := [*read]):
        raise LabkitError(f"nothing in {source} was handed in for {assignment}")
    mine, left = _by_owner(course, assignment, roster, files)
    for student, theirs in sorted(mine.items()):
        kept = _keep(course, assignment, student, theirs, when)
        done: list[Taken] | Failure = for_student(student, list, kept)
        if isinstance(done, Failure):
            done = [Taken(student, "", f"not taken; {done.why}", fine=False)]
        yield from done
    for why, labels in left.items():
        yield Taken("", ", ".join(labels), f"left there; {why}", fine=False)
    if rules.due(assignment) and not any(x.exact or when for x in files):
        yield Taken("", "", "no hand-in times in it, so nobody is late; --at TIME gives one")


def _by_owner(
    course: Course, assignment: str, roster: Roster, files: Sequence[File]
) -> tuple[dict[str, list[File]], dict[str, list[str]]]:
    """The files by the id of their owner, and the names of those that are left, by the reason."""
    known = participants(course)
    recorded = dict(known.get(assignment, {}))
    mine: dict[str, list[File]] = {}
    left: dict[str, list[str]] = {}
    for file in files:
        owner = roster.known_as(file.column, file.value) if file.column else None
        if owner and not file.refused:
            mine.setdefault(owner.id, []).append(file)
        else:
            why = f"no one student of the roster has this {file.column or 'name'}"
            left.setdefault(file.refused or why, []).append(file.label)
    for student, theirs in [*mine.items()]:
        called = {x.moodle.number: x.moodle for x in theirs if x.moodle}
        whose = {one.number: name for name, one in recorded.items()}
        numbers = sorted({*called, *(n for n, name in whose.items() if called and name == student)})
        if len(numbers) > 1 or any(whose.get(n, student) != student for n in numbers):
            why = f"Moodle's numbers {', '.join(numbers)} and {student} do not match"
            left.setdefault(why, []).extend(x.label for x in mine.pop(student))
        elif called:
            (recorded[student],) = called.values()
    if recorded:
        data = msgspec.json.encode(known | {assignment: recorded}, order="sorted")
        write(course.root / PARTICIPANTS, msgspec.json.format(data, indent=1) + b"\n")
    return mine, left


def participants(course: Course) -> dict[str, dict[str, Participant]]:
    """Moodle's participants whose work was collected, by assignment and student.

    Raises:
        LabkitError: The record is damaged.
    """
    path = course.root / PARTICIPANTS
    try:
        return msgspec.json.decode(path.read_bytes(), type=dict[str, dict[str, Participant]])
    except FileNotFoundError:
        return {}
    except msgspec.DecodeError:
        says = f"{path} is damaged; move it away, and collect the downloads again"
        raise LabkitError(says) from None


def _keep(
    course: Course, assignment: str, student: str, theirs: Sequence[File], at: datetime | None
) -> Iterator[Taken]:
    """Keep one student's files, and let the newest count."""
    kept = course.root / FOLDER / student / assignment
    folder = course.submitted / student / assignment
    if any(x.is_symlink() for x in (folder.parent, folder, kept.parent, kept)):
        raise LabkitError(f"{folder} or {kept} is a link; put a folder there")
    read: list[tuple[datetime, bool, File]] = []
    for file in theirs:
        if not file.exact and (at or file.late):
            file = replace(file, when=at or file.when, exact=True)
        if file.name.lower().endswith(".ipynb"):
            plain = _REPEATED.sub(".ipynb", file.name) == f"{assignment}.ipynb"
            read.append((file.when, plain, file))
        else:
            yield Taken(student, file.name, "not taken; it is no notebook", fine=False)
    if not read:
        return
    *earlier, (_, _, file) = sorted(read, key=lambda one: one[:2])
    for _, _, one in earlier:
        _store(kept, one.when, one.read())
        yield Taken(student, one.name, f"kept, but {file.name} counts")
    data, path = file.read(), folder / f"{assignment}.ipynb"
    there = read_file(path) if path.exists() else b""
    before = (read_time(read_stamp(folder)) or _written(path)) if there else file.when
    _store(kept, file.when, data)
    if there and there != data and file.when <= before:
        yield Taken(student, file.name, f"kept, but the one of {before:%Y-%m-%d %H:%M} UTC counts")
        return
    if there != data or (file.folder and file.when >= before):  # students ask about the newest
        beside = {TIMESTAMP: str(file.when).encode() if file.exact else None}
        beside[SECRET] = read_secret(file.folder)
        if there:
            _store(kept, before, there)
        write(path, data)
        os.utime(path, (file.when.timestamp(), file.when.timestamp()))
        for name, content in beside.items():
            if content is None:
                (folder / name).unlink(missing_ok=True)
            else:
                write(folder / name, content)
    says = "there already" if there == data else "taken"
    yield Taken(student, file.name, says + ", late" * file.late)


def _written(path: Path) -> datetime:
    return datetime.fromtimestamp(int(path.lstat().st_mtime), UTC)


def _store(kept: Path, when: datetime, data: bytes) -> None:
    """Keep a notebook in ``attempts/``, if it is not there already."""
    name = digest(data)[:16]
    if not any(kept.glob(f"*-{name}.ipynb")):
        write(kept / f"{when.astimezone(UTC):%Y-%m-%dT%H%M%SZ}-{name}.ipynb", data)


def reading(entry: str) -> dict[str, Any]:
    """What an entry of Moodle's or Canvas's zip says of its owner; nothing if that is not clear."""
    moodle, canvas = _MOODLE.fullmatch(entry), [*_CANVAS.finditer(entry)]
    canvas = [] if "/" in entry else canvas
    if bool(moodle) + len(canvas) != 1:  # a name or a file that could be read as somebody else's
        return {}
    if moodle:
        file = clean_line(moodle["file"]) if moodle["kind"] == "file" else moodle["kind"]
        who = Participant(moodle["number"], clean_line(moodle["name"], 200))
        return {"column": "name", "value": who.name, "name": file, "moodle": who}
    (match,) = canvas
    about = {"column": "lms_user_id", "value": match["user"], "late": bool(match["late"])}
    return about | {"name": clean_line(match["file"])}


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
        name = entry.orig_filename
        if not entry.is_dir():
            refused = _refused(entry, name)
            about = {"refused": refused} if refused else reading(name)
            label, when = clean_line(name[-LONGEST:])[-120:], _when(entry, _written(source))
            yield File(label, when, partial(_read, archive, entry), **about)


def _refused(entry: zipfile.ZipInfo, name: str) -> str:
    """Why an entry is refused, whoever owns it; "" if it is not."""
    if stat.S_ISLNK(entry.external_attr >> 16) or entry.flag_bits & 1:
        return "they are links, or locked with a password"
    if len(name) > LONGEST or set(name) & set("\\\0") or {"", ".", ".."} & set(name.split("/")):
        return "their names are too long, or lead out of the download"
    return ""


def _when(entry: zipfile.ZipInfo, made: datetime) -> datetime:
    """An entry's time, which zips store as local time without a zone; 1980 is none."""
    try:
        return datetime(*entry.date_time).astimezone(UTC) if entry.date_time[0] > 1980 else made
    except ValueError:
        return made


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """Unpack an entry in memory up to the size limit, whatever size it states."""
    check_size(entry.file_size, NOTEBOOK)
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

    def of(path: Path, user: str, stated: str) -> list[File]:
        when, label = read_time(stated), clean_line(path.name)
        _check_owner(user, path, unverified)
        column, notebooks = "email" if "@" in user else "login", sorted(path.glob("*.ipynb"))
        if when is None or not notebooks:
            raise LabkitError("they state no time, or hold no notebook")
        first = File(label, when, bytes, column, user, exact=True, folder=path)
        named = [(clean_line(one.name), partial(read_file, one)) for one in notebooks]
        return [replace(first, name=name, read=read) for name, read in named]

    for path in sorted(folder.iterdir()):
        user, name, stated, *_ = (*path.name.rsplit("+", 3), "", "")
        if name == assignment:
            found = for_student(user, of, path, user, stated)
            if isinstance(found, Failure):
                now = datetime.now(UTC)
                found = [File(clean_line(path.name), now, bytes, refused=found.why)]
            yield from found


def _check_owner(user: str, path: Path, unverified: bool) -> None:
    """Raise a LabkitError unless a folder belongs to the user in its name."""
    if path.is_symlink() or not path.is_dir():
        raise LabkitError("they are links")
    try:
        if path.lstat().st_uid != pwd.getpwnam(user).pw_uid:
            raise LabkitError("another user than the one in the name owns them")
    except (KeyError, ValueError):
        if not unverified:
            raise LabkitError("this machine does not know these users; see --unverified") from None


def read_secret(folder: Path | None) -> bytes | None:
    """The secret beside a submission; None if it did not come through the exchange.

    Raises:
        LabkitError: The file is a link, or too large.
    """
    path = folder and folder / SECRET
    return read_file(path, 1) if path and os.path.lexists(path) else None


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
            (page.parent / TIMESTAMP).write_text(read_stamp(submitted))
        return secret is not None

    of = {page: page.parents[1].name for page in pages}
    return [
        for_student(student, lay, page, course.submitted / student / assignment)
        for page, student in of.items()
    ]
