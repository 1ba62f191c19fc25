"""Collect: downloads from Moodle and Canvas, or nbgrader's exchange, into ``submitted/``.

The owner of a file follows from the platform's own field (``platforms``) and from the roster
(``owner``, ``identity``); ``attempts`` decides which of a student's notebooks counts.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..clean import few
from ..each import Failure, for_student
from ..submission import digest
from .attempts import (
    HandIn,
    counted_attempt,
    named_for,
    perhaps_late,
    store,
)
from .exchange import in_exchange
from .identity import all_lms_users, assign_folders, identity_lock, record_users
from .installed import in_place, install, instead, store_submitted
from .move import move_to_owners
from .owner import find_owner
from .platforms import File, Named, in_folder, in_zip, open_zip, reader
from .roster import read_roster


@dataclass(frozen=True)
class Taken:
    """A file, and what was done with it.

    Attributes:
        student: The name of the owner's folder; empty if the owner is not known.
        file: The file's name in the download; empty if the remark concerns no single file.
        says: What was done.
        fine: Whether nobody needs to look at it.
    """

    student: str
    file: str
    says: str
    fine: bool = True

    def __str__(self) -> str:
        return ": ".join(filter(None, (self.student, self.file, self.says)))


_NO_LIST = (
    "no class list, so students are known by the platform's numbers alone, which Moodle gives anew "
    "in each assignment; for one folder a student all term, type: labkit students import LIST.csv"
)
_PERHAPS_LATE = (
    "perhaps late: {who}; no late rule is applied to them until their hand-in times are known: "
    "with Moodle, download the grading worksheet now and type: labkit students import "
    "WORKSHEET.csv --assignment {of}; with files of your own, collect with --at"
)
_HandedIn = tuple[File, Named]
"""A file, and the correct reading of its name."""


def collect(
    course: Course,
    assignment: str,
    source: Path,
    *,
    unverified: bool = False,
    named: str | None = None,
    at: datetime | None = None,
) -> Iterator[Taken]:
    """Collect notebooks from a download; collecting it again changes nothing.

    Args:
        course: The course.
        assignment: The assignment.
        source: A zip from Moodle or Canvas, or the inbound folder of nbgrader's exchange.
        unverified: Whether to collect from users of the exchange whom this machine does not know.
        named: The pattern of the names of files that come from no platform, such as
            ``paths-{student}/*.ipynb``; the source is then a folder or a zip of such files.
        at: When the source was made, if that is known.  It is the hand-in time of files that come
            from no platform, and the latest possible hand-in time for a platform's zip.

    Yields:
        What was done with each file.

    Raises:
        LabkitError: The source is not of these kinds, is damaged, or holds nothing; or a record
            of the course is damaged.
    """
    if not source.exists():
        raise LabkitError(f"there is no {source}")
    if not (source.is_file() or source.is_dir()):  # a device or pipe may never end
        raise LabkitError(f"{source} is neither a file nor a folder; give the download as it is")
    now = datetime.fromtimestamp(int(source.stat().st_mtime), UTC)
    with identity_lock(course):
        if named is not None:
            read = reader(named)
            others = [x for x in course.names() if x != assignment]
            with ExitStack() as stack:
                if source.is_dir():
                    files = list(in_folder(source, read))
                else:
                    files = list(in_zip(stack.enter_context(open_zip(source)), now, read))
                mine = [
                    x for x in files if not any(named_for(Path(x.label).name, y) for y in others)
                ]
                yield from _with_nothing_else(files, mine)
                if not mine:
                    raise LabkitError(f"nothing in {source} is for {assignment} and fits {named!r}")
                yield from _collect(course, assignment, source, [_made(x, at, True) for x in mine])
        elif source.is_dir():
            files = list(in_exchange(source, assignment, unverified=unverified))
            yield from _collect(course, assignment, source, files)
        elif not zipfile.is_zipfile(source):
            raise LabkitError(
                f"{source} is neither a folder nor a zip file; give the download as it is"
            )
        else:
            with open_zip(source) as archive:
                files = [_made(file, at, False) for file in in_zip(archive, now)]
                yield from _collect(course, assignment, source, files)


def _with_nothing_else(files: Sequence[File], mine: Sequence[File]) -> Iterator[Taken]:
    """Name files of other assignments if a student handed in nothing else.

    Args:
        files: All files.
        mine: Those that are not named after another assignment.
    """
    known = {x.readings[0].who for x in mine if x.readings}
    left: dict[str, list[str]] = {}
    for file in files:
        if file.readings and file.readings[0].who not in known:
            left.setdefault(file.readings[0].who.name, []).append(file.readings[0].file)
    for who, names in left.items():
        yield Taken(who, "", f"not taken; named after another assignment: {few(names)}")


def _made(file: File, at: datetime | None, exact: bool) -> File:
    """The file, dated by the time of its source if that is known, as an ``exact`` time or not."""
    return file if at is None else replace(file, when=at, exact=exact)


def _collect(
    course: Course, assignment: str, source: Path, files: Sequence[File]
) -> Iterator[Taken]:
    if not files:
        kind = "the inbound folder of nbgrader's exchange" if source.is_dir() else "a zip"
        raise LabkitError(
            f"nothing in {source} was handed in for {assignment}, read as {kind}; files that come "
            "from no platform need --named, such as --named 'paths-{student}/*.ipynb'"
        )
    roster = read_roster(course)
    for left in move_to_owners(course, roster):
        yield Taken("", "", left.why, fine=False)
    known = all_lms_users(course)
    handed_in: list[_HandedIn] = []
    for file in files:
        named = find_owner(file, roster)
        if isinstance(named, str):
            yield Taken("", file.label, named, fine=False)
        else:
            handed_in.append((file, named))
    people = {named.who.key: named.who for _, named in handed_in}
    found = assign_folders(people.values(), assignment, known, roster)
    by_folder = {place.folder: people[key] for key, place in found.items()}
    if not roster.students:
        yield Taken("", "", _NO_LIST)
    for place in found.values():
        if place.doubt:
            yield Taken(place.folder, "", place.doubt, fine=False)
    record_users(course, assignment, by_folder)
    by_student: dict[str, list[_HandedIn]] = {}
    for file, named in handed_in:
        by_student.setdefault(found[named.who.key].folder, []).append((file, named))
    for student, mine in sorted(by_student.items()):
        yield from _store(course, assignment, student, mine)
    if late := [x for x in sorted(by_student) if perhaps_late(course, x, assignment)]:
        yield Taken("", "", _PERHAPS_LATE.format(who=f"{len(late)} ({few(late)})", of=assignment))


def _store(
    course: Course, assignment: str, student: str, mine: Sequence[_HandedIn]
) -> Iterator[Taken]:
    """Store one student's notebooks, and copy the one that counts to ``submitted/``."""
    notebooks = [(file, named) for file, named in mine if not _no_notebook(named)]
    for _, named in mine:
        if says := _no_notebook(named):
            yield Taken(student, named.file, f"not taken; {says}", fine=bool(notebooks))
    done = for_student(student, lambda: list(_store_each(course, assignment, student, notebooks)))
    if isinstance(done, Failure):
        done = [Taken(student, "", f"not taken; {done.why}", fine=False)]
    yield from done


def _no_notebook(named: Named) -> str:
    file = named.file.lower()
    if named.kind != "file":
        return f"it came as Moodle's {named.kind} and not as a file"
    if file.endswith(".zip"):
        return "it is a zip; ask for the notebook itself"
    return "" if file.endswith(".ipynb") else "it is not a notebook"


def _store_each(
    course: Course, assignment: str, student: str, notebooks: Sequence[_HandedIn]
) -> Iterator[Taken]:
    now = str(datetime.now(UTC))
    there = store_submitted(course, student, assignment, now)
    lies = in_place(course, student, assignment, there)
    before = counted_attempt(course, student, assignment)
    shown = max((file.when for file, _ in notebooks), default=datetime.now(UTC))
    done: list[tuple[HandIn, str, bool]] = []
    for file, named in notebooks:
        try:
            data, secret = file.read(), file.secret()
        except LabkitError as error:
            yield Taken(student, named.file, f"not taken; {error}", fine=False)
            continue
        when = file.when if file.exact else shown  # a download shows them all at once
        hand_in = HandIn(when, *named.who.key, named.file, file.exact, named.late, now)
        new = store(course, student, assignment, data, hand_in, secret, there)
        done.append((hand_in, digest(data), new))
    after = install(course, student, assignment)
    beside = {x.when: x.file for x in after.attempt.hand_ins} if after else {}
    for hand_in, sha256, new in done:
        if after is None or after.attempt.sha256 != sha256:
            which = beside.get(hand_in.when, "one")
            if after and which in {hand_in.file, "one"}:
                which = f"another {which}, of {after.came.when:%Y-%m-%d %H:%M %Z},"
            says = f"{'kept' if new else 'there already'}, but {which} counts"
        elif before is not None and before.attempt.sha256 == sha256:
            says = "there already"
        else:
            older = before is None or before.first.when < after.first.when
            which = "an earlier one" if older else str(before).replace("the file", "the one")
            says = "taken" + (f", in place of {which}, which is kept" if before else "")
            says += "" if hand_in.file == f"{assignment}.ipynb" else f", as {assignment}.ipynb"
        yield Taken(student, hand_in.file, says + (", late" if hand_in.late else ""))
    new_one = before is None or after is None or before.attempt.sha256 != after.attempt.sha256
    if not new_one and (says := instead(lies, after)):
        yield Taken(student, "", says)
