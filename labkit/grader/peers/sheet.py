"""A reader's sheet, a notebook with two reports without names and the rubric to fill in.

A report comes from another student: its code is shown as text, only pictures are kept of its
outputs, and nothing in its text makes a browser fetch anything.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import nbformat
from nbformat import v4

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.notebook import Notebook, grade_id, read_cells
from ...errors import LabkitError
from ..atomic import write
from ..clean import clean_text
from ..each import Failure, for_student
from ..nbgrader.autograded_notebook import as_typed
from ..pseudonyms import pseudonyms
from ..seeds import seed_for
from ..students.class_list import Student
from ..students.roster import read_roster
from ..submission import Submission
from .readers import (
    handed_out,
    names_of_class,
    of_class,
    readers,
    sheet_of,
    team_of,
    without_names,
)

FORM = "level: \ncomment: "
HEAD = """# Review of two reports

Below are two reports by other teams, without names, each followed by the rubric. Read a report
first as a whole. Then give each row a level, a number from 0 to 3 after `level:`, and after
`comment:` one sentence that would help the authors. The authors read both, and do not learn who
you are; do not write your name.

Save this file and hand it in without renaming it."""
_PICTURE = re.compile(r"!(?=\[[^\]]*\](?!\(attachment:))")
_BASE64 = re.compile(r"[A-Za-z0-9+/=\s]+")


def hand_out(course: Course, assignment: str) -> Iterator[str | Failure]:
    """Write a sheet for each student who has none yet; existing sheets stay as they are.

    Yields:
        Sentences for the instructor, and a failure for each student without a sheet.

    Raises:
        LabkitError: There are fewer than three reports that can be read.
    """
    bundle, roster = Bundle.of(course, assignment), read_roster(course)
    reports, people, doubled = of_class(course, assignment)
    cells = bundle.data["cells"]
    rubric = {m["grade_id"]: cells[k - 1]["source"] for k, m in enumerate(cells) if "points" in m}
    if not rubric:
        raise LabkitError(f"{assignment} has no rubric, so there is nothing to review by")
    told: dict[str, list[dict[str, Any]]] = {}
    anybody = names_of_class(roster.students)
    for team, author in list(reports.items()):
        members = team_of(author, people, roster)
        step = partial(_report, course, assignment, author, members, anybody, cells)
        done = for_student(author, step)
        if isinstance(done, Failure):
            del reports[team]
            yield done
        else:
            told[author] = done
    code = pseudonyms(course)
    to_read = readers(seed_for(course, assignment), reports, people)
    new = {who: handed_out(course, assignment, who) for who in to_read}
    new = {who: path for who, path in new.items() if not path.exists()}
    for student, path in new.items():
        parts = [(code(author), told[author]) for author in to_read[student]]
        write(path, nbformat.writes(_sheet(parts, rubric)) + "\n")
    yield f"sheets in feedback/*/{sheet_of(assignment)}: {len(new)} new, {len(to_read)} in all"
    for student in doubled:
        first = reports.get(people[student], "somebody")
        yield f"{student}: nobody reads this report, as {first} of the same team handed in one too"


def _sheet(
    parts: Sequence[tuple[str, Sequence[dict[str, Any]]]], rubric: Mapping[str, str]
) -> Notebook:
    """The reports, each with its pseudonym and cells, and after each the rubric to fill in."""
    cells = [v4.new_markdown_cell(HEAD, id="head")]
    for number, (name, report) in enumerate(parts, 1):
        cells.append(v4.new_markdown_cell(f"## Report {number}", id=f"report-{number}"))
        cells += [{**cell, "id": f"{number}-{k}"} for k, cell in enumerate(report)]
        for row, text in rubric.items():
            cells.append(v4.new_markdown_cell(text, id=f"rubric-{number}-{row}"))
            cells.append(v4.new_raw_cell(FORM, id=f"{name}_{row}"))
    return nbformat.from_dict(dict(v4.new_notebook(cells=cells)))


def _report(
    course: Course,
    assignment: str,
    author: str,
    team: Sequence[Student],
    anybody: re.Pattern[str],
    released: Iterable[Mapping[str, Any]],
) -> list[dict[str, Any]]:
    """The cells that a team wrote, and the release's headings between them."""
    data, _, wrong = Submission.of(course, assignment, author).read()
    if wrong:
        raise LabkitError(f"{wrong}; nobody can read this report")
    known = {m["source"].strip(): m["kind"] for m in released}
    answers = {m["grade_id"] for m in released if m["kind"] == "answer"}
    told: list[dict[str, Any]] = []
    for cell in read_cells(Path(f"{assignment}.ipynb"), data):
        text = clean_text(cell["source"]).strip()
        kind = known.get(text, "own") if text else "walk"
        if kind == "brief" and text.startswith("#"):
            told.append(v4.new_markdown_cell("#" + text.partition("\n")[0]))
        elif kind == "own" and grade_id(cell) not in answers:
            text = anybody.sub("somebody", without_names(text, team, "author"))
            code = cell["cell_type"] == "code"
            shown = (
                as_typed(text, "python") if code else _PICTURE.sub("", text.replace("<", "&lt;"))
            )
            pictures = dict(_pictures(cell, code))
            if code:
                shown += "".join(f"\n\n![figure](attachment:{name})" for name in pictures)
            told.append(v4.new_markdown_cell(shown, attachments=pictures))
    return told


def _pictures(cell: Mapping[str, Any], code: bool) -> Iterator[tuple[str, dict[str, str]]]:
    """The PNG pictures of a cell, from a code cell's outputs or a text cell's attachments."""
    if code:
        outputs = cell.get("outputs")
        parts = outputs if isinstance(outputs, list) else []
        found = [
            (f"figure-{k}.png", x.get("data")) for k, x in enumerate(parts) if isinstance(x, dict)
        ]
    else:
        attached = cell.get("attachments")
        found = list(attached.items()) if isinstance(attached, dict) else []
    for name, data in found:
        png = data.get("image/png") if isinstance(data, dict) else None
        png = "".join(map(str, png)) if isinstance(png, list) else png
        if isinstance(png, str) and _BASE64.fullmatch(png):
            yield name, {"image/png": png}
