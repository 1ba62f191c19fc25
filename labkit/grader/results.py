"""Results: one file for each submission, identified by hashes of what it was made from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, TypedDict

import labkit

from ..course.authoring.layout import Course
from ..course.serialize import read_record, record_data
from ..course.verdict import Points, Verdict
from ..errors import LabkitError
from ..formats import check_stamp, stamp
from .clean import clean_data, clean_line
from .files import write

_LABKIT = Path(labkit.__file__).parent


class Run(TypedDict):
    """A run of the arm on a public case; see `evidence.runs`."""

    test: str
    says: str
    complete: bool
    since: float
    measures: dict[str, float | None]
    limits: dict[str, float | None]
    words: str
    motion: str


class Numbers(TypedDict):
    """The numbers of an answer and those expected; see `evidence.numbers`."""

    call: str
    expected: list[float]
    given: list[float]
    of: int


@dataclass(frozen=True)
class Answer:
    """The outcome of one question.

    Attributes:
        verdict: The verdict of `mark`.
        notes: Sentences on what was unusual.
        source: The text of the cell that answers the question.
        runs: The runs of the arm on public cases.
        numbers: The numbers of the answer and those expected, if they differ.
    """

    verdict: Verdict
    notes: tuple[str, ...] = ()
    source: str = ""
    runs: tuple[Run, ...] = ()
    numbers: Numbers | None = None


@dataclass(frozen=True)
class Result:
    """The outcome of one submission.

    Attributes:
        assignment: The name of the assignment.
        student: The student who handed it in.
        score: The points earned; 0 if the submission was rejected.
        points: The points for a perfect submission.
        seed: The seed of the hidden cases.
        hashes: Hashes of the submission, of the release's bundle and of the engine, which is
            labkit's code.
        rejected: Why the submission could not be graded, in a sentence; empty if it was.
        questions: An answer for each question.
        notes: What was unusual about the whole submission.
        cells: For each cell that failed, its number from 0, its kind and its error.
        own: The student's own cells: type, source, and the cell of the release that it is after.
        written: The text of each cell that a person marks, by the name of the cell.
        isolation: What isolated the submission while it ran.
        seconds: How long grading took in all, and how long the student's code ran.
        receipt: What `lk.hand_in` printed for this file; empty if the submission was rejected.
    """

    assignment: str
    student: str
    score: Points
    points: Points
    seed: int
    hashes: Mapping[str, str]
    rejected: str = ""
    questions: tuple[Answer, ...] = ()
    notes: tuple[str, ...] = ()
    cells: tuple[Mapping[str, Any], ...] = ()
    own: tuple[Mapping[str, str], ...] = ()
    written: Mapping[str, str] = field(default_factory=dict)
    isolation: str = ""
    seconds: Mapping[str, float] = field(default_factory=dict)
    receipt: str = ""

    def text(self) -> str:
        """The result as JSON."""
        data = stamp() | record_data(self)
        return json.dumps(data, ensure_ascii=True, indent=1, allow_nan=False) + "\n"

    @classmethod
    def read(cls, text: str, name: str = "the result") -> Result:
        """Read what `text` wrote, and make every text in it safe to store and to show.

        Args:
            text: A result as JSON.
            name: What a refusal calls it.

        Raises:
            LabkitError: The text is not a complete result, or another version wrote it.
        """
        try:
            data = dict(clean_data(json.loads(text)))
            check_stamp(data, name, "grade it again")
            return read_record(cls, data)
        except (TypeError, ValueError, RecursionError, LabkitError) as error:
            why = clean_line(str(error), 120)
            raise LabkitError(f"{name} is not a whole result: {why}") from None

    def __str__(self) -> str:
        no = f"rejected; {self.rejected}; ask for the file again" if self.rejected else ""
        return f"{self.student}: {no or f'{self.score:g} of {self.points:g}'}"

    @property
    def asked(self) -> dict[str, float]:
        """The points of each question of the release that made the result."""
        return {question.verdict.name: question.verdict.points for question in self.questions}

    @property
    def earned(self) -> dict[str, float]:
        """The points that each question earned."""
        return {question.verdict.name: question.verdict.earned for question in self.questions}


class Results:
    """The result files of one assignment."""

    def __init__(self, course: Course, assignment: str) -> None:
        self.folder = course.results / assignment

    def path(self, student: str) -> Path:
        """The path of a student's result file."""
        return self.folder / f"{student}.json"

    def students(self) -> list[str]:
        """The students who have a result file, damaged or not."""
        return sorted(path.stem for path in self.folder.glob("*.json"))

    def read(self, student: str) -> Result | None:
        """A student's result, or None if there is no file.

        Raises:
            LabkitError: The file is not a complete result.
        """
        path = self.path(student)
        try:
            return Result.read(path.read_text(encoding="utf-8", errors="replace"), path.name)
        except FileNotFoundError:
            return None

    def get(self, student: str) -> Result | None:
        """A student's result, or None if there is no complete one."""
        try:
            return self.read(student)
        except LabkitError:
            return None

    def keep(self, result: Result) -> None:
        """Write a result in place of an earlier one."""
        write(self.path(result.student), result.text())

    def __iter__(self) -> Iterator[Result]:
        """All complete results; `current_results` also names those missing or damaged."""
        return filter(None, map(self.get, self.students()))


@cache
def engine() -> str:
    """A hash of labkit's code, as other code may give other marks."""
    whole = hashlib.sha256()
    for path in sorted(_LABKIT.rglob("*.py")):
        whole.update(str(path.relative_to(_LABKIT)).encode() + path.read_bytes())
    return whole.hexdigest()
