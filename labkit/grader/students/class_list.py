"""Read lists of students: exports of Moodle and Canvas, or any table with a row per student.

Canvas: *Grades, Export*; its columns are Student ("Last, First"), ID, SIS User ID, SIS Login ID and
Section.  Moodle: *Participants*, select all, *Download table data as CSV*; or the grading worksheet
of an assignment, the only list that has the participant numbers.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...errors import LabkitError
from ..submission import check_size
from .platforms import person

LARGEST = 20
"""The largest list that is read, in [MiB]."""
HEADS = {
    "login": "login, login name, username, user name, sis login id, anmeldename, nutzername, "
    "benutzername",
    "id_number": "id number, idnumber, sis user id, student number, student id, "
    "matriculation number, matrikelnummer, id-nummer, numéro d’identification, número de id",
    "lms_user_id": "lms user id, canvas id",
    "github": "github, github username, github login",
    "team": "team, group, groups, gruppe, groupe, grupo",
    "email": "email, e-mail, email address, e-mail address, mail, e-mail-adresse, "
    "adresse de courriel, dirección de correo",
    "first_name": "first name, firstname, given name, forename, vorname, prénom, nombre",
    "last_name": "last name, lastname, surname, family name, nachname, nom, apellido(s)",
    "name": "name, full name, student, student name, vollständiger name, nom complet, "
    "nombre completo",
    "participant": "identifier",
    "handed_in": "last modified (submission)",
}
"""The headings of each field; what a column "id" means depends on the other columns."""
_FIELDS = {head: field for field, heads in HEADS.items() for head in heads.split(", ")}
_NOT_A_STUDENT = "points possible"
_NO_TEAM = {"no groups", "keine gruppen"}
"""Entries in Moodle's column Groups for a student who is in no group."""
_PARTICIPANT = re.compile(r"[^\d]*([0-9]{1,19})")
GUESS = "cp1252"
"""The encoding of a file that is neither UTF-8 nor UTF-16; a Mac's is another one."""
_LONG_LINE = 100_000
"""The part of the first line that is searched for the delimiter, in characters."""


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
        github: User name on GitHub.
        team: Name of the team; the students of a team share an arm.
    """

    id: str
    first_name: str = ""
    last_name: str = ""
    email: str = ""
    lms_user_id: str = ""
    login: str = ""
    id_number: str = ""
    github: str = ""
    team: str = ""

    @property
    def name(self) -> str:
        """First and last name."""
        return f"{self.first_name} {self.last_name}".strip()

    def __str__(self) -> str:
        return f"{self.name} ({self.id})" if self.name else self.id


@dataclass(frozen=True)
class Entry:
    """One row of a list; what the list does not say is empty.

    Attributes:
        line: The number of its last line in the file.
        student: The student, without an ``id``, which the roster assigns.
        participant: Moodle's number for the participant in one assignment.
        handed_in: When the participant handed in, as Moodle's worksheet writes it.
        guessed: Whether first and last name were guessed from one column.
    """

    line: int
    student: Student
    participant: str = ""
    handed_in: str = ""
    guessed: bool = False

    @property
    def is_canvas_test_student(self) -> bool:
        """Whether this is Canvas's "Student, Test", with which teachers see the student view."""
        return bool(self.student.lms_user_id) and self.student.name == "Test Student"


def read_list(path: Path) -> tuple[Entry, ...]:
    """Read a list of students.

    Args:
        path: A CSV file; its delimiter and its encoding are detected.

    Raises:
        LabkitError: The file is not a table, a column is missing, or a row does not fit.
    """
    heads, rows = read_table(path)
    if not any(heads):
        what = "does not name its columns in the first line" if rows else "is empty"
        raise LabkitError(f"{path} {what}; download the list again")
    columns = _columns(heads)
    if not columns.keys() & {"login", "name", "last_name"}:
        raise LabkitError(
            f"{path} does not say who its students are; its columns are "
            f"{', '.join(map(repr, heads))[:300]}; call one of them 'name' or 'login', or two of "
            "them 'first name' and 'last name'"
        )
    refuse_long_rows(path, heads, rows)
    return tuple(_entries(path, columns, rows))


def read_table(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """The first row of a CSV file, cleaned, and the other rows with their line numbers.

    Raises:
        LabkitError: The file is not a table.
    """
    text = _read_text(path).replace("\r\n", "\n").replace("\r", "\n")
    first = text.partition("\n")[0][:_LONG_LINE]
    delimiter = max(
        ",;\t|", key=lambda x: len(_columns(next(csv.reader([first], delimiter=x), [])))
    )
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    try:
        rows = [(reader.line_num, [person(cell) for cell in row]) for row in reader]
    except csv.Error as error:
        raise LabkitError(f"{path}, line {reader.line_num}: {error}; correct the table") from None
    (_, heads), *others = rows or [(0, [])]
    return heads, others


def refuse_long_rows(
    path: Path, heads: Sequence[str], rows: Sequence[tuple[int, list[str]]]
) -> None:
    """Refuse a table in which an unquoted comma may have shifted the cells of a row.

    Raises:
        LabkitError: A row has more cells than there are columns.
    """
    for line, row in rows:
        if any(row[len(heads) :]):
            raise LabkitError(
                f"{path}, line {line} has {len(row)} cells and the first line has {len(heads)}; "
                "put quotation marks around what holds a comma"
            )


def _read_text(path: Path) -> str:
    """The text of a file, in any encoding that spreadsheets write."""
    if not path.is_file():
        raise LabkitError(f"there is no file {path}")
    check_size(path.stat().st_size, LARGEST)
    data = path.read_bytes()
    encoding = encoding_of(data)
    if encoding != "utf-16" and (data.startswith(b"PK\x03\x04") or b"\0" in data):
        raise LabkitError(f"{path} is not a text; save the spreadsheet as CSV")
    try:
        return data.decode(encoding, errors="replace" if encoding == GUESS else "strict")
    except UnicodeDecodeError:
        raise LabkitError(f"{path} is cut off; download or save it again") from None


def encoding_of(data: bytes) -> str:
    """The encoding of a file's text; `GUESS` if it is neither UTF-8 nor UTF-16."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return GUESS
    return "utf-8-sig"


def _columns(heads: Sequence[str]) -> dict[str, int]:
    """The index of the column of each field."""
    plain = [re.sub(r"[\s_]+", " ", person(head).casefold()).strip(' *"') for head in heads]
    found: dict[str, int] = {}
    for at, head in enumerate(plain):
        if head in _FIELDS:
            found.setdefault(_FIELDS[head], at)
    if "id" in plain:
        canvas = "student" in plain and bool({"section", "sis login id"} & set(plain))
        other = "id_number" if "login" in found else "login"
        found.setdefault("lms_user_id" if canvas else other, plain.index("id"))
    return found


def _entries(
    path: Path, columns: dict[str, int], rows: Sequence[tuple[int, list[str]]]
) -> Iterator[Entry]:
    for line, row in rows:
        cells = {k: row[at] if at < len(row) else "" for k, at in columns.items()}
        name, guessed = cells.pop("name", ""), False
        if not (name or any(cells.values())) or name.casefold() == _NOT_A_STUDENT:
            continue  # an empty line, or Canvas's full marks
        if name and not (cells.get("first_name") or cells.get("last_name")):
            first, last = _split(name, first_is_first="participant" in columns)
            cells |= {"first_name": first, "last_name": last}
            guessed = True
        if cells.get("team", "").casefold() in _NO_TEAM:
            cells["team"] = ""
        number = _PARTICIPANT.fullmatch(cells.get("participant", ""))
        cells["participant"] = number[1] if number else ""
        of_hand_in = {k: cells.pop(k, "") for k in ("participant", "handed_in")}
        student = Student("", **cells)
        if not (student.name or student.login):
            raise LabkitError(f"{path}, line {line} has neither a name nor a login")
        yield Entry(line, student, **of_hand_in, guessed=guessed)


def _split(name: str, first_is_first: bool) -> tuple[str, str]:
    """First and last name, from "Davis, Jr., Sammy" (Canvas) or "Sammy Davis, Jr." (Moodle)."""
    last, comma, first = name.rpartition(",")
    if comma and not first_is_first:
        return first.strip(), last.strip()
    before, comma, after = name.partition(",")
    first, _, last = before.rpartition(" ")
    return first.strip(), last + comma + after
