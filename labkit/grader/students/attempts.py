"""Attempts: every notebook that was handed in, and the rule that decides which one counts.

Each attempt is kept unchanged in ``attempts/STUDENT/ASSIGNMENT/TIME-HASH/``.  The file
``attempt.json`` beside it records the name of the notebook and when it was handed in, or when a
platform showed it.  No new hand-in overwrites a notebook or deletes one.  Identical content is the
same attempt, however often it is handed in; each time is added to the record.

**The latest hand-in counts.**  The exchange records its time.  A download from Moodle or Canvas has
no hand-in times, only the time of the download itself.  Such a hand-in is therefore dated by the
first download that shows it, and an older download never replaces a newer hand-in.  If several
notebooks were handed in together, the one that is named after the assignment counts; among several
of those, the one with the highest number, such as ``01_paths(2).ipynb``; then the one that was
collected last.  A notebook that somebody put into ``submitted/`` by hand is dated by the time at
which the file was written, or put back if it is a known attempt; whether a known one is late
follows from its own hand-in.  If ``course.toml`` says ``counts = "latest in time"``, the latest
hand-in before the due date counts, and a late one counts only if there is no other, or if a person
put it there.

`installed` copies the attempt that counts to ``submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb``,
where nbgrader reads it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec.structs import replace

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..atomic import write
from ..clean import safe_name
from ..rules import read_rules
from ..submission import digest
from .exchange import SECRET

FOLDER = "attempts"
BY_HAND = "by hand"
RECORD = "attempt.json"
_REPEATED = re.compile(r" ?[(-](\d{1,9})\)?\.ipynb$")


@dataclass(frozen=True)
class HandIn:
    """One time at which a notebook was handed in, or at which a download showed it.

    Attributes:
        when: The time.
        origin: "moodle", "canvas", "exchange", or "by hand".
        number: The number or name by which the platform knows the student.
        file: The name that the student gave the file.
        exact: Whether the time is that of the hand-in itself and not of the download.
        late: Whether the platform marks the hand-in as late.
        collected: When it was collected, in ISO 8601.
    """

    when: Annotated[datetime, msgspec.Meta(tz=True)]
    origin: str
    number: str
    file: str
    exact: bool = False
    late: bool = False
    collected: str = ""


class Attempt(msgspec.Struct, frozen=True):
    """One notebook as it was handed in; ``attempt.json`` stores it, with the name of the file.

    Attributes:
        file: The notebook.
        sha256: The digest of its bytes.
        hand_ins: Each time and place at which it was handed in or shown.
    """

    file: Path
    sha256: str
    hand_ins: tuple[HandIn, ...] = msgspec.field(name="seen")


@dataclass(frozen=True)
class Counted:
    """The attempt that counts.

    Attributes:
        attempt: The attempt.
        first: The hand-in that made it the latest, or the first download that showed it as such.
    """

    attempt: Attempt
    first: HandIn

    @property
    def came(self) -> HandIn:
        """The hand-in that says when it came: the student's, also if a person put it back."""
        theirs = [x for x in self.attempt.hand_ins if x.origin != BY_HAND]
        back = self.first.origin == BY_HAND and theirs
        return min(theirs, key=lambda x: (not x.exact, x.when)) if back else self.first

    def __str__(self) -> str:
        return f"the file of {self.came.when:%Y-%m-%d %H:%M %Z}"


def attempts(course: Course, student: str, assignment: str) -> tuple[Attempt, ...]:
    """All attempts of a student, sorted by the names of their folders.

    Raises:
        LabkitError: The record of an attempt is damaged.
    """
    place = course.root / FOLDER / student / assignment
    return tuple(_read(path) for path in sorted(place.glob(f"*/{RECORD}")))


def choose(theirs: Sequence[Attempt], assignment: str) -> Counted | None:
    """The attempt that counts, by the latest hand-in; None if there are no attempts."""
    found: list[Counted] = []
    for origin in sorted({x.origin for one in theirs for x in one.hand_ins}):
        shown = [(x, one) for one in theirs for x in one.hand_ins if x.origin == origin]
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
    """A student's attempt that counts under the rules of the course; None if there is none.

    Raises:
        LabkitError: A record or the rules file is damaged.
    """
    theirs, rules = attempts(course, student, assignment), read_rules(course)
    due = rules.due_for(student, assignment)
    if due is None or rules.counts == "latest":
        return choose(theirs, assignment)

    def in_time(one: Attempt) -> Attempt:
        taken = (x for x in one.hand_ins if (x.when <= due and not x.late) or _by_a_person(x, one))
        return replace(one, hand_ins=tuple(taken))

    found = choose([one for one in map(in_time, theirs) if one.hand_ins], assignment)
    if found is None:
        return choose(theirs, assignment)
    return Counted(next(one for one in theirs if one.file == found.attempt.file), found.first)


def or_another(course: Course, student: str, assignment: str) -> str:
    """What else to do about a file that cannot be graded; "" if the student has no other one."""
    here = Path(FOLDER, student, assignment)
    more = len(list((course.root / here).glob(f"*/{RECORD}"))) > 1
    return f", or let another one of theirs count, in {here.as_posix()}" if more else ""


def perhaps_late(course: Course, student: str, assignment: str) -> str:
    """A remark on work that may be late, as its time is not known exactly; "" if there is no doubt.

    Canvas marks late work as late, and the exchange records the times of hand-ins.
    """
    due = read_rules(course).due_for(student, assignment)
    try:
        chosen = counted_attempt(course, student, assignment)
    except LabkitError:  # collecting names a damaged record
        return ""
    if chosen is None or due is None or chosen.came.when <= due:
        return ""
    first = chosen.came
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
    """Store a notebook as an attempt.

    Args:
        course: The course.
        student: The student who handed it in.
        assignment: The assignment.
        data: The notebook.
        hand_in: When and where it was handed in or shown.
        secret: The secret by which the exchange identifies the hand-in.
        there: The student's attempts as `store_submitted` returns them, to which this one is
            added; by default they are read from the disk.

    Returns:
        Whether the attempt is new; False if another one has the same content.

    Raises:
        LabkitError: The record of an attempt is damaged.
    """
    there = by_digest(course, student, assignment) if there is None else there
    sha256 = digest(data)
    before, new = there.get(sha256), sha256 not in there
    if before is None:
        name = f"{hand_in.when:%Y-%m-%dT%H%M%SZ}-{sha256[:16]}"
        folder = course.root / FOLDER / student / assignment / name
        before = Attempt(folder / f"{safe_name(Path(hand_in.file).stem)}.ipynb", sha256, ())
        put(before.file, data)
    newest = max(
        (one.when for one in before.hand_ins if one.origin == "exchange"), default=hand_in.when
    )
    if secret is not None and hand_in.when >= newest:
        put(before.file.parent / SECRET, secret)
    same = (hand_in.when, hand_in.origin, hand_in.file, hand_in.exact)
    if all((x.when, x.origin, x.file, x.exact) != same for x in before.hand_ins):
        record = replace(before, hand_ins=(*before.hand_ins, hand_in))
        data = msgspec.json.encode(record, enc_hook=lambda file: file.name)
        text = msgspec.json.format(data, indent=1).decode()
        write(before.file.parent / RECORD, text + "\n")
        there[sha256] = record
    return new


def _by_a_person(hand_in: HandIn, one: Attempt) -> bool:
    """Whether a person put the attempt there; an older labkit recorded its own copies as such."""
    theirs = {int(x.when.timestamp()) for x in one.hand_ins if x.origin != BY_HAND}
    by_hand = hand_in.origin == BY_HAND and not hand_in.exact
    return by_hand and int(hand_in.when.timestamp()) not in theirs


def named_for(file: str, assignment: str) -> bool:
    """Whether a file is named after the assignment, with or without a number."""
    return _REPEATED.sub(".ipynb", file) == f"{assignment}.ipynb"


def _rank(hand_in: HandIn, assignment: str) -> tuple[bool, int, str]:
    """The sort key of notebooks that were handed in together; the highest counts."""
    match = _REPEATED.search(hand_in.file)  # a browser or platform added it
    return named_for(hand_in.file, assignment), int(match[1]) if match else 0, hand_in.collected


def by_digest(course: Course, student: str, assignment: str) -> dict[str, Attempt]:
    """All attempts of a student by SHA-256 digest."""
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


def put(path: Path, data: bytes) -> None:
    """Write a file, unless it already has this content; then its modification time stays."""
    if not path.is_file() or path.read_bytes() != data:
        write(path, data)
