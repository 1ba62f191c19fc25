"""Results: one file for each submission, known by the contents that it came from."""

from __future__ import annotations

import glob
import hashlib
import json
import os
import platform
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import msgspec

import labkit

from ..course.layout import Course
from ..course.question import Question
from ..course.question_codec import read_question
from ..errors import LabkitError
from .clean import clean_data, clean_line
from .result_data import ResultData


@dataclass(frozen=True)
class Result:
    """What came of one submission.

    Attributes:
        assignment: Which.
        student: Whose.
        score: Points; 0 where it was rejected.
        points: What full marks would be.
        rejected: Why it could not be graded, in a sentence; empty where it was.
        questions: One verdict each, as data: name, outcome, earned, points, tests, the withheld
            tools that it used, mistake, notes, source, and what `seen` adds, which older results
            lack: runs, numbers.
        notes: What was unusual about the whole.
        cells: Cells that failed or were stopped, with their sentence.
        own: The student's own cells, where they stood.
        tricks: What may be a way around a withheld tool, for the instructor, sentences.
        isolation: What kept it apart while it ran.
        versions: Of what graded it.
        hashes: Of the submission, the release and the engine.
        seed: Of the hidden cases.
        seconds: How long it took: in all, and in the student's own code.
    """

    assignment: str
    student: str
    score: float
    points: float
    rejected: str = ""
    questions: tuple[Mapping[str, Any], ...] = ()
    notes: tuple[str, ...] = ()
    cells: tuple[Mapping[str, Any], ...] = ()
    own: tuple[Mapping[str, str], ...] = ()
    tricks: tuple[str, ...] = ()
    isolation: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    hashes: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)

    def text(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self), ensure_ascii=True, indent=1) + "\n"

    @classmethod
    def read(cls, text: str) -> Result:
        """What `text` wrote, with every text in it made safe to store and to show.

        Raises:
            LabkitError: It is not a whole result; the sentence says where.
        """
        try:
            data = clean_data(json.loads(text, parse_constant=_refuse))
            msgspec.convert(data, ResultData)
            for name in ("questions", "notes", "cells", "own", "tricks"):
                data[name] = tuple(data[name])
            result = cls(**data)
        except (msgspec.ValidationError, ValueError, TypeError, RecursionError) as error:
            raise LabkitError(f"it is not a whole result: {clean_line(str(error), 120)}") from None
        result._check_sums()
        return result

    def _check_sums(self) -> None:
        """Raise a LabkitError unless the score is what the questions earned."""
        earned = [q["earned"] for q in self.questions if q["earned"] <= q["points"]]
        names = {q["name"] for q in self.questions}
        whole = len(names) == len(self.questions) == len(earned)
        if not whole or bool(self.rejected) == bool(names) or abs(sum(earned) - self.score) > 0.01:
            raise LabkitError(
                f"it is not a whole result: the score is {self.score:g}, "
                f"and {len(self.questions)} questions earned {sum(earned):g}"
            )

    def __str__(self) -> str:
        came = f"{self.score:g} of {self.points:g}"
        return f"{self.student}: {f'rejected; {self.rejected}' if self.rejected else came}"

    @property
    def verdict(self) -> dict[str, Any]:
        """Everything that must come out the same wherever it is graded."""
        data = asdict(self)
        del data["seconds"], data["isolation"]
        for cell in data["cells"]:
            del cell["seconds"]
        return data


class Results:
    """The result files of one assignment."""

    def __init__(self, course: Course, assignment: str) -> None:
        self.folder = course.results / assignment

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
            result = Result.read(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except OSError as error:
            raise LabkitError(f"{path.name} cannot be read: {error.strerror}") from None
        except ValueError:
            raise LabkitError(f"{path.name} is not text") from None
        except LabkitError as error:
            raise LabkitError(f"{path.name} is damaged; {error}") from None
        if (result.student, result.assignment) != (student, self.folder.name):
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
        """Write a result; an older one that came from other contents goes to ``old/``."""
        path, before = self.path(result.student), self.get(result.student)
        if path.exists() and (before is None or before.hashes != result.hashes):
            hashes = {} if before is None else before.hashes
            key = "-".join(hashes.get(x, "")[:8] for x in ("submission", "bundle", "engine"))
            old = self.folder / "old" / f"{result.student}-{key}.json"
            old.parent.mkdir(parents=True, exist_ok=True)
            if path.is_file():
                shutil.copyfile(path, old)
            else:  # somebody's folder, which must make room
                path.rename(old)
        write(path, result.text())

    def __iter__(self) -> Iterator[Result]:
        """Whole results; `standing` also names those that are missing or damaged."""
        for student in self.students():
            result = self.get(student)
            if result is not None:
                yield result


def write(path: Path, text: str) -> None:
    """Write a file whole or not at all; what a run that was killed left unfinished goes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    for left in path.parent.glob(f".{glob.escape(path.name)}.*.new"):
        if not Path("/proc", left.name.split(".")[-2]).exists():
            left.unlink(missing_ok=True)
    new = path.with_name(f".{path.name}.{os.getpid()}.new")
    try:
        with new.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is not a number of JSON")


@dataclass(frozen=True)
class Bundle:
    """What a release leaves for graders.

    Attributes:
        data: Assignment, seed, manifest, questions with their hidden cases, hash; and, if there are
            any, the questions ``added`` when some had handed in already.
    """

    data: Mapping[str, Any]

    @classmethod
    def of(cls, course: Course, assignment: str) -> Bundle:
        """The bundle of an assignment.

        Raises:
            LabkitError: It was not released, or its file is damaged.
        """
        path = course.bundle / f"{assignment}.json"
        if not path.exists():
            raise LabkitError(
                f"{assignment} was not released here; type: labkit release {assignment}"
            )
        try:
            return cls(json.loads(path.read_text(encoding="utf-8")))
        except ValueError as error:
            raise LabkitError(
                f"{path} is damaged: {error}; restore it, or type: labkit release {assignment}"
            ) from None

    @cached_property
    def questions(self) -> tuple[Question, ...]:
        """Its questions, hidden cases included; read once for all submissions."""
        return tuple(map(read_question, self.data["questions"]))

    @property
    def added(self) -> frozenset[str]:
        """Questions that came when some had handed in already."""
        return frozenset(self.data.get("added", ()))

    @property
    def points(self) -> float:
        """Full marks."""
        return float(sum(q["points"] for q in self.data["questions"]))


def digest(data: bytes) -> str:
    """A name for contents."""
    return hashlib.sha256(data).hexdigest()


@cache
def engine() -> str:
    """A name for the code that grades: another version, another mark."""
    root = Path(labkit.__file__).parent
    whole = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        if "replay" not in path.parts:
            whole.update(str(path.relative_to(root)).encode() + path.read_bytes())
    return whole.hexdigest()


@cache
def versions() -> Mapping[str, str]:
    """Of Python and of what marks depend on."""
    found = {"labkit": labkit.__version__, "python": platform.python_version()}
    for name in ("numpy", "scipy", "pybullet", "pin"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "missing"
    return found
