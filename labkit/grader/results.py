"""Results: one file for each submission, identified by hashes of what it was made from."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TypedDict

import labkit

from ..course.authoring.layout import Course
from ..course.serialize import read_record, record_data
from ..course.verdict import Points, Verdict
from ..errors import LabkitError
from ..formats import check_stamp, stamp
from .clean import clean_data, clean_line
from .files import write

_LABKIT = Path(labkit.__file__).parent
OTHER_NOTEBOOK = "this looks like the notebook of another assignment"
_OF_A_WORKER = {"grading", "sandbox"} | {
    f"{name}.py"
    for name in ("clean", "each", "evidence", "files", "grade", "plan", "results", "submission")
}
"""The parts of the grader that a worker loads."""


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
    """Hashes of what a result was made from; ``engine`` is that of the code that grades."""

    submission: str
    bundle: str
    engine: str


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
        hashes: Hashes of the submission, the release and the engine.
        rejected: Why the submission could not be graded, in a sentence; empty if it was.
        questions: An answer for each question.
        notes: What was unusual about the whole submission.
        cells: The cells that failed or were stopped, and why.
        own: The student's own cells, and where they are.
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
    hashes: Hashes
    rejected: str = ""
    questions: tuple[Answer, ...] = ()
    notes: tuple[str, ...] = ()
    cells: tuple[FailedCell, ...] = ()
    own: tuple[OwnCell, ...] = ()
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
        marks = [question.verdict for question in result.questions]
        over = len({x.name for x in marks}) < len(marks) or any(x.earned > x.points for x in marks)
        if (
            (result.rejected and marks)
            or over
            or abs(sum(x.earned for x in marks) - result.score) > 0.01
        ):
            raise _damaged(name, f"the score is {result.score:g}, and its questions say otherwise")
        return result

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

    def falls_from(self, before: Result) -> bool:
        """Whether this submission had a higher mark in an earlier result.

        A release can change the points of a question, so the earlier share of the points is applied
        to the points of today.
        """
        if before.hashes["submission"] != self.hashes["submission"]:
            return False
        full, had, now = before.asked, before.earned, self.earned
        shares = {name: had.get(name, 0.0) / points for name, points in full.items() if points}
        was = sum(share * self.asked.get(name, 0.0) for name, share in shares.items())
        has = sum(now.get(name, 0.0) for name in shares)
        return before.score > 0.0 if self.rejected else has < was - 0.01 * len(now)

    @property
    def unanswered(self) -> str:
        """A sentence if the submission cannot hold an attempt at any question, else ""."""
        other = (note for note in self.notes if note.startswith(OTHER_NOTEBOOK))
        return self.rejected or next(other, "")


class Results:
    """The result files of one assignment."""

    def __init__(self, course: Course, assignment: str) -> None:
        self.folder, self.assignment = course.results / assignment, assignment

    def path(self, student: str) -> Path:
        """The path of a student's result file."""
        return self.folder / f"{student}.json"

    def students(self) -> list[str]:
        """The students who have a result file, damaged or not."""
        return sorted(path.stem for path in self.folder.glob("*.json"))

    def read(self, student: str) -> Result | None:
        """A student's result, or None if there is no file.

        Raises:
            LabkitError: The file is not a complete result of this student and this assignment.
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
        """A student's result, or None if there is no complete one."""
        try:
            return self.read(student)
        except LabkitError:
            return None

    def keep(self, result: Result) -> None:
        """Write a result in place of an earlier one."""
        path = self.path(result.student)
        if path.is_dir():  # that somebody made
            path.rename(path.with_suffix(".folder"))
        write(path, result.text())

    def __iter__(self) -> Iterator[Result]:
        """All complete results; `current_results` also names those missing or damaged."""
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
    """A hash of the code that grades, as other code may give other marks."""
    whole = hashlib.sha256()
    for path in engine_files():
        whole.update(str(path.relative_to(_LABKIT)).encode() + path.read_bytes())
    return whole.hexdigest()


def engine_files() -> Iterator[Path]:
    """The files of code that a mark can depend on.

    They are the lab and the course without the replay viewer, and the parts of the grader that a
    worker loads.  Pages and commands cannot change a mark, so a change to them does not make
    anybody be graded again.
    """
    for path in sorted(_LABKIT.rglob("*.py")):
        first, *more = path.relative_to(_LABKIT).parts
        if first not in {"replay", "__main__.py", "grader"} or (more and more[0] in _OF_A_WORKER):
            yield path
