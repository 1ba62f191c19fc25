"""A new term: a seed of one's own, and a record of what was released."""

from __future__ import annotations

import json
import secrets
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any

from ...course.layout import Course
from ...course.own_arm import FILE as ARMS
from ...course.own_arm import HANDLES
from ...course.seed import PUBLIC_SEED
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
"""The files of one term alone, with students' names, what leads to them, and hidden cases.

All of it is ignored by git.
"""


def _private(course: Course) -> Path:
    return course.root / "course_private"


def running(course: Course) -> str:
    """What the term under way has of students, in words; "" if it has nothing of them yet."""
    enrolled = len(roster.read_roster(course).students)
    submitted = len({path.parent for path in course.submitted.glob("*/*/*")})
    graded = len(list(course.results.glob("*/*.json")))
    counts = ((enrolled, "student"), (submitted, "submission"), (graded, "graded mark"))
    return ", ".join(how_many(n, what) for n, what in counts if n)


def refuse_running(course: Course) -> None:
    """Refuse to end a term that has something of students.

    Raises:
        LabkitError: It has.
    """
    if there := running(course):
        raise LabkitError(
            f"the term under way has {there}; to hand out another notebook in it, type: labkit "
            "release NAME; to archive all this and begin the next term, add --yes to labkit "
            "term new"
        )


def new_term(course: Course, seed: int | None, names: tuple[str, ...] = ()) -> dict[str, Any]:
    """Begin a term: archive the last one's, release with a new seed, keep a record.

    Args:
        course: The course.
        seed: Of the hidden cases; None draws one.
        names: What to release; all by default.

    Returns:
        The record: seed, date, the archive of the last term, and the hash of each bundle, which
        every result names.

    Raises:
        LabkitError: The seed is the public one, or the last term's; or a name is unknown.
    """
    names = names or course.names()
    for name in names:
        course.notebook_source(name)
    if seed in (PUBLIC_SEED, seed_of(course)):
        raise LabkitError(f"seed {seed} was used before, so its cases may be known; take another")
    seed = secrets.randbelow(2**31) if seed is None else seed
    old = archive(course)
    record = {"seed": seed, "begun": datetime.now(UTC).date().isoformat(), "bundles": {}}
    record["archived"] = old.name if old else ""
    _keep(course, record)  # first, so that a release that fails is made again with this seed
    for name in names:
        release(course, name, seed)
    record["bundles"] = {
        path.stem: json.loads(path.read_text(encoding="utf-8"))["hash"]
        for path in sorted(course.bundle.glob("*.json"))
    }
    _keep(course, record)
    return record


def _keep(course: Course, record: dict[str, Any]) -> None:
    write(course.term, json.dumps(record, indent=1) + "\n")


def archive(course: Course) -> Path | None:
    """Move what holds the last term's names into one folder; None if there is nothing.

    The rules are copied, as most of them serve again; arms are deleted where students get them.
    """
    for path in course.release.glob(f"*/{ARMS}"):
        path.unlink()
    there = [course.root / name for name in PERSONAL_FILES if (course.root / name).exists()]
    if not there:
        return None
    folder = _private(course) / datetime.now(UTC).strftime("archive-%Y-%m-%d-%H%M%S")
    folder.mkdir(parents=True)
    for path in there:
        shutil.move(path, folder / path.name)
    if course.term.exists():
        shutil.move(course.term, folder / course.term.name)
    if (course.root / RULES).exists():
        shutil.copy(course.root / RULES, folder)
    return folder


def way_back(course: Course, folder: str) -> Iterator[str]:
    """Where the last term is now, and the commands that return to it, a line each."""
    old = (_private(course) / folder).relative_to(course.root)
    mine = (*PERSONAL_FILES, course.term.relative_to(course.root).as_posix(), RULES)
    new = [name for name in mine if (course.root / name).exists()]
    by_place: dict[Path, list[str]] = {}
    for name in (Path(name) for name in mine):
        if (course.root / old / name.name).exists():
            by_place.setdefault(name.parent, []).append(f"{old / name.name}")
    names = sorted(x.stem for x in (course.root / old / "bundle").glob("*.json"))
    yield f"the last term is in {old}; to return to it, type in the course's folder:"
    yield "    mkdir course_private/undone"
    yield f"    mv {' '.join(new)} course_private/undone"
    yield from (f"    mv {' '.join(files)} {place}" for place, files in by_place.items())
    yield f"    labkit release {' '.join(names)}".rstrip()


def old_rules(course: Course) -> str:
    """What of the last term's rules is still in force, in a sentence; "" if nothing is."""
    rules = read_rules(course)
    over = [x for x in rules.assignments if (due := rules.due(x)) and due < datetime.now(UTC)]
    said = [f"due dates that are over: {', '.join(over)}"] * bool(over)
    said += [f"extensions: {len(rules.extensions)}"] * bool(rules.extensions)
    return f"{RULES} still has {'; '.join(said)}. Edit it before students hand in" if said else ""


@dataclass(frozen=True)
class Archive:
    """A term that is over.

    Attributes:
        folder: Where it lies.
        ended: The day on which the next one began.
        people: How many handed in, also such as are not in the roster.
    """

    folder: Path
    ended: date
    people: int

    def __str__(self) -> str:
        return f"{self.folder.name}: ended {self.ended}, {self.people} handed in"


def archives(course: Course, older: float = 0.0) -> list[Archive]:
    """The terms that ended at least ``older`` years ago; all of them by default."""
    found = []
    for folder in sorted(_private(course).glob("archive-*")):
        ended = date.fromisoformat(folder.name.removeprefix("archive-")[:10])
        people = len({path.parts[-3] for path in (folder / "submitted").glob("*/*/*")})
        if (datetime.now(UTC).date() - ended).days >= 365.25 * older:
            found.append(Archive(folder, ended, people))
    return found


def about(course: Course) -> Iterator[str]:
    """The term that is under way, and those that are over, a line each."""
    file = course.term
    if file.exists():
        record = json.loads(file.read_text(encoding="utf-8"))
        released = ", ".join(sorted(record.get("bundles", ()))) or "nothing"
        yield f"now: begun {record.get('begun', 'some day')}, released: {released}"
    else:
        yield "now: no term was begun; hidden cases have the public seed"
    yield from map(str, archives(course))
