"""How a learning platform knows the students whose work was collected from it.

Names and numbers stand in ``course_private/lms.json``, which git ignores; they go with the term.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from .course import Course
from .results import write

FILE = "course_private/lms.json"


@dataclass(frozen=True)
class Known:
    """A student as a platform's download names him.

    Attributes:
        system: "moodle" or "canvas".
        number: Canvas's number of the user; Moodle's of the participant, one for each assignment.
        name: As it stands in the download.
    """

    system: str
    number: str
    name: str


def known(course: Course, assignment: str) -> dict[str, Known]:
    """Who was collected from a platform, by the name of his folder."""
    return {student: Known(**about) for student, about in _read(course).get(assignment, {}).items()}


def remember(course: Course, assignment: str, found: Mapping[str, Known]) -> None:
    """Add to what is known, by the name of the folder."""
    if found:
        data = _read(course)
        data.setdefault(assignment, {}).update({k: asdict(v) for k, v in found.items()})
        text = json.dumps(data, indent=1, ensure_ascii=False, sort_keys=True)
        write(course.root / FILE, text + "\n")


def folders(slugs: Mapping[Known, str], before: Mapping[str, Known]) -> dict[Known, str]:
    """Which folder each student gets.

    Canvas's numbers stay the same all term, so they are part of the name.  Moodle's do not, so a
    student is called by his name alone, and by the number too only where two have that name.

    Args:
        slugs: Those of one download, with their names as a folder's.
        before: By folder, from earlier downloads of this assignment.
    """
    there = {(one.system, one.number): folder for folder, one in before.items()}
    names = list(slugs.values())
    chosen = {}
    for one, slug in slugs.items():
        alone = one.system == "moodle" and names.count(slug) == 1 and slug not in before
        chosen[one] = there.get((one.system, one.number)) or (
            slug if alone else f"{slug}-{one.number}"
        )
    return chosen


def _read(course: Course) -> dict[str, dict[str, dict[str, str]]]:
    path = course.root / FILE
    if not path.exists():
        return {}
    data: dict[str, dict[str, dict[str, str]]] = json.loads(path.read_text(encoding="utf-8"))
    return data
