"""The roster: the students of the class, and how platforms identify them.

It is kept in ``course_private/roster.csv``, which git ignores, with the columns of nbgrader's own
list of students and more; a person can read and edit it.  It is archived with the term.
"""

from __future__ import annotations

import csv
import io
import unicodedata
from dataclasses import asdict, dataclass, fields
from functools import cache, cached_property

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..atomic import write
from ..clean import from_no_formula, no_formula, safe_name
from ..nbgrader.gradebook import open_gradebook
from .class_list import Student, read_table, refuse_long_rows
from .platforms import LmsUser

FILE = "course_private/roster.csv"
COLUMNS = tuple(field.name for field in fields(Student))


@dataclass(frozen=True)
class Roster:
    """The students of a course, each with an ``id`` of their own."""

    students: tuple[Student, ...] = ()

    def __contains__(self, id: str) -> bool:
        return id in self._by_id

    def get(self, id: str) -> Student | None:
        """The student with this id, which is the name of their folder."""
        return self._by_id.get(id)

    def whose(self, one: LmsUser) -> tuple[Student, ...]:
        """The students whom a platform may mean: none, one, or all with the same name."""
        key = same_name(one.name) if one.system == "moodle" else one.number.casefold()
        found = self._by_key.get((one.system, key), ())
        if one.system == "files" and not found:
            return self._by_key.get(("files", " ".join(same_name(one.name))), ())
        return found

    def identifies(self, one: LmsUser) -> bool:
        """Whether a file is named by something that identifies one student, such as a login.

        Names, and anything that students can choose for themselves, do not count.
        """
        students = self.whose(one) if one.system == "files" else ()
        return len(students) == 1 and one.number.casefold() in _identifiers(students[0])

    def namesakes(self) -> list[tuple[Student, ...]]:
        """Groups of students who have the same name in the form that platforms write."""
        groups = [group for (system, _), group in self._by_key.items() if system == "moodle"]
        return [group for group in groups if len(group) > 1]

    def alike(self, name: str) -> list[Student]:
        """Students whose names share two words with ``name``, as after a change of surname."""
        words = _words(name)
        return [student for student in self.students if len(words & _words(student.name)) > 1]

    @cached_property
    def _by_id(self) -> dict[str, Student]:
        return {student.id: student for student in self.students}

    @cached_property
    def _by_key(self) -> dict[tuple[str, object], tuple[Student, ...]]:
        """The students by each key that a platform may use for them."""
        found: dict[tuple[str, object], tuple[Student, ...]] = {}
        for student in self.students:
            login, email = student.login.casefold(), student.email.casefold()
            keys = {("moodle", same_name(student.name)), ("canvas", student.lms_user_id)}
            chosen = (email.partition("@")[0], student.github.casefold())
            names = (*_identifiers(student), *chosen, " ".join(same_name(student.name)))
            keys |= {("files", name) for name in names}
            for key in keys | {("exchange", login), ("exchange", email)}:
                if key[1]:
                    found[key] = (*found.get(key, ()), student)
        return found


def _identifiers(student: Student) -> tuple[str, ...]:
    """The identifiers that a school gives to one student alone."""
    known = (student.id, student.login, student.id_number, student.lms_user_id, student.email)
    return tuple(x.casefold() for x in known)


def same_name(name: str) -> tuple[str, ...]:
    """A key that is the same for all spellings of one person's name.

    Platforms differ in the order of first and last name, and omit characters that file names must
    not contain; so only the letters and digits of the words count, and not their order.
    """
    plain = unicodedata.normalize("NFKC", name).casefold().replace("_", " ").replace(",", " ")
    words = ("".join(c for c in w if unicodedata.category(c)[0] in "LMN") for w in plain.split())
    return tuple(sorted(filter(None, words)))


@cache
def _words(name: str) -> frozenset[str]:
    return frozenset(same_name(name.replace("-", " ")))


def read_roster(course: Course) -> Roster:
    """The course's roster; an empty one if none was imported.

    Raises:
        LabkitError: The file is damaged.
    """
    path = course.root / FILE
    if not path.exists():
        return Roster()
    try:
        heads, rows = read_table(path)
        refuse_long_rows(path, heads, rows)
    except LabkitError as error:
        raise _damaged(path, str(error)) from None
    if "id" not in heads:
        raise _damaged(path, "it has no column 'id'")
    found: dict[str, Student] = {}
    for line, row in rows:
        cells = dict(zip(heads, map(from_no_formula, row), strict=False))
        student = Student(**{column: cells.get(column, "") for column in COLUMNS})
        if student.id != safe_name(student.id) or student.id.casefold() in found:
            why = "is there twice" if student.id.casefold() in found else "cannot name a folder"
            raise _damaged(path, f"line {line}: the id {student.id!r} {why}")
        found[student.id.casefold()] = student
    return Roster(tuple(found.values()))


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
        there = {student.id: student for student in book.students}
        for student in roster.students:
            about = {
                "first_name": student.first_name or None,
                "last_name": student.last_name or None,
                "email": student.email or None,
                "lms_user_id": student.lms_user_id or student.id_number or None,
            }
            if any(getattr(there.get(student.id), k, "") != v for k, v in about.items()):
                book.update_or_create_student(student.id, **about)


def _damaged(path: object, why: str) -> LabkitError:
    return LabkitError(
        f"{path} is damaged: {why}; correct it, or move it away and type: "
        "labkit students import FILE.csv"
    )
