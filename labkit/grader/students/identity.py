"""Whom a platform means: its users, by the folder that holds their work, the same all term.

A person has the folder that the roster says.  Students who are missing from the
roster, or are there twice, get folders of their own that nobody else has, and are named.  Without a
roster Canvas's users and those of the exchange are known by what stays the same all term; Moodle's
participants have another number in each assignment, so they are known by name, and by the number
where two have one name.

``course_private/lms.json`` lists the users whose work was collected, by assignment and by folder.
Git ignores the file, and it goes with the term.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, count

import msgspec

from ...course.layout import Course
from ...errors import LabkitError
from ..atomic import write
from ..clean import clean_line, safe_name
from ..lock import locked
from .platforms import LmsUser
from .roster import Roster, same_name

FILE = "course_private/lms.json"
_READ_GREEDILY = re.compile(r"([^_/]*)_([0-9]+)_assignsubmission_file")
_BY_HAND = (
    "{} has the name of a folder that somebody made by hand, so their work is kept apart; a list "
    "of students that you import first says whose a folder is"
)


def lms_users(course: Course, assignment: str) -> dict[str, LmsUser]:
    """Who was collected from a platform, by the name of their folder.

    Raises:
        LabkitError: The record is damaged.
    """
    return all_lms_users(course).get(assignment, {})


def all_lms_users(course: Course) -> dict[str, dict[str, LmsUser]]:
    """Who was collected, by assignment and by the name of their folder.

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


def remember(course: Course, assignment: str, found: Mapping[str, LmsUser]) -> None:
    """Add to what is known, by the name of the folder; nobody is left in two folders.

    Raises:
        LabkitError: The record is damaged.
    """
    if not found:
        return
    known = all_lms_users(course)
    mine = known.get(assignment, {})
    now = {one.key for one in found.values()}
    kept = {folder: one for folder, one in mine.items() if one.key not in now}
    for folder, one in found.items():  # a platform's number is needed later
        if one.system in {"moodle", "canvas"} or folder not in kept:
            kept[folder] = one
    if kept != mine:
        save_lms_users(course, known | {assignment: kept})


def save_lms_users(course: Course, known: Mapping[str, Mapping[str, LmsUser]]) -> None:
    """Write who was collected, as `all_lms_users` reads it."""
    data = msgspec.json.encode(known, order="sorted")
    write(course.root / FILE, msgspec.json.format(data, indent=1) + b"\n")


@contextmanager
def alone(course: Course) -> Iterator[None]:
    """Keep a second one away from the records of who is who.

    Raises:
        LabkitError: Somebody else is at it.
    """
    busy = "somebody else is collecting or changes who is in the class; wait for it to end"
    with locked(course.root / "course_private" / ".identity", busy):
        yield


def _cleaned(user: LmsUser) -> LmsUser:
    """One entry; of those that an older labkit read greedily, the name is the first person's."""
    greedy = _READ_GREEDILY.match(user.name) if user.system == "moodle" else None
    number, name = (greedy[2], greedy[1]) if greedy else (user.number, user.name)
    return LmsUser(*map(clean_line, (user.system, number, name)))


@dataclass(frozen=True)
class Place:
    """Where a person's work goes.

    Attributes:
        folder: The name of the folder.
        doubt: Why it is not certain whose it is, empty if it is certain.
    """

    folder: str
    doubt: str = ""


def places(
    people: Iterable[LmsUser],
    assignment: str,
    known: Mapping[str, Mapping[str, LmsUser]],
    roster: Roster,
    folders: Iterable[str],
) -> dict[tuple[str, str], Place]:
    """Where each person's work goes, by `LmsUser.key`.

    Args:
        people: Those of one download.
        assignment: Which was handed in.
        known: What is known from earlier downloads, by assignment, then by folder.
        roster: The course's; an empty one if none was imported.
        folders: The names of those that are there.
    """
    named = {one.key: one for one in people}
    before = {  # Moodle's numbers are those of one assignment
        one.key: folder
        for name in (*known, assignment)
        for folder, one in known.get(name, {}).items()
        if name == assignment or one.system != "moodle"
    }
    everyone = {one.key: one for one in known.get(assignment, {}).values()} | named
    claims = Counter(_claim(one, before.get(key, ""), roster) for key, one in everyone.items())
    names = Counter(_plain(one).casefold() for one in named.values())
    owners = _owners(assignment, known, roster, folders)
    found: dict[tuple[str, str], Place] = {}
    for key, one in named.items():
        folder, students = before.get(key, ""), roster.whose(one)
        if folder in roster:
            found[key] = Place(folder)
        elif len(students) == 1 and claims[_claim(one, folder, roster)] == 1:
            found[key] = Place(students[0].id)
        else:
            plain = _plain(one)
            by_hand = not folder and ("folder", plain) in owners.get(plain.casefold(), ())
            unique = names[plain.casefold()] == 1 and not students
            folder = folder or _free(one, unique, owners)
            owners.setdefault(folder.casefold(), set()).add(key)
            if roster.students:
                found[key] = Place(folder, _doubt(one, len(students)))
            else:
                found[key] = Place(folder, _BY_HAND.format(one) * (by_hand and folder != plain))
    return found


def _claim(one: LmsUser, folder: str, roster: Roster) -> tuple[str, ...]:
    """Which student of the roster a person of a platform is, or claims to be by name."""
    return (one.system, *([folder] if folder in roster else [s.id for s in roster.whose(one)]))


def _doubt(one: LmsUser, students: int) -> str:
    if not students:
        return (
            f"{one} is not in the roster, so their work is kept apart; import a list that "
            "has them, labkit students import LIST.csv, and collect again"
        )
    until = "their work is kept apart until you import the assignment's grading worksheet"
    if students > 1:
        return f"{one} has the name of {students} students of the roster; {until}"
    return f"{one} has the name of a student, and so has somebody else who handed in; {until}"


def _plain(one: LmsUser) -> str:
    name = safe_name(one.name)
    return f"{name}-{one.number}" if one.system == "canvas" else name


def _all_term(one: LmsUser) -> tuple[str, ...]:
    """What stays the same from one assignment to the next."""
    return ("called", *same_name(one.name)) if one.system == "moodle" else one.key


def _owners(
    assignment: str,
    known: Mapping[str, Mapping[str, LmsUser]],
    roster: Roster,
    folders: Iterable[str],
) -> dict[str, set[tuple[str, ...]]]:
    """Whose each folder is; file systems may not tell capitals from small letters."""
    owners: dict[str, set[tuple[str, ...]]] = {}
    for name, people in known.items():
        for folder, one in people.items():
            owner = one.key if name == assignment else _all_term(one)
            owners.setdefault(folder.casefold(), set()).add(owner)
    for student in roster.students:
        owners.setdefault(student.id.casefold(), set()).add(("roster", student.id))
    for folder in folders:
        owners.setdefault(folder.casefold(), {("folder", folder)})
    return owners


def _free(one: LmsUser, unique: bool, owners: Mapping[str, set[tuple[str, ...]]]) -> str:
    """The name of a folder that is nobody else's."""
    plain, mine = _plain(one), {one.key, _all_term(one)}
    if one.system == "exchange":
        mine.add(("folder", one.number))  # nbgrader's own collect calls it after the user
    numbered = [f"{plain}-{one.number}"] * (one.system == "moodle")
    names = chain([plain] * unique, numbered, (f"{plain}-{k}" for k in count(2)))
    return next(name for name in names if owners.get(name.casefold(), set()) <= mine)
