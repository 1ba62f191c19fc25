"""Find the owner of a file in a download, by its name and the roster."""

from __future__ import annotations

from ..clean import how_many
from .platforms import File, LmsUser, Named
from .roster import Roster


def find_owner(file: File, roster: Roster) -> Named | str:
    """The correct reading of a file's name, or why there is none."""
    if file.refused or not file.readings:
        return file.refused or "not taken; its name does not say who handed it in"
    if len(file.readings) == 1:
        who = file.readings[0].who
        ids = [one.id for one in roster.whose(who)]
        if who.system == "files" and roster.students and len(ids) != 1:
            cure = "correct the roster with labkit students import LIST.csv"
            if ids:
                cure = f"name the file or folder by {' or '.join(ids)}, or by a login or number"
            known = how_many(len(ids), "student")
            return (
                f"not taken; {who.name!r} matches {known} of the roster; {cure}, and collect again"
            )
        return file.readings[0]
    fits = [named for named in file.readings if _is_called_so(named.who, roster)]
    if len(fits) == 1:
        return fits[0]
    people = " or ".join(str(named.who) for named in file.readings)
    return f"not taken; it may belong to {people}; the roster does not say which"


def _is_called_so(who: LmsUser, roster: Roster) -> bool:
    """Whether the roster has this Canvas user under this name."""
    names = [f"{s.last_name}{s.first_name}" for s in roster.whose(who)]
    return letters(who.name) in map(letters, names)


def letters(name: str) -> str:
    """A name reduced to lower-case letters and digits, as some platforms write it."""
    return "".join(c for c in name.casefold() if c.isalnum())
