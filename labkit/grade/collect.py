"""Collect: downloads from Moodle and Canvas, or nbgrader's exchange, into ``submitted/``.

Names and times come from the download, never from within a student's file.  Moodle puts
``NAME_PARTICIPANT_assignsubmission_file_`` before each file, as a folder or not; Canvas calls each
``NAME_[LATE_]USER_ATTACHMENT_FILE`` (its ``lib/content_zipper.rb``).  The numbers are kept for the
export; see `lms`.
"""

from __future__ import annotations

import re
import shutil
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from ..errors import LabkitError
from .course import Course
from .handback import SECRET, read_secret
from .limits import Limits
from .lms import Known, folders, known, remember
from .submission import check_size, read_file

_MOODLE = re.compile(
    r"^(?P<name>[^/]+)_(?P<id>\d+)_assignsubmission_file(?:_?/|_)(?:[^/]+/)*(?P<file>[^/]+)$"
)
_CANVAS = re.compile(
    r"^(?P<name>[^/_]+)_(?P<late>LATE_)?(?P<id>\d+)_(?P<number>\d+)_(?P<file>[^/]+)$"
)
_EXCHANGE = re.compile(
    r"^(?P<name>[^.+/][^+/]*)\+(?P<assignment>[^+/]+)\+(?P<when>[^+/]+?)(\+[^/]*)?$"
)
_REPEATED = re.compile(r" ?[(-](\d+)\)?\.ipynb$")


@dataclass(frozen=True)
class Taken:
    """One file, and what was done with it.

    Attributes:
        student: Whose, as the folder is called; empty if nobody's.
        file: Its name in the download; empty if it is of none in particular.
        says: What was done.
    """

    student: str
    file: str
    says: str

    def __str__(self) -> str:
        return ": ".join(filter(None, (self.student, self.file, self.says)))


@dataclass(frozen=True)
class _Found:
    student: str
    file: str
    read: Callable[[], bytes]  # late, as a class's files need not fit into memory together
    when: str = ""
    late: bool = False
    known: Known | None = None
    beside: Path | None = None  # the folder in the exchange, with its secret


def collect(course: Course, assignment: str, source: Path) -> Iterator[Taken]:
    """Take notebooks from a download.

    Args:
        course: The course.
        assignment: Which.
        source: A zip from Moodle or Canvas, or the inbound folder of nbgrader's exchange.

    Yields:
        What was done with each file; of several of one student the last counts, of several that he
        handed in together the one that is called as the assignment.

    Raises:
        LabkitError: It is neither, it is damaged, or it holds nothing.
    """
    if not source.exists():
        raise LabkitError(f"there is no {source}")
    if source.is_dir():
        yield from _take(course, assignment, source, list(_from_exchange(source, assignment)))
    elif not zipfile.is_zipfile(source):
        raise LabkitError(
            f"{source} is neither a folder nor a zip file; give the download as it is"
        )
    else:
        try:
            with zipfile.ZipFile(source) as archive:
                yield from _take(course, assignment, source, list(_from_zip(archive)))
        except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError) as error:
            raise LabkitError(
                f"{source} is damaged or locked: {error}; download it again"
            ) from None


def _take(
    course: Course, assignment: str, source: Path, found: Sequence[_Found]
) -> Iterator[Taken]:
    if not found:
        raise LabkitError(f"nothing in {source} was handed in for {assignment}")
    before = known(course, assignment)
    people = {one.known: one.student for one in found if one.known is not None}
    places = folders(people, before)
    for name, count in Counter(people.values()).items():
        if count > 1:
            yield Taken(name, "", f"{count} students are called so; told apart by their number")
    remember(course, assignment, {folder: one for one, folder in places.items()})
    by_student: dict[str, list[_Found]] = {}
    for one in found:
        one = one if one.known is None else replace(one, student=places[one.known])
        if not one.student:
            yield Taken("", one.file, "not taken; no student can be told from its name")
        elif not one.file.endswith(".ipynb"):
            yield Taken(one.student, one.file, "not taken; it is no notebook")
        else:
            by_student.setdefault(one.student, []).append(one)
    for student, files in sorted(by_student.items()):
        files.sort(key=lambda one: (one.when, _called(one.file, assignment), _number(one.file)))
        *others, counts = files
        for one in others:
            which = "a later one" if one.file == counts.file else counts.file
            yield Taken(student, one.file, f"not taken; {which} counts")
        yield _put(course, assignment, counts)


def _put(course: Course, assignment: str, one: _Found) -> Taken:
    folder = course.submitted / one.student / assignment
    path = folder / f"{assignment}.ipynb"
    try:
        data = one.read()
        secret = None if one.beside is None else read_secret(one.beside)
    except LabkitError as error:
        return Taken(one.student, one.file, f"not taken; {error}")
    if path.is_file() and path.read_bytes() == data:
        if secret is not None:  # handed in once more: the newer one is asked about
            (folder / SECRET).write_bytes(secret)
        return Taken(one.student, one.file, "there already")
    again = folder.exists()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    path.write_bytes(data)
    if one.when:
        (folder / "timestamp.txt").write_text(one.when, encoding="utf-8")
    if secret is not None:
        (folder / SECRET).write_bytes(secret)
    says = "taken, in place of an earlier one" if again else "taken"
    says += "" if one.file == path.name else f", as {path.name}"
    return Taken(one.student, one.file, says + (", late" if one.late else ""))


def _from_zip(archive: zipfile.ZipFile) -> Iterator[_Found]:
    for entry in archive.infolist():
        if entry.is_dir():
            continue
        read = partial(_read, archive, entry)
        moodle = _MOODLE.match(entry.filename)
        match = moodle or _CANVAS.match(entry.filename)
        if match is None:
            yield _Found("", entry.filename[-80:], read)
            continue
        parts = match.groupdict()
        who = Known("moodle" if moodle else "canvas", parts["id"], parts["name"])
        late = bool(parts.get("late"))
        yield _Found(_slug(who.name), parts["file"], read, late=late, known=who)


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    check_size(entry.file_size, Limits().notebook)
    return archive.read(entry)


def _from_exchange(folder: Path, assignment: str) -> Iterator[_Found]:
    for inside in sorted(folder.iterdir()):
        match = _EXCHANGE.match(inside.name)
        if match is None or inside.is_symlink() or not inside.is_dir():
            continue
        if match["assignment"] != assignment:
            continue
        for path in sorted(inside.glob("*.ipynb")):
            read = partial(read_file, path, Limits().notebook)
            yield _Found(match["name"], path.name, read, _time(match["when"]), beside=inside)


def _time(text: str) -> str:
    """The exchange's time in the form of ``timestamp.txt``; now, if it cannot be read."""
    from dateutil.parser import parse

    try:
        return str(parse(text))
    except (ValueError, OverflowError):
        return str(datetime.now(UTC))


def _slug(name: str) -> str:
    """A name as a folder's: letters of any script, digits, and hyphens."""
    return re.sub(r"[^\w.]+", "-", name).strip("-._")[:60] or "nobody"


def _number(name: str) -> int:
    """The number that a browser or platform put on a repeated file: notebook(3), notebook-3."""
    match = _REPEATED.search(name)
    return int(match[1]) if match else 0


def _called(name: str, assignment: str) -> bool:
    """Whether a file is called as the assignment, whatever number it has."""
    return _REPEATED.sub(".ipynb", name) == f"{assignment}.ipynb"
