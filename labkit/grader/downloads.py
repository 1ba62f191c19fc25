"""Reads what platforms hand over: a zip from Moodle or Canvas, or the inbound folder of nbgrader.

Every file comes with all ways to read whose it is, and with the reason for which it is refused.
Nothing is unpacked, so no name in a download leads anywhere.
"""

from __future__ import annotations

import io
import lzma
import os
import pwd
import stat
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import BinaryIO

from ..errors import LabkitError
from .attempts import read_time
from .clean import clean_line
from .handback import read_secret
from .lms import Known
from .platforms import Named, person, readings
from .sandbox.limits import Limits
from .submission import check_size, read_file

_DAMAGED = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error),
    *(OSError, EOFError, RuntimeError, ValueError, IndexError),
)


_STRANGERS = (
    "not taken; this machine has no such users, so it cannot be told whether they handed this in "
    "themselves; if your hub sees to that, add --unverified"
)


@dataclass(frozen=True)
class File:
    """One file of a download.

    Attributes:
        label: Its name in the download, as it can be shown.
        readings: The ways to read whose it is.
        when: When it was handed in, or shown by the platform.
        read: Its bytes; late, as a class's files need not fit into memory together.
        exact: Whether ``when`` is the hand-in's own time, and not only the download's.
        refused: What is wrong with it, in a sentence; empty if it can be taken.
        secret: What the exchange knows the hand-in by.
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
    """Open a zip, also one with a name that is not in the encoding that it states.

    Raises:
        LabkitError: It is damaged.
    """
    try:
        try:
            archive = zipfile.ZipFile(path)
        except UnicodeDecodeError:
            archive = zipfile.ZipFile(_without_utf8_flags(path))
    except _DAMAGED as error:
        said = clean_line(str(error))
        raise LabkitError(f"{path} is damaged: {said}; download it again") from None
    with archive:
        yield archive


def in_zip(archive: zipfile.ZipFile, made: datetime) -> Iterator[File]:
    """The files of a zip.

    Args:
        archive: The zip.
        made: When it was downloaded, for entries without a time.
    """
    names: set[str] = set()
    for entry in archive.infolist():
        if entry.is_dir():
            continue
        name = _name(entry)
        label, when = clean_line(name)[-120:], _when(entry, made)
        refused = _refused(entry, name)
        who = () if refused else readings(name)
        yield File(label, who, when, partial(_read, archive, entry), refused=refused)
        if name in names and not refused:
            twice = "it is in the zip twice; both are kept, so look which one counts"
            yield File(label, (), when, bytes, refused=twice)
        names.add(name)


def in_exchange(folder: Path, assignment: str, *, unverified: bool) -> Iterator[File]:
    """The notebooks in the inbound folder of nbgrader's exchange.

    A student's own process makes the folder ``USER+ASSIGNMENT+TIME+RANDOM``, so USER is only what
    somebody says.  Whose it is says its owner, whom the system knows.

    Args:
        folder: The inbound folder.
        assignment: Which is collected.
        unverified: Whether users whom this machine does not know are taken at their word, as long
            as nobody else hands in under the same name.
    """
    parts = {path: path.name.rsplit("+", 3) for path in sorted(folder.iterdir())}
    mine = {path: x for path, x in parts.items() if len(x) > 2 and x[1] == assignment}
    owners: dict[str, set[int]] = {}
    for path, (user, *_) in mine.items():
        owners.setdefault(user, set()).add(path.lstat().st_uid)
    unknown = [user for user in owners if person(user) == user and _number(user) is None]
    strangers = [] if unverified else unknown
    if strangers:
        yield File(_some(strangers), (), datetime.now(UTC), bytes, refused=_STRANGERS)
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
        who = Known("exchange", user, user)
        for notebook in notebooks:
            yield File(
                clean_line(notebook.name),
                (Named(who, clean_line(notebook.name)),),
                when,
                partial(read_file, notebook, Limits().notebook),
                exact=True,
                secret=partial(read_secret, path),
            )


def _not_a_hand_in(path: Path) -> str:
    if path.is_symlink() or not path.is_dir():
        return "it is a link or a file, and not a folder"
    return "" if os.access(path, os.R_OK | os.X_OK) else "its mode does not let you read it"


def _not_theirs(user: str, path: Path, owners: set[int]) -> str:
    """Why a folder is not that of the user whose name it bears; empty if it is."""
    if not user or person(user) != user:
        return "nobody can have such a name"
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


def _some(names: Sequence[str]) -> str:
    some = ", ".join(clean_line(name, 40) for name in names[:8])
    return f"{some} and {len(names) - 8} more" if len(names) > 8 else some


def _number(user: str) -> int | None:
    """The number of a user of this machine."""
    try:
        return pwd.getpwnam(user).pw_uid
    except KeyError:
        return None


def _user(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"user number {uid}"


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
    """What is wrong with an entry, whoever's it is."""
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "not taken; it is a link"
    if entry.flag_bits & 1:
        return "not taken; it is locked with a password"
    if "\\" in name or "\0" in name or {"", ".", ".."} & set(name.split("/")):
        return "not taken; it leads out of the download"
    return ""


def _when(entry: zipfile.ZipInfo, made: datetime) -> datetime:
    """An entry's time, which is that of this machine's clock on the wall."""
    try:
        when = datetime(*entry.date_time)
    except ValueError:
        return made
    return made if when == datetime(1980, 1, 1) else when.astimezone(UTC)


def _read(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """Unpack an entry in memory, no further than is allowed, whatever it says of its size."""
    most = Limits().notebook
    check_size(entry.file_size, most)
    try:
        with archive.open(entry) as file:
            data = file.read(most * 2**20 + 1)
    except _DAMAGED as error:
        raise LabkitError(f"damaged: {clean_line(str(error))}") from None
    check_size(len(data), most)
    return data


def _without_utf8_flags(path: Path) -> BinaryIO:
    """A copy in which no name claims to be UTF-8, so that every name can be read."""
    data = bytearray(path.read_bytes())
    end = data.rfind(b"PK\5\6")
    size, _ = struct.unpack_from("<LL", data, end + 12)
    at = end - size
    while data[at : at + 4] == b"PK\1\2":
        local = struct.unpack_from("<L", data, at + 42)[0]
        data[at + 9] &= ~8
        data[local + 7] &= ~8
        at += 46 + sum(struct.unpack_from("<3H", data, at + 28))
    return io.BytesIO(data)
