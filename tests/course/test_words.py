"""Verdicts in words: read aloud, they say what was asked, what came back and what to do."""

from dataclasses import replace

import numpy as np
from questions import CALLS, DOUBLE, HIDDEN, double, square

from labkit.course import Call, Test
from labkit.course.marking import mark, not_counted
from labkit.course.messages import head, tell

COMPLETE = replace(DOUBLE, tests=(*DOUBLE.tests[:2], Test("negative", CALLS[2:])))
"""The same question without anything to be tried later."""


def said(function, question=DOUBLE, **more):
    return tell(question, mark(question, function), **more)


def stub(x):
    raise NotImplementedError


def test_the_verdict_comes_first():
    """The first line holds name, verdict and points, and nothing else."""
    assert said(double, COMPLETE).splitlines()[0] == "double: right. 4 of 4 points."
    assert head(mark(DOUBLE, stub)) == "double: not attempted yet. 0 of 4 points."
    assert head(mark(DOUBLE, square)) == "double: not yet right. 0 of 4 points."
    assert head(mark(DOUBLE, lambda x: 1 / 0)) == "double: it stopped with an error. 0 of 4 points."


def test_not_attempted_says_what_to_do():
    """A stub is told the task and the hint, and no failures."""
    words = said(stub)
    assert "To do: Give twice the number." in words
    assert 'hint("double", 1)' in words and "failed" not in words


def test_right_says_what_else_is_tried():
    """Where hidden cases are still to come, a right answer hears of them, and no promise."""
    assert said(double).splitlines() == [
        "double: right on all cases here; 4 points if the teacher's cases agree.",
        "  The teacher also tries: any number.",
    ]
    graded = replace(
        DOUBLE, tests=(*DOUBLE.tests[:2], Test("more", (CALLS[2], HIDDEN), 1.0, "any number"))
    )
    assert said(double, graded) == "double: right. 4 of 4 points."


def test_wrong_shows_the_call_and_both_numbers():
    """A failure holds the call as typed, what was expected and what came; passed tests are told."""
    words = said(lambda x: abs(2.0 * x))
    assert "[passed] two (needed before anything counts)" in words
    assert "[failed] negative" in words and "double(-1.0):" in words
    assert "expected -2\n" in words and "got      2\n" in words


def test_a_known_mistake_is_named():
    """Its name and its sentence follow the failures."""
    words = said(square).splitlines()
    named = next(k for k, line in enumerate(words) if "well-known" in line)
    assert "squared" in words[named] and "That is the square." in words[named + 1]


def test_errors_are_told_on_their_call():
    """An exception is told with its type, its words and the call that raised it."""
    words = " ".join(said(lambda x: [][0]).split())  # long lines are folded
    assert "double(2.0) raised IndexError: list index out of range" in words


def test_a_withheld_tool_is_an_outcome_of_its_own():
    """An answer that uses one is not counted, whatever it gives; the sentence names the tool."""
    verdict = not_counted(DOUBLE, ("labkit.Circle", "numpy.multiply"))
    words = " ".join(tell(DOUBLE, verdict).split())
    assert words.startswith(
        "double: not counted: uses lk.Circle and numpy.multiply, which this question asks you to "
        "write. 0 of 4 points. "
    )
    assert "write it yourself" in words and "passed" not in words
    assert head(not_counted(DOUBLE, ("pinocchio",))) == (
        "double: not counted: uses pinocchio, which may not be used in this answer. 0 of 4 points."
    )


def test_prints_are_shown_in_part():
    """What the code printed is shown, long lines and many lines cut."""
    words = said(double, printed="\n".join(["x" * 500, *map(str, range(20))]))
    assert "your code printed" in words and "... and 15 more lines" in words
    assert max(map(len, words.splitlines())) < 200


def test_long_answers_stand_below_each_other():
    """Two answers too long for a line can be compared number by number."""
    calls = (Call((np.eye(3),), expected=np.arange(6.0)),)
    question = replace(DOUBLE, tests=(Test("a long one", calls),), mistakes=())
    lines = said(lambda x: -np.arange(6.0), question).splitlines()
    at = next(k for k, line in enumerate(lines) if "expected" in line)
    assert "double(<3 x 3 numbers>)" in lines[at - 1]
    assert lines[at].index("[0, 1") == lines[at + 1].index("[0, -1")
    assert "(the same with the other sign)" in lines[at + 2]


def test_a_test_that_nobody_can_see_is_told():
    """A test without a public case has not passed, whether the rest is right or wrong."""
    question = replace(COMPLETE, tests=(*COMPLETE.tests, Test("elsewhere", ())))
    assert "Not tried here, and points hang on it: elsewhere." in said(double, question)
    assert "Not tried here" not in said(double)
    for wrong in (square, lambda x: None, lambda x: 1 / 0):
        assert "  [not tried here] elsewhere" in said(wrong, question).splitlines()
    assert "double: right on all cases here" in said(double, question)


def test_the_same_failure_is_told_once():
    """What went wrong in the same way again is not told again."""
    words = said(lambda x: None)
    assert words.count("it returned nothing (None)") == 1
    assert words.count(": the same") == 2
