"""Takes a list of students into the roster: who is new, and who is there already.

A row is a student of the roster if they share a login, an address or a number; or the name, if
nobody else has it and nothing speaks against it.  Nobody leaves the roster by a list that does not
name them.  A student keeps the folder in which work of theirs lies.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from ..errors import LabkitError
from .attempts import move
from .clean import safe_name
from .course import Course
from .lms import Known, known, remember
from .roster import Roster, Student, same_name
from .student_list import Entry

_KEYS = ("login", "email", "lms_user_id", "id_number")
_FIELDS = ("first_name", "last_name", *_KEYS)


@dataclass(frozen=True)
class Enrolled:
    """What came of a list.

    Attributes:
        roster: With the list's students in it.
        rows: Each row of the list with its student.
        new: Those who were not there before.
    """

    roster: Roster
    rows: tuple[tuple[Entry, Student], ...]
    new: tuple[Student, ...]


def enrol(
    roster: Roster, entries: Sequence[Entry], collected: Mapping[str, Mapping[str, Known]]
) -> Enrolled:
    """Take a list into the roster.

    Args:
        roster: As it was.
        entries: The list's rows.
        collected: Whose work was collected before, by assignment, then by folder.

    Raises:
        LabkitError: Two rows, or a row and the roster, contradict each other.
    """
    _refuse_contradictions(entries)
    students = {student.id: student for student in roster.students}
    names = Counter(name for name, *_ in {(same_name(e.name), *_keys(e)) for e in entries})
    folders = [(folder, one) for people in collected.values() for folder, one in people.items()]
    rows: list[tuple[Entry, Student]] = []
    new: list[str] = []
    for entry in entries:
        alone = names[same_name(entry.name)] == 1
        student = _find(list(students.values()), entry, alone)
        if student is None:
            plain = Student("", **{k: getattr(entry, k) for k in _FIELDS})
            student = replace(plain, id=_folder(plain, alone, students, folders))
            new.append(student.id)
        else:
            said = {k: getattr(entry, k) for k in _FIELDS if getattr(entry, k)}
            student = replace(student, **said)
        students[student.id] = student
        rows.append((entry, student))
    return Enrolled(
        Roster(tuple(students.values())),
        tuple((entry, students[student.id]) for entry, student in rows),
        tuple(students[id] for id in new),
    )


def namesakes(roster: Roster) -> list[tuple[Student, ...]]:
    """Students who have the same name, as far as platforms write it."""
    by_name: dict[tuple[str, ...], tuple[Student, ...]] = {}
    for student in roster.students:
        name = same_name(student.name)
        by_name[name] = (*by_name.get(name, ()), student)
    return [group for name, group in by_name.items() if name and len(group) > 1]


def keep_numbers(
    course: Course, assignment: str, rows: Iterable[tuple[Entry, Student]]
) -> list[str]:
    """Keep whose each participant's number is, and bring earlier work to its owner.

    Returns:
        What a person should look at, a sentence each.
    """
    mine = {s.id: Known("moodle", e.participant, s.name) for e, s in rows if e.participant}
    before = {one.key: folder for folder, one in known(course, assignment).items()}
    left = [move(course, assignment, before.get(x.key, ""), id) for id, x in mine.items()]
    remember(course, assignment, mine)
    return [sentence for sentence in left if sentence]


def _keys(one: Entry | Student) -> tuple[str, ...]:
    return tuple(getattr(one, key).casefold() for key in _KEYS)


def _shared(one: Entry | Student, other: Entry | Student) -> list[bool]:
    """For each key that both have, whether it is the same."""
    return [a == b for a, b in zip(_keys(one), _keys(other), strict=True) if a and b]


def _refuse_contradictions(entries: Sequence[Entry]) -> None:
    by: dict[tuple[str, object], list[Entry]] = {}
    for entry in entries:
        name = same_name(entry.name)
        for key in {*zip(_KEYS, _keys(entry), strict=True), ("name", name)}:
            for other in by.get(key, ()) if key[1] else ():
                shared = _shared(entry, other)
                lines = f"lines {other.line} and {entry.line}"
                if key[0] == "name" and not shared:
                    raise LabkitError(
                        f"{lines} are both {entry.name}, and nothing tells them apart; give each a "
                        "login, an address or a number, or delete one"
                    )
                if any(shared) and not (all(shared) and same_name(other.name) == name):
                    raise LabkitError(f"{lines} contradict each other: {_says(other, entry)}")
            by.setdefault(key, []).append(entry)


def _says(one: Entry, other: Entry) -> str:
    pairs = [(getattr(one, k), getattr(other, k)) for k in ("name", *_KEYS)]
    same = " and ".join(a for a, b in pairs if a and a.casefold() == b.casefold())
    differ = " and ".join(
        f"{a} here and {b} there" for a, b in pairs if a and b and a.casefold() != b.casefold()
    )
    return f"{same} stands in both, with {differ}"


def _find(students: Sequence[Student], entry: Entry, alone: bool) -> Student | None:
    """The student of the roster whom a row means."""
    found = [student for student in students if any(_shared(student, entry))]
    if len(found) > 1:
        raise LabkitError(
            f"line {entry.line} could be {' or '.join(map(str, found))} of the roster; "
            "mend the list, or course_private/roster.csv"
        )
    called = [s for s in students if same_name(s.name) == same_name(entry.name) != ()]
    if not found and alone and len(called) == 1 and not _shared(called[0], entry):
        return called[0]
    return found[0] if found else None


def _folder(
    student: Student,
    alone: bool,
    students: Mapping[str, Student],
    folders: Sequence[tuple[str, Known]],
) -> str:
    """A folder for a new student: the one of their earlier work, or a new one."""
    taken = {id.casefold() for id in students}
    one = Roster((student,))
    mine = Counter(
        folder
        for folder, known in folders
        if one.whose(known) and (alone or known.system != "moodle")
    )
    used = [folder for folder, _ in mine.most_common() if folder == safe_name(folder)]
    plain = safe_name(student.login or student.name)
    others = (student.email.partition("@")[0], student.id_number, student.lms_user_id)
    names = used + [plain] * bool(student.login or alone)
    names += [safe_name(f"{plain}-{other}") for other in others if other]
    names += [f"{plain}-{k}" for k in range(2, len(students) + 3)]
    return next(name for name in names if name.casefold() not in taken)
