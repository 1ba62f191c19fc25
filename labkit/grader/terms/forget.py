"""Forget: delete earlier terms, or everything that is stored about one student."""

from __future__ import annotations

import glob
import shutil
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from datetime import timedelta
from functools import partial
from itertools import combinations, starmap
from pathlib import Path
from shlex import quote

from markupsafe import escape
from nbgrader.api import Gradebook

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.own_arm import FILE as ARMS
from ...course.own_arm import HANDLES, Arms
from ...errors import LabkitError
from ..atomic import write
from ..grading.results import Results
from ..nbgrader.gradebook import quiet_database
from ..rules import FILE as RULES
from ..rules import rules_in
from ..students.enrol import agreements, marks
from ..students.identity import FILE as LMS
from ..students.identity import all_lms_users, identity_lock, save_lms_users
from ..students.move import move_work
from ..students.roster import FILE as ROSTER
from ..students.roster import Roster, read_roster, save_roster
from ..submission import is_name, students
from .older import relocate
from .term import archives

FOLDERS = ("submitted", "attempts", "autograded", "feedback")
_OF_A_STUDENT = (
    *(f"{folder}/{{}}" for folder in FOLDERS),
    *("results/*/{}.json", "results/*/old/{}"),
    *("results/*/aside/{}.json", "results/*/aside/old/{}"),
    *("build/course/defence/{}.html", "build/course/explain/{}"),
)
"""Patterns of one student's files and folders within the folder of a term."""
NOW = "now"
"""The name of the term under way, as `labkit term list` calls it."""


def all_terms(course: Course) -> dict[str, Course]:
    """The current term and the archived ones by name, each with the layout of a course."""
    folders = [one.folder for one in archives(course) if one.folder.is_dir()]
    terms = {NOW: course} | {folder.name: Course(folder) for folder in folders}
    for name, term in terms.items():
        relocate(term, archived=name != NOW)
    return terms


def terms_of(course: Course, student: str, names: Collection[str] = ()) -> list[Course]:
    """The named terms, or all, in which a student is to be forgotten.

    Raises:
        LabkitError: A term is unknown, or this folder belongs to different people in two rosters.
    """
    known = all_terms(course)
    if unknown := [name for name in names if name not in known]:
        raise LabkitError(f"there is no term {unknown[0]!r}; there are {', '.join(known)}")
    terms = {name: term for name, term in known.items() if name in names or not names}
    people = {name: one for name, term in terms.items() if (one := read_roster(term).get(student))}
    ties = starmap(agreements, combinations(people.values(), 2))
    if any(tie and not any(tie) for tie in ties):
        listed = [f"{x}: {', '.join((y.name, *marks(y).values()))}" for x, y in people.items()]
        rest = [x for x, y in terms.items() if x not in people and files_of([y], student)]
        listed += [f"{x}: not in its roster" for x in rest]
        raise LabkitError(
            f"{student} is not the same person in all terms ({'; '.join(listed)}); name the terms "
            f"of the one who is meant: labkit term forget {min(people)} --student {quote(student)}"
        )
    return list(terms.values())


def files_of(terms: Iterable[Course], student: str) -> list[Path]:
    """One student's files and folders in these terms, and pages that name them.

    Raises:
        LabkitError: No student can have this name.
    """
    if not is_name(student) or student in {"", ".", ".."} or "/" in student:
        raise LabkitError(f"{student!a} is not the name of a student's folder")
    patterns = [pattern.format(glob.escape(student)) for pattern in _OF_A_STUDENT]
    found = list[Path]()
    for term in terms:
        for pattern in patterns:
            names = glob.glob(pattern, root_dir=term.root, include_hidden=True)
            found += [term.root / name for name in sorted(names)]
        found += pages_of_mates(term, student)
    return found


def entries_of(terms: Iterable[Course], student: str) -> list[Path]:
    """Files about the whole class that have an entry for one student, in these terms.

    Raises:
        LabkitError: One of these files is damaged.
    """
    return [path for term in terms for path, _ in _entries(term, student)]


def shared_work(terms: Iterable[Course], student: str) -> list[tuple[Course, str, str]]:
    """What a student handed in for a team: term, assignment and new owner of each.

    Reports belong to it.

    Raises:
        LabkitError: The roster or the release of a term is damaged.
    """
    found = []
    for term in terms:
        roster = read_roster(term)
        one = roster.get(student)
        if one is None or not one.team:
            continue
        team = {mate.id for mate in roster.students if mate.team == one.team}
        for name in sorted(path.stem for path in term.bundle.glob("*.json")):
            own = team & {*students(term, name), *Results(term, name).students()}
            if Bundle.of(term, name).is_report and min(own, default="") == student and team - own:
                found.append((term, name, min(team - own)))
    return found


def shorter_extensions(
    course: Course, student: str, shared: Iterable[tuple[Course, str, str]]
) -> list[str]:
    """A sentence for each of `shared_work` whose new owner has a shorter extension."""
    said = []
    for term, name, mate in shared:
        file = term.root / RULES
        try:
            rules = rules_in(file)
        except LabkitError:
            continue  # `left_by_hand` names the file
        if (longer := rules.longer(student, name)) > rules.longer(mate, name):
            said.append(
                f"{student} has an extension of {longer / timedelta(days=1):g} days for {name}; in "
                f"{file.relative_to(course.root)}, give it to {mate} too before you add --yes, or "
                "the team's mark may fall"
            )
    return said


def forget(
    course: Course, found: Iterable[Path], terms: Sequence[Course] = (), student: str = ""
) -> None:
    """Delete what `files_of` found, or archived terms, and a student's entries in these terms.

    Work for a team, on which the marks of others depend, is first moved to one of them.

    Raises:
        LabkitError: Another command holds the lock, a file about the whole class is damaged, or
            work for a team cannot be moved or has a new owner with a shorter extension.
    """
    with identity_lock(course):
        shared = shared_work(terms, student)
        if said := shorter_extensions(course, student, shared):
            raise LabkitError("; ".join(said))
        for term, name, mate in shared:
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
        for term in terms:
            for _, delete in _entries(term, student):
                delete()


def pages_of_mates(term: Course, student: str) -> list[Path]:
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
        arms = replace(arms, handles=handles)
        yield term.root / HANDLES, partial(write, term.root / HANDLES, arms.text())
        for file in sorted(term.release.glob(f"*/{ARMS}")):
            yield file, partial(write, file, arms.table())


def _in_gradebook(path: Path, student: str) -> bool:
    with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
        return student in {one.id for one in book.students}


def _leave_gradebook(path: Path, student: str) -> None:
    with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
        book.remove_student(student)
