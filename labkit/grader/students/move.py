"""Move work and marks to their owner, once the roster identifies the owner."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ...course.authoring.layout import Course
from ..each import Failure
from ..grading.results import Results
from ..nbgrader.gradebook import open_gradebook
from .attempts import FOLDER
from .identity import all_lms_users, assign_folders, record_users
from .roster import Roster, read_roster

_WORK = (FOLDER, "submitted")
_MADE = ("autograded", "feedback")


def move_to_owners(course: Course, roster: Roster) -> list[Failure]:
    """Move all work whose owner the roster has identified since it was collected.

    Returns:
        The folders that stayed, and why.
    """
    left: list[Failure] = []
    collected = all_lms_users(course)
    for assignment, people in collected.items():
        found = assign_folders(people.values(), assignment, collected, roster)
        moves = {old: found[one.key].folder for old, one in people.items()}
        left += move_work(course, assignment, moves)
        gone = [x for x in moves.items() if x[0] != x[1] and not _work(course, x[0], assignment)]
        record_users(course, assignment, {new: people[old] for old, new in gone})
    return left


def unlisted(course: Course, roster: Roster) -> list[str]:
    """Folders with work that belong to nobody in the roster."""
    found = {path.parent.name for base in _WORK for path in (course.root / base).glob("*/*")}
    return sorted(name for name in found if name not in roster)


def move_work(course: Course, assignment: str, moves: Mapping[str, str]) -> list[Failure]:
    """Move work from one folder to another, and then its marks, including those given by hand.

    If both folders have work, nothing moves: they may belong to two people, as an owner may be
    identified by name alone.

    Args:
        course: The course.
        assignment: The assignment whose work moves.
        moves: By the present folder, the folder where the work belongs.

    Returns:
        The folders that stayed, and why.
    """
    moves = {old: new for old, new in moves.items() if old != new}
    moved: dict[str, str] = {}
    for pair in _in_order(moves):
        both = all(_work(course, who, assignment) for who in pair)
        for base in () if both else (*_WORK, *_MADE):
            source, target = (course.root / base / who / assignment for who in pair)
            if target.is_dir() and all(path.is_dir() for path in target.rglob("*")):
                shutil.rmtree(target)  # it holds no files
            if source.exists() and not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                source.rename(target)
                if not any(source.parent.iterdir()):
                    source.parent.rmdir()
        if not _work(course, pair[0], assignment):
            moved |= [pair]
    _move_marks(course, assignment, moved)
    said, roster = list[Failure](), read_roster(course)
    for old, new in moves.items():
        result = Results(course, assignment).path(old)
        left = [] if old in moved else _work(course, old, assignment)
        if result.exists() and old not in moved.values():
            left.append(result)
        if left:
            names = " and ".join(str(path.relative_to(course.root)) for path in left)
            says = (
                f"{names}: left there, because it belongs in {new}, which has work too; collect "
                "the same downloads again, which brings each file to its student, and grade; then "
                f"give {new} again what {old} was given by hand in formgrader"
            )
            rest = "" if old in roster else f", and delete {names}"
            said.append(Failure(old, says + rest))
    return said


def _in_order(moves: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """The moves, each after the one that empties its target; moves in a circle are left out."""
    waiting = dict(moves)
    while free := [old for old, new in waiting.items() if new not in waiting]:
        yield from [(old, waiting.pop(old)) for old in free]


def _work(course: Course, student: str, assignment: str) -> list[Path]:
    """The folders of a student's hand-ins that hold a file."""
    folders = [course.root / base / student / assignment for base in _WORK]
    return [path for path in folders if any(x.is_file() for x in path.rglob("*"))]


def _move_marks(course: Course, assignment: str, moves: Mapping[str, str]) -> None:
    results = Results(course, assignment)
    for old, new in moves.items():
        results.rename(old, new)
        _move_pages(course, assignment, old, new)
    if not moves or not (course.root / "gradebook.db").exists():
        return
    with open_gradebook(course) as book:
        there = {one.student.id: one for one in book.assignment_submissions(assignment)}
        for old, new in moves.items():
            if old in there and new not in there:
                there[new] = there.pop(old)
                there[new].student = book.update_or_create_student(new)
                book.db.commit()
        for old, new in moves.items():
            _move_the_rest(course, book, old, new)


def _move_pages(course: Course, assignment: str, old: str, new: str) -> None:
    """Move pages about a student whose folder has no work left."""
    left = any((course.root / base / old).exists() for base in _WORK)
    stays = left or old in read_roster(course)
    if stays:
        return
    made = (course.build / "explain", course.build / "defence", *map(course.root.joinpath, _MADE))
    for folder in made:
        if (folder / old).is_dir():
            shutil.copytree(folder / old, folder / new, dirs_exist_ok=True)
            shutil.rmtree(folder / old)
        if (page := folder / f"{old}.html").exists():
            page.replace(folder / f"{new}.html")


def _move_the_rest(course: Course, book: Any, old: str, new: str) -> None:
    """Move marks without a file, such as that of a defence, and then delete the old name."""
    if old not in {one.id for one in book.students} or old in read_roster(course):
        return
    if any((course.root / base / old).exists() for base in _WORK):
        return  # somebody's work is still there
    student = book.update_or_create_student(new)
    there = {one.name for one in student.submissions}
    for one in list(book.find_student(old).submissions):
        if one.name not in there:
            one.student = student
    book.db.commit()
    if not book.find_student(old).submissions:
        book.remove_student(old)
