"""A team's report: one member hands it in, and it counts for all of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from ...course.bundle import Bundle
from ...course.layout import Course
from .mark import Mark


def for_teams(course: Course, assignment: str, rows: Iterable[Mark]) -> Iterator[Mark]:
    """Give what one member of a team handed in to each who handed in nothing.

    Args:
        course: The course.
        assignment: Which; if it is not a report, the rows come back as they are.
        rows: The mark of each student for what they handed in themselves.
    """
    released = (course.bundle / f"{assignment}.json").exists()
    shared = released and Bundle.of(course, assignment).is_report
    yield from _shared(list(rows)) if shared else rows


def _shared(rows: Iterable[Mark]) -> Iterator[Mark]:
    reports: dict[str, Mark] = {}
    for row in rows:
        if row.person and row.person.team and not row.absent:
            reports.setdefault(row.person.team, row)
    for row in rows:
        who = row.person
        report = reports.get(who.team) if who and row.absent else None
        if who is None or report is None:
            yield row
            continue
        mine = replace(report, student=row.student, person=who, user=row.user)
        mine = replace(mine, first=who.first_name, last=who.last_name, email=who.email)
        remark = f"the team's report, handed in by {report.student}"
        yield replace(mine, author=report.student, remark=remark)
