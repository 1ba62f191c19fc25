"""Forget: delete earlier terms, or everything that is stored about one student."""

from __future__ import annotations

import glob
import shlex
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from markupsafe import escape
from nbgrader.api import Gradebook

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import CUP, Course
from ...course.own_arm import HANDLES, Arms
from ...errors import LabkitError
from ..atomic import write
from ..grading.results import Results
from ..nbgrader.gradebook import quiet_database
from ..pseudonyms import FILE as KEY
from ..pseudonyms import pseudonym
from ..rules import FILE as RULES
from ..rules import rules_in
from ..students.identity import FILE as LMS
from ..students.identity import all_lms_users, identity_lock, save_lms_users
from ..students.move import move_work
from ..students.roster import FILE as ROSTER
from ..students.roster import Roster, read_roster, same_name, save_roster
from ..submission import did_you_mean, is_name, students
from .older import relocate
from .term import archives

_FOLDERS = ("submitted", "attempts", "autograded", "feedback")
_OF_A_STUDENT = (
    *(f"{folder}/{{}}" for folder in _FOLDERS),
    *("results/*/{}.json", "results/*/old/{}"),
    *("results/*/aside/{}.json", "results/*/aside/old/{}"),
    *("build/course/defence/{}.html", "build/course/explain/{}"),
)
"""Patterns of one student's files and folders within the folder of a term."""


def files_of(course: Course, student: str) -> list[Path]:
    """One student's files and folders, and pages that name them, in this term and in earlier ones.

    Raises:
        LabkitError: No student can have this name.
    """
    if not is_name(student) or student in {"", ".", ".."} or "/" in student:
        raise LabkitError(f"{student!a} is not the name of a student's folder")
    patterns = [pattern.format(glob.escape(student)) for pattern in _OF_A_STUDENT]
    return [
        term.root / found
        for term in _terms(course)
        for pattern in patterns
        for found in sorted(glob.glob(pattern, root_dir=term.root, include_hidden=True))
    ] + [page for term in _terms(course) for page in _pages_of_mates(term, student)]


def entries_of(course: Course, student: str) -> list[Path]:
    """Files about the whole class that have an entry for one student, in every term.

    Raises:
        LabkitError: One of these files is damaged.
    """
    return [path for term in _terms(course) for path, _ in _entries(term, student)]


def shared_work(course: Course, student: str) -> list[tuple[Course, str, str]]:
    """What a student handed in for a team: term, assignment, and new owner.

    These are reports, and the cup's notebook if it is the team's only one.

    Raises:
        LabkitError: The roster or the release of a term is damaged.
    """
    found = []
    for term in _terms(course):
        roster = read_roster(term)
        one = roster.get(student)
        if one is None or not one.team:
            continue
        team = {mate.id for mate in roster.students if mate.team == one.team}
        for name in [CUP, *sorted(path.stem for path in term.bundle.glob("*.json"))]:
            own = team & {*students(term, name), *Results(term, name).students()}
            first = len(own) == 1 if name == CUP else Bundle.of(term, name).is_report
            if first and min(own, default="") == student and team - own:
                found.append((term, name, min(team - own)))
    return found


def forget(
    course: Course, found: Sequence[Path], entries: Sequence[Path] = (), student: str = ""
) -> None:
    """Delete what `files_of` found, or archived terms, and what `entries_of` found.

    Work for a team, on which the marks of others depend, is first moved to one of them.

    Raises:
        LabkitError: Another command holds the lock, a file about the whole class is damaged, or the
            team's report cannot be moved.
    """
    with identity_lock(course):
        for term, name, mate in shared_work(course, student) if student else ():
            if move_work(term, name, {student: mate}):
                raise LabkitError(
                    f"{student} handed in {name} for {mate} too, who has other files in "
                    f"{term.root / 'attempts' / mate / name}; move these away, then try again"
                )
            shutil.rmtree(term.root / "feedback" / mate / name, ignore_errors=True)  # names both
        for path in found:
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)
        for term in _terms(course) if entries else ():
            for _, delete in _entries(term, student):
                delete()


def left_by_hand(course: Course, student: str) -> Iterator[str]:
    """A sentence for each thing about a student that only a person can delete."""
    for file in (term.root / RULES for term in _terms(course)):
        try:
            granted = any(one.student == student for one in rules_in(file).extensions)
        except LabkitError as error:
            yield f"{error}, and see whether it names an extension of theirs"
        else:
            if granted:
                name = file.relative_to(course.root)
                yield f"{name} names an extension of theirs; delete it there"
    for term in _terms(course):
        if alike := _perhaps_theirs(term, student):
            where = term.submitted.relative_to(course.root)
            yield (
                f"in {where}, perhaps theirs too: {', '.join(alike)}; look, and for each that is "
                "theirs type: labkit term forget --student FOLDER"
            )
    for page in _pages_of_mates(course, student):
        mate, assignment = page.parts[-3:-1]
        yield (
            f"{page.relative_to(course.root)} says that {student} handed in; once it is deleted, "
            f"write it again: labkit feedback {assignment} --student {shlex.quote(mate)}"
        )
    sheets = [str(path.relative_to(course.root)) for path in _read_by_others(course, student)]
    if sheets:
        yield f"the sheets of their readers still hold their report: {', '.join(sheets)}"
    yield (
        "copies elsewhere are yours to delete: downloads, exported tables and reports, backups, "
        "the exchange, the platform itself"
    )


def unknown(course: Course, student: str) -> LabkitError:
    """The error for a student about whom nothing is stored, with similar names."""
    folders = (path.name for term in _terms(course) for path in term.submitted.glob("*"))
    known = {name: name for name in folders if is_name(name)}
    known |= {one.id: str(one) for one in read_roster(course).students}
    near = did_you_mean(student, known.values())
    return LabkitError(f"no student {student!r} in this term or an earlier one{near}")


def _perhaps_theirs(term: Course, student: str) -> list[str]:
    """Other folders of a term whose owner has the same name and is not in the roster."""
    roster, users = read_roster(term), all_lms_users(term).values()
    known = [(folder, same_name(one.name)) for each in users for folder, one in each.items()]
    names = {name for folder, name in known if folder == student}
    names |= {same_name(one.name) for one in roster.students if one.id == student}
    return sorted(
        {x for x, name in known if name and name in names and x not in roster} - {student}
    )


def _pages_of_mates(term: Course, student: str) -> list[Path]:
    """Feedback pages of a team that say that this student handed in."""
    roster, said = read_roster(term), f"Handed in by {escape(student)} for your team."
    one = roster.get(student)
    team = [x.id for x in roster.students if one and one.team and x.team == one.team]
    pages = [
        x
        for mate in sorted({*team} - {student})
        for x in (term.root / "feedback" / mate).glob("*/*.html")
    ]
    return [x for x in pages if said in x.read_text(encoding="utf-8", errors="replace")]


def _read_by_others(course: Course, student: str) -> Iterator[Path]:
    """Peer-review sheets, handed out or handed in, that contain a student's report."""
    for term in _terms(course):
        key = term.root / KEY
        if key.exists():
            name = pseudonym(key.read_bytes(), student)
            for folder in _FOLDERS:
                sheets = sorted(term.root.glob(f"{folder}/*/*_review/**/*.ipynb"))
                yield from (x for x in sheets if f"{name}_" in x.read_text(errors="replace"))


def _terms(course: Course) -> list[Course]:
    """The current term and the archived ones, each with the layout of a course."""
    folders = [one.folder for one in archives(course) if one.folder.is_dir()]
    terms = [course, *map(Course, folders)]
    for term in terms:
        relocate(term, archived=term != course)
    return terms


def _entries(term: Course, student: str) -> Iterator[tuple[Path, Callable[[], object]]]:
    """The files about a term's whole class that name a student, and how to delete the entry."""
    book, roster, arms = term.root / "gradebook.db", read_roster(term), Arms.of(term.root)
    if book.exists() and _in_gradebook(book, student):
        yield book, partial(_leave_gradebook, book, student)
    if student in roster:
        others = Roster(tuple(one for one in roster.students if one.id != student))
        yield term.root / ROSTER, partial(save_roster, term, others)
    known = all_lms_users(term)
    left = {name: {k: v for k, v in users.items() if k != student} for name, users in known.items()}
    if left != known:
        yield term.root / LMS, partial(save_lms_users, term, left)
    if student in arms.handles:
        handles = {who: handle for who, handle in arms.handles.items() if who != student}
        text = replace(arms, handles=handles).text().encode()
        yield term.root / HANDLES, partial(write, term.root / HANDLES, text)


def _in_gradebook(path: Path, student: str) -> bool:
    with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
        return student in {one.id for one in book.students}


def _leave_gradebook(path: Path, student: str) -> None:
    with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
        book.remove_student(student)
