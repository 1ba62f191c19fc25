"""The roster: the students of the class, and by what each platform knows them.

It is kept in ``course_private/roster.csv``, which git ignores, with the columns of nbgrader's own
list of students and more; a person can read and edit it.  It is archived with the term.

A list is a CSV file: Moodle's participants (select all, *Download table data as*), Canvas's grades
(*Export*), or any table with a row for each student.
"""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import NamedTuple

from ..course.authoring.layout import Course
from ..errors import LabkitError
from .clean import clean_line, few, from_no_formula, no_formula, safe_name
from .files import write
from .gradebook import open_gradebook

FILE = "course_private/roster.csv"
HEADS = {
    "login": "login, username, user name, sis login id, anmeldename, benutzername",
    "id_number": "id number, sis user id, student number, student id, matrikelnummer, id-nummer, "
    "numéro d’identification, número de id",
    "lms_user_id": "lms user id, canvas id",
    "email": "email, e-mail, email address, mail, e-mail-adresse, adresse de courriel, "
    "dirección de correo",
    "first_name": "first name, given name, vorname, prénom, nombre",
    "last_name": "last name, surname, family name, nachname, nom, apellido(s)",
    "name": "name, full name, student, vollständiger name, nom complet, nombre completo",
    "role": "role, roles, rolle, rollen, rôles, roles",
}
"""The headings of each column; what "id" means depends on the others, see `_columns`."""
_STUDENT = re.compile("student|teilnehme|étudiant|estudiante", re.IGNORECASE)
"""What the role of a student says; who has another role is left out."""


@dataclass(frozen=True)
class Student:
    """One student; all but ``id`` may be empty.

    Attributes:
        id: The name of the student's folder, which is also the student's id in nbgrader.
        first_name: First name.
        last_name: Last name.
        email: E-mail address.
        lms_user_id: Canvas's number for the user.
        login: Login name.
        id_number: Student number at the university.
    """

    id: str
    first_name: str = ""
    last_name: str = ""
    email: str = ""
    lms_user_id: str = ""
    login: str = ""
    id_number: str = ""

    @property
    def name(self) -> str:
        """First and last name."""
        return f"{self.first_name} {self.last_name}".strip()

    def __str__(self) -> str:
        return f"{self.name} ({self.id})" if self.name else self.id

    def agrees(self, other: Student) -> list[bool]:
        """For each number or address that both students have, whether the two are alike."""
        keys = ("login", "email", "lms_user_id", "id_number")
        pairs = ((getattr(self, key), getattr(other, key)) for key in keys)
        return [a.casefold() == b.casefold() for a, b in pairs if a and b]


COLUMNS = tuple(field.name for field in fields(Student))
Roster = Mapping[str, Student]
"""The students of a course by their ids."""


class Imported(NamedTuple):
    """Who in a list is no student, who is in the roster now, new in it, or not in the list."""

    others: list[str]
    students: list[str]
    new: list[str]
    absent: list[str]


def known_as(roster: Roster, column: str, value: str) -> Student | None:
    """The one student with this value in a column, or with this name; None if not one has."""
    plain = same_name if column == "name" else str.casefold
    key = plain(value)
    found = [x for x in roster.values() if key and plain(getattr(x, column)) == key]
    return found[0] if len(found) == 1 else None


@cache
def same_name(name: str) -> tuple[str, ...]:
    """A key that is the same for all spellings of one person's name.

    Platforms differ in the order of first and last name, and omit characters that file names must
    not contain; so only the letters and digits of the words count, and not their order.
    """
    plain = unicodedata.normalize("NFKC", name).casefold().replace("_", " ").replace(",", " ")
    words = ("".join(c for c in w if unicodedata.category(c)[0] in "LMN") for w in plain.split())
    return tuple(sorted(filter(None, words)))


def import_list(course: Course, file: Path) -> Imported:
    """Add the students of a list to the roster; who is there keeps their folder.

    Args:
        course: The course.
        file: A CSV file.

    Raises:
        LabkitError: The file is no list, or a row could be several students.
    """
    rows, others = read_list(file)
    before = read_roster(course)
    students, listed = {**before}, set[str]()
    names = Counter(same_name(row.name) for row in rows)
    for row in rows:
        name = same_name(row.name)
        sure = [x for x in students.values() if any(x.agrees(row))]
        found = sure or [
            x for x in students.values() if same_name(x.name) == name != () and not x.agrees(row)
        ]
        again = found and (found[0].id in listed or (not sure and names[name] > 1))
        if len(found) > 1 or again:
            people = few([str(x) for x in found])
            raise LabkitError(f"{row.name or row.login} could be {people}; correct the list")
        id = found[0].id if found else safe_name(row.login or row.name)
        while not found and id.casefold() in {x.casefold() for x in students}:
            id += "-2"
        given = {column: cell for column, cell in asdict(row).items() if cell}
        students[id] = replace(students.get(id, row), **given, id=id)
        listed.add(id)
    save_roster(course, students.values())
    with open_gradebook(course) as book:  # where formgrader reads the names
        for id, one in students.items():
            known = {k: getattr(one, k) or None for k in COLUMNS[1:5]}
            book.update_or_create_student(id, **known)
    groups = (students, students.keys() - before.keys(), before.keys() - listed)
    return Imported(others, *([str(students[id]) for id in sorted(x)] for x in groups))


def read_list(file: Path) -> tuple[list[Student], list[str]]:
    """The students of a list, still without ids, and who in it is no student.

    Raises:
        LabkitError: The file is not a table, or a column is missing.
    """
    heads, table = _read_table(file)
    columns = _columns(heads)
    if not columns.keys() & {"login", "name", "last_name"}:
        there = ", ".join(heads)[:300]
        raise LabkitError(f"{file} has no column 'name' or 'login'; it has {there}")
    rows, others = list[Student](), list[str]()
    for row in table:
        cells = {column: row[head] for column, head in columns.items()}
        role, name = cells.pop("role", ""), cells.pop("name", "")
        if name and not cells.get("last_name"):
            last, comma, first = name.rpartition(",")  # "Lovelace, Ada", or "Ada Lovelace"
            first, last = (first, last) if comma else (*name.rpartition(" ")[::2],)
            cells |= {"first_name": first.strip(), "last_name": last.strip()}
        one = Student("", **cells)
        test = one.name == "Test Student" and bool(one.lms_user_id)
        if test or (role and not _STUDENT.search(role)):
            others.append(f"{one.name or one.login} ({role or 'of Canvas'})")
        elif (one.name or one.login) and name.casefold() != "points possible":
            rows.append(one)
    if not rows:
        raise LabkitError(f"{file} names no student; choose all students, and download it again")
    return rows, others


def _columns(heads: Sequence[str]) -> dict[str, str]:
    """The heading of each known column."""
    plain = {re.sub(r"[\s_]+", " ", x.casefold()).strip(' *"'): x for x in reversed(heads)}
    found = {k: plain[x] for k, known in HEADS.items() for x in known.split(", ") if x in plain}
    if "id" in plain:
        canvas = "student" in plain and plain.keys() & {"section", "sis login id"}
        other = "id_number" if "login" in found else "login"
        found.setdefault("lms_user_id" if canvas else other, plain["id"])
    return found


def _read_table(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """The headings of a CSV file, and its rows that are not empty, by heading, cleaned.

    Raises:
        LabkitError: The file is not a table in UTF-8 or UTF-16.
    """
    try:
        data = path.read_bytes()
        text = data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
        mark = max(",;\t", key=text.partition("\n")[0].count)
        lines = csv.reader(io.StringIO(text, newline=""), delimiter=mark, strict=True)
        rows = [[clean_line(cell, 200) for cell in row] for row in lines]
    except (OSError, UnicodeError, csv.Error) as error:
        raise LabkitError(f"{path} is no CSV file in UTF-8: {error}; save it as one") from None
    heads, *others = rows or [[]]
    if long := next((row for row in others if any(row[len(heads) :])), None):
        raise LabkitError(f"{path}: the row of {long[0]!r} is too long; put commas into quotes")
    return heads, [dict(zip_longest(heads, row, fillvalue="")) for row in others if any(row)]


def read_roster(course: Course) -> Roster:
    """The course's roster; an empty one if no list was imported.

    Raises:
        LabkitError: The file is damaged.
    """
    path = course.root / FILE
    _, rows = _read_table(path) if path.exists() else ([], [])
    cells = [{k: from_no_formula(row.get(k, "")) for k in COLUMNS} for row in rows]
    seen = Counter(each["id"].casefold() for each in cells)
    for id in (each["id"] for each in cells):
        if id != safe_name(id) or seen[id.casefold()] > 1:
            raise LabkitError(f"{path}: the id {id!r} is there twice, or names no folder")
    return {each["id"]: Student(**each) for each in cells}


def save_roster(course: Course, students: Iterable[Student]) -> None:
    """Write the course's roster."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\n")
    table.writerow(COLUMNS)
    table.writerows([map(no_formula, asdict(one).values()) for one in students])
    write(course.root / FILE, out.getvalue())
