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

from .clean import safe_name
from .lms import Known
from .roster import Roster, same_name


@dataclass(frozen=True)
class Place:
    """Where a person's work goes.

    Attributes:
        folder: The name of the folder.
        doubt: Why it is not certain whose it is, empty if it is certain.
        before: The folder that this person's work lay in until it was known whose it is.
    """

    folder: str
    doubt: str = ""
    before: str = ""


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
    before = _before(assignment, known)
    everyone = {one.key: one for one in known.get(assignment, {}).values()} | named
    claims = Counter(_claim(one, before.get(key, ""), roster) for key, one in everyone.items())
    found: dict[tuple[str, str], Place] = {}
    nobody_yet: list[Known] = []
    for key, one in named.items():
        folder, students = before.get(key, ""), roster.whose(one)
        if folder in roster:
            found[key] = Place(folder)
        elif len(students) == 1 and claims[_claim(one, folder, roster)] == 1:
            found[key] = Place(students[0].id, before=folder)
        elif folder:
            found[key] = Place(folder, _doubt(one, roster))
        else:
            nobody_yet.append(one)
    taken = _Taken(assignment, known, roster, folders)
    names = Counter(_folder(one).casefold() for one in named.values())
    for one in nobody_yet:
        alone = names[_folder(one).casefold()] == 1 and not roster.whose(one)
        found[one.key] = Place(taken.free(one, alone), _doubt(one, roster))
    return found


def _doubt(one: Known, roster: Roster) -> str:
    if not roster.students:
        return ""
    students = roster.whose(one)
    if not students:
        return f"{one} is not in the roster"
    if len(students) > 1:
        return f"{one}: {len(students)} in the roster are called so"
    return f"{one}: somebody else handed in under this name, which the roster has once"


def _before(
    assignment: str, known: Mapping[str, Mapping[str, Known]]
) -> dict[tuple[str, str], str]:
    """The folder that each had; Moodle's numbers are those of one assignment."""
    return {
        one.key: folder
        for name in (*known, assignment)
        for folder, one in known.get(name, {}).items()
        if name == assignment or one.system != "moodle"
    }


def _claim(one: Known, folder: str, roster: Roster) -> tuple[str, ...]:
    """Which student of the roster a person of a platform is, or claims to be by name."""
    return (one.system, *([folder] if folder in roster else [s.id for s in roster.whose(one)]))


def _folder(one: Known) -> str:
    name = safe_name(one.name)
    return f"{name}-{one.number}" if one.system == "canvas" else name


class _Taken:
    """Folders that are somebody's."""

    def __init__(
        self,
        assignment: str,
        known: Mapping[str, Mapping[str, Known]],
        roster: Roster,
        folders: Iterable[str],
    ) -> None:
        self.owners: dict[str, set[tuple[str, ...]]] = {}
        for name, people in known.items():
            for folder, one in people.items():
                self._add(folder, one.key if name == assignment else _all_term(one))
        for student in roster.students:
            self._add(student.id, ("roster", student.id))
        for folder in folders:
            if folder.casefold() not in self.owners:
                self._add(folder, ("folder", folder))
        self.strict = bool(roster.students)

    def free(self, one: Known, alone: bool) -> str:
        """A folder that is nobody else's, and now this person's."""
        plain = _folder(one)
        mine = {one.key, _all_term(one)}
        if one.system == "exchange" or not self.strict:
            mine.add(("folder", plain))
        names = [plain] * alone + [f"{plain}-{one.number}"] * (one.system == "moodle")
        names += [f"{plain}-{k}" for k in range(2, len(self.owners) + 4)]
        name = next(x for x in names if self.owners.get(x.casefold(), set()) <= mine)
        self._add(name, one.key)
        return name

    def _add(self, folder: str, owner: tuple[str, ...]) -> None:
        self.owners.setdefault(folder.casefold(), set()).add(owner)


def _all_term(one: Known) -> tuple[str, ...]:
    """What stays the same from one assignment to the next."""
    return ("moodle", "called", *same_name(one.name)) if one.system == "moodle" else one.key
