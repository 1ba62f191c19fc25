"""The bundle, which is the file of a release for graders, with the hidden cases."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ...errors import LabkitError
from ...formats import check_stamp, stamp
from ..question import Question
from ..serialize import question_data, read_question
from .layout import Course


@dataclass(frozen=True)
class Bundle:
    """The file of a release for graders.

    Attributes:
        data: Assignment, seed, manifest, questions with their hidden cases, and hash.
    """

    data: Mapping[str, Any]

    @classmethod
    def of(cls, course: Course, assignment: str) -> Bundle:
        """The bundle of an assignment.

        Raises:
            LabkitError: The assignment was not released, or its file is damaged.
        """
        path = course.bundle / f"{assignment}.json"
        again = f"type: labkit release {assignment}"
        if not path.exists():
            raise LabkitError(f"{assignment} was not released here; {again}")
        try:
            data = dict(json.loads(path.read_text(encoding="utf-8")))
            check_stamp(data, str(path), again)
            checks = sum(cell["kind"] == "check" for cell in data["cells"])
            if checks != len(data["questions"]):
                raise ValueError(f"{len(data['questions'])} questions, {checks} checks")
        except (KeyError, TypeError, ValueError) as error:
            raise LabkitError(f"{path} is damaged: {error}; restore it, or {again}") from None
        return cls(data)

    @cached_property
    def questions(self) -> tuple[Question, ...]:
        """The questions with their hidden cases, which are read once for all submissions."""
        return tuple(map(read_question, self.data["questions"]))

    @property
    def points(self) -> float:
        """Full marks for the questions that are graded automatically."""
        return float(sum(q["points"] for q in self.data["questions"]))

    @property
    def by_hand(self) -> float:
        """Points that a person gives, besides `points`."""
        return float(sum(cell.get("points", 0.0) for cell in self.data["cells"]))


def write_bundle(
    course: Course,
    assignment: str,
    seed: int,
    cells: list[dict[str, Any]],
    questions: Mapping[str, Question],
) -> None:
    """Write a release's bundle.

    Args:
        course: The course.
        assignment: Name of the assignment.
        seed: Seed of the hidden cases.
        cells: The manifest of its notebook.
        questions: The questions by name, with their hidden cases.
    """
    path = course.bundle / f"{assignment}.json"
    data: dict[str, Any] = {
        **stamp(),
        "assignment": assignment,
        "seed": seed,
        "cells": cells,
        "questions": [question_data(q) for q in questions.values()],
    }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
    data["hash"] = hashlib.sha256(text.encode()).hexdigest()
    path.parent.mkdir(0o700, parents=True, exist_ok=True)
    new = path.with_suffix(".new")
    new.touch(0o600)
    new.write_text(json.dumps(data) + "\n", encoding="utf-8")
    new.replace(path)  # so that a grading under way reads the old one or the new one
