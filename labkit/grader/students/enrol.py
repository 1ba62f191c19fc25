"""Merge a list of students into the roster.

A row matches a student of the roster if they share a login, an address or a number; or a name, if
it is unique and nothing contradicts the match.  A student whom a list does not name stays in the
roster.  A new student gets a folder of their own, and their work that was collected earlier moves
there (``move``).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import chain, count
from pathlib import Path

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..clean import few, how_many, safe_name
from ..rules import read_rules
from ..seeds import key_of
from .arms import give_arms
from .class_list import Entry, Student, read_list
from .identity import all_lms_users, assign_folders, identity_lock
from .list_remarks import (
    about_changed_teams,
    about_doubles,
    about_encoding,
    about_namesakes,
    about_odd_teams,
    about_teams,
)
from .move import move_to_owners, unlisted
from .platforms import LmsUser
from .roster import FILE, Roster, read_roster, same_name, save_roster, tell_gradebook
from .worksheet import keep_numbers, keep_times, refuse_another

_Mark = tuple[str, object]
_KEYS = ("login", "email", "lms_user_id", "id_number", "github")
_FIELDS = ("first_name", "last_name", "team", *_KEYS)


@dataclass(frozen=True)
class Enrolled:
    """The result of merging a list.

    Attributes:
        roster: The roster with the students of the list.
        rows: Each row of the list, with its student.
        new: The students who were not in the roster before.
    """

    roster: Roster
    rows: tuple[tuple[Entry, Student], ...]
    new: tuple[Student, ...]


def enrol(
    roster: Roster, entries: Sequence[Entry], collected: Mapping[str, Mapping[str, LmsUser]]
) -> Enrolled:
    """Merge a list into the roster.

    Args:
        roster: The roster so far.
        entries: The rows of the list.
        collected: The users whose work was collected before, by assignment, then by folder.

    Raises:
        LabkitError: Two rows, or a row and the roster, contradict each other.
    """
    listed = {(same_name(x.student.name), *marks(x.student).items()) for x in entries}
    names = Counter(name for name, *_ in listed)
    students = {student.id: student for student in roster.students}
    by_mark: dict[_Mark, set[str]] = {}
    for student in roster.students:
        _index(student, by_mark)
    rows: list[tuple[Entry, str]] = []
    before: dict[object, list[Entry]] = {}
    for entry in entries:
        unique = names[same_name(entry.student.name)] == 1
        # `_folders` replaces the line as the id of a new student; no folder's name has a space
        id = _find(entry, unique, students, by_mark) or f"line {entry.line}"
        student = students.get(id, Student(id))
        known = ("first_name", "last_name") if entry.guessed and student.name else ()
        said = {k: v for k in _FIELDS if (v := getattr(entry.student, k)) and k not in known}
        students[id] = replace(student, **said)
        _index(students[id], by_mark)
        _refuse_contradictions(entry, id, before)
        rows.append((entry, id))
    new = {id for id in students if id not in roster}
    folders = _folders(Roster(tuple(students.values())), new, collected)
    done = {id: replace(s, id=folders.get(id, id)) for id, s in students.items()}
    return Enrolled(
        Roster(tuple(done.values())),
        tuple((entry, done[id]) for entry, id in rows),
        tuple(one for id, one in done.items() if id in new),
    )


def import_list(
    course: Course, file: Path, assignment: str | None = None
) -> tuple[list[str], list[str]]:
    """Merge a list of students into the course's roster, and move earlier work to its owners.

    Args:
        course: The course.
        file: A CSV file; see `read_list`.
        assignment: The assignment, if the file is Moodle's grading worksheet.

    Returns:
        Two lists of sentences. The first says what was done; the second, what a person should look
        at, such as names that may be wrong or hand-in times that are not set.

    Raises:
        LabkitError: The list contradicts the roster or itself, the file is not a list, or it is the
            worksheet of another assignment; or, with a worksheet, the rules file is damaged.
    """
    rows = read_list(file)
    entries = [entry for entry in rows if not entry.is_canvas_test_student]
    if not entries:
        raise LabkitError(
            f"{file} names its columns but no student; choose all students, and download it again"
        )
    numbered = sum(bool(entry.participant) for entry in entries)
    if assignment and not numbered:
        raise LabkitError(
            f"{file} has no column 'Identifier'; give the grading worksheet of "
            f"{assignment}, in English: Submissions, Actions, Download grading worksheet"
        )
    with identity_lock(course):
        before = read_roster(course)
        done = enrol(before, entries, all_lms_users(course))
        if assignment:
            refuse_another(course, assignment, done.roster, done.rows)
            rules = read_rules(course)
        save_roster(course, done.roster)
        tell_gradebook(course, done.roster)
        give_arms(course, done.roster, key_of(course, "arms"))
        left = move_to_owners(course, done.roster)
        taken, late, look = 0, list[str](), list[str]()
        if assignment:
            left += keep_numbers(course, assignment, done.roster, done.rows)
            taken, late, look = keep_times(course, assignment, done.rows, rules)
    listed = {student.id for _, student in done.rows}
    absent = [one for one in before.students if one.id not in listed]
    everybody = how_many(len(done.roster.students), "student")
    who = f": {few([*map(str, done.new)])}" if before.students and done.new else ""
    summary = [f"{FILE}: {everybody}, {len(done.new)} of them new{who}"]
    if absent and not assignment:
        summary.append(
            f"not in this list, and still in the roster: {len(absent)} "
            f"({few([*map(str, absent)])}); keep their rows, even if they have left the class"
        )
    look += [
        *about_encoding(file, (entry.student for entry in entries)),
        *about_doubles(absent, done.new),
        *about_odd_teams(done.rows),
        *about_changed_teams(before, done.rows),
    ]
    named = {one.student for one in left}
    if others := [x for x in unlisted(course, done.roster) if x not in named]:
        look.append(
            f"work in folders that belong to nobody in the roster: {', '.join(others)}; where it "
            "is a listed student's, import Moodle's grading worksheet, with --assignment, or copy "
            "the notebook that is to count to submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb"
        )
    if len(entries) < len(rows):
        summary.append(
            "not taken: Test Student, whom Canvas adds for the instructor's student view"
        )
    summary += about_teams(done.rows)
    if assignment:
        set_now = f"{how_many(taken, 'hand-in time')} set"
        summary += [f"{assignment}: {how_many(numbered, 'participant')}; {set_now}", *late]
    else:
        if numbered:
            summary.append(
                "the participants' numbers are those of one assignment; --assignment NAME keeps "
                "them"
            )
        summary += about_namesakes(done.roster, all_lms_users(course))
    return summary, [*dict.fromkeys(one.why for one in left), *look]


def marks(one: Student) -> dict[str, str]:
    """The known data that identify a student, by field."""
    return {key: mark.casefold() for key in _KEYS if (mark := getattr(one, key))}


def agreements(one: Student, other: Student) -> list[bool]:
    """For each key that both students have, whether the values agree."""
    a, b = marks(one), marks(other)
    return [a[key] == b[key] for key in a.keys() & b.keys()]


def _refuse_contradictions(entry: Entry, id: str, rows: dict[object, list[Entry]]) -> None:
    """Refuse a row that contradicts an earlier one; otherwise add it to the rows."""
    who, name, number = entry.student, same_name(entry.student.name), entry.participant
    for other in rows.setdefault(("participant", number), []) if number else ():
        raise LabkitError(
            f"lines {other.line} and {entry.line} are both participant {number}; download the "
            "worksheet again"
        )
    for other in rows.setdefault(("name", name), []) if name else ():
        if not agreements(who, other.student):
            raise LabkitError(
                f"lines {other.line} and {entry.line} are both {who.name}, and nothing tells them "
                "apart; give each a login, an address or a number, or delete one"
            )
    for other in rows.setdefault(("id", id), []):
        alike = same_name(other.student.name) == name
        pairs = [(getattr(other.student, x), getattr(who, x)) for x in ("name", *_KEYS)[alike:]]
        differ = [f"{a} and {b}" for a, b in pairs if a and b and a.casefold() != b.casefold()]
        if differ:
            raise LabkitError(
                f"lines {other.line} and {entry.line} are one student by a login, an address or a "
                f"number, and contradict each other: {', '.join(differ)}; correct the list"
            )
    for key in (("participant", number), ("name", name), ("id", id)):
        rows.setdefault(key, []).append(entry)


def _index(student: Student, by_mark: dict[_Mark, set[str]]) -> None:
    for mark in (*marks(student).items(), ("name", same_name(student.name))):
        by_mark.setdefault(mark, set()).add(student.id)


def _find(
    entry: Entry, unique: bool, students: Mapping[str, Student], by_mark: Mapping[_Mark, set[str]]
) -> str:
    """The id of the student whom a row means; empty if the student is new."""
    found = set().union(*(by_mark.get(mark, set()) for mark in marks(entry.student).items()))
    if len(found) > 1:
        people = " or ".join(str(students[id]) for id in sorted(found))
        raise LabkitError(
            f"line {entry.line} could be {people}; correct the list, or course_private/roster.csv"
        )
    name = same_name(entry.student.name)
    called = by_mark.get(("name", name), set()) if name and unique and not found else set()
    if len(called) == 1 and not agreements(students[min(called)], entry.student):
        return min(called)
    return min(found, default="")


def _folders(
    everybody: Roster, new: Set[str], collected: Mapping[str, Mapping[str, LmsUser]]
) -> dict[str, str]:
    """The name of a folder for each new student; it holds nobody else's work."""
    owners = {student.id.casefold(): {student.id} for student in everybody.students}
    for assignment, people in collected.items():
        found = assign_folders(people.values(), assignment, collected, everybody)
        for folder, one in people.items():
            owners.setdefault(folder.casefold(), set()).add(found[one.key].folder)
    alike = {student.id for group in everybody.namesakes() for student in group}
    folders: dict[str, str] = {}
    for student in everybody.students:
        if student.id in new:
            plain = safe_name(student.login or student.name)
            others = (student.email.partition("@")[0], student.id_number, student.lms_user_id)
            names = chain(
                [plain] * bool(student.login or student.id not in alike),
                (safe_name(f"{plain}-{other}") for other in others if other),
                (f"{plain}-{k}" for k in count(2)),
            )
            free = (x for x in names if owners.get(x.casefold(), set()) <= {student.id})
            folders[student.id] = name = next(free)
            owners.setdefault(name.casefold(), set()).add(student.id)
    return folders
