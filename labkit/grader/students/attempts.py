"""Attempts: every notebook that was handed in, and the rule by which one of them counts.

Each is kept in ``attempts/STUDENT/ASSIGNMENT/TIME-HASH/`` as it was handed in.  Beside it
``attempt.json`` says when it was handed in, or a platform showed it, and what it was called.
Nothing there is ever overwritten or deleted; the same content is the same attempt, however often it
comes.

**What counts** is the latest hand-in.  The exchange says when that was.  Moodle and Canvas write no
hand-in times into a download, only when it was made; so a hand-in is as old as the first download
that shows it, and an older download never takes the place of a newer hand-in.  Of several notebooks
that were handed in together the one that is called as the assignment counts, and of those the one
with the highest number, ``01_paths(2).ipynb``; then the one that was collected last.  A notebook
that somebody put into ``submitted/`` by hand is a hand-in of the moment at which the file was
written.  Where ``course.toml`` says ``counts = "latest in time"``, the latest that came before it
was due counts, and a late one only where there is no other.

The one that counts is copied to ``submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb``, which nbgrader
reads.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec.structs import replace

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..atomic import write
from ..clean import safe_name
from ..rules import read_rules
from ..submission import digest, read_file
from ..timestamp import TIMESTAMP, read_stamp, read_time
from .exchange import SECRET, read_secret

FOLDER = "attempts"
BY_HAND = "by hand"
_RECORD = "attempt.json"
_REPEATED = re.compile(r" ?[(-](\d{1,9})\)?\.ipynb$")


@dataclass(frozen=True)
class HandIn:
    """One time at which a notebook was handed in, or shown by a download.

    Attributes:
        when: That time.
        origin: "moodle", "canvas", "exchange", or "by hand".
        number: The student, as the platform knows them.
        file: What the student called it.
        exact: Whether this is the hand-in's own time, and not only the download's.
        late: Whether the platform calls it late.
        collected: When it was taken, in ISO 8601.
    """

    when: Annotated[datetime, msgspec.Meta(tz=True)]
    origin: str
    number: str
    file: str
    exact: bool = False
    late: bool = False
    collected: str = ""


class Attempt(msgspec.Struct, frozen=True):
    """One notebook, as it was handed in; ``attempt.json`` holds it, with the name of the file.

    Attributes:
        file: The file.
        sha256: The digest of its bytes.
        hand_ins: When and where it was handed in or shown, each time.
    """

    file: Path
    sha256: str
    hand_ins: tuple[HandIn, ...] = msgspec.field(name="seen")


@dataclass(frozen=True)
class Counted:
    """The attempt that counts.

    Attributes:
        attempt: The attempt.
        first: When it was handed in, or first shown by a download after every other attempt.
    """

    attempt: Attempt
    first: HandIn


def attempts(course: Course, student: str, assignment: str) -> tuple[Attempt, ...]:
    """All attempts of a student, in the order of their folders' names.

    Raises:
        LabkitError: The record of one is damaged.
    """
    place = course.root / FOLDER / student / assignment
    return tuple(_read(path) for path in sorted(place.glob(f"*/{_RECORD}")))


def choose(all: Sequence[Attempt], assignment: str) -> Counted | None:
    """The attempt that counts; None if there is none."""
    found: list[Counted] = []
    for origin in sorted({x.origin for one in all for x in one.hand_ins}):
        shown = [(x, one) for one in all for x in one.hand_ins if x.origin == origin]
        shown.sort(key=lambda pair: (pair[0].when, *_rank(pair[0], assignment), pair[1].sha256))
        at_each_time = {hand_in.when: (hand_in, one) for hand_in, one in shown}
        *earlier, (first, last) = at_each_time.values()
        for hand_in, one in reversed(earlier):
            if one is not last:
                break
            first = hand_in
        found.append(Counted(last, first))
    return max(found, key=lambda x: (x.first.when, x.first.origin == BY_HAND), default=None)


def counted_attempt(course: Course, student: str, assignment: str) -> Counted | None:
    """The attempt of a student that counts by the rules of the course; None if there is none.

    Raises:
        LabkitError: A record is damaged, or the rules are.
    """
    all, rules = attempts(course, student, assignment), read_rules(course)
    due = rules.due_for(student, assignment)
    if due is None or rules.counts == "latest":
        return choose(all, assignment)
    shown = (
        replace(one, hand_ins=tuple(x for x in one.hand_ins if x.when <= due and not x.late))
        for one in all
    )
    return choose([one for one in shown if one.hand_ins], assignment) or choose(all, assignment)


def perhaps_late(course: Course, student: str, assignment: str) -> str:
    """What to know of work that a download showed after it was due; empty if all is known.

    Canvas calls late work late, and the exchange has times of its own.
    """
    due = read_rules(course).due_for(student, assignment)
    try:
        chosen = counted_attempt(course, student, assignment)
    except LabkitError:  # a damaged record, which is named where work is collected
        return ""
    if chosen is None or due is None or chosen.first.when <= due:
        return ""
    first = chosen.first
    exact = any(x.exact for x in (first, *chosen.attempt.hand_ins))
    if exact or first.late or first.origin not in {"moodle", "files"}:
        return ""
    return (
        f"nobody knows whether it came in time, only that it was there at "
        f"{first.when:%Y-%m-%d %H:%M %Z}; no late rule is applied"
    )


def store(
    course: Course,
    student: str,
    assignment: str,
    data: bytes,
    hand_in: HandIn,
    secret: bytes | None = None,
    there: dict[str, Attempt] | None = None,
) -> bool:
    """Keep a notebook as an attempt.

    Args:
        course: The course.
        student: Whose.
        assignment: Which.
        data: The notebook.
        hand_in: When and where it was handed in or shown.
        secret: What the exchange knows the hand-in by.
        there: The student's attempts as `adopt` returns them, to which this one is added; they are
            read by default.

    Returns:
        Whether it is a new one, and not the same content as another.

    Raises:
        LabkitError: The record of an attempt is damaged.
    """
    there = _by_digest(course, student, assignment) if there is None else there
    sha256 = digest(data)
    before, new = there.get(sha256), sha256 not in there
    if before is None:
        name = f"{hand_in.when:%Y-%m-%dT%H%M%SZ}-{sha256[:16]}"
        folder = course.root / FOLDER / student / assignment / name
        before = Attempt(folder / f"{safe_name(Path(hand_in.file).stem)}.ipynb", sha256, ())
        _put(before.file, data)
    newest = max(
        (one.when for one in before.hand_ins if one.origin == "exchange"), default=hand_in.when
    )
    if secret is not None and hand_in.when >= newest:
        _put(before.file.parent / SECRET, secret)
    same = (hand_in.when, hand_in.origin, hand_in.file, hand_in.exact)
    if all((x.when, x.origin, x.file, x.exact) != same for x in before.hand_ins):
        record = replace(before, hand_ins=(*before.hand_ins, hand_in))
        data = msgspec.json.encode(record, enc_hook=lambda file: file.name)
        text = msgspec.json.format(data, indent=1).decode()
        write(before.file.parent / _RECORD, text + "\n")
        there[sha256] = record
    return new


def adopt(course: Course, student: str, assignment: str, now: str) -> dict[str, Attempt]:
    """Keep what somebody else put into ``submitted/``: a person, nbgrader, or an older labkit.

    Args:
        course: The course.
        student: Whose.
        assignment: Which.
        now: The time, in ISO 8601.

    Returns:
        All attempts of the student, by the digest of their bytes.

    Raises:
        LabkitError: It cannot be read, or a record is damaged.
    """
    folder = course.submitted / student / assignment
    for path in (folder.parent, folder):
        if path.is_symlink():
            raise LabkitError(f"{path.relative_to(course.root)} is a link; put a folder there")
    there = _by_digest(course, student, assignment)
    ours, chosen = set(there), counted_attempt(course, student, assignment)
    for path in sorted(folder.glob("*.ipynb")):
        if path.is_symlink() or not path.is_file():
            raise LabkitError(f"{path.relative_to(course.root)} is not a file; move it away")
        data = read_file(path)
        if path.name == f"{assignment}.ipynb" and chosen is not None:
            known = digest(data) == chosen.attempt.sha256
        else:
            known = digest(data) in ours
        if not known:
            new = digest(data) not in ours
            stated = read_time(read_stamp(folder)) if new else None
            when = stated or datetime.fromtimestamp(int(path.stat().st_mtime), UTC)
            exact = stated is not None
            hand_in = HandIn(when, BY_HAND, "", path.name, exact=exact, collected=now)
            secret = read_secret(folder) if new else None
            store(course, student, assignment, data, hand_in, secret, there)
    return there


def install(course: Course, student: str, assignment: str) -> Counted | None:
    """Copy the attempt that counts to where nbgrader reads it.

    Returns:
        That attempt; None if there is none.

    Raises:
        LabkitError: An attempt or its record is damaged.
    """
    chosen = counted_attempt(course, student, assignment)
    if chosen is None:
        return None
    source, when = chosen.attempt.file, chosen.first.when
    data = source.read_bytes()
    if digest(data) != chosen.attempt.sha256:
        raise LabkitError(f"{source} is not as it was handed in; restore it")
    folder = course.submitted / student / assignment
    path = folder / f"{assignment}.ipynb"
    same = path.is_file() and path.read_bytes() == data
    secret = read_secret(source.parent)
    stated = [x.when for x in (chosen.first, *chosen.attempt.hand_ins) if x.exact]
    if not stated and chosen.first.late:  # no earlier than this, as far as the platform says
        stated = [chosen.first.when]
    stamp = str(stated[0]).encode() if stated else None
    for name, content in ((TIMESTAMP, stamp), (SECRET, secret)):
        if content is not None:
            _put(folder / name, content)
        elif not same:
            (folder / name).unlink(missing_ok=True)  # the attempt that it came with has it
    if not same:
        _put(path, data)
        os.utime(path, (when.timestamp(), when.timestamp()))
    return chosen


def named_for(file: str, assignment: str) -> bool:
    """Whether a file is called as the assignment, whatever number it has."""
    return _REPEATED.sub(".ipynb", file) == f"{assignment}.ipynb"


def _rank(hand_in: HandIn, assignment: str) -> tuple[bool, int, str]:
    """Which of several that were handed in together counts."""
    match = _REPEATED.search(hand_in.file)  # the number that a browser or platform put there
    return named_for(hand_in.file, assignment), int(match[1]) if match else 0, hand_in.collected


def _by_digest(course: Course, student: str, assignment: str) -> dict[str, Attempt]:
    return {one.sha256: one for one in attempts(course, student, assignment)}


def _read(path: Path) -> Attempt:
    def beside(_: type, name: str) -> Path:
        return path.with_name(name)

    try:
        return msgspec.json.decode(path.read_bytes(), type=Attempt, dec_hook=beside)
    except msgspec.DecodeError:
        raise LabkitError(
            f"{path} is damaged; restore it, or move its folder out of {FOLDER}/ and collect again"
        ) from None


def _put(path: Path, data: bytes) -> None:
    """Write a file unless it holds this already; then it keeps its time."""
    if not path.is_file() or path.read_bytes() != data:
        write(path, data)
