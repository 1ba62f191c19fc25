"""Which student a user of a platform is, recorded by the folder that holds their work.

A student of the roster keeps the folder that the roster names for the whole term.  A user who is
not in the roster, or who could be either of two students, gets a separate folder and is reported.
That folder is named after the platform's number for the user, because people can change their names
and so be mistaken for others.  Users of Canvas and of the exchange keep their numbers all term.
Moodle's participants have another number in each assignment, so only a roster can connect them.

``course_private/lms.json`` lists the users whose work was collected, by assignment and by folder.
Git ignores the file, and it is archived with the term.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import contextmanager
from dataclasses import dataclass

import msgspec

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..atomic import write
from ..clean import clean_line, safe_name
from ..lock import locked
from ..submission import digest
from .platforms import LmsUser
from .roster import Roster

FILE = "course_private/lms.json"
_TOLD_APART = {
    "moodle": "you import the assignment's grading worksheet: labkit students import "
    "WORKSHEET.csv --assignment {}",
    "canvas": "you import Canvas's own list",
    "exchange": "you import a list with each student's login",
    "files": "the file is named by the student's login, address or number, and collected again",
}
"""What distinguishes people who have the same name on a platform."""
_READ_GREEDILY = re.compile(r"([^_/]*)_([0-9]+)_assignsubmission_file")


def lms_users(course: Course, assignment: str) -> dict[str, LmsUser]:
    """The users whose work was collected for an assignment, by the name of their folder.

    Raises:
        LabkitError: The record is damaged.
    """
    return all_lms_users(course).get(assignment, {})


def all_lms_users(course: Course) -> dict[str, dict[str, LmsUser]]:
    """The users whose work was collected, by assignment and by the name of their folder.

    Raises:
        LabkitError: The record is damaged.
    """
    path = course.root / FILE
    try:
        data = msgspec.json.decode(path.read_bytes(), type=dict[str, dict[str, LmsUser]])
    except FileNotFoundError:
        return {}
    except msgspec.DecodeError:
        raise LabkitError(
            f"{path} is damaged; restore it from a backup, or move it away and collect the "
            "downloads again, which writes it anew"
        ) from None
    return {x: {folder: _cleaned(one) for folder, one in y.items()} for x, y in data.items()}


def record_users(course: Course, assignment: str, found: Mapping[str, LmsUser]) -> None:
    """Record users by the name of their folder; nobody is left in two folders.

    Raises:
        LabkitError: The record is damaged.
    """
    if not found:
        return
    known = all_lms_users(course)
    mine = known.get(assignment, {})
    now = {one.key for one in found.values()}
    kept = {folder: one for folder, one in mine.items() if one.key not in now}
    for folder, one in found.items():  # export needs a platform's number
        if one.system in {"moodle", "canvas"} or folder not in kept:
            kept[folder] = one
    if kept != mine:
        save_lms_users(course, known | {assignment: kept})


def save_lms_users(course: Course, known: Mapping[str, Mapping[str, LmsUser]]) -> None:
    """Write the users whose work was collected, as `all_lms_users` reads them."""
    data = msgspec.json.encode(known, order="sorted")
    write(course.root / FILE, msgspec.json.format(data, indent=1) + b"\n")


@contextmanager
def identity_lock(course: Course) -> Iterator[None]:
    """Lock the roster and the records of users, which one command at a time may change.

    Raises:
        LabkitError: Another command holds the lock.
    """
    busy = "another command is collecting work or changing the roster; wait for it to end"
    with locked(course.root / "course_private" / ".identity", busy):
        yield


def _cleaned(user: LmsUser) -> LmsUser:
    """A cleaned entry; names that an older labkit read too greedily are cut back to the first."""
    greedy = _READ_GREEDILY.match(user.name) if user.system == "moodle" else None
    number, name = (greedy[2], greedy[1]) if greedy else (user.number, user.name)
    return LmsUser(*map(clean_line, (user.system, number, name)))


@dataclass(frozen=True)
class Place:
    """Where a person's work goes.

    Attributes:
        folder: The name of the folder.
        doubt: Why the owner is not certain; empty if there is no doubt.
    """

    folder: str
    doubt: str = ""


def assign_folders(
    people: Iterable[LmsUser],
    assignment: str,
    known: Mapping[str, Mapping[str, LmsUser]],
    roster: Roster,
) -> dict[tuple[str, str], Place]:
    """Choose the folder for each person's work, by `LmsUser.key`.

    Args:
        people: The people in one download.
        assignment: The assignment that was handed in.
        known: The users of earlier downloads, by assignment, then by folder.
        roster: The roster of the course; empty if none was imported.
    """
    named = {one.key: one for one in people}
    before = {  # Moodle's numbers hold for one assignment only
        one.key: folder
        for name in (*known, assignment)
        for folder, one in known.get(name, {}).items()
        if name == assignment or one.system != "moodle"
    }
    everyone = {one.key: one for one in known.get(assignment, {}).values()} | named
    claims = Counter(_claim(one, before.get(key, ""), roster) for key, one in everyone.items())
    owners = _owners(known, roster)
    found: dict[tuple[str, str], Place] = {}
    for key, one in named.items():
        folder, students = before.get(key, ""), roster.whose(one)
        if folder in roster:
            found[key] = Place(folder)
        elif roster.identifies(one) or (
            len(students) == 1 and claims[_claim(one, folder, roster)] == 1
        ):
            found[key] = Place(students[0].id)
        else:
            folder = folder or _own_folder(one, owners)
            owners.setdefault(folder.casefold(), set()).add(key)
            found[key] = Place(folder, _doubt(one, assignment, roster))
    return found


def _claim(one: LmsUser, folder: str, roster: Roster) -> tuple[str, ...]:
    """The students of the roster that a user of a platform is, or may be by name."""
    return (one.system, *([folder] if folder in roster else [s.id for s in roster.whose(one)]))


def _doubt(one: LmsUser, assignment: str, roster: Roster) -> str:
    """Why the owner of this work is not certain, and what to do; "" without a roster."""
    if not roster.students:
        return ""
    students = len(roster.whose(one))
    if not students:
        says = (
            f"{one} is not in the roster, so their work is kept apart; import a list that "
            "has them, labkit students import LIST.csv, and collect again"
        )
        if one.system == "moodle" and (alike := roster.alike(one.name)):
            people = " or ".join(map(str, alike))
            says += f"; if they are {people}, import the assignment's grading worksheet"
        return says
    until = f"their work is kept apart until {_TOLD_APART[one.system].format(assignment)}"
    if students > 1:
        return f"{one} has the name of {students} students of the roster; {until}"
    return f"{one} has the name of a student, and so has another user on record; {until}"


def _owners(
    known: Mapping[str, Mapping[str, LmsUser]], roster: Roster
) -> dict[str, set[tuple[str, str]]]:
    """The owners of each folder, in lower case, as some file systems ignore case."""
    owners = {student.id.casefold(): {("roster", student.id)} for student in roster.students}
    for people in known.values():
        for folder, one in people.items():
            owners.setdefault(folder.casefold(), set()).add(one.key)
    return owners


def _own_folder(one: LmsUser, owners: Mapping[str, Set[tuple[str, str]]]) -> str:
    """The name of a folder that nobody else has, made from the platform's number."""
    name, number = safe_name(one.name), one.number
    if one.system in {"moodle", "canvas"}:
        folder = f"{name}-{number}"
    elif safe_name(number) == number == number.lower():
        folder = number  # as nbgrader's own collect calls it
    else:
        folder = f"{name}-{digest(number.encode())[:8]}"
    while not owners.get(folder.casefold(), set()) <= {one.key}:
        folder += f"-{one.system}"
    return folder
