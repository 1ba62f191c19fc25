"""Forget: delete earlier terms, or all that is there of one student, wherever it lies."""

from __future__ import annotations

import csv
import glob
import io
import json
import re
import shutil
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

from nbgrader.api import Gradebook, MissingEntry

from ..course.layout import Course
from ..course.own_arm import HANDLES
from ..errors import LabkitError
from .atomic import write
from .gradebook import quiet_database
from .identity import FILE as LMS
from .identity import alone
from .pseudonyms import FILE as KEY
from .pseudonyms import pseudonym
from .roster import FILE as ROSTER
from .rules import FILE as RULES
from .submission import is_name

_OLD = r"-(([0-9a-f]{8}-){2}[0-9a-f]{8}|--)\.json"
"""How an earlier result of somebody ends, see `Results.keep`."""
_FOLDERS = ("submitted", "attempts", "autograded", "feedback")


def places_of(course: Course, student: str) -> list[Path]:
    """Files and folders that are one student's, in this term and in earlier ones.

    Raises:
        LabkitError: Nobody can have this name.
    """
    if not is_name(student) or student in {"", ".", ".."} or "/" in student:
        raise LabkitError(f"{student!a} is not the name of a student's folder")
    plain = glob.escape(student)
    found = [root / name / student for root in _terms(course) for name in _FOLDERS]
    for root in _terms(course):
        found += sorted(root.glob(f"results/*/{plain}.json"))
        found += [x / f"{student}.html" for x in (root / "build/course/defence", root / "defence")]
        explained = re.compile(re.escape(student) + r"-\w+\.html")
        pages = [*root.glob("build/course/explain/*.html"), *root.glob("explain/*.html")]
        found += [x for x in sorted(pages) if explained.fullmatch(x.name)]
        found += sorted(root.glob(f"results/*/aside/{plain}.json"))
        old = re.compile(re.escape(student) + _OLD)
        found += [x for x in sorted(root.glob("results/*/old/*.json")) if old.fullmatch(x.name)]
    return [path for path in found if path.exists() or path.is_symlink()]


def forget(course: Course, found: Sequence[Path], student: str | None = None) -> Iterator[str]:
    """Delete what `places_of` found, or archived terms, and what is written of a student.

    Yields:
        What else was done, and what is left to do by hand, a sentence each.
    """
    for path in found:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
    if student is None:
        return
    for root in _terms(course):
        if (root / "gradebook.db").exists() and _leave_gradebook(root / "gradebook.db", student):
            yield f"no more in {(root / 'gradebook.db').relative_to(course.root)}"
    with alone(course):
        for root in _terms(course):
            private = root / "course_private" if root == course.root else root
            for path in _leave_records(private, student):
                yield f"no more in {path.relative_to(course.root)}"
    for file in filter(Path.exists, (root / RULES for root in _terms(course))):
        granted = tomllib.loads(file.read_text(encoding="utf-8")).get("extensions", ())
        if any(one.get("student") == student for one in granted):
            yield f"{file.relative_to(course.root)} names an extension of theirs; delete it there"
    sheets = [str(path.relative_to(course.root)) for path in _read_by_others(course, student)]
    if sheets:
        yield f"the sheets of their readers still hold their report: {', '.join(sheets)}"
    yield (
        "copies elsewhere are yours to delete: downloads, exported tables and reports, backups, "
        "the exchange, the platform itself"
    )


def _read_by_others(course: Course, student: str) -> Iterator[Path]:
    """Sheets of peer review, given out or handed in, that hold a student's report."""
    for root in _terms(course):
        key = root / (KEY if root == course.root else Path(KEY).name)
        if key.exists():
            name = pseudonym(key.read_bytes(), student)
            for folder in _FOLDERS:
                sheets = sorted(root.glob(f"{folder}/*/*_review/**/*.ipynb"))
                yield from (x for x in sheets if f"{name}_" in x.read_text(errors="replace"))


def _terms(course: Course) -> list[Path]:
    return [course.root, *sorted((course.root / "course_private").glob("archive-*"))]


def _leave_records(private: Path, student: str) -> Iterator[Path]:
    """Take a student out of a term's roster, its arms and its record of platforms' numbers."""
    roster, users, arms = (private / Path(name).name for name in (ROSTER, LMS, HANDLES))
    if roster.exists():
        rows = list(csv.reader(io.StringIO(roster.read_text(encoding="utf-8"))))
        kept = [row for row in rows if row[:1] != [student]]
        if kept != rows:
            out = io.StringIO()
            csv.writer(out, lineterminator="\n").writerows(kept)
            write(roster, out.getvalue())
            yield roster
    if users.exists():
        known = json.loads(users.read_text(encoding="utf-8"))
        left = {name: {k: v for k, v in x.items() if k != student} for name, x in known.items()}
        if left != known:
            write(users, json.dumps(left, indent=1, sort_keys=True) + "\n")
            yield users
    if arms.exists():
        given = json.loads(arms.read_text(encoding="utf-8"))
        if given["handles"].pop(student, None) is not None:
            write(arms, json.dumps(given, indent=1, sort_keys=True) + "\n")
            yield arms


def _leave_gradebook(path: Path, student: str) -> bool:
    """Take a student out of a gradebook; whether they were in it."""
    with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
        try:
            book.remove_student(student)
        except MissingEntry:
            return False
    return True
