"""Verdicts in words: whole messages stand in a golden file, and laws hold for all.

``pytest tests/course/test_messages.py --golden`` writes the file again; read what changed.
"""

import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from questions import CALLS, DOUBLE, HIDDEN, double, square

from labkit import Hold, JointVelocity, robot
from labkit.course import Call, Close, Test
from labkit.course.card import card
from labkit.course.judges import COMMITTED
from labkit.course.marking import mark, not_counted
from labkit.course.messages import is_prediction, message, outcome_word
from labkit.course.question import Loop
from labkit.course.verdict import Outcome, TestResult, Verdict

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


@pytest.mark.parametrize("expected", [1 / 3, np.sin(np.arange(4.0)), np.sin(np.ones((5, 7)))])
def test_numbers_that_differ_little_do_not_look_the_same(expected):
    """The digits show the difference."""
    tests = (Test("a", (Call((), expected=expected),)),)
    question = replace(DOUBLE, judge=Close(rtol=1e-9), tests=tests, mistakes=())
    words = " ".join(said(lambda: expected * (1.0 + 2e-7), question).split())
    shown = re.search(r"expected ([^,]*?|\[.*?\]),? got ([^,]*?|\[.*?\])( To try|$)", words)
    assert shown and shown[1] != shown[2]


def test_the_same_failure_is_told_once():
    """What went wrong in the same way again is not told again."""
    words = said(lambda x: None)
    assert words.count("t returned nothing (None)") == 1
    assert words.count("[failed]") == 3 and words.count("double(") == 1
    tests = [Test(name, CALLS[:1]) for name in ("one", "a tour")]
    words = said(lambda x: 5.0, replace(DOUBLE, tests=tuple(tests), mistakes=()))
    assert words.count("double(2.0): expected 4, got 5") == 1


def shown(function, printed="", picture=None):
    verdict = mark(DOUBLE, function)
    return card(message(DOUBLE, verdict, printed), verdict.outcome, picture)


def words(page):
    """What is to be read on a page."""
    return " ".join(unescape(re.sub(r"<style>.*</style>|<[^>]*>", " ", page, flags=re.S)).split())


@pytest.mark.parametrize("function", [double, square, stub, lambda x: 1 / 0, lambda x: None])
def test_the_card_holds_the_words_of_the_plain_text(function):
    """Nothing that is said in text is missing on the card, and the text is the text."""
    found = shown(function, printed="a print of mine")
    assert found["text/plain"] == str(message(DOUBLE, mark(DOUBLE, function), "a print of mine"))
    page = words(found["text/html"])
    for line in found["text/plain"].replace("`", " ").split("\n"):
        if line.strip() != "Where it fails:":
            assert " ".join(line.split()) in page, line


def test_tests_and_numbers_are_folded():
    """What helps stands open; tests and numbers open at a click or a key."""
    page = shown(square)["text/html"]
    folded = page[page.index("<details>") : page.index("</details>")]
    assert "That is the square." in page and "That is the square." not in folded
    assert "<summary>2 of 3 tests failed. Show" in folded and "double(3.0): expected 6" in folded
    assert "Show them, with the numbers</summary>" in page
    verdict = mark(DOUBLE, square)
    bare = replace(message(DOUBLE, verdict), numbers=())
    assert "Show them</summary>" in card(bare, verdict.outcome)["text/html"]
    assert "<details>" not in shown(double)["text/html"]


def test_hints_open_one_after_the_other():
    """Each is folded within the one before; the last one follows an attempt."""
    for function, count in ((stub, 2), (square, 3)):
        page = shown(function)["text/html"]
        first = page.index(f"Hint 1 of {count}<")
        parts = page[first:].split("<summary>")
        assert len(parts) == count
        for k, part in enumerate(parts):
            assert (
                DOUBLE.hints[k] in unescape(part)
                and part.count("</details>") == (0, count)[k == count - 1]
            )


def test_nothing_of_a_student_becomes_markup():
    """Prints, messages of exceptions and names are text on the card, whatever they hold."""
    attack = "<script>alert(1)</script><img src=x onerror='alert(2)'>`</code><b>`$x$\""

    def says(x):
        raise ValueError(attack)

    page = shown(says, printed=attack, picture=(b"", attack))["text/html"]
    tags = Tags()
    tags.feed(page)
    assert set(tags.found) == {
        ("div", "class style"), ("p", ""), ("b", "aria-hidden"), ("code", ""), ("details", ""),
        ("summary", ""), ("ul", ""), ("li", ""), ("pre", ""), ("img", "alt src"),
        ("style", ""),
    }  # fmt: skip
    assert page.count("alert(1)") == 3, "as text"


class Tags(HTMLParser):
    """The tags of a page, with the names of their attributes."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, " ".join(name for name, _ in attrs)))


def test_a_prediction_is_committed_and_not_right():
    """Its point is for being made, so no page calls it right; an answer that is right is."""
    for name, says in ((COMMITTED, "committed"), ("on a circle", "right")):
        test = TestResult(name, 1.0, Outcome.RIGHT)
        verdict = Verdict("it", Outcome.RIGHT, 1.0, 1.0, (test,))
        assert outcome_word(verdict) == says and is_prediction(verdict) == (says == "committed")
