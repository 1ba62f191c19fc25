"""How a platform knows the students whose work was collected from it.

The numbers stand in ``course_private/lms.json``, by assignment and by the name of the student's
folder.  Git ignores the file, and it goes with the term.
"""

from __future__ import annotations

import fcntl
import json
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass

from ..course.layout import Course
from ..errors import LabkitError
from .clean import clean_line
from .results import write

FILE = "course_private/lms.json"
_READ_GREEDILY = re.compile(r"([^_/]*)_([0-9]+)_assignsubmission_file")


@dataclass(frozen=True)
class Known:
    """A person as a platform's download names them.

    Attributes:
        system: "moodle", "canvas" or "exchange".
        number: Canvas's number of the user; Moodle's of the participant, one for each assignment;
            the name of the user in the exchange.
        name: As it stands in the download.
    """

    system: str
    number: str
    name: str

    @property
    def key(self) -> tuple[str, str]:
        """What tells this person from all others in one assignment."""
        return self.system, self.number

    def __str__(self) -> str:
        what = {"moodle": "participant", "canvas": "Canvas's user", "exchange": "user"}[self.system]
        return f"{what} {self.number}" + (f" ({self.name})" if self.name != self.number else "")


def known(course: Course, assignment: str) -> dict[str, Known]:
    """Who was collected from a platform, by the name of their folder.

    Raises:
        LabkitError: The record is damaged.
    """
    return known_all_term(course).get(assignment, {})


def known_all_term(course: Course) -> dict[str, dict[str, Known]]:
    """The same for each assignment.

    Raises:
        LabkitError: The record is damaged.
    """
    path = course.root / FILE
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        return {
            assignment: {folder: _known(**about) for folder, about in people.items()}
            for assignment, people in data.items()
        }
    except FileNotFoundError:
        return {}
    except (ValueError, TypeError, AttributeError):
        raise LabkitError(
            f"{path} is damaged; restore it from a backup, or move it away and collect the "
            "downloads again, which writes it anew"
        ) from None


def remember(course: Course, assignment: str, found: Mapping[str, Known]) -> None:
    """Add to what is known, by the name of the folder; nobody is left in two folders.

    Raises:
        LabkitError: The record is damaged.
    """
    if not found:
        return
    data = known_all_term(course)
    mine = data.get(assignment, {})
    now = {one.key for one in found.values()}
    kept = {folder: one for folder, one in mine.items() if one.key not in now}
    for folder, one in found.items():
        if one.system != "exchange" or folder not in kept:  # a platform's number is needed later
            kept[folder] = one
    if kept != mine:
        data[assignment] = kept
        plain = {name: {k: asdict(v) for k, v in people.items()} for name, people in data.items()}
        text = json.dumps(plain, indent=1, ensure_ascii=False, sort_keys=True)
        write(course.root / FILE, text + "\n")


@contextmanager
def alone(course: Course) -> Iterator[None]:
    """Keep a second one away from the records of who is who.

    Raises:
        LabkitError: Somebody else is at it.
    """
    lock = course.root / "course_private" / ".identity"
    lock.parent.mkdir(exist_ok=True)
    with open(lock, "w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise LabkitError("somebody else is collecting; wait for it to end") from None
        yield


def _known(system: str, number: str, name: str) -> Known:
    """One entry; of those that an older labkit read greedily, the name is the first person's."""
    if not all(isinstance(x, str) for x in (system, number, name)):
        raise TypeError
    greedy = _READ_GREEDILY.match(name) if system == "moodle" else None
    name, number = (greedy[1], greedy[2]) if greedy else (name, number)
    return Known(clean_line(system), clean_line(number), clean_line(name))
