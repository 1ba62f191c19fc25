"""Forget: delete earlier terms, or all that is there of one student, wherever it lies."""

from __future__ import annotations

import csv
import glob
import io
import json
import re
import shutil
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from nbgrader.api import Gradebook, MissingEntry

from ...course.layout import Course
from ...course.own_arm import HANDLES
from ...errors import LabkitError
from ..atomic import write
from ..nbgrader.gradebook import quiet_database
from ..pseudonyms import FILE as KEY
from ..pseudonyms import pseudonym
from ..rules import FILE as RULES
from ..students.identity import FILE as LMS
from ..students.identity import alone
from ..students.owner import letters
from ..students.platforms import File, LmsUser, in_zip, open_zip
from ..students.roster import FILE as ROSTER
from ..students.roster import read_roster
from ..submission import is_name, meant

_OLD = r"-(([0-9a-f]{8}-){2}[0-9a-f]{8}|--)\.json"
"""How an earlier result of somebody ends, see `Results.keep`."""
_FOLDERS = ("submitted", "attempts", "autograded", "feedback")
_KEPT_BY_HAND = ("downloads", "dist")
"""Folders in which a person lays what comes from a platform and goes there."""
_TEXTS = (".csv", ".tsv", ".txt", ".md", ".html")


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


def entries_of(course: Course, student: str) -> list[Path]:
    """Files that are of the whole class, with an entry of one student, in every term."""
    books = [root / "gradebook.db" for root in _terms(course)]
    found = [book for book in books if book.exists() and _in_gradebook(book, student)]
    return [*found, *_records_without(course, student)]


def forget(
    course: Course, found: Sequence[Path], entries: Sequence[Path] = (), student: str = ""
) -> None:
    """Delete what `places_of` found, or archived terms, and what `entries_of` found."""
    for path in found:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
    for path in entries:
        if path.suffix == ".db":
            with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
                book.remove_student(student)
    if entries:
        with alone(course):
            for path, text in _records_without(course, student).items():
                write(path, text)


def left_by_hand(course: Course, student: str) -> Iterator[str]:
    """What else names a student, which only a person can delete, a sentence each."""
    for file in filter(Path.exists, (root / RULES for root in _terms(course))):
        granted = tomllib.loads(file.read_text(encoding="utf-8")).get("extensions", ())
        if any(one.get("student") == student for one in granted):
            yield f"{file.relative_to(course.root)} names an extension of theirs; delete it there"
    sheets = [str(path.relative_to(course.root)) for path in _read_by_others(course, student)]
    if sheets:
        yield f"the sheets of their readers still hold their report: {', '.join(sheets)}"
    if naming := [str(path.relative_to(course.root)) for path in _naming(course, student)]:
        yield f"files in the course folder that name them, for you to delete: {', '.join(naming)}"
    yield (
        "copies elsewhere are yours to delete: downloads, exported tables and reports, backups, "
        "the exchange, the platform itself"
    )


def unknown(course: Course, student: str) -> LabkitError:
    """The error where nothing is known of a student, with those who are meant perhaps."""
    folders = (path.name for root in _terms(course) for path in root.glob("submitted/*"))
    known = {name: name for name in folders if is_name(name)}
    known |= {one.id: str(one) for one in read_roster(course).students}
    near = meant(student, known.values())
    return LabkitError(f"no student {student!r} in this term or an earlier one{near}")


@dataclass(frozen=True)
class _Known:
    """What a student is called: in texts, in Canvas's entries, and by platforms' numbers."""

    said: re.Pattern[str]
    called: frozenset[str]
    keys: frozenset[tuple[str, str]]

    def named(self, text: str, people: Iterable[LmsUser]) -> bool:
        """Whether a file with this text, or with work of these people, names the student."""
        return bool(self.said.search(text)) or any(
            one.key in self.keys or (one.system == "canvas" and letters(one.name) in self.called)
            for one in people
        )


def _known(course: Course, student: str) -> _Known:
    """What a student is called in the records of each term."""
    names, called, keys = {re.escape(student)}, set[str](), set[tuple[str, str]]()
    for root in _terms(course):
        private = root / "course_private" if root == course.root else root
        roster, users = (private / Path(name).name for name in (ROSTER, LMS))
        if roster.exists():
            for row in csv.DictReader(io.StringIO(roster.read_text("utf-8"))):
                if row.get("id") == student:
                    columns = ("first_name", "last_name", "login", "email")
                    first, last, *others = (re.escape(row.get(key) or "") for key in columns)
                    names |= {*others}
                    keys.add(("canvas", row.get("lms_user_id") or ""))
                    if first and last:
                        names |= {rf"{first}[\W_]*{last}", rf"{last}[\W_]*{first}"}
                        called.add(letters(f"{row['last_name']}{row['first_name']}"))
        if users.exists():
            of_each = json.loads(users.read_text("utf-8")).values()
            mine = [people[student] for people in of_each if student in people]
            keys |= {(one["system"], one["number"]) for one in mine}
    words = "|".join(sorted(filter(None, names)))
    said = re.compile(rf"(?<![^\W_])(?<!-)({words})(?![^\W_]|-)")
    return _Known(said, frozenset(called), frozenset(keys))


def _naming(course: Course, student: str) -> Iterator[Path]:
    """Downloads and tables in the course folder with a student's name, login, address or number."""
    known = _known(course, student)
    for path in sorted(course.root.glob("*")):
        inside = path.rglob("*") if path.is_dir() and path.name in _KEPT_BY_HAND else [path]
        yield from (x for x in sorted(inside) if x.is_file() and known.named(*_words(x)))


def _words(path: Path) -> tuple[str, list[LmsUser]]:
    """The text of a table or page; of a zip the names in it, and whom a platform means by them."""
    if path.suffix != ".zip":
        return path.read_text("utf-8", "replace") if path.suffix in _TEXTS else "", []
    files: list[File] = []
    with suppress(LabkitError), open_zip(path) as archive:
        files = list(in_zip(archive, datetime.now(UTC)))
    people = [named.who for file in files for named in file.readings]
    return "\n".join([*(file.label for file in files), *(who.name for who in people)]), people


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


def _records_without(course: Course, student: str) -> dict[Path, str]:
    """Each term's roster, record of platforms' numbers and arms that has a student, without them.

    Returns:
        The new text of each file.
    """
    found: dict[Path, str] = {}
    for root in _terms(course):
        private = root / "course_private" if root == course.root else root
        roster, users, arms = (private / Path(name).name for name in (ROSTER, LMS, HANDLES))
        if roster.exists():
            rows = list(csv.reader(io.StringIO(roster.read_text(encoding="utf-8"))))
            kept = [row for row in rows if row[:1] != [student]]
            if kept != rows:
                out = io.StringIO()
                csv.writer(out, lineterminator="\n").writerows(kept)
                found[roster] = out.getvalue()
        if users.exists():
            known = json.loads(users.read_text(encoding="utf-8"))
            left = {x: {k: v for k, v in y.items() if k != student} for x, y in known.items()}
            if left != known:
                found[users] = json.dumps(left, indent=1, sort_keys=True) + "\n"
        if arms.exists():
            given = json.loads(arms.read_text(encoding="utf-8"))
            if given["handles"].pop(student, None) is not None:
                found[arms] = json.dumps(given, indent=1, sort_keys=True) + "\n"
    return found


def _in_gradebook(path: Path, student: str) -> bool:
    with quiet_database(), Gradebook(f"sqlite:///{path}") as book:
        try:
            book.find_student(student)
        except MissingEntry:
            return False
    return True
