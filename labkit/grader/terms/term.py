"""A term: its secret, the record of what was released, and its archive."""

from __future__ import annotations

import json
import secrets
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

from ...course.authoring.layout import Course
from ...course.own_arm import FILE as ARMS
from ...course.own_arm import HANDLES
from ...errors import LabkitError
from .. import pseudonyms
from ..atomic import write
from ..clean import how_many
from ..rules import FILE as RULES
from ..rules import read_rules
from ..seeds import seed_of
from ..students import attempts, identity, roster
from .release import release

PERSONAL_FILES = (
    *("submitted", "autograded", "feedback", "results", "gradebook.db", "build/course/bundle"),
    *("build/course/defence", "build/course/explain"),
    *(attempts.FOLDER, roster.FILE, HANDLES, identity.FILE, pseudonyms.FILE),
)
"""The files that belong to one term, with students' names or keys to them, and hidden cases.

Git ignores all of them.
"""
_TERM = "course_private/term.json"


def _private(course: Course) -> Path:
    return course.root / "course_private"


def running(course: Course) -> str:
    """The students, submissions and marks of the current term, in words; "" if none."""
    enrolled = len(roster.read_roster(course).students)
    submitted = len({path.parent for path in course.submitted.glob("*/*/*")})
    graded = len(list(course.results.glob("*/*.json")))
    counts = ((enrolled, "student"), (submitted, "submission"), (graded, "graded mark"))
    return ", ".join(how_many(n, what) for n, what in counts if n)


def refuse_running(course: Course) -> None:
    """Refuse to end a term that has students or their work.

    Raises:
        LabkitError: The term has students, submissions or marks.
    """
    if there := running(course):
        raise LabkitError(
            f"the term under way has {there}; to hand out another notebook in it, type: labkit "
            "release NAME; to archive all this and begin the next term, add --yes to labkit "
            "term new"
        )


def new_term(course: Course, names: tuple[str, ...] = ()) -> dict[str, Any]:
    """Begin a term: archive the last one, release with a new secret, keep a record.

    Args:
        course: The course.
        names: The assignments to release; all by default.

    Returns:
        The record: the secret of 128 random bits, the date, the archive of the last term, and each
        bundle's hash, by which every result identifies its release.

    Raises:
        UnknownName: There is no such assignment.
    """
    names = names or course.names()
    for name in names:
        course.notebook_source(name)
    old = archive(course)
    record = {
        "secret": secrets.token_hex(16),
        "begun": datetime.now(UTC).date().isoformat(),
        "bundles": {},
    }
    record["archived"] = old.name if old else ""
    _keep(course, record)  # first, so that a failed release is repeated with this secret
    for name in names:
        release(course, name, seed_of(course))
    record["bundles"] = {
        path.stem: json.loads(path.read_text(encoding="utf-8"))["hash"]
        for path in sorted(course.bundle.glob("*.json"))
    }
    _keep(course, record)
    return record


def _keep(course: Course, record: dict[str, Any]) -> None:
    write(course.term, json.dumps(record, indent=1) + "\n")


def archive(course: Course) -> Path | None:
    """Move the personal files of the last term to an archive; None if there are none.

    The archive has the layout of the course.  The rules are copied, as most of them are used again;
    the students' arms are deleted from the students' notebooks.
    """
    for path in course.release.glob(f"*/{ARMS}"):
        path.unlink()
    there = [name for name in PERSONAL_FILES if (course.root / name).exists()]
    if not there:
        return None
    folder = _private(course) / datetime.now(UTC).strftime("archive-%Y-%m-%d-%H%M%S")
    while folder.exists():  # two in one second
        folder = folder.with_name(f"{folder.name}-2")
    folder.mkdir(parents=True)
    for name in (*there, *[_TERM] * course.term.exists()):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.move(course.root / name, folder / name)
    if (course.root / RULES).exists():
        shutil.copy(course.root / RULES, folder)
    return folder


def restore(course: Course, old: Path) -> tuple[Path | None, list[str]]:
    """Return to an archived term, and archive the current one.

    Args:
        course: The course.
        old: The folder of the archive.

    Returns:
        The new archive, or None if there was nothing to archive; and the released assignments.
    """
    undone = archive(course)
    for name in (*PERSONAL_FILES, _TERM, RULES):
        if (old / name).exists():
            (course.root / name).unlink(missing_ok=True)  # the rules, which `archive` copied
            (course.root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.move(old / name, course.root / name)
    (Course(old).build / ".gradebook").unlink(missing_ok=True)  # a lock of `open_gradebook`
    if not any(path.is_file() for path in old.rglob("*")):
        shutil.rmtree(old)
    released = sorted(path.stem for path in course.bundle.glob("*.json"))
    for name in released:
        release(course, name, seed_of(course))
    return undone, released


def old_rules(course: Course) -> str:
    """A sentence on rules of the last term that still apply; "" if there are none."""
    rules = read_rules(course)
    over = [x for x in rules.assignments if (due := rules.due(x)) and due < datetime.now(UTC)]
    said = [f"due dates that are over: {', '.join(over)}"] * bool(over)
    said += [f"extensions: {len(rules.extensions)}"] * bool(rules.extensions)
    return f"{RULES} still has {'; '.join(said)}. Edit it before students hand in" if said else ""


@dataclass(frozen=True)
class Archive:
    """A term that is over.

    Attributes:
        folder: The folder of the archive.
        ended: The day on which the next term began; None if the folder's name has no date.
        people: How many students handed in, including any who are not in the roster.
    """

    folder: Path
    ended: date | None
    people: int

    def __str__(self) -> str:
        if self.ended is None:
            when = "its name has no date, so --older leaves it; rename it archive-YYYY-MM-DD"
        else:
            when = f"ended {self.ended}"
        return f"{self.folder.name}: {when}, {self.people} handed in"


def archives(course: Course, older: float | None = None) -> list[Archive]:
    """The terms that ended at least ``older`` years ago; by default all, even without a date."""
    found = []
    for folder in sorted(_private(course).glob("archive-*")):
        people = len({path.parts[-3] for path in (folder / "submitted").glob("*/*/*")})
        one = Archive(folder, _date(folder.name), people)
        days = (datetime.now(UTC).date() - one.ended).days if one.ended else -1
        if older is None or days >= 365.25 * older:
            found.append(one)
    return found


def _date(name: str) -> date | None:
    try:
        return date.fromisoformat(name.removeprefix("archive-")[:10])
    except ValueError:
        return None


def about(course: Course) -> Iterator[str]:
    """A line for the current term and for each archived one."""
    file = course.term
    if file.exists():
        record = json.loads(file.read_text(encoding="utf-8"))
        released = ", ".join(sorted(record.get("bundles", ()))) or "nothing"
        yield f"now: begun {record.get('begun', 'some day')}, released: {released}"
    else:
        yield "now: no term was begun; hidden cases have the public seed"
    yield from map(str, archives(course))
