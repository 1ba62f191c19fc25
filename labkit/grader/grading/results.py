"""Results: one file for each submission, known by the contents that it came from."""

from __future__ import annotations

import copy
import hashlib
import json
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TypedDict

import labkit

from ...course.authoring.layout import Course
from ...course.serialize import read_record, record_data
from ...course.verdict import Points, Verdict
from ...errors import LabkitError
from ...formats import check_stamp, stamp
from ..atomic import write
from ..clean import clean_data, clean_line

_LABKIT = Path(labkit.__file__).parent
OTHER_NOTEBOOK = "this looks like the notebook of another assignment"
_NOTHING = hashlib.sha256(b"").hexdigest()
_OF_A_WORKER = ("grading", "sandbox", "atomic.py", "clean.py", "each.py", "submission.py")
"""Parts of the grader that a worker loads."""


class Run(TypedDict):
    """A run of the arm on a public case; see `public_evidence.runs`."""

    test: str
    says: str
    complete: bool
    since: float
    measures: dict[str, float | None]
    limits: dict[str, float | None]
    words: str
    motion: str


class Numbers(TypedDict):
    """The numbers of an answer beside those expected; see `public_evidence.numbers`."""

    call: str
    expected: list[float]
    given: list[float]
    of: int


class FailedCell(TypedDict):
    """A cell that failed or was stopped; `cell` counts from 0."""

    cell: int
    kind: str
    error: str
    output: str
    seconds: float


class OwnCell(TypedDict):
    """A cell of the student's own, and the cell of the release that it follows."""

    type: str
    source: str
    after: str


class Hashes(TypedDict):
    """What a result is known by; ``engine`` stands for the code that grades."""

    submission: str
    bundle: str
    engine: str


@dataclass(frozen=True)
class Answer:
    """What came of one question.

    Attributes:
        verdict: As `mark` reached it.
        notes: What was unusual, sentences.
        source: The text of the cell that answers.
        runs: The public runs of the arm.
        numbers: The answer's numbers beside those expected, where they differ.
    """

    verdict: Verdict
    notes: tuple[str, ...] = ()
    source: str = ""
    runs: tuple[Run, ...] = ()
    numbers: Numbers | None = None


@dataclass(frozen=True)
class Result:
    """What came of one submission.

    Attributes:
        assignment: Which.
        student: Whose.
        score: Points; 0 where it was rejected.
        points: What full marks would be.
        seed: Of the hidden cases.
        hashes: Of the submission, the release and the engine.
        rejected: Why it could not be graded, in a sentence; empty where it was.
        questions: One for each question.
        notes: What was unusual about the whole.
        cells: Cells that failed or were stopped, with their sentence.
        own: The student's own cells, where they stood.
        written: The text of each cell that a person marks, by its name.
        tricks: What may be a way around a withheld tool, for the instructor, sentences.
        isolation: What kept it apart while it ran.
        seconds: How long it took: in all, and in the student's own code.
        receipt: What `lk.hand_in` printed for this file; empty where it was rejected.
    """

    assignment: str
    student: str
    score: Points
    points: Points
    seed: int
    hashes: Hashes
    rejected: str = ""
    questions: tuple[Answer, ...] = ()
    notes: tuple[str, ...] = ()
    cells: tuple[FailedCell, ...] = ()
    own: tuple[OwnCell, ...] = ()
    written: Mapping[str, str] = field(default_factory=dict)
    tricks: tuple[str, ...] = ()
    isolation: str = ""
    seconds: Mapping[str, float] = field(default_factory=dict)
    receipt: str = ""

    def text(self) -> str:
        """As JSON."""
        data = stamp() | record_data(self)
        return json.dumps(data, ensure_ascii=True, indent=1, allow_nan=False) + "\n"

    @classmethod
    def read(cls, text: str, name: str = "the result") -> Result:
        """What `text` wrote, with every text in it made safe to store and to show.

        Args:
            text: JSON.
            name: What to call it where it is refused.

        Raises:
            LabkitError: It is not a whole result, or one of another version; the sentence says so.
        """
        try:
            data = clean_data(json.loads(text, parse_constant=_refuse))
        except (ValueError, RecursionError) as error:
            raise _damaged(name, str(error)) from None
        if not isinstance(data, dict):
            raise _damaged(name, "it is not a table")
        check_stamp(data, name, "grade it again")
        try:
            result = read_record(cls, data)
        except LabkitError as error:
            raise _damaged(name, str(error)) from None
        result._check_sums(name)
        return result

    def _check_sums(self, name: str) -> None:
        """Raise a LabkitError unless the score is what the questions earned, and none is missing.

        A report has no question at all: people mark it.
        """
        verdicts = [question.verdict for question in self.questions]
        earned = [v.earned for v in verdicts if v.earned <= v.points]
        whole = len({v.name for v in verdicts}) == len(verdicts) == len(earned)
        points = 0.0 if self.rejected else self.points
        apart = (sum(earned) - self.score, sum(v.points for v in verdicts) - points)
        if not whole or (self.rejected and verdicts) or max(map(abs, apart)) > 0.01:
            whole_sum = f"{len(verdicts)} questions earned {sum(earned):g} of {self.points:g}"
            raise _damaged(name, f"the score is {self.score:g}, and {whole_sum}")

    def __str__(self) -> str:
        came = f"{self.score:g} of {self.points:g}"
        return f"{self.student}: {f'rejected; {self.rejected}' if self.rejected else came}"

    @property
    def asked(self) -> dict[str, float]:
        """The points of each question that it answers."""
        return {question.verdict.name: question.verdict.points for question in self.questions}

    def falls_from(self, before: Result) -> bool:
        """Whether the same submission had more before, of the questions that both releases ask.

        A release can change what a question is worth, so the share of each question is compared,
        times its points now; with the same points that is the mark.  A question that earned
        something and is no longer asked may merely have a new name; the share of the whole is
        then compared, too.  A file that could not be read is not taken for another submission.
        """
        unread = bool(self.rejected) and self.hashes["submission"] == _NOTHING
        if before.hashes["submission"] != self.hashes["submission"] and not unread:
            return False
        if self.rejected:
            return before.score > 0.0
        mine, theirs = ({q.verdict.name: q.verdict for q in x.questions} for x in (self, before))
        both = [name for name in mine if name in theirs and theirs[name].points]
        was = sum(theirs[x].earned / theirs[x].points * mine[x].points for x in both)
        rounded = 0.01 * sum(theirs[x].points != mine[x].points for x in both)
        if sum(mine[x].earned for x in both) < was - rounded - 1e-6:
            return True
        gone = any(v.earned for name, v in theirs.items() if name not in mine)
        share = before.score / before.points * self.points if gone else 0.0
        return self.score < share - 0.01 * len(mine)

    @property
    def unanswered(self) -> str:
        """Why nothing in it is an attempt at a question, in a sentence; "" if something may be."""
        other = (note for note in self.notes if note.startswith(OTHER_NOTEBOOK))
        return self.rejected or next(other, "")


class Results:
    """The result files of one assignment."""

    def __init__(self, course: Course, assignment: str) -> None:
        self.folder, self.assignment = course.results / assignment, assignment

    @property
    def aside(self) -> Results:
        """Results that no mark is made of until `grade_class` takes them over."""
        other = copy.copy(self)
        other.folder = self.folder / "aside"
        return other

    def path(self, student: str) -> Path:
        """Where a student's result is."""
        return self.folder / f"{student}.json"

    def students(self) -> list[str]:
        """Who has a file here, whole or not."""
        return sorted(path.stem for path in self.folder.glob("*.json"))

    def read(self, student: str) -> Result | None:
        """A student's result, or None if there is no file.

        Raises:
            LabkitError: The file is not a whole result of this student and this assignment.
        """
        path = self.path(student)
        try:
            result = Result.read(path.read_text(encoding="utf-8"), path.name)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise LabkitError(f"{path.name} cannot be read: {error.strerror}") from None
        except ValueError:
            raise LabkitError(f"{path.name} is not text") from None
        if (result.student, result.assignment) != (student, self.assignment):
            whose = f"{result.student}'s {result.assignment}"
            raise LabkitError(f"{path.name} is damaged; it is the result of {whose}")
        return result

    def get(self, student: str) -> Result | None:
        """A student's result, or None if there is no whole one."""
        try:
            return self.read(student)
        except LabkitError:
            return None

    def keep(self, result: Result) -> None:
        """Write a result; an older one that came from other contents goes to ``old/STUDENT/``."""
        path, before = self.path(result.student), self.get(result.student)
        if path.exists() and (before is None or before.hashes != result.hashes):
            keys = [] if before is None else [str(x)[:8] for x in before.hashes.values()]
            old = self.folder / "old" / result.student / f"{'-'.join(keys) or 'damaged'}.json"
            old.parent.mkdir(parents=True, exist_ok=True)
            if path.is_file():
                shutil.copy2(path, old)  # with the time at which it was written
            else:  # somebody's folder, which must make room
                path.rename(old)
        write(path, result.text())

    def __iter__(self) -> Iterator[Result]:
        """Whole results; `standing` also names those that are missing or damaged."""
        for student in self.students():
            result = self.get(student)
            if result is not None:
                yield result


def _damaged(name: str, why: str) -> LabkitError:
    why = clean_line(why, 120)
    return LabkitError(f"{name} is damaged; it is not a whole result: {why}")


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is not a number of JSON")


@cache
def engine() -> str:
    """A name for the code that grades: another version, another mark."""
    whole = hashlib.sha256()
    for path in engine_files():
        whole.update(str(path.relative_to(_LABKIT)).encode() + path.read_bytes())
    return whole.hexdigest()


def engine_files() -> Iterator[Path]:
    """The code that a mark can depend on.

    It is the lab and the course, without what shows replays, and of the grader what a worker loads.
    A corrected word in a page or in a command changes no mark, so nobody is graded again for it.
    """
    for path in sorted(_LABKIT.rglob("*.py")):
        first, *more = path.relative_to(_LABKIT).parts
        if first not in {"replay", "__main__.py", "grader"} or (more and more[0] in _OF_A_WORKER):
            yield path
