"""Marks as tables: for Canvas and Moodle, and with one column per question.

Canvas: the first columns are Student, ID, SIS User ID, SIS Login ID, Section, in this order; a row
whose first cell holds "Points Possible" gives full marks; a student is found by ID, else by SIS ID,
else by login, else by name; an assignment's column is named ``TITLE (NUMBER)``, and a title that
Canvas does not know creates an assignment (github.com/instructure/canvas-lms,
``lib/gradebook_importer.rb``; the columns also at
teaching.resources.osu.edu, "Import CSV File to Carmen Grades").

Moodle's gradebook (docs.moodle.org/en/Grade_import) asks which column identifies users: "Email
address" goes to ``useremail``, "ID number" to ``useridnumber``.

Names, addresses and numbers come from the roster, if there is one.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from ..course.authoring.layout import DEFENCE
from .clean import few, how_many, no_formula
from .marks import Mark

Table = list[list[Any]]


def questions(assignment: str, marks: Sequence[Mark]) -> Table:
    """One column for each question, and remarks; the second line has the full marks."""
    most = {x.name: x.points for r in marks for x in r.lines if r.raw is not None}
    table: Table = [["student", *most, "penalty", "score", "remark"]]
    if marks:
        table.append(["(full marks)", *most.values(), "", marks[0].points or "", ""])
    for r in marks:
        each = {x.name: x.score or 0.0 for x in r.lines if r.raw is not None}
        cells = [each.get(name, "") for name in most]
        taken = "" if r.raw is None else r.penalty
        table.append([r.student, *cells, taken, r.score, r.missing or r.remark])
    return table


def canvas(column: str, marks: Sequence[Mark]) -> Table:
    """The table for Canvas's gradebook; ``column`` is Canvas's name, as in "Paths (4711)"."""
    table: Table = [["Student", "ID", "SIS User ID", "SIS Login ID", "Section", column]]
    table.append(["    Points Possible", "", "", "", "", marks[0].points or "" if marks else ""])
    for r in marks:
        who = r.person
        name = ", ".join(filter(None, (who.last_name, who.first_name))) or r.student
        table.append([name, who.lms_user_id, who.id_number, who.login, "", r.score])
    return table


def moodle(column: str, marks: Sequence[Mark]) -> Table:
    """The table for Moodle's gradebook: columns that identify the user, and the grade."""
    table: Table = [["First name", "Last name", "ID number", "Username", "Email address", column]]
    for who, score in ((r.person, r.score) for r in marks):
        keys = (who.id_number, who.login, who.email)
        if any(keys):  # otherwise Moodle could not find the student
            table.append([who.first_name, who.last_name, *keys, score])
    return table


LAYOUTS: dict[str, Callable[[str, Sequence[Mark]], Table]] = {
    "questions": questions,
    "canvas": canvas,
    "moodle": moodle,
}


def of_term(marks: Mapping[str, Sequence[Mark]], weights: Mapping[str, float]) -> Table:
    """All assignments side by side, with the total in percent.

    What was not handed in counts as 0.  Without a defence yet, the percentage is that of everything
    else.

    Args:
        marks: The marks by assignment; the students may differ between assignments.
        weights: The weight of each assignment in the total.
    """
    known = {mark.student: mark.person for each in marks.values() for mark in each}
    rows = [(name, m) for name, each in marks.items() for m in each]
    cells = {(k, m.student): 0.0 if m.absent and k != DEFENCE else m.score for k, m in rows}
    full = {name: max((m.points for m in each), default=0.0) for name, each in marks.items()}
    table: Table = [["student", "first", "last", "email", "id", *marks, "percent"]]
    table.append(["(full marks)", "", "", "", "", *full.values(), 100])
    table.append(["(weight)", "", "", "", "", *(weights[name] for name in marks), ""])
    for student, who in sorted(known.items()):
        scores = {name: cells.get((name, student), "") for name in marks}
        counted = {k: x for k, x in scores.items() if full[k] and (k, x) != (DEFENCE, "")}
        whole = sum(weights[name] for name in counted)
        percent: float | str = ""
        if whole and "" not in counted.values():
            earned = sum(weights[name] * float(x) / full[name] for name, x in counted.items())
            percent = round(100 * earned / whole, 2)
        ids = (student, who.first_name, who.last_name, who.email, who.id_number)
        table.append([*ids, *scores.values(), percent])
    return table


_KEYS: dict[str, tuple[str, Callable[[Mark], str]]] = {
    "canvas": (
        "an ID or login (labkit roster CANVAS-LIST.csv)",
        lambda r: r.person.lms_user_id or r.person.id_number or r.person.login,
    ),
    "moodle": (
        "an address, ID number or login (labkit roster LIST.csv)",
        lambda r: r.person.email or r.person.id_number or r.person.login,
    ),
}
"""What identifies a student on each platform, and the command that provides it."""


def remarks(layout: str, marks: Sequence[Mark], assignment: str = "") -> Iterator[str]:
    """Remarks on a table: who has no mark, and whom the platform cannot identify."""
    for mark in marks:
        if mark.missing:
            yield f"no mark: {mark.student}: {mark.missing}"
        elif mark.remark and not mark.absent:
            yield f"{mark.student}: {mark.remark}"
    if absent := [mark.student for mark in marks if mark.absent]:
        nothing = "with no defence yet" if assignment == DEFENCE else "handed in nothing"
        yield f"{len(absent)} {nothing}: {few(absent)}"
    if lost := unmatched(layout, marks):
        who = how_many(len(lost), "student")
        yield f"{who} cannot be matched without {_KEYS[layout][0]}: {few(lost)}"


def unmatched(layout: str, marks: Sequence[Mark]) -> list[str]:
    """Students with a mark whom a platform cannot find from a table."""
    key = _KEYS[layout][1] if layout in _KEYS else lambda mark: mark.student
    return [mark.student for mark in marks if not mark.absent and not key(mark)]


def as_csv(table: Sequence[Sequence[Any]]) -> str:
    """A table as text; nothing in it can become a formula in a spreadsheet."""
    out = io.StringIO()
    rows = [[no_formula(x) if isinstance(x, str) else x for x in row] for row in table]
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()
