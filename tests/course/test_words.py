"""Verdicts in words: the whole messages stand in a golden file, and laws hold for all.

``pytest tests/course/test_words.py --golden`` writes the file again; read what changed.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from questions import CALLS, DOUBLE, HIDDEN, double, square

from labkit import Hold, JointVelocity, robot
from labkit.course import Call, Close, Test
from labkit.course.marking import mark, not_counted
from labkit.course.messages import message, worth
from labkit.course.question import Loop, in_points

GOLDEN = Path(__file__).with_name("words.txt")
COMPLETE = replace(DOUBLE, tests=(*DOUBLE.tests[:2], Test("negative", CALLS[2:])))
"""The same question without anything to be tried later."""


def said(function, question=DOUBLE, **more):
    return str(message(question, mark(question, function), **more))


def stub(x):
    raise NotImplementedError


def one(*cases, name="a test", **changed):
    """The question with these cases as its only test."""
    return replace(DOUBLE, tests=(Test(name, cases),), mistakes=(), **changed)


def messages():
    """Each kind of message, by what it is about."""
    turn = Hold(robot("left").ready + 0.1, 0.1)
    table = Call((), expected={"A is worse than B": "holds"})
    gains = one(Call((1.0,), expected=(1.0, 2.0)), judge=Close(parts=("kp", "kd")))
    yield "right", said(double, COMPLETE)
    yield "right so far", said(double)
    yield "with the hidden case", said(double, replace(COMPLETE, tests=(Test("x", (HIDDEN,)),)))
    yield "a stub", said(stub)
    yield "wrong in a test", said(lambda x: abs(2.0 * x) + (x < 0))
    yield "a known mistake", said(square)
    yield "what it uses is wrong", said(square, depends_on=("half", "third"))
    yield "an exception", said(lambda x: [][0])
    yield "nothing returned", said(lambda x: None)
    yield "a claim", said(lambda: {"A is worse than B": True}, one(table))
    yield "a run that fails", said(lambda s, t: [][0], one(Loop(turn, expected={"max_mm": 1.0})))
    still = one(Loop(turn, expected={"max_mm": 1.0}))
    yield "a run over its limit", said(lambda s, t: JointVelocity(np.zeros(7)), still)
    yield "a long call", said(lambda x: 2.0, one(Call((np.eye(3),), expected=1.0)))
    four = one(Call((1.0,), expected=np.arange(4.0)))
    yield "a number of a vector", said(lambda x: np.array([0.0, 1.0, 9.0, 3.5]), four)
    six = one(Call((np.eye(3),), expected=np.arange(6.0)))
    yield "long answers", said(lambda x: -np.arange(6.0), six)
    unseen = replace(COMPLETE, tests=(*COMPLETE.tests, Test("elsewhere", ())))
    yield "a test that nobody sees", said(double, unseen)
    for given in ((-1.0, 2.0), (float("inf"), 2.0), (1.0, 2.5), (1.0,)):
        yield f"gains {given}", said(lambda x, given=given: given, gains)
    printed = "\n".join(["x" * 500, "y" * 160, *map(str, range(19))])
    yield "prints", said(double, printed=printed)
    withheld = not_counted(DOUBLE, ("labkit.Circle", "numpy.multiply"))
    yield "withheld tools", str(message(DOUBLE, withheld))


def test_messages_are_those_of_the_golden_file(pytestconfig):
    """After a sentence was changed, the file is written again."""
    text = "\n\n".join(f"## {about}\n\n{text}" for about, text in messages()) + "\n"
    if pytestconfig.option.golden:
        GOLDEN.write_text(text, encoding="utf-8")
    assert text == GOLDEN.read_text(encoding="utf-8")


@pytest.mark.parametrize("points", [4.0, 5.0, 1.0])
def test_a_test_is_worth_what_it_earns_alone(points):
    """The points beside a test are those that it earns if it is the only one that passes."""
    question = replace(COMPLETE, points=points)
    for function, passes in ((lambda x: abs(2.0 * x), 1), (lambda x: 2.0 * x + (x == 3.0), 2)):
        verdict = mark(question, function)
        note = f"(worth {verdict.earned:g} of {in_points(points)})"
        assert worth(verdict.tests[passes], verdict) == f" {note}"


def test_the_shares_of_the_points_have_their_sum():
    """A share that has no two decimals is a fraction, so no hundredth is lost."""
    tests = tuple(Test(f"test {k}", CALLS[:1], w) for k, w in enumerate((1.0, 1.0, 2.0, 3.0)))
    verdict = mark(replace(DOUBLE, tests=tests), double)
    shares = [worth(test, verdict) for test in verdict.tests]
    assert shares == [f" (worth {x}/7 of the 4 points)" for x in (1, 1, 2, 3)]


@pytest.mark.parametrize("expected", [1 / 3, np.sin(np.arange(4.0)), np.sin(np.ones((5, 7)))])
def test_numbers_that_differ_little_do_not_look_the_same(expected):
    """The digits show the difference, and float32, if that is the cause, is named."""
    tests = (Test("a", (Call((), expected=expected),)),)
    question = replace(DOUBLE, judge=Close(rtol=1e-9), tests=tests, mistakes=())
    for given, cause in ((np.float32(expected), True), (expected * (1.0 + 2e-7), False)):
        words = " ".join(said(lambda given=given: given, question).split())
        shown = re.search(r"expected ([^,]*?|\[.*?\]),? got ([^,]*?|\[.*?\])( To try|$)", words)
        assert shown and shown[1] != shown[2]
        assert ("t is float32, which has 7 digits; compute in float64" in words) == cause


def test_a_factor_is_told_only_if_it_holds_in_every_call_that_failed():
    """Neither twice in one call and another thing in the next, nor of a single number by chance."""
    tests = [Test(f"{k} rows", (Call((np.eye(k),), expected=np.ones(9)),)) for k in (3, 4)]
    question = replace(DOUBLE, tests=tuple(tests), mistakes=())
    for second, told in ((0.3, False), (2.0, True)):
        text = said(lambda x, y=second: np.full(9, 2.0 if len(x) == 3 else y), question)
        assert ("twice" in text) == told
    plain = replace(DOUBLE, mistakes=())
    assert "other sign" in said(lambda x: -2.0 * x, plain)
    assert "other sign" not in said(lambda x: 2.0 * abs(x), plain)


def test_the_same_failure_is_told_once():
    """What went wrong in the same way again is not told again."""
    words = said(lambda x: None)
    assert words.count("t returned nothing (None)") == 1
    assert words.count("[failed]") == 3 and words.count("double(") == 1
    tests = [Test(name, CALLS[:1]) for name in ("one", "a tour")]
    words = said(lambda x: 5.0, replace(DOUBLE, tests=tuple(tests), mistakes=()))
    assert words.count("double(2.0): expected 4, got 5") == 1
