"""A synthetic class: submissions of every typical kind, and the marks that they deserve.

`python -m tests.synthetic 01_paths --count 14` writes one into the course of the present folder.
"""

from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.course.authoring.problem import Problem
from labkit.course.marking import mark
from labkit.course.notebook import grade_id
from labkit.course.predictions import Prediction
from labkit.course.question import Question
from labkit.errors import LabkitError
from labkit.grader.files import write
from labkit.grader.results import Results

from . import kinds
from .inline import inline

Random = np.random.Generator


@dataclass
class Draft:
    """A submission that is being made.

    Attributes:
        assignment: The name of the assignment.
        problems: The problems, by name.
        foretold: The predictions of the notebook.
        questions: The questions with their hidden cases.
        random: The source of random choices.
        cells: The cells of the notebook, as JSON data.
        expected: The points that each question deserves.
        rejected: Whether the submission cannot be graded at all.
        data: The bytes of the file, if it is not a notebook.
        name: The name of the file.
    """

    assignment: str
    problems: dict[str, Problem]
    foretold: Sequence[Prediction]
    questions: dict[str, Question]
    random: Random
    cells: list[dict[str, Any]]
    expected: dict[str, float] = field(default_factory=dict)
    rejected: bool = False
    data: bytes | None = None
    name: str = ""

    def place(self, question: str) -> int:
        """The cell of the answer to a question."""
        for k, cell in enumerate(self.cells):
            if grade_id(cell) == question:
                return k
        raise LabkitError(f"no cell for {question}")

    def answer(self, question: str, source: str, points: float) -> None:
        """Answer a question with the text of a cell."""
        self.cells[self.place(question)]["source"] = source
        self.expected[question] = points

    def answer_with(self, question: str, function: Callable[..., Any]) -> None:
        """Answer a question with the source of a function of the course."""
        earned = mark(self.questions[question], function).earned
        self.answer(question, inline(function, question), earned)

    def solve(self) -> None:
        """Give right answers to all questions."""
        for name, problem in self.problems.items():
            self.answer_with(name, problem.answer)
        self.commit()

    def commit(self) -> None:
        """Commit to every prediction."""
        for prediction in self.foretold:
            self.answer(prediction.name, prediction.solved(), prediction.points)

    def anyhow(self) -> None:
        """Answer like people: most right, some right in other forms, some wrong, some missing."""
        for name, problem in self.problems.items():
            luck = self.random.uniform()
            wrong = [w.function for w in problem.wrong]
            if luck < 0.12:
                continue
            choices: Sequence[Callable[..., Any]] = [problem.answer]
            if luck < 0.4 and wrong:
                choices = wrong
            elif luck < 0.6 and problem.variants:
                choices = problem.variants
            self.answer_with(name, choices[int(self.random.integers(len(choices)))])
        if self.random.uniform() < 0.8:
            self.commit()

    def add(self, source: str) -> None:
        """Add a code cell near the start."""
        cell: dict[str, Any] = {
            "cell_type": "code",
            "id": f"own{len(self.cells):05d}",
            "metadata": {},
            "source": source,
            "outputs": [],
            "execution_count": None,
        }
        self.cells.insert(2, cell)

    def bytes(self) -> bytes:
        """Write the file."""
        if self.data is not None:
            return self.data
        notebook = {"cells": self.cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
        return json.dumps(notebook).encode()


def make_class(course: Course, assignment: str, seed: int, count: int = 40) -> dict[str, Any]:
    """Write the submissions of a class into the course, and the marks that they deserve.

    Args:
        course: The course; the assignment must be released.
        assignment: The name of the assignment.
        seed: The seed for names, order and random choices.
        count: The number of submissions; those after the special kinds answer like people.

    Returns:
        The kind, the points of each question and the score, by student; also in ``build/class/``.
    """
    random = np.random.default_rng(seed)
    bundle = Bundle.of(course, assignment)
    problems = {problem.name: problem for problem in course.problems(assignment)}
    foretold = [p for p in course.predictions(assignment) if isinstance(p, Prediction)]
    questions = {question.name: question for question in bundle.questions}
    released = course.release / assignment / f"{assignment}.ipynb"
    blank = json.loads(released.read_text(encoding="utf-8"))["cells"]
    chosen = [*kinds.KINDS.items()][:count]
    chosen += [(f"person {k}", Draft.anyhow) for k in range(count - len(chosen))]
    order = random.permutation(count)
    expected: dict[str, Any] = {}
    for number, (kind, make) in zip(order, chosen, strict=True):
        student = f"student-{number + 1:03d}"
        draft = Draft(assignment, problems, foretold, questions, random, copy.deepcopy(blank))
        draft.expected = dict.fromkeys((*problems, *(p.name for p in foretold)), 0.0)
        make(draft)
        folder = course.submitted / student / assignment
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        (folder / (draft.name or f"{assignment}.ipynb")).write_bytes(draft.bytes())
        score = round(sum(draft.expected.values()), 2)
        expected[student] = {
            "kind": kind,
            "rejected": draft.rejected,
            "questions": draft.expected,
            "score": 0.0 if draft.rejected else score,
        }
    text = json.dumps(dict(sorted(expected.items())), indent=1)
    write(expected_file(course, assignment), text + "\n")
    return expected


def expected_file(course: Course, assignment: str) -> Path:
    """The file with the marks that a class deserves."""
    return course.build.parent / "class" / f"{assignment}.json"


def differences(course: Course, assignment: str) -> Iterator[str]:
    """The differences of the results from what the class deserves, a sentence for each."""
    results = Results(course, assignment)
    for student, deserved in json.loads(expected_file(course, assignment).read_text()).items():
        result = results.get(student)
        if result is None:
            yield f"{student} ({deserved['kind']}) has no result"
            continue
        got = {q.verdict.name: q.verdict.earned for q in result.questions}
        if bool(result.rejected) != deserved["rejected"]:
            yield f"{student} ({deserved['kind']}): {result.rejected or 'not rejected'}"
        elif not deserved["rejected"]:
            for name, points in deserved["questions"].items():
                if got[name] != points:
                    yield (
                        f"{student} ({deserved['kind']}): {name} earned {got[name]:g}, "
                        f"deserved {points:g}"
                    )
