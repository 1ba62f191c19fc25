"""The learning outcomes of the course, for which questions are evidence."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ...errors import LabkitError

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


def check_outcomes(file: Path, name: str, outcomes: Iterable[str]) -> None:
    """Raise a LabkitError unless a question's outcomes are names of `OUTCOMES`.

    Args:
        file: The file with the question.
        name: Name of the question.
        outcomes: The outcomes of which it is evidence.
    """
    for outcome in outcomes:
        if outcome not in OUTCOMES:
            raise LabkitError(
                f"{file}: {name} has the outcome {outcome!r}; take one of {', '.join(OUTCOMES)}"
            )
