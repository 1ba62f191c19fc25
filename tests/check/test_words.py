"""Verdicts in words: read aloud, they say what was asked, what came back and what to do."""

import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import numpy as np
from questions import CALLS, DOUBLE, HIDDEN, double, square

from labkit.check import Call, Test, mark
from labkit.check.words import head, tell


def said(function, question=DOUBLE, **more):
    return tell(question, mark(question, function), **more)


def stub(x):
    raise NotImplementedError


def test_the_verdict_comes_first():
    """The first line holds name, verdict and points, and nothing else."""
    assert said(double).splitlines()[0] == "double: right. 4 of 4 points."
    assert head(mark(DOUBLE, stub)) == "double: not attempted yet. 0 of 4 points."
    assert head(mark(DOUBLE, square)) == "double: not yet right. 0 of 4 points."
    assert head(mark(DOUBLE, lambda x: 1 / 0)) == "double: it stopped with an error. 0 of 4 points."


def test_not_attempted_says_what_to_do():
    """A stub is told the task and the hint, and no failures."""
    words = said(stub)
    assert "To do: Give twice the number." in words
    assert 'hint("double", 1)' in words and "failed" not in words


def test_right_says_what_else_is_tried():
    """A right answer hears of the classes of hidden case, where there are any to come."""
    assert "The teacher also tries: any number." in said(double)
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


def test_withheld_names_are_a_note():
    """Leaning on a withheld name is said, in one sentence, and takes no points here."""
    words = said(double, used=("numpy.multiply",))
    assert words.splitlines()[0].endswith("4 of 4 points.")
    assert "your code uses numpy.multiply" in " ".join(words.split())


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
    """Where no case of a test is public, "right" says what points still hang on."""
    question = replace(DOUBLE, tests=(*DOUBLE.tests, Test("elsewhere", ())))
    assert "Not tried here, and points hang on it: elsewhere." in said(double, question)
    assert "Not tried here" not in said(double)


def test_the_same_failure_is_told_once():
    """What went wrong in the same way again is not told again."""
    words = said(lambda x: None)
    assert words.count("it gave nothing back (None)") == 1
    assert words.count(": the same") == 2
