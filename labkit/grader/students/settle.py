"""Brings work and marks to the student whose they are, once the roster has come to know it."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...course.authoring.layout import Course
from ..each import Failure
from ..grading.results import Results
from ..nbgrader.gradebook import open_gradebook
from .attempts import FOLDER
from .identity import all_lms_users, places, remember
from .roster import Roster, read_roster

_WORK = (FOLDER, "submitted")
_MADE_OF_IT = ("autograded", "feedback")


@dataclass(frozen=True)
class Move:
    """The work of one assignment, which goes from one folder to another."""

    assignment: str
    old: str
    new: str


def settle(course: Course, roster: Roster) -> list[Failure]:
    """Bring all work to those whom the roster has come to know since it was collected.

    Returns:
        Which folders stayed, and why.
    """
    left: list[Failure] = []
    collected = all_lms_users(course)
    for assignment, people in collected.items():
        found = places(people.values(), assignment, collected, roster)
        moves = [Move(assignment, old, found[one.key].folder) for old, one in people.items()]
        left += bring(course, moves)
        gone = [x for x in moves if x.old != x.new and not _work(course, x.old, assignment)]
        remember(course, assignment, {x.new: people[x.old] for x in gone})
    return left


def strangers(course: Course, roster: Roster) -> list[str]:
    """Folders of work that are of nobody in the roster."""
    found = {path.parent.name for base in _WORK for path in (course.root / base).glob("*/*")}
    return sorted(name for name in found if name not in roster)


def bring(course: Course, moves: Iterable[Move]) -> list[Failure]:
    """Take work from one folder to another, and then its marks, also those by hand.

    Where both folders have work nothing moves: the two may be of two people, as who they are may be
    known by a name alone.

    Returns:
        Which folders stayed, and why.
    """
    moves = [move for move in moves if move.old and move.old != move.new]
    for move in moves:
        both = all(_work(course, who, move.assignment) for who in (move.old, move.new))
        for base in () if both else (*_WORK, *_MADE_OF_IT):
            source = course.root / base / move.old / move.assignment
            target = course.root / base / move.new / move.assignment
            if target.is_dir() and all(path.is_dir() for path in target.rglob("*")):
                shutil.rmtree(target)  # nothing but folders
            if source.exists() and not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                source.rename(target)
                if not any(source.parent.iterdir()):
                    source.parent.rmdir()
    _bring_marks(course, [x for x in moves if not _work(course, x.old, x.assignment)])
    said: list[Failure] = []
    for move in moves:
        result = Results(course, move.assignment).path(move.old)
        left = [*_work(course, move.old, move.assignment), *[result] * result.exists()]
        if left:
            names = " and ".join(str(path.relative_to(course.root)) for path in left)
            says = (
                f"{names}: left there, as the same student has work in {move.new} too; to keep "
                "both, collect the same downloads again, which brings each file to its student; "
                f"then give {move.new} again what {move.old} was given by hand in formgrader, and "
                "move what was left away"
            )
            said.append(Failure(move.old, says))
    return said


def _work(course: Course, student: str, assignment: str) -> list[Path]:
    """Folders of what a student handed in, where they hold a file."""
    folders = [course.root / base / student / assignment for base in _WORK]
    return [path for path in folders if any(x.is_file() for x in path.rglob("*"))]


def _bring_marks(course: Course, moves: Sequence[Move]) -> None:
    for move in moves:
        results = Results(course, move.assignment)
        result = results.get(move.old)
        if result is not None and not results.path(move.new).exists():
            results.keep(replace(result, student=move.new))
            results.path(move.old).unlink()
    if not moves or not (course.root / "gradebook.db").exists():
        return
    with open_gradebook(course) as book:
        for assignment, old, new in ((x.assignment, x.old, x.new) for x in moves):
            there = {one.student.id: one for one in book.assignment_submissions(assignment)}
            if old in there and new not in there:
                there[old].student = book.update_or_create_student(new)
                book.db.commit()
        for old, new in {(x.old, x.new) for x in moves}:
            _bring_the_rest(course, book, old, new)


def _bring_the_rest(course: Course, book: Any, old: str, new: str) -> None:
    """What belongs to no file, such as the mark of a defence, and then the empty name."""
    if old not in {one.id for one in book.students} or old in read_roster(course):
        return
    if any((course.root / base / old).exists() for base in _WORK):
        return  # somebody's work is there still
    student = book.update_or_create_student(new)
    there = {one.name for one in student.submissions}
    for one in list(book.find_student(old).submissions):
        if one.name not in there:
            one.student = student
    book.db.commit()
    if not book.find_student(old).submissions:
        book.remove_student(old)
