"""A class graded without a sandbox, with handmade results in the grader's format."""

from __future__ import annotations

import json
from dataclasses import replace

from handmade import NAME, hand_in

from labkit.course.authoring.bundle import Bundle
from labkit.course.verdict import Difference, Kind, Outcome, TestResult, Verdict
from labkit.grader.grade import hashes, rejection
from labkit.grader.gradebook import record
from labkit.grader.marks import mark_of
from labkit.grader.results import Answer, Result, Results

NOTEBOOK = {"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}


def notebook_of(student):
    """The bytes of a notebook, which differ for each student."""
    return json.dumps(NOTEBOOK | {"metadata": {"of": student}}).encode()


def result_of(course, student, *, share=1.0, rejected="", data=None, **more):
    """The result of a student's notebook, with a share of the points of every question."""
    bundle = Bundle.of(course, NAME)
    data = notebook_of(student) if data is None else data
    if rejected:
        return rejection(rejected, student, bundle, "made by hand", data)
    outcome = Outcome.RIGHT if share == 1.0 else Outcome.WRONG
    questions = tuple(
        Answer(
            Verdict(
                q.name,
                outcome,
                round(share * q.points, 2),
                q.points,
                tuple(TestResult(t.name, t.weight, outcome, hidden=True) for t in q.tests),
            ),
            source=f"def {q.name}():\n    return {student!r}",
        )
        for q in bundle.questions
    )
    score = round(sum(q.verdict.earned for q in questions), 2)
    made = {
        "hashes": hashes(data, bundle),
        "seconds": {"all": 1.0, "student": 0.5},
    }
    seed = bundle.data["seed"]
    return Result(NAME, student, score, bundle.points, seed, questions=questions, **(made | more))


def changed(result, number=0, verdict=None, **more):
    """A result with changes in one of its answers and in the verdict on that answer."""
    answers = list(result.questions)
    found = replace(answers[number].verdict, **(verdict or {}))
    answers[number] = replace(answers[number], verdict=found, **more)
    return replace(result, questions=tuple(answers))


def saying(verdict, words):
    """A verdict in which each test failed with an exception that has the given words."""
    why = Difference(Kind.RAISED, found=words, error="ValueError")
    tests = tuple(replace(t, outcome=Outcome.ERROR, difference=why) for t in verdict.tests)
    return replace(verdict, tests=tests)


def said_by_hand(result, **comments):
    """The mark of a result with a person's comments on some of its questions."""
    mark = mark_of(result)
    lines = tuple(replace(x, comment=comments.get(x.name, "")) for x in mark.lines)
    return replace(mark, lines=lines)


def handed_in(course, *students):
    for student in students:
        hand_in(course, NAME, student, notebook_of(student))


def graded(course, *results, recorded=True):
    """Save results and their submissions, and record them."""
    for result in results:
        handed_in(course, result.student)
        Results(course, NAME).keep(result)
    return record(course, NAME, results) if recorded else []
