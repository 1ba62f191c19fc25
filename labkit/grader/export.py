"""Marks as tables: for nbgrader, Canvas and Moodle, and with one column per question.

Canvas: the first columns are Student, ID, SIS User ID, SIS Login ID, Section, in this order; a row
whose first cell holds "Points Possible" gives full marks; a student is found by ID, else by SIS ID,
else by login, else by name; an assignment's column is named ``TITLE (NUMBER)``, and a title that
Canvas does not know creates an assignment (github.com/instructure/canvas-lms,
``lib/gradebook_importer.rb``; the columns also at
teaching.resources.osu.edu, "Import CSV File to Carmen Grades").

Moodle has two imports.  The gradebook's import (docs.moodle.org/en/Grade_import) asks which column
identifies users: "Email address" goes to ``useremail``, "ID number" to ``useridnumber``.  The
assignment's own grading worksheet needs the columns Identifier, Grade and Last modified (grade);
the identifier is "Participant" and the number in the download of submissions
(github.com/moodle/moodle, ``mod/assign/feedback/offline/importgradeslib.php``).

Names, addresses and numbers come from the roster, if there is one.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from ..course.authoring.layout import DEFENCE
from .clean import few, no_formula
from .marks import Mark


def nbgrader(assignment: str, marks: Sequence[Mark]) -> list[list[Any]]:
    """The columns of ``nbgrader export``."""
    head = "assignment duedate timestamp student_id last_name first_name email raw_score"
    table: list[list[Any]] = [[*head.split(), "late_submission_penalty", "score", "max_score"]]
    for r in marks:
        who = r.person
        table.append(
            [assignment, r.due, r.when, r.student, who.last_name, who.first_name, who.email]
            + [*r.cells, r.full]
        )
    return table


def questions(assignment: str, marks: Sequence[Mark]) -> list[list[Any]]:
    """One column for each question, and remarks; the second line has the full marks."""
    names = list(dict.fromkeys(name for r in marks for name in r.questions))
    most = {name: r.questions[name][1] for r in marks for name in r.questions}
    table: list[list[Any]] = [["student", *names, "penalty", "score", "remark"]]
    if marks:
        table.append(["(full marks)", *(most[name] for name in names), "", marks[0].full, ""])
    for r in marks:
        each = [r.questions.get(name, ("", ""))[0] for name in names]
        table.append([r.student, *each, *r.cells[1:], r.missing or r.remark])
    return table


def canvas(column: str, marks: Sequence[Mark]) -> list[list[Any]]:
    """The table for Canvas's gradebook; ``column`` is Canvas's name, as in "Paths (4711)"."""
    table: list[list[Any]] = [["Student", "ID", "SIS User ID", "SIS Login ID", "Section", column]]
    table.append(["    Points Possible", "", "", "", "", marks[0].full if marks else ""])
    for r in marks:
        name = ", ".join(filter(None, (r.person.last_name, r.person.first_name))) or r.student
        sis = r.person.id_number if r.listed else ""
        table.append([name, r.person.lms_user_id, sis, r.login, "", r.score])
    return table


def moodle(column: str, marks: Sequence[Mark]) -> list[list[Any]]:
    """The table for Moodle's gradebook: columns that identify the user, and the grade."""
    table: list[list[Any]] = [
        ["First name", "Last name", "ID number", "Username", "Email address", column]
    ]
    for r in marks:
        who = r.person
        keys = (who.id_number, r.login, who.email)
        if any(keys):  # otherwise Moodle could not find the student
            table.append([who.first_name, who.last_name, *keys, r.score])
    return table


def moodle_worksheet(column: str, marks: Sequence[Mark]) -> list[list[Any]]:
    """The grading worksheet for a Moodle assignment: the participants in its download."""
    table: list[list[Any]] = [
        ["Identifier", "Full name", "Grade", "Maximum Grade", "Last modified (grade)"]
    ]
    table += [
        [f"Participant {r.moodle.number}", r.moodle.name, r.score, r.full, ""]
        for r in marks
        if r.moodle
    ]
    return table


_NEEDS = {
    "canvas": "ID or login (labkit roster CANVAS-LIST.csv)",
    "moodle": "address, ID number or login (labkit roster LIST.csv)",
    "moodle-worksheet": "participant's number (labkit collect NAME MOODLE.zip)",
}
"""What identifies a student on each platform, and the command that provides it."""


def of_term(marks: Mapping[str, Sequence[Mark]], weights: Mapping[str, float]) -> list[list[Any]]:
    """All assignments side by side, with the total in percent.

    Without a defence yet, the percentage is that of everything else.

    Args:
        marks: The marks by assignment; the students may differ between assignments.
        weights: The weight of each assignment in the total.
    """
    known = {mark.student: mark.person for each in marks.values() for mark in each}
    cells = {(name, m.student): m for name, each in marks.items() for m in each}
    full = {name: max((m.points for m in each), default=0.0) for name, each in marks.items()}
    table: list[list[Any]] = [["student", "first", "last", "email", "id", *marks, "percent"]]
    table.append(["(full marks)", "", "", "", "", *full.values(), 100])
    table.append(["(weight)", "", "", "", "", *(weights[name] for name in marks), ""])
    for student, who in sorted(known.items()):
        scores = [m.score if (m := cells.get((name, student))) else "" for name in marks]
        scored = list(zip(marks, scores, strict=True))
        counted = [(name, x) for name, x in scored if full[name] and (name, x) != (DEFENCE, "")]
        whole = sum(weights[name] for name, _ in counted)
        shares = [weights[n] * x / full[n] for n, x in counted if isinstance(x, float)]
        certain = whole and len(shares) == len(counted)
        percent = round(100 * sum(shares) / whole, 2) if certain else ""
        ids = (student, who.first_name, who.last_name, who.email, who.id_number)
        table.append([*ids, *scores, percent])
    return table


def remarks(layout: str, marks: Sequence[Mark], assignment: str = "") -> Iterator[str]:
    """Remarks on a table: who has no mark, and whom the platform cannot identify."""
    for mark in marks:
        if mark.missing:
            yield f"no mark: {mark.student}: {mark.missing}"
        elif mark.remark and not (mark.absent or mark.author):
            yield f"{mark.student}: {mark.remark}"
    if team := [f"{mark.student} ({mark.author})" for mark in marks if mark.author]:
        have = f"{len(team)} {'has' if len(team) == 1 else 'have'}"
        yield f"{have} the mark of a report that their team handed in: {few(team)}"
    if absent := [mark.student for mark in marks if mark.absent]:
        nothing = "with no defence yet" if assignment == DEFENCE else "handed in nothing"
        yield f"{len(absent)} {nothing}: {few(absent)}"
    lost = [m.student for m in marks if not (m.absent or m.person.lms_user_id)]
    if layout == "canvas" and lost:
        have = f"{len(lost)} {'has' if len(lost) == 1 else 'have'}"
        yield (
            f"{have} no Canvas ID, so Canvas must find them by SIS ID or login: "
            f"{few(lost)}; import Canvas's own list (Grades, Export), which has the IDs"
        )
    yield from filter(None, [left_out(layout, marks)])


def left_out(layout: str, marks: Sequence[Mark]) -> str:
    """Students whom a platform cannot find from a table, in a sentence; "" if it finds all."""
    lost, count = unmatched(layout, marks)
    if lost and len(lost) == count:
        return (
            f"nobody can import this table: it has no {_NEEDS[layout]} of the {count} who handed in"
        )
    who = f"{len(lost)} of the {count} who handed in"
    return f"{who} cannot be matched by this table: {few(lost)}" if lost else ""


def unmatched(layout: str, marks: Sequence[Mark]) -> tuple[list[str], int]:
    """Students whom a platform cannot find from a table, and how many handed in."""
    ways: dict[str, Callable[[Mark], str]] = {
        "canvas": lambda r: r.person.lms_user_id or r.person.id_number or r.login,
        "moodle": lambda r: r.person.email or r.person.id_number or r.login,
        "moodle-worksheet": lambda r: r.moodle.number if r.moodle else "",
    }
    if layout not in ways:
        return [], 0
    way = ways[layout]
    there = [r for r in marks if not r.absent]
    return [r.student for r in there if not way(r) or _cell(way(r), True) != way(r)], len(there)


LAYOUTS: dict[str, Callable[[str, Sequence[Mark]], list[list[Any]]]] = {
    "nbgrader": nbgrader,
    "questions": questions,
    "canvas": canvas,
    "moodle": moodle,
    "moodle-worksheet": moodle_worksheet,
}


IDENTITIES = frozenset(
    ("ID", "SIS User ID", "SIS Login ID", "ID number", "Username", "Email address", "Identifier")
)
"""Columns by which a platform knows a student."""
_PLAIN = re.compile(r"[\w.@+-]*")


def as_csv(table: Sequence[Sequence[Any]]) -> str:
    """A table as text; nothing in it can become a formula in a spreadsheet.

    A cell that could begin a formula gets a leading quotation mark.  An identity gets one only if
    it holds more than letters, digits and ``. _ @ + -``, as the platform would no longer recognize
    it; `left_out` names such a student.
    """
    identity = [head in IDENTITIES for head in table[0]]
    rows = [[_cell(x, known) for x, known in zip(r, identity, strict=True)] for r in table]
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def _cell(x: Any, identity: bool) -> Any:
    if not isinstance(x, str) or (identity and _PLAIN.fullmatch(x)):
        return x
    return no_formula(x)
