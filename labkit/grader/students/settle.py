"""Brings work and marks to the student whose they are, once the roster has come to know it."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..each import Failure, for_student
from ..grading.results import Results
from ..nbgrader.gradebook import open_gradebook
from ..sandbox.limits import Limits
from ..submission import Submission, digest
from ..timestamp import TIMESTAMP
from .attempts import FOLDER, adopt, install, keep
from .exchange import SECRET, read_secret
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

    If there is work in both, all attempts are kept in the new folder, and one of them counts by the
    rules of the course.  Work in the folder of another student of the roster stays there.

    Returns:
        What wants a look: what was joined, and what stayed where it was; a sentence each.
    """
    moves = [move for move in moves if move.old and move.old != move.new]
    roster, said = read_roster(course), list[str]()
    for move in moves:
        both = [_work(course, move.assignment, name) for name in (move.old, move.new)]
        if all(both) and move.old not in roster:
            joined = for_student(move.old, partial(_join, course, move))
            said.append(joined.why if isinstance(joined, Failure) else joined)
        for base in () if all(both) else (*_WORK, *_MADE_OF_IT):
            source, target = _folders(course, base, move)
            if source.exists() and not target.exists():
                _take(source, target)
    done = [move for move in moves if not _work(course, move.assignment, move.old)]
    said += _bring_marks(course, done)
    for move in moves:
        result = Results(course, move.assignment).path(move.old)
        left = [*_work(course, move.assignment, move.old), *[result] * result.exists()]
        if left:
            names = " and ".join(str(path.relative_to(course.root)) for path in left)
            said.append(f"{names} of the same student stays; look what it is, and move it away")
    return said


def _join(course: Course, move: Move) -> str:
    """Keep all attempts of both folders in the new one, and let the right one count."""
    name, now = move.assignment, str(datetime.now(UTC))
    theirs, there = (adopt(course, x, name, now) for x in (move.old, move.new))
    for sha256, one in theirs.items():
        folder = one.file.parent
        if sha256 not in there:
            _take(folder, course.root / FOLDER / move.new / name / folder.name)
            continue
        data, secret = one.file.read_bytes(), read_secret(folder)
        for hand_in in one.hand_ins:
            keep(course, move.new, name, data, hand_in, secret, there)
        shutil.rmtree(folder)
    chosen = install(course, move.new, name)
    submitted = course.submitted / move.old / name
    for path in (*submitted.glob("*.ipynb"), submitted / TIMESTAMP, submitted / SECRET):
        path.unlink(missing_ok=True)  # the attempts have it
    for base in _WORK:
        _remove_empty(_folders(course, base, move)[0])
    if chosen is None:
        raise LabkitError(f"neither {move.old} nor {move.new} has an attempt at {name}")
    from_old = chosen.attempt.sha256 in theirs
    for base in _MADE_OF_IT:  # what was made of the work that counts
        source, target = _folders(course, base, move)
        shutil.rmtree(target if from_old else source, ignore_errors=True)
        if source.exists():
            _take(source, target)
        _remove_empty(source)
    return (
        f"{move.old} and {move.new} are one student; {name}: of {len(theirs | there)} attempts, "
        f"the one of {chosen.first.when:%Y-%m-%d %H:%M %Z} counts; type: labkit grade {name}"
    )


def _folders(course: Course, base: str, move: Move) -> tuple[Path, Path]:
    """Where something of an assignment is, and where it goes."""
    return (
        course.root / base / move.old / move.assignment,
        course.root / base / move.new / move.assignment,
    )


def _take(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    source.rename(target)
    _remove_empty(source.parent)


def _remove_empty(folder: Path) -> None:
    """Remove a folder, and the one around it, if there is nothing in them."""
    for path in (folder, folder.parent):
        if path.is_dir() and not any(path.iterdir()):
            path.rmdir()


def _work(course: Course, assignment: str, student: str) -> list[Path]:
    """What was handed in and is in the folder of a student."""
    folders = [course.root / base / student / assignment for base in _WORK]
    return [path for path in folders if path.exists()]


def _bring_marks(course: Course, moves: Sequence[Move]) -> list[str]:
    """Bring results and marks; of two for one assignment, those of the work that counts stay.

    Returns:
        Which marks given by hand were of the other work, a sentence each.
    """
    kept: dict[Move, str] = {}
    for move in moves:
        results = Results(course, move.assignment)
        mine, other = results.get(move.old), results.get(move.new)
        now = Submission.of(course, move.assignment, move.new).read(Limits().notebook)[0]
        alone = not results.path(move.new).exists()
        counts = mine is not None and mine.hashes["submission"] == digest(now)
        kept[move] = move.old if counts or alone else move.new
        if mine is not None and kept[move] == move.old:
            results.keep(replace(mine, student=move.new))
        if mine is not None and (other is not None or alone):
            results.path(move.old).unlink()
    if not moves or not (course.root / "gradebook.db").exists():
        return []
    said: list[str] = []
    with open_gradebook(course) as book:
        for move in moves:
            there = {x.student.id: x for x in book.assignment_submissions(move.assignment)}
            if move.old in there and move.new in there:
                gone = move.new if kept[move] == move.old else move.old
                said += _by_hand(there.pop(gone), move.assignment)
                book.remove_submission(move.assignment, gone)
            if move.old in there:
                there[move.old].student = book.update_or_create_student(move.new)
                book.db.commit()
        for old, new in {(x.old, x.new) for x in moves}:
            _bring_the_rest(course, book, old, new)
    return said


def _by_hand(submission: Any, assignment: str) -> Iterator[str]:
    """The marks that a person gave to work that does not count any more."""
    for grade in (x for notebook in submission.notebooks for x in notebook.grades):
        if grade.manual_score is not None:
            yield (
                f"{submission.student.id}: {assignment}: {grade.name} had {grade.manual_score:g} "
                "by hand, for an attempt that does not count any more"
            )


def _bring_the_rest(course: Course, book: Any, old: str, new: str) -> None:
    """What belongs to no file, such as the mark of a defence, and then the empty name."""
    if old not in {one.id for one in book.students}:
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
