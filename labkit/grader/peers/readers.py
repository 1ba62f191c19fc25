"""Peer review: which reports each student reads, and the reviews without names.

A reader's sheet is made by `sheet.hand_out`.  The course's copy of it, in ``feedback/``, is the
record of the two reports that a student was given.  The sheet that the student hands in is compared
with it cell by cell.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from ...course.authoring.layout import Course
from ...course.notebook import read_cells
from ...errors import LabkitError
from ..atomic import write
from ..clean import clean_text
from ..pseudonyms import pseudonyms
from ..students.class_list import Student
from ..students.roster import Roster, read_roster
from ..submission import Submission, students
from ..whys import rank

EACH = 2
"""The number of reports that each student reads."""
LEAST_NAME = 3
"""Shorter names are not removed from a text, as "An" and "Li" are words and symbols too."""
LEAST_NUMBER = 5
"""Shorter numbers are not removed from a text, as a report has many numbers."""
LONGEST_COMMENT = 2000
_MOVED = "report"
"""The metadata of a cell, in the course's copy of a sheet, with the report's new pseudonym."""
_FORM = re.compile(r"^\s*level\s*[:=]\s*([0-3])\b.*?^\s*comment\s*[:=](.*)", re.I | re.M | re.S)


def sheet_of(assignment: str) -> str:
    """The name of a review sheet, as a file and as an assignment to collect."""
    return f"{assignment}_review"


@dataclass(frozen=True)
class Review:
    """One reader's review of one report.

    Attributes:
        levels: The level for each row of the rubric.
        comments: The comment on each row of the rubric; may be empty.
    """

    levels: Mapping[str, int]
    comments: Mapping[str, str]


def readers(
    seed: int, reports: Mapping[str, str], people: Mapping[str, str]
) -> dict[str, tuple[str, ...]]:
    """Choose the reports that each student reads, by HMAC-SHA256 under the term's seed.

    The reports form a circle.  The members of a team take the reports after their own, two by
    two, so each report has at least two readers, and nobody reads a report of their own team.

    Args:
        seed: The seed of the term.
        reports: The student who handed in the report, by team.
        people: The team of each student.

    Returns:
        The authors of two reports, for each student.

    Raises:
        LabkitError: There are fewer than three reports.
    """
    if len(reports) <= EACH:
        raise LabkitError(
            f"{len(reports)} teams handed in a report; peer review needs {EACH + 1}, so that each "
            f"student reads {EACH} reports of others"
        )
    secret = partial(rank, seed, "peer review")
    circle, n = sorted(reports, key=secret), len(reports)
    teams: dict[str, list[str]] = {}
    for student in sorted(people, key=secret):
        teams.setdefault(people[student], []).append(student)
    found = {}
    for team, members in teams.items():
        own = circle.index(team) if team in reports else int.from_bytes(secret(team)) % n
        others = [reports[circle[(own + step) % n]] for step in range(1, n)]
        for number, student in enumerate(members):
            at = (EACH * number + k for k in range(EACH))
            found[student] = tuple(others[k % (n - 1)] for k in at)
    return found


def of_class(course: Course, assignment: str) -> tuple[dict[str, str], dict[str, str], list[str]]:
    """Reports by team, the team of each student, and the authors of a team's further reports."""
    authors, roster = students(course, assignment), read_roster(course)
    people = {one.id: one.team or one.id for one in roster.students}
    people |= {author: author for author in authors if author not in people}
    reports: dict[str, str] = {}
    for author in authors:
        reports.setdefault(people[author], author)
    return reports, people, [x for x in authors if reports[people[x]] != x]


def team_of(author: str, people: Mapping[str, str], roster: Roster) -> list[Student]:
    """The members of the team that wrote a report."""
    team = [name for name in sorted(people) if people[name] == people[author]]
    return [roster.get(name) or Student(name) for name in team]


def without_names(text: str, people: Sequence[Student], who: str) -> str:
    """Replace the names of people in a text by ``who`` and a number.

    Names, logins, addresses and numbers are replaced, whether in upper or lower case.
    """
    for number, one in enumerate(people, 1):
        text = re.sub(
            rf"(?<!\w)(?:{_any_of(_known(one))})(?!\w)", f"{who} {number}", text, flags=re.I
        )
    return text


def names_of_class(people: Iterable[Student]) -> re.Pattern[str]:
    """A pattern that finds the names of all people in a class.

    One word alone, such as "Mark" or the login "force", is a name where it begins with a capital
    letter or is in quotation marks; anything else, such as a whole name, is found in any case.
    """
    known = {x for one in people for x in _known(replace(one, team=""))}
    words = {x for x in known if x.isalpha()}
    capital = _any_of({x[0].upper() + x[1:] for x in words})
    quoted = rf"(?<=[\"'`])(?i:{_any_of(words)})(?=[\"'`])"
    return re.compile(rf"(?<!\w)(?:(?i:{_any_of(known - words)})|{capital})(?!\w)|{quoted}")


def _known(one: Student) -> set[str]:
    """The names and numbers of a student that a text is searched for."""
    names = [one.id, one.login, one.email, one.id_number, one.lms_user_id, one.github, one.name]
    names += [one.team, one.first_name, one.last_name, *re.split(r"[\W_]+", one.id)]
    return {x for x in names if len(x) >= (LEAST_NUMBER if x.isdigit() else LEAST_NAME)}


def _any_of(names: Iterable[str]) -> str:
    """A pattern for any of these texts, the longest first; without texts it finds nothing."""
    return "|".join(map(re.escape, sorted(names, key=len, reverse=True))) or "(?!)"


def handed_out(course: Course, assignment: str, student: str) -> Path:
    """The path of the course's copy of the sheet that a student was given."""
    name = sheet_of(assignment)
    return course.root / "feedback" / student / name / f"{name}.ipynb"


def reviews(course: Course, assignment: str) -> tuple[dict[str, list[Review]], list[str]]:
    """The reviews by author of the report, and a sentence for each student who has not done both.

    A review counts when every row of the rubric has a level.

    Raises:
        LabkitError: A sheet in ``feedback/`` is damaged.
    """
    name, roster = sheet_of(assignment), read_roster(course)
    given = sorted((course.root / "feedback").glob(f"*/{name}/{name}.ipynb"))
    code = pseudonyms(course) if given else str
    authors = {code(author): author for author in students(course, assignment)}
    found: dict[str, list[Review]] = {author: [] for author in authors.values()}
    waiting = []
    for path in given:
        student = path.parents[1].name
        asked: dict[str, list[str]] = {}
        report: dict[str, str] = {}
        for cell in read_cells(path):
            if cell["cell_type"] == "raw":
                who, _, row = cell["id"].partition("_")
                asked.setdefault(who, []).append(row)
                report[who] = _report_of(cell)
        said, wrong = _sheet_texts(course, name, student)
        if said and not any(f"{who}_{row}" in said for who, rows in asked.items() for row in rows):
            wrong = "the notebook that counts is not the sheet that they were given"
        me = [roster.get(student) or Student(student)]
        whole = 0
        for who, rows in asked.items():
            review = _review(rows, {row: said.get(f"{who}_{row}", "") for row in rows}, me)
            if review is not None:
                whole += 1
                found.setdefault(authors.get(report[who], ""), []).append(review)
        if whole < len(asked):
            waiting.append(f"{student}: {wrong or f'{whole} of {len(asked)} reviews'}")
    waiting += [
        f"submitted/{folder}/{name}: this sheet belongs to nobody in the roster; whose it is, the "
        "worksheet of its assignment says: labkit students import WORKSHEET.csv --assignment "
        f"{name}"
        for folder in students(course, name)
        if roster.students and folder not in roster
    ]
    return found, waiting


def move_reviews(course: Course, assignment: str, old: str, new: str) -> None:
    """Let the reviews of a report follow it to another student's folder.

    The readers' own sheets keep the old pseudonym; the course's copies get the new one too.

    Raises:
        LabkitError: A sheet in ``feedback/`` is damaged.
    """
    name = sheet_of(assignment)
    for path in sorted((course.root / "feedback").glob(f"*/{name}/{name}.ipynb")):
        code, cells = pseudonyms(course), read_cells(path)
        moved = [x for x in cells if x["cell_type"] == "raw" and _report_of(x) == code(old)]
        for cell in moved:
            cell["metadata"][_MOVED] = code(new)
        if moved:
            sheet = json.loads(path.read_text(encoding="utf-8")) | {"cells": cells}
            write(path, json.dumps(sheet, indent=1, ensure_ascii=False) + "\n")


def _report_of(cell: Mapping[str, Any]) -> str:
    """The present pseudonym of the report about which a form in a sheet asks."""
    return str(cell["metadata"].get(_MOVED) or cell["id"].partition("_")[0])


def _sheet_texts(course: Course, name: str, student: str) -> tuple[dict[str, str], str]:
    """The texts of a student's sheet by cell name, or why there are none."""
    submission = Submission.of(course, name, student)
    if not submission.folder.exists():
        return {}, "handed in no review"
    data, _, wrong = submission.read()
    if wrong:
        return {}, wrong
    try:
        cells = read_cells(submission.folder / f"{name}.ipynb", data)
    except LabkitError as error:
        return {}, str(error)
    return {str(cell.get("id")): cell["source"] for cell in cells}, ""


def _review(rows: Iterable[str], said: Mapping[str, str], me: Sequence[Student]) -> Review | None:
    """A review, or None if a row has no level."""
    levels, comments = dict[str, int](), dict[str, str]()
    for row in rows:
        form = _FORM.search(clean_text(said[row]))
        if form is None:
            return None
        levels[row] = int(form[1])
        comments[row] = without_names(form[2].strip(), me, "reader")[:LONGEST_COMMENT]
    return Review(levels, comments)
