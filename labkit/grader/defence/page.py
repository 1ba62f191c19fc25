"""The page of a defence: a side for the student, and one with the answers for the examiner."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path

from ...course.authoring.layout import Course
from ..atomic import write
from ..feedback.page import error_over_time, measures, number_by_number
from ..pages import file, render_page
from ..rules import read_rules
from .draw import ASKED, FULL, Asked

RUBRIC = (
    "says which line was changed, and what it was before",
    "says what the arm will do, or what is returned, before the answer is shown",
    "explains the picture by the line: which term, which sign, which frame",
)
"""The criteria for each question, at one point each."""
WIDTH, ROOM = 95, 400.0
"""The characters in a printed line of code; the height for all lines, in [pt]."""


def write_page(course: Course, student: str, asked: Sequence[Asked]) -> Path:
    """Write the page of a student, and return its file."""
    page = render_page(
        "defence.html.j2",
        file("defence.css") + _print_size(asked),
        replays=any(one.run and one.run["motion"] for one in asked),
        student=student,
        course=read_rules(course).name,
        asked=asked,
        rubric=RUBRIC,
        full=FULL,
        count=ASKED,
        command=f"labkit defence {shlex.quote(student)} --mark {','.join(['?'] * ASKED)}",
        error_over_time=error_over_time,
        rows=rows,
        number_by_number=number_by_number,
    )
    path = course.build / "defence" / f"{student}.html"
    write(path, page)
    return path


def _print_size(asked: Sequence[Asked]) -> str:
    """The style with a print size of code at which all functions fit one side of A4."""
    lines = sum(1 + len(line) // WIDTH for one in asked for line in one.edit.lines)
    return f"@media print {{ .code {{ font-size: {min(8.0, ROOM / max(1, lines)):.2f}pt }} }}"


def rows(one: Asked) -> Iterator[tuple[str, str, str, str]]:
    """Each measure with a limit: its words, the value now, the value as handed in, the limit."""
    now, own = (
        {} if run is None else {x.words: x for x in measures(run)} for run in (one.run, one.own)
    )
    for words, row in (own | now).items():
        if row.limit:
            found, was = (t[words].value if words in t else "none" for t in (now, own))
            yield words, found, was, row.limit
