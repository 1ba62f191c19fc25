"""Which folder is whose: one for each person, the same in all assignments.

A person has the folder that the roster says.  Whoever is not in the roster, or is there twice, gets
a folder of their own that is nobody else's, and is named.  Without a roster Canvas's users and
those of the exchange are known by what stays the same all term; Moodle's participants have another
number in each assignment, so they are known by name, and by the number where two have one name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain, count

from .clean import safe_name
from .lms import Known
from .roster import Roster, same_name

_BY_HAND = (
    "{} has the name of a folder that somebody made by hand, so their work is kept apart; a list "
    "of students that you import first says whose a folder is"
)


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
    people: Iterable[Known],
    assignment: str,
    known: Mapping[str, Mapping[str, Known]],
    roster: Roster,
    folders: Iterable[str],
) -> dict[tuple[str, str], Place]:
    """Where each person's work goes, by `Known.key`.

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
            alone = names[plain.casefold()] == 1 and not students
            folder = folder or _free(one, alone, owners)
            owners.setdefault(folder.casefold(), set()).add(key)
            if roster.students:
                found[key] = Place(folder, _doubt(one, len(students)))
            else:
                found[key] = Place(folder, _BY_HAND.format(one) * (by_hand and folder != plain))
    return found


def _claim(one: Known, folder: str, roster: Roster) -> tuple[str, ...]:
    """Which student of the roster a person of a platform is, or claims to be by name."""
    return (one.system, *([folder] if folder in roster else [s.id for s in roster.whose(one)]))


def _doubt(one: Known, students: int) -> str:
    if not students:
        return f"{one} is not in the roster, so their work is kept apart"
    until = "their work is kept apart until you import the assignment's grading worksheet"
    if students > 1:
        return f"{one} has the name of {students} students of the roster; {until}"
    return f"{one} has the name of a student, and so has somebody else who handed in; {until}"


def _plain(one: Known) -> str:
    name = safe_name(one.name)
    return f"{name}-{one.number}" if one.system == "canvas" else name


def _all_term(one: Known) -> tuple[str, ...]:
    """What stays the same from one assignment to the next."""
    return ("called", *same_name(one.name)) if one.system == "moodle" else one.key


def _owners(
    assignment: str,
    known: Mapping[str, Mapping[str, Known]],
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


def _free(one: Known, alone: bool, owners: Mapping[str, set[tuple[str, ...]]]) -> str:
    """The name of a folder that is nobody else's."""
    plain, mine = _plain(one), {one.key, _all_term(one)}
    if one.system == "exchange":
        mine.add(("folder", plain))  # nbgrader's own collect calls it after the user
    numbered = [f"{plain}-{one.number}"] * (one.system == "moodle")
    names = chain([plain] * alone, numbered, (f"{plain}-{k}" for k in count(2)))
    return next(name for name in names if owners.get(name.casefold(), set()) <= mine)
