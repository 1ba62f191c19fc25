"""The course's rules, in one file that a person reads and edits: ``course.toml``.

The file gives the name of the course, the due date and weight of each assignment, extensions and
the penalty for late work.  Due dates and extensions are written into the gradebook, where
formgrader shows them, with the penalty.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import Annotated
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import msgspec

from ..course.authoring.layout import DEFENCE, Course
from ..errors import LabkitError

FILE = "course.toml"
_Share = Annotated[float, msgspec.Meta(ge=0.0, le=100.0)]
_Positive = Annotated[float, msgspec.Meta(ge=0.0, le=10_000.0)]


class _Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of the file, in which a misspelt name is an error."""


class Late(_Table, frozen=True):
    """The penalty for late work.

    Attributes:
        percent_per_day: Percentage of the points earned, for each day begun.
        at_most: The largest deduction, in percent.
        grace_minutes: Work that is late by no more than this counts as in time.
    """

    percent_per_day: _Share = 0.0
    at_most: _Share = 100.0
    grace_minutes: _Positive = 0.0

    def penalty(self, score: float, seconds: float) -> float:
        """The points to deduct from ``score`` for work that was ``seconds`` late."""
        if seconds <= 60 * self.grace_minutes:
            return 0.0
        percent = min(self.at_most, self.percent_per_day * math.ceil(seconds / 86400))
        return round(score * percent / 100, 4)


class Assignment(_Table, frozen=True):
    """The due date of an assignment, and its weight in the term."""

    due: datetime | None = None
    weight: _Positive = 1.0


class Extension(_Table, frozen=True):
    """An extension for one student, in one assignment or in all of them."""

    student: str
    days: _Positive
    assignment: str = ""


class Rules(_Table, frozen=True):
    """The contents of the file.

    Attributes:
        name: The name of the course on pages.
        id: The name of the course in nbgrader's exchange, in one word.
        zone: The time zone of due dates that state none, such as "Europe/Berlin".
        late: The penalty for late work.
        assignments: The assignments by name.
        extensions: The extensions.
    """

    name: str = ""
    id: Annotated[str, msgspec.Meta(pattern=r"^[\w-]+\Z")] = "trajectory_tracking"
    zone: str = "UTC"
    late: Late = Late()
    assignments: Mapping[str, Assignment] = {}
    extensions: tuple[Extension, ...] = ()

    def due(self, assignment: str) -> datetime | None:
        """When an assignment is due for everybody, in UTC; None if the rules do not say."""
        when = self.assignments.get(assignment, Assignment()).due
        if when is None:
            return None
        return (when if when.tzinfo else when.replace(tzinfo=ZoneInfo(self.zone))).astimezone(UTC)

    def weight(self, assignment: str) -> float:
        """The weight of an assignment in the term."""
        return self.assignments.get(assignment, Assignment()).weight

    def longer(self, student: str, assignment: str) -> timedelta:
        """A student's extension; the longest if there are several."""
        days = [
            x.days
            for x in self.extensions
            if x.student == student and x.assignment in {"", assignment}
        ]
        return timedelta(days=max(days, default=0.0))


def read_rules(course: Course) -> Rules:
    """The rules of the course; without a file, rules that deduct nothing.

    Raises:
        LabkitError: The file is not TOML, or a rule in it is not valid.
    """
    path = course.root / FILE
    try:
        rules = msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8-sig")), Rules)
        ZoneInfo(rules.zone)
    except FileNotFoundError:
        return Rules()
    except (ValueError, RecursionError, OSError, ZoneInfoNotFoundError) as error:
        raise LabkitError(f"{path}: {error}; correct that, as in the guide's example") from None
    named = {*rules.assignments, *(x.assignment for x in rules.extensions)}
    if unknown := named - {"", DEFENCE, *course.names()}:
        there = ", ".join(course.names())
        raise LabkitError(f"{path}: there is no assignment {min(unknown)!r}; there are {there}")
    return rules
