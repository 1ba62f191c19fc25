"""Results: one file for each submission, identified by hashes of what it was made from."""

from __future__ import annotations

import copy
import hashlib
import json
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
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
"""The parts of the grader that a worker loads."""


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
    """The numbers of an answer and those expected; see `public_evidence.numbers`."""

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
        result._check_sums(name)
        return result

    def _check_sums(self, name: str) -> None:
        """Raise a LabkitError unless the score is the sum of all questions, and none is missing.

        The result of a report has no questions, because people mark the report.
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
        no = f"rejected; {self.rejected}; ask for the file again" if self.rejected else ""
        return f"{self.student}: {no or f'{self.score:g} of {self.points:g}'}"

    @property
    def asked(self) -> dict[str, float]:
        """The points of each question of the release that made the result."""
        return {question.verdict.name: question.verdict.points for question in self.questions}

    def falls_from(self, before: Result) -> bool:
        """Whether this submission had a higher mark in an earlier result.

        Only questions that both releases ask are compared.  A release can change the points of a
        question, so the earlier share of the points is applied to the points of today.  A question
        that earned points and is no longer asked may have been renamed, so the shares of the whole
        are then compared, too.  A file that cannot be read counts as the same submission.
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
        """A sentence if the submission cannot hold an attempt at any question, else ""."""
        other = (note for note in self.notes if note.startswith(OTHER_NOTEBOOK))
        return self.rejected or next(other, "")


class Results:
    """The result files of one assignment."""

    def __init__(self, course: Course, assignment: str) -> None:
        self.folder, self.assignment = course.results / assignment, assignment

    @property
    def provisional(self) -> Results:
        """Results of ``--diff``, which make no mark until `grade_class` adopts them."""
        other = copy.copy(self)
        other.folder = self.folder / "aside"
        return other

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
        """Write a result, and move one made from other contents to ``old/STUDENT/``."""
        path, before = self.path(result.student), self.get(result.student)
        if path.exists() and (before is None or before.hashes != result.hashes):
            keys = [] if before is None else [str(x)[:8] for x in before.hashes.values()]
            old = self.folder / "old" / result.student / f"{'-'.join(keys) or 'damaged'}.json"
            old.parent.mkdir(parents=True, exist_ok=True)
            if path.is_file():
                shutil.copy2(path, old)  # with the time at which it was written
            else:  # a folder that somebody made, which must make room
                path.rename(old)
        write(path, result.text())

    def rename(self, old: str, new: str) -> None:
        """Give the results of a student, also the earlier ones, another student's name.

        What `labkit grade --diff` made is deleted.  A result is left if it is damaged, or if the
        other student has one.
        """
        result = self.get(old)
        if result is not None and not self.path(new).exists():
            self.keep(replace(result, student=new))
            self.path(old).unlink()
        self.provisional.path(old).unlink(missing_ok=True)
        for folder in (self.folder / "old", self.provisional.folder / "old"):
            if (folder / old).is_dir():
                shutil.copytree(folder / old, folder / new, dirs_exist_ok=True)
                shutil.rmtree(folder / old)

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
