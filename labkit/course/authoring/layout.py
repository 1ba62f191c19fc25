"""The layout of a course on disk: sources, assignments, submissions and results."""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...errors import LabkitError, UnknownName

OUTCOMES = {
    "frames": "express points, poses and errors of orientation in named frames, and test them",
    "motion": "plan a motion within limits of speed and acceleration, and predict its peaks",
    "model": "build an arm's Jacobian and dynamics, and verify them by energy and experiment",
    "control": "choose and write a control law, and set its gains from a frequency and a margin",
    "contact": "predict the rest force at a wall from a stiffness, and verify it within 10 %",
    "sensing": "tell a sensor's bias, spread and age apart, and predict ahead to make up for age",
    "experiment": "design an experiment that identifies a number or a fault of an arm",
    "evidence": "state a claim with a number, its unit and an interval, or that it is undecided",
}
"""What students can do after the course, by the names that ``outcomes`` of a question uses."""

if TYPE_CHECKING:
    from ..predictions import Prediction
    from .problem import Problem


PUBLIC_SEED = 2019
"""The seed of the demonstration, so hidden cases that are drawn from it can be known."""
DEFENCE = "09_defence"
"""The oral examination, an assignment of the gradebook that nobody hands in."""


@dataclass(frozen=True)
class Course:
    """A course directory, laid out as `nbgrader_config.py` says.

    Attributes:
        root: The directory that holds ``solutions/`` and ``nbgrader_config.py``.
    """

    root: Path

    @classmethod
    def here(cls, start: Path | None = None) -> Course:
        """The course around a folder, the working directory by default.

        Raises:
            LabkitError: There is none; or `start` is not given and the course is inside another
                one, which happens in a submission that has its own configuration.
        """
        place = (start or Path.cwd()).resolve()
        if not place.exists():
            raise LabkitError(f"there is no {place}; give the course's folder with --course")
        around = [x for x in (place, *place.parents) if (x / "nbgrader_config.py").exists()]
        if not around:
            raise LabkitError(
                f"{place} is not inside a course: no nbgrader_config.py there or above; "
                "change to the course's folder, or give it with --course"
            )
        if start is None and len(around) > 1:
            raise LabkitError(
                f"{around[0]} has an nbgrader_config.py and lies inside the course {around[-1]}; "
                "if you trust it, name the course that you mean with --course"
            )
        return cls(around[0])

    @property
    def build(self) -> Path:
        """Generated files, which are never committed."""
        return self.root / "build" / "course"

    @property
    def source(self) -> Path:
        """The sources for nbgrader with the hidden cases, for instructors only."""
        return self.build / "source"

    @property
    def solution(self) -> Path:
        """Solved notebooks with the source of the answers, for after the deadline."""
        return self.build / "solution"

    @property
    def bundle(self) -> Path:
        """The bundles for graders: manifests, questions, hidden cases."""
        return self.build / "bundle"

    @property
    def term(self) -> Path:
        """The record of the term, with its seed."""
        return self.root / "course_private" / "term.json"

    @property
    def release(self) -> Path:
        """The students' notebooks."""
        return self.root / "assignments"

    @property
    def submitted(self) -> Path:
        """The submissions, as student/assignment/notebook."""
        return self.root / "submitted"

    @property
    def results(self) -> Path:
        """One result file for each submission."""
        return self.root / "results"

    def names(self) -> tuple[str, ...]:
        """All assignments that have a source, in order."""
        return tuple(sorted(path.stem for path in self.root.glob("solutions/*/[0-9][0-9]_*.py")))

    def notebook_source(self, name: str) -> Path:
        """The source text of an assignment's notebook.

        Raises:
            UnknownName: There is no assignment of that name.
        """
        if name not in self.names():
            raise UnknownName("assignment", name, self.names())
        return self.root / "solutions" / name.partition("_")[2] / f"{name}.py"

    def problems(self, name: str) -> tuple[Problem, ...]:
        """The problems of an assignment: those of its ``problems.py``, then its text's own.

        Raises:
            UnknownName: There is no assignment of that name.
            LabkitError: The assignment has a notebook but no problems, or one in its text is wrong.
        """
        from .short import short_problems

        return (*self._listed(name, "problems"), *short_problems(self.notebook_source(name)))

    def predictions(self, name: str) -> tuple[Prediction, ...]:
        """The predictions of an assignment, from the course's own ``solutions`` package.

        Raises:
            UnknownName: There is no assignment of that name.
            LabkitError: The assignment has a notebook but no predictions.
        """
        return self._listed(name, "predictions")

    def _listed(self, name: str, what: str) -> tuple[Any, ...]:
        """The list in a module of an assignment's folder."""
        self.notebook_source(name)
        if str(self.root) not in sys.path:
            sys.path.insert(0, str(self.root))
        where = f"solutions.{name.partition('_')[2]}.{what}"
        try:
            return tuple(getattr(importlib.import_module(where), what.upper()))
        except ModuleNotFoundError as error:
            if error.name not in (where, where.removesuffix(f".{what}")):
                raise
            path = where.replace(".", "/")
            raise LabkitError(
                f"{name} has no {what}; write {path}.py with {what.upper()}"
            ) from None
