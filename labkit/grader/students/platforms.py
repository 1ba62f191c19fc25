"""Read zips and folders: each file, and its owner by the name that the platform gave it.

Moodle and Canvas put what they know about the person first, and the student's own file name last.
A name is therefore read from its beginning, and no file name that a student chooses can change the
owner.

Moodle writes ``NAME_PARTICIPANT_assignsubmission_file`` and then ``/FILE``, with the student's own
folders between, or ``_FILE``.  It replaces underscores in NAME by spaces, so the first number
is the participant's; a name with a leading underscore is a team's, or belongs to somebody else
(github.com/moodle/moodle, ``mod/assign/classes/downloader.php``).

Canvas writes ``NAME_[LATE_]USER_ATTACHMENT_FILE``.  NAME is in small letters, without spaces, and
may end in an underscore and a number; then there are two readings if the file's own name begins
with a number too (github.com/instructure/canvas-lms, ``lib/content_zipper.rb``).  Canvas
counts the attachments of a whole school, so a number below 100 belongs to the file's own name, as
in ``10_cup.ipynb``.

Every file comes with all possible readings of its owner, and with the reason if it is refused.
Nothing is unpacked to disk, so a path in a download can do no harm.

Folders and zips without a platform's names are read by a pattern that the instructor gives: clones
of GitHub Classroom, ``paths-ada/01_paths.ipynb``, or any other files, ``01_paths_4711.ipynb``.  The
part that stands for the student must be in the roster: a login, an address, a number, the user name
on GitHub, or the student's own name.
"""

from __future__ import annotations

import lzma
import os
import re
import stat
import struct
import unicodedata
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from ...errors import LabkitError
from ..clean import clean_line
from ..submission import NOTEBOOK, check_size, read_file

_MOODLE = re.compile(
    r"(?P<name>[^_/]*)_(?P<number>0|[1-9][0-9]{0,18})_assignsubmission_"
    r"(?P<kind>[a-z]+)(?:_?/(?:[^/]+/)*|_)(?P<file>[^/]+)"
)
_CANVAS = re.compile(
    r"(?P<name>\w*?)_(?P<late>LATE_)?(?P<number>[0-9]+)_(?P<attachment>[0-9]+)_(?P<file>[^/]+)"
)
_NUMBER_FIRST = re.compile(r"([0-9]{3,})_([^/]+)")
_OF_A_MAC = re.compile(r"(^|/)(__MACOSX/|\.DS_Store$|\._[^/]*$)")
"""Files that macOS adds to a zip, which nobody handed in."""
_ID = re.compile(r"[1-9][0-9]{0,18}")
_DAMAGED = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error),
    *(OSError, EOFError, RuntimeError, ValueError, IndexError),
)


@dataclass(frozen=True)
class LmsUser:
    """A person as a platform's download names them.

    Attributes:
        system: "moodle", "canvas", "exchange", or "files" if they come from no platform.
        number: Canvas's number for the user; Moodle's for the participant, one per assignment; the
            user name in the exchange; or the text in a file's name.
        name: The person's name, as the download writes it.
    """

    system: str
    number: str
    name: str

    @property
    def key(self) -> tuple[str, str]:
        """The key that identifies this person within one assignment."""
        return self.system, self.number

    def __str__(self) -> str:
        what = {"moodle": "participant", "canvas": "Canvas's user"}.get(self.system, "user")
        return f"{what} {self.number}" + (f" ({self.name})" if self.name != self.number else "")


@dataclass(frozen=True)
class Named:
    """One reading of the name of a file in a download.

    Attributes:
        who: The person.
        file: The name that the student gave the file.
        late: Whether Canvas marks it as late.
        kind: How it was handed in, in Moodle's words: "file", or another, such as "onlinetext".
    """

    who: LmsUser
    file: str
    late: bool = False
    kind: str = "file"


Reader = Callable[[str], tuple[Named, ...]]
"""Finds the possible owners of a file by its name, which includes its folders."""


def readings(entry: str) -> tuple[Named, ...]:
    """The possible readings of a name: none if it has no owner, two if it may have either of two.

    Args:
        entry: The name of the file with its folders, as the download writes it.
    """
    if match := _MOODLE.fullmatch(entry):
        who = LmsUser("moodle", match["number"], person(match["name"]))
        return (Named(who, clean_line(match["file"]), kind=match["kind"]),)
    match = _CANVAS.fullmatch(entry)
    if match is None or "assignsubmission" in match["name"] or match["name"] == "anon":
        return ()
    name, number, attachment = match["name"], match["number"], match["attachment"]
    found = [(name, number, attachment, match["file"])]
    if not match["late"] and (more := _NUMBER_FIRST.fullmatch(match["file"])):
        found.append((f"{name}_{number}", attachment, more[1], more[2]))
    return tuple(
        Named(LmsUser("canvas", user, person(called)), clean_line(file), bool(match["late"]))
        for called, user, number, file in found
        if _ID.fullmatch(user) and _ID.fullmatch(number)
    )


def person(name: str) -> str:
    """A person's name in a normal form, however it was typed."""
    return unicodedata.normalize("NFC", clean_line(name, 200))


@dataclass(frozen=True)
class File:
    """One file of a download.

    Attributes:
        label: Its name in the download, safe to show.
        readings: The possible readings of its owner.
        when: When it was handed in, or when the platform showed it.
        read: Reads its bytes when called, as a whole class's files may not fit into memory.
        exact: Whether ``when`` is the time of the hand-in itself and not of the download.
        refused: What is wrong with it, in a sentence; empty if it can be taken.
        secret: Reads the secret by which the exchange identifies the hand-in.
    """

    label: str
    readings: tuple[Named, ...]
    when: datetime
    read: Callable[[], bytes]
    exact: bool = False
    refused: str = ""
    secret: Callable[[], bytes | None] = lambda: None


@contextmanager
def open_zip(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open a zip.

    Raises:
        LabkitError: The zip is damaged, or a name is not in the encoding that it states.
    """
    try:
        archive = zipfile.ZipFile(path)
    except _DAMAGED as error:
        said = clean_line(str(error))
        raise LabkitError(f"{path} is damaged: {said}; download it again") from None
    with archive:
        yield archive


def in_zip(archive: zipfile.ZipFile, made: datetime, read: Reader = readings) -> Iterator[File]:
    """The files of a zip.

    Args:
        archive: The zip.
        made: When it was downloaded, for entries without a time.
        read: Finds the owner of a file by its name; by default as Moodle and Canvas write it.
    """
    names: set[str] = set()
    for entry in archive.infolist():
        name = _name(entry)
        if entry.is_dir() or _OF_A_MAC.search(name):
            continue
        label, when = clean_line(name)[-120:], _when(entry, made)
        refused = _refused(entry, name)
        who = () if refused else read(name)
        yield File(label, who, when, partial(_read, archive, entry), refused=refused)
        if name in names and not refused:
            twice = "it is in the zip twice; both are kept; check which one counts"
            yield File(label, (), when, bytes, refused=twice)
        names.add(name)


def _name(entry: zipfile.ZipInfo) -> str:
    """The entry's name; most programs write UTF-8 without saying so."""
    if entry.flag_bits & 0x800:
        return entry.orig_filename
    raw = entry.orig_filename.encode("cp437", "replace")
    try:
        return raw.decode()
    except UnicodeDecodeError:
        return entry.orig_filename


def _refused(entry: zipfile.ZipInfo, name: str) -> str:
    """Why an entry is refused, regardless of its owner; empty if it is accepted."""
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "not taken; it is a link"
    if entry.flag_bits & 1:
        return "not taken; it is locked with a password"
    if "\\" in name or "\0" in name or {"", ".", ".."} & set(name.split("/")):
        return "not taken; it leads out of the download"
    return ""


def _when(entry: zipfile.ZipInfo, made: datetime) -> datetime:
    """An entry's time, which zips store as local time without a zone."""
    try:
        when = datetime(*entry.date_time)
    except ValueError:
        return made
    return made if when == datetime(1980, 1, 1) else when.astimezone(UTC)


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """Unpack an entry in memory up to the size limit, whatever size it states."""
    check_size(entry.file_size, NOTEBOOK)
    try:
        with archive.open(entry) as file:
            data = file.read(NOTEBOOK * 2**20 + 1)
    except _DAMAGED as error:
        raise LabkitError(f"damaged: {clean_line(str(error))}") from None
    check_size(len(data), NOTEBOOK)
    return data


_PARTS = {"{student}": "(?P<student>[^/]+?)", "**": ".*", "*": "[^/]*"}


def reader(pattern: str) -> Reader:
    """A reader for names that all follow one pattern.

    Args:
        pattern: A pattern such as ``paths-{student}/*.ipynb``; ``*`` stands for anything within
            one name, ``**`` for folders too.

    Raises:
        LabkitError: The pattern does not have ``{student}`` exactly once.
    """
    if pattern.count("{student}") != 1:
        raise LabkitError(
            f"{pattern!r} needs {{student}} once, such as in 'paths-{{student}}/*.ipynb'"
        )
    parts = re.split(r"(\{student\}|\*\*|\*)", pattern)
    whole = re.compile("".join(_PARTS.get(x, re.escape(x)) for x in parts), re.IGNORECASE)

    def read(name: str) -> tuple[Named, ...]:
        match = whole.fullmatch(name)
        if match is None:
            return ()
        who = person(match["student"])
        return (Named(LmsUser("files", who, who), clean_line(Path(name).name)),)

    return read


def in_folder(folder: Path, read: Reader) -> Iterator[File]:
    """The files in a folder and all folders in it that a student may have handed in.

    These are the files that the reader knows, and others that are, or once were, called a notebook.
    Links are not followed.  The times are when they were written here, by a download or a clone.
    """
    for top, folders, names in os.walk(folder):
        folders[:] = sorted(x for x in folders if not x.startswith("."))
        for name in sorted(x for x in names if not x.startswith(".")):
            path = Path(top, name)
            label = str(path.relative_to(folder))
            who = read(label)
            if who or ".ipynb" in name.lower():
                when = datetime.fromtimestamp(int(path.lstat().st_mtime), UTC)
                yield File(clean_line(label)[-120:], who, when, partial(read_file, path))
