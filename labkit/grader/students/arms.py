"""Give each student of the roster, or each team, an arm of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...course.authoring.layout import Course
from ...course.own_arm import DEMO, FILE, HANDLES, Arms
from ..atomic import write

if TYPE_CHECKING:
    from .roster import Roster


def give_arms(course: Course, roster: Roster, key: str) -> None:
    """Record which student has which arm, and put the arms beside released notebooks.

    The students of a team share one arm. An arm depends only on the key and the handle, so it
    stays the same when others join the class.

    Args:
        course: The course.
        roster: The students of the course.
        key: The term's key for arms.
    """
    handles = {student.id: student.team or student.id for student in roster.students}
    write(course.root / HANDLES, Arms(key, handles).text())
    for name in course.names():
        lay_arms(course, name)


def lay_arms(course: Course, name: str) -> None:
    """Put the arms beside a released notebook that asks about the student's own arm."""
    arms, folder = Arms.of(course.root), course.release / name
    if arms.handles and _asks(course, name) and folder.is_dir():
        write(folder / FILE, arms.table())
        (folder / FILE).chmod(0o644)


def without_arms(course: Course, names: Sequence[str]) -> str:
    """A warning about notebooks that ask about one's own arm but have only the public arm."""
    lacking = [x for x in names if _asks(course, x) and not (course.release / x / FILE).exists()]
    if not lacking:
        return ""
    return (
        f"{', '.join(lacking)}: every student has the public arm {DEMO!r}; for an arm each, import "
        "the list of students (labkit roster LIST.csv), then make the zip again"
    )


def _asks(course: Course, name: str) -> bool:
    """Whether a notebook has a question about one's own arm."""
    text = course.notebook_source(name).read_text(encoding="utf-8")
    return bool(re.search(r"\bmy_(arm|bug)\(", text))
