"""A class that is graded without a sandbox: results made by hand, as the grader writes them."""

from __future__ import annotations

import json

from handmade import hand_in

from labkit.grader.grade import hashes, rejection
from labkit.grader.gradebook import record
from labkit.grader.results import Bundle, Result, Results

NAME = "01_paths"
NOTEBOOK = {"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}


def notebook_of(student):
    """Bytes that no other student handed in."""
    return json.dumps(NOTEBOOK | {"metadata": {"of": student}}).encode()


def result_of(course, student, *, share=1.0, rejected="", data=None, **more):
    """What came of a student's notebook: this share of every question's points."""
    bundle = Bundle.of(course, NAME)
    data = notebook_of(student) if data is None else data
    if rejected:
        return rejection(rejected, student, bundle, "made by hand", data)
    outcome = "right" if share == 1.0 else "wrong"
    questions = tuple(
        {
            "name": q.name,
            "outcome": outcome,
            "earned": round(share * q.points, 2),
            "points": q.points,
            "tests": [
                {"name": t.name, "weight": t.weight, "outcome": outcome, "says": "", "hidden": True}
                for t in q.tests
            ],
            "mistake": None,
            "notes": [],
            "source": f"def {q.name}():\n    return {student!r}",
            "runs": [],
            "numbers": None,
        }
        for q in bundle.questions
    )
    score = round(sum(q["earned"] for q in questions), 2)
    made = {"hashes": hashes(data, bundle), "seconds": {"all": 1.0, "student": 0.5}}
    return Result(NAME, student, score, bundle.points, questions=questions, **(made | more))


def handed_in(course, *students):
    for student in students:
        hand_in(course, NAME, student, notebook_of(student))


def graded(course, *results, recorded=True):
    """Keep results, their submissions beside them, and record them."""
    for result in results:
        handed_in(course, result.student)
        Results(course, NAME).keep(result)
    return record(course, NAME, results) if recorded else []


def marks(text):
    """A table of the layout ``questions``: each student's last two cells, score and remark."""
    rows = [line.split(",", maxsplit=8) for line in text.splitlines()[2:]]
    return {row[0]: (row[-2], row[-1]) for row in rows}
