"""Brings work and marks to the student whose they are, once the roster has come to know it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...course.authoring.layout import Course
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


def settle(course: Course, roster: Roster) -> list[str]:
    """Bring all work to those whom the roster has come to know since it was collected.

    Returns:
        What a person should look at, a sentence each.
    """
    left: list[str] = []
    collected = all_lms_users(course)
    for assignment, people in collected.items():
        found = places(people.values(), assignment, collected, roster)
        moved = {folder: found[one.key].folder for folder, one in people.items()}
        left += bring(course, [Move(assignment, old, new) for old, new in moved.items()])
        remember(course, assignment, {moved[x]: who for x, who in people.items() if moved[x] != x})
    return left


def strangers(course: Course, roster: Roster) -> list[str]:
    """Folders of work that are of nobody in the roster."""
    found = {path.parent.name for base in _WORK for path in (course.root / base).glob("*/*")}
    return sorted(name for name in found if name not in roster)


def bring(course: Course, moves: Iterable[Move]) -> list[str]:
    """Take work from one folder to another, and then its marks, also those by hand.

    Where both folders have work nothing moves: the two may be of two people, as who they are may be
    known by a name alone.

    Returns:
        What stayed where it was, a sentence each.
    """
    moves = [move for move in moves if move.old and move.old != move.new]
    for move in moves:
        both = _work(course, move, move.old) and _work(course, move, move.new)
        for base in () if both else (*_WORK, *_MADE_OF_IT):
            source = course.root / base / move.old / move.assignment
            target = course.root / base / move.new / move.assignment
            if target.is_dir() and not any(target.iterdir()):
                target.rmdir()
            if source.exists() and not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                source.rename(target)
                if not any(source.parent.iterdir()):
                    source.parent.rmdir()
    _bring_marks(course, [move for move in moves if not _work(course, move, move.old)])
    said: list[str] = []
    for move in moves:
        result = Results(course, move.assignment).path(move.old)
        left = [*_work(course, move, move.old), *[result] * result.exists()]
        if left:
            names = " and ".join(str(path.relative_to(course.root)) for path in left)
            said.append(
                f"{names}: left there, as the same student has work in {move.new} too; to keep "
                "both, collect the same downloads again, which brings each file to its student; "
                "then move what was left away"
            )
    return said


def _work(course: Course, move: Move, student: str) -> list[Path]:
    """What was handed in and is in one of the two folders."""
    folders = [course.root / base / student / move.assignment for base in _WORK]
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
