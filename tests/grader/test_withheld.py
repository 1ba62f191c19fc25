"""Withheld tools: what uses one is not counted, and what may be a trick around one is listed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade import QUICK, add, put, raw
from tricks import TRICKS, Trick

from labkit.course.authoring.bundle import Bundle
from labkit.course.verdict import Outcome
from labkit.grader.feedback.class_report import report
from labkit.grader.feedback.page import page
from labkit.grader.grading.grade import grade
from labkit.grader.marks.table import mark_of

pytestmark = pytest.mark.slow  # a sandbox for each trick


@pytest.fixture(scope="module")
def one(bundle):
    """A bundle with the first question alone."""
    return Bundle(bundle.data | {"questions": bundle.data["questions"][:1]})


@pytest.fixture
def graded(one, sandbox, blank):
    """Grades a notebook with one answer and a cell above it."""

    def graded(answer, cell=""):
        if cell:
            add(blank, cell, at=4)
        return grade(raw(put(blank, "bang_bang", answer)), "ada", one, sandbox, QUICK)

    return graded


@pytest.mark.parametrize("name", TRICKS)
def test_every_known_trick_is_reported(graded, name):
    """Each earns nothing but for a few, and these are listed for the instructor."""
    trick = TRICKS[name]
    result = graded(trick.answer, trick.cell)
    (question,) = result.questions
    assert (question.verdict.earned > 0) == trick.counted, question
    assert question.verdict.withheld == ("labkit.BangBang",) or result.tricks
    if question.verdict.withheld:
        assert question.verdict.outcome is Outcome.NOT_COUNTED
    assert bool(result.cells) == trick.fails, result.cells


def test_the_class_report_lists_both(graded):
    """Who used a tool, and what in whose cells needs a look; of the honest it says nothing."""
    results = [
        replace(graded(trick.answer, trick.cell), student=name)
        for name, trick in [
            ("ada", TRICKS["by name"]),
            ("cleo", Trick("return t, 0, 0")),
            ("bob", TRICKS["loading under another name"]),
        ]
    ]
    text = report("01_paths", list(map(mark_of, results)), {}, str.upper)
    lines = text[text.index("## Withheld tools") :].splitlines()
    assert lines[2:] == [
        "- ADA, not counted: bang_bang uses lk.BangBang, which this question asks you to write",
        "- BOB, worth a look: cell 5 imports importlib.util; cell 5 uses labkit.paths.__file__; "
        "cell 5 uses sys.modules",
    ]
    assert "| bang_bang | 1 | 1 | 0 | 1 | 0 |" in text


def test_what_is_not_counted_says_why(graded):
    """The result names the tool, and the page that is made of it says the sentence."""
    result = graded(TRICKS["by name"].answer)
    (question,) = result.questions
    sentence = "it uses lk.BangBang, which this question asks you to write"
    assert question.notes[0] == sentence
    assert sentence in page(result)
    assert {test.outcome for test in question.verdict.tests} == {Outcome.NOT_COUNTED}
