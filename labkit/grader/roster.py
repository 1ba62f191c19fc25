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
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from itertools import chain, count
from pathlib import Path

from ..course.authoring.layout import Course
from ..errors import LabkitError
from .clean import clean_line, few, from_no_formula, how_many, no_formula, safe_name
from .files import write
from .gradebook import open_gradebook
from .rules import FILE as RULES
from .rules import read_rules

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
_COLUMN = {head: column for column, heads in HEADS.items() for head in heads.split(", ")}
_STUDENT = re.compile("student|teilnehme|étudiant|estudiante", re.IGNORECASE)
"""What the role of a student says; who has another role is left out."""
_NO_TEAM = {"no groups", "keine gruppen"}
"""What Moodle writes for a student who is in no group."""
KEYS = ("login", "email", "lms_user_id", "id_number")
"""What identifies a student."""


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
        team: Name of the team; the students of a team share an arm.
    """

    id: str
    first_name: str = ""
    last_name: str = ""
    email: str = ""
    lms_user_id: str = ""
    login: str = ""
    id_number: str = ""
    team: str = ""

    @property
    def name(self) -> str:
        """First and last name."""
        return f"{self.first_name} {self.last_name}".strip()

    def __str__(self) -> str:
        return f"{self.name} ({self.id})" if self.name else self.id

    def agrees(self, other: Student) -> list[bool]:
        """For each key that both students have, whether the two are alike."""
        pairs = ((getattr(self, key), getattr(other, key)) for key in KEYS)
        return [a.casefold() == b.casefold() for a, b in pairs if a and b]


COLUMNS = tuple(field.name for field in fields(Student))


@dataclass(frozen=True)
class Roster:
    """The students of a course, each with an ``id`` of their own."""

    students: tuple[Student, ...] = ()

    def get(self, id: str) -> Student | None:
        """The student with this id, which is the name of their folder."""
        return next((one for one in self.students if one.id == id), None)

    def known_as(self, column: str, value: str) -> Student | None:
        """The one student with this value in a column, or with this name; None if not one has."""
        key = _plain(column, value)
        found = [x for x in self.students if key and _plain(column, getattr(x, column)) == key]
        return found[0] if len(found) == 1 else None


@cache
def _plain(column: str, value: str) -> object:
    return same_name(value) if column == "name" else value.casefold()


@cache
def same_name(name: str) -> tuple[str, ...]:
    """A key that is the same for all spellings of one person's name.

    Platforms differ in the order of first and last name, and omit characters that file names must
    not contain; so only the letters and digits of the words count, and not their order.
    """
    plain = unicodedata.normalize("NFKC", name).casefold().replace("_", " ").replace(",", " ")
    words = ("".join(c for c in w if unicodedata.category(c)[0] in "LMN") for w in plain.split())
    return tuple(sorted(filter(None, words)))


def import_list(course: Course, file: Path, teams: str = "") -> list[str]:
    """Add the students of a list to the roster; who is there keeps their folder.

    Args:
        course: The course.
        file: A CSV file.
        teams: The heading of the column with the teams; "" leaves teams as they are.

    Returns:
        Sentences on what was done.

    Raises:
        LabkitError: The file is no list, or a row could be several students.
    """
    rows, others = read_list(file, teams)
    before = read_roster(course)
    roster, listed = _merged(before, rows)
    save_roster(course, roster)
    tell_gradebook(course, roster)
    new = [str(one) for one in roster.students if not before.get(one.id)]
    absent = [str(one) for one in before.students if one.id not in listed]
    says = [f"{FILE}: {how_many(len(roster.students), 'student')}, {len(new)} of them new"]
    says += [f"new: {few(new)}"] if new and before.students else []
    says += [f"left out, as they are no students: {', '.join(others)}"] if others else []
    says += [f"not in this list, and kept in the roster: {', '.join(absent)}"] if absent else []
    return says


def read_list(file: Path, teams: str = "") -> tuple[list[tuple[int, Student]], list[str]]:
    """The students of a list, each with the number of its line, and who in it is no student.

    Raises:
        LabkitError: The file is not a table, or a column is missing.
    """
    heads, table = _read_table(file)
    columns = _columns(heads)
    if teams:
        plain = [head.casefold() for head in heads]
        columns |= {"team": plain.index(teams.casefold())} if teams.casefold() in plain else {}
    if not columns.keys() & {"login", "name", "last_name"} or (teams and "team" not in columns):
        asked = f"column {teams!r}" if teams else "column 'name' or 'login'"
        raise LabkitError(f"{file} has no {asked}; it has {', '.join(heads)[:300]}")
    rows, others = list[tuple[int, Student]](), list[str]()
    for line, row in table:
        cells = {k: row[at] if at < len(row) else "" for k, at in columns.items()}
        role, name = cells.pop("role", ""), cells.pop("name", "")
        if name and not cells.get("last_name"):
            last, comma, first = name.rpartition(",")  # "Lovelace, Ada", or "Ada Lovelace"
            first, last = (first, last) if comma else (*name.rpartition(" ")[::2],)
            cells |= {"first_name": first.strip(), "last_name": last.strip()}
        if cells.get("team", "").casefold() in _NO_TEAM:
            cells["team"] = ""
        one = Student("", **cells)
        test = one.name == "Test Student" and bool(one.lms_user_id)
        if test or (role and not _STUDENT.search(role)):
            others.append(f"{one.name or one.login} ({role or 'of Canvas'})")
        elif (one.name or one.login) and name.casefold() != "points possible":
            rows.append((line, one))
    if not rows:
        raise LabkitError(f"{file} names no student; choose all students, and download it again")
    return rows, others


def _columns(heads: Sequence[str]) -> dict[str, int]:
    """The index of each known column."""
    plain = [re.sub(r"[\s_]+", " ", head.casefold()).strip(' *"') for head in heads]
    found = {_COLUMN[head]: at for at, head in reversed([*enumerate(plain)]) if head in _COLUMN}
    if "id" in plain:
        canvas = "student" in plain and bool({"section", "sis login id"} & set(plain))
        other = "id_number" if "login" in found else "login"
        found.setdefault("lms_user_id" if canvas else other, plain.index("id"))
    return found


def _read_table(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """The first row of a CSV file, cleaned, and the others that are not empty, with their lines.

    Raises:
        LabkitError: The file is not a table in UTF-8 or UTF-16.
    """
    if not path.is_file():
        raise LabkitError(f"there is no file {path}")
    data = path.read_bytes()
    try:
        text = data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        raise LabkitError(f"{path} is not in UTF-8; save it as CSV in UTF-8") from None
    first = text.partition("\n")[0][:10_000]
    mark = max(",;\t", key=lambda x: len(_columns(first.strip().split(x))))
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=mark, strict=True)
    try:
        rows = [(lines.line_num, [clean_line(cell, 200) for cell in row]) for row in lines]
    except csv.Error as error:
        raise LabkitError(f"{path}, line {lines.line_num}: {error}; correct the table") from None
    (_, heads), *others = rows or [(0, [])]
    if long := next((line for line, row in others if any(row[len(heads) :])), None):
        raise LabkitError(f"{path}, line {long} has too many cells; put what has a comma in quotes")
    return heads, [(line, row) for line, row in others if any(row)]


def _merged(before: Roster, rows: Sequence[tuple[int, Student]]) -> tuple[Roster, set[str]]:
    """The roster with the students of a list, and the ids of these."""
    students = {one.id: one for one in before.students}
    names, listed = Counter(same_name(row.name) for _, row in rows), set[str]()
    for line, row in rows:
        name = same_name(row.name)
        found = [x for x in students.values() if any(x.agrees(row))] or [
            x for x in students.values() if same_name(x.name) == name != () and not x.agrees(row)
        ]
        people = [*map(str, found)]
        if len(found) > 1 or (found and not any(found[0].agrees(row)) and names[name] > 1):
            raise LabkitError(f"line {line} of the list could be {few(people)}; correct the list")
        if found and found[0].id in listed:
            raise LabkitError(f"line {line} of the list is {people[0]} again; correct the list")
        one = found[0] if found else Student(_folder(row, students))
        students[one.id] = replace(one, **{k: v for k, v in asdict(row).items() if v})
        listed.add(one.id)
    return Roster(tuple(students.values())), listed


def _folder(row: Student, students: Mapping[str, Student]) -> str:
    """The name of a new student's folder: the login or, without one, the name."""
    there = {id.casefold() for id in students}
    plain = safe_name(row.login or row.name)
    found = chain([plain], (f"{plain}-{k}" for k in count(2)))
    return next(x for x in found if x.casefold() not in there)


def read_roster(course: Course) -> Roster:
    """The course's roster; an empty one if no list was imported.

    Raises:
        LabkitError: The file is damaged.
    """
    path = course.root / FILE
    if not path.exists():
        return Roster()
    heads, rows = _read_table(path)
    found: dict[str, Student] = {}
    for line, row in rows:
        cells = dict(zip(heads, map(from_no_formula, row), strict=False))
        one = Student(**{column: cells.get(column, "") for column in COLUMNS})
        if one.id != safe_name(one.id) or one.id.casefold() in found:
            raise LabkitError(f"{path}, line {line}: the id {one.id!r} is twice there or no folder")
        found[one.id.casefold()] = one
    return Roster(tuple(found.values()))


def idle_extensions(course: Course) -> Iterator[str]:
    """A sentence for each extension whose student is neither in the roster nor has handed in."""
    known = {path.name for path in course.submitted.glob("*")}
    known |= {one.id for one in read_roster(course).students}
    for name in sorted({x.student for x in read_rules(course).extensions} - known):
        yield f"{RULES} has an extension for {name[:60]!a}, whom nobody knows"


def save_roster(course: Course, roster: Roster) -> None:
    """Write the course's roster."""
    out = io.StringIO()
    table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
    table.writeheader()
    for student in roster.students:
        table.writerow({name: no_formula(cell) for name, cell in asdict(student).items()})
    write(course.root / FILE, out.getvalue())


def tell_gradebook(course: Course, roster: Roster) -> None:
    """Write the students into nbgrader's gradebook, where formgrader reads their names."""
    with open_gradebook(course) as book:
        for one in roster.students:
            known = {"lms_user_id": one.lms_user_id or one.id_number, "email": one.email}
            known |= {"first_name": one.first_name, "last_name": one.last_name}
            book.update_or_create_student(one.id, **{k: v or None for k, v in known.items()})
