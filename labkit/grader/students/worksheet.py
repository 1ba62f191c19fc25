"""Moodle's grading worksheet: each student's participant number and hand-in time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..clean import few, how_many, span
from ..each import Failure
from ..rules import Rules
from ..timestamp import read_time
from .attempts import (
    FOLDER,
    RECORD,
    Attempt,
    Counted,
    attempts,
    choose,
    counted_attempt,
    perhaps_late,
    store,
)
from .class_list import Entry, Student
from .identity import FILE, all_lms_users, assign_folders, lms_users, record_users
from .installed import install, instead
from .list_remarks import about_extensions
from .move import move_work
from .platforms import LmsUser
from .roster import Roster


def refuse_another(
    course: Course, assignment: str, roster: Roster, rows: Iterable[tuple[Entry, Student]]
) -> None:
    """Refuse a worksheet that gives students other numbers than this assignment has already.

    The number with which a student's work was collected is certain; that of an earlier worksheet
    counts only for a student without such work.  Moodle gives no number twice: if two students
    change places, both numbers are known; in another assignment's worksheet, none is.

    Raises:
        LabkitError: Each student who has a number would get another one.
    """
    known, collected = all_lms_users(course), dict(_collected(course, assignment))
    users = [one for one in known.get(assignment, {}).values() if one.system == "moodle"]
    found = assign_folders(users, assignment, known, roster)
    sure = {folder for folder in collected.values() if folder in roster}
    owners = collected | {key: x.folder for key, x in found.items() if x.folder not in sure}
    numbered = {*owners.values()}
    here = [("moodle", e.participant) for e, s in rows if e.participant and s.id in numbered]
    if here and owners.keys().isdisjoint(here):
        raise LabkitError(
            f"nothing was imported: each student with a number in {assignment} ({len(here)}) "
            "would get another, so this is probably another assignment's worksheet; give "
            f"that one's name with --assignment. If {assignment} was made again in Moodle, or "
            f"its recorded numbers are wrong, delete the entry {assignment!r} from {FILE}, collect "
            "the download again, and then import this worksheet"
        )


def _collected(course: Course, assignment: str) -> Iterator[tuple[tuple[str, str], str]]:
    """The users of Moodle whose work was collected, by `LmsUser.key`, and the folders it is in."""
    for place in sorted((course.root / FOLDER).glob(f"*/{assignment}")):
        folder = place.parent.name
        hand_ins = (x for one in attempts(course, folder, assignment) for x in one.hand_ins)
        yield from (((x.origin, x.number), folder) for x in hand_ins if x.origin == "moodle")


def keep_numbers(
    course: Course, assignment: str, roster: Roster, rows: Iterable[tuple[Entry, Student]]
) -> list[Failure]:
    """Record each student's participant number, and move earlier work to its owner.

    Collected work in a folder that is not in the roster goes to the student with its number.

    Returns:
        The folders that stayed, and why.
    """
    mine = {s.id: LmsUser("moodle", e.participant, s.name) for e, s in rows if e.participant}
    owners = {one.key: id for id, one in mine.items()}
    places = [(one.key, folder) for folder, one in lms_users(course, assignment).items()]
    places += [place for place in _collected(course, assignment) if place[1] not in roster]
    moves = {folder: owners[key] for key, folder in places if key in owners}
    left = move_work(course, assignment, moves)
    record_users(course, assignment, mine)
    return left


def keep_times(
    course: Course, assignment: str, rows: Sequence[tuple[Entry, Student]], rules: Rules
) -> tuple[int, list[str], list[str]]:
    """Record when each counted attempt was handed in, as Moodle's worksheet says.

    Returns:
        How many times were recorded; a sentence for each student who is late or perhaps late; and
        sentences on what a person should look at: times that were not recorded, or that change
        which attempt counts or what feedback says, and extensions that reach nobody.
    """
    zone, taken = ZoneInfo(rules.zone), 0
    late, left, waiting, returned = (list[str]() for _ in range(4))
    for entry, student in rows:
        theirs = attempts(course, student.id, assignment)
        chosen, said = choose(theirs, assignment), entry.handed_in.strip(" -")
        if chosen is None:
            if said:
                waiting.append(str(student))
            continue
        first = chosen.first
        if first.origin != "moodle" or (first.exact and not said):
            continue
        at = read_time(said, zone)
        when = _time(said, at, zone, chosen, theirs)
        if when is None:
            if doubt := perhaps_late(course, student.id, assignment):
                late.append(f"{student} handed in the same file again, at {said}; {doubt}")
            elif first.exact and at and _late(rules, assignment, student, at):
                record = (chosen.attempt.file.parent / RECORD).relative_to(course.root)
                left.append(
                    f"{student}: the hand-in time stays {_local(first.when, zone)}, and the "
                    f"worksheet now says {said!r}; if they did not hand in the same file twice, "
                    "the recorded time is wrong, as after the worksheet of another assignment or "
                    f"with another zone: delete the entry with this time from {record}, and import "
                    "the worksheet again"
                )
        elif isinstance(when, str):
            left.append(f"{student}: no hand-in time is set; the worksheet says {when}")
        elif when != first.when or not first.exact:
            before = counted_attempt(course, student.id, assignment)
            data = chosen.attempt.file.read_bytes()
            store(course, student.id, assignment, data, replace(first, when=when, exact=True))
            after = install(course, student.id, assignment)
            if says := instead(before, after):
                left.append(f"{student}: {says}; to grade it, type: labkit grade {assignment}")
            if after and (says := _late(rules, assignment, student, after.came.when)):
                late.append(says)
                page = course.root / "feedback" / student.id / assignment / f"{assignment}.html"
                if page.exists():
                    returned.append(str(student))
            taken += 1
    if left and not any(entry.handed_in for entry, _ in rows):
        left = [
            "no hand-in time is set; the worksheet has none, or its column is not called 'Last "
            "modified (submission)'; download it in English"
        ]
    if returned:
        left.append(
            f"the feedback of {how_many(len(returned), 'student')} does not say yet that they were "
            f"late: {few(returned)}; type: labkit feedback {assignment}"
        )
    if waiting:
        left.append(
            f"{how_many(len(waiting), 'student')} handed in, and nothing of theirs was collected "
            f"yet: {few(waiting)}; collect the download, then import the worksheet again"
        )
    return taken, late, [*left, *about_extensions(course)]


def _late(rules: Rules, assignment: str, student: Student, when: datetime) -> str:
    """The sentence that a student was late, and what is deducted; "" if the work was in time."""
    latest = rules.due_for(student.id, assignment)
    if latest is None or when <= latest:
        return ""
    due = latest - timedelta(minutes=rules.late.grace_minutes)
    seconds = (when - due).total_seconds()
    share = rules.late.penalty(100.0, seconds)
    costs = f"; {share:g} % of the points earned are deducted" if share else ""
    at = _local(due, ZoneInfo(rules.zone))
    return f"late: {student}, {span(seconds)} after the due date {at}{costs}"


def _time(
    said: str, when: datetime | None, zone: ZoneInfo, chosen: Counted, theirs: Sequence[Attempt]
) -> datetime | str | None:
    """The time of the attempt that counts; or why the worksheet gives none, and what to do.

    None if the same file was probably handed in again: the worksheet knows only when that was.
    """
    first = chosen.first.when
    others = [x.when for one in theirs if one is not chosen.attempt for x in one.hand_ins]
    earlier = max((x for x in others if x < first), default=None)
    if when is None:
        unread = "which is not a time that labkit can read; download the worksheet in English"
        nothing = "nothing; download the worksheet again, and import it"
        return f"{said!r}, {unread}" if said else nothing
    if when > first:
        if any(x.origin == "moodle" and x.when >= when for x in chosen.attempt.hand_ins):
            return None
        return (
            f"{said!r}, and the download that was collected is from {_local(first, zone)}; collect "
            "a newer download, or this one with --at and the time at which it was made; then "
            "import the worksheet again"
        )
    if earlier and when <= earlier:
        return (
            f"{said!r}, and a download from {_local(earlier, zone)} shows an earlier notebook; "
            "download the worksheet again, and import it"
        )
    return when


def _local(when: datetime, zone: ZoneInfo) -> str:
    return f"{when.astimezone(zone):%Y-%m-%d %H:%M %Z}"
