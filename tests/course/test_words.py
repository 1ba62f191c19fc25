"""Verdicts in words: read aloud, they say what was asked, what came back and what to do."""

import re
from dataclasses import replace

import numpy as np
import pytest
from questions import CALLS, DOUBLE, HIDDEN, double, square

from labkit import Hold, JointVelocity, robot
from labkit.course import Call, Close, Test
from labkit.course.marking import mark, not_counted
from labkit.course.messages import head, message, summary, worth
from labkit.course.question import Loop, in_points

COMPLETE = replace(DOUBLE, tests=(*DOUBLE.tests[:2], Test("negative", CALLS[2:])))
"""The same question without anything to be tried later."""


def said(function, question=DOUBLE, **more):
    return str(message(question, mark(question, function), **more))


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
        "double: right on all cases here; 4 points if the instructor's cases agree.",
        "  The instructor also tries: any number.",
    ]
    graded = replace(
        DOUBLE, tests=(*DOUBLE.tests[:2], Test("more", (CALLS[2], HIDDEN), 1.0, "any number"))
    )
    assert said(double, graded) == "double: right. 4 of 4 points."


def test_wrong_shows_the_call_and_both_numbers():
    """A failure holds the call as typed, what was expected and what came; passed tests are told."""
    assert said(lambda x: abs(2.0 * x) + (x < 0)).splitlines() == [
        "double: not yet right. 3 of 4 points.",
        "  In `double(-1.0)`, it is 3 instead of -2.",
        "  [passed] two (needed before anything counts)",
        "  [passed] three (worth 3 of 4 points)",
        "  [failed] negative (worth 1 of 4 points)",
        "  Where it fails:",
        "    double(-1.0): expected -2, got 3",
        '  Stuck? Run `hint("double", 1)` in a new cell (press Esc, then B). It is free.',
    ]


def test_a_claim_is_quoted_and_a_name_is_not():
    """A key that is a sentence would read as one's own words about the answer."""
    for key, quoted in (("A is worse than B", '"A is worse than B"'), ("kp", "kp")):
        tests = (Test("a table", (Call((), expected={key: "holds"}),)),)
        words = said(lambda key=key: {key: True}, replace(DOUBLE, tests=tests, mistakes=()))
        assert f"\n  {quoted}: it should be 'holds', not True.\n" in words


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


def test_a_known_mistake_is_named_first():
    """Its name and its sentence come before the tests, and the tests before the numbers."""
    words = said(square)
    assert words.splitlines()[1] == "  A well-known mistake: squared. That is the square."
    at = [words.index(x) for x in ("squared", "[failed] three", "double(3.0): expected 6, got 9")]
    assert at == sorted(at)
    assert summary(mark(DOUBLE, square))[1] == words.splitlines()[1]


def test_an_answer_that_is_wrong_already_is_named_before_all_else():
    """Who uses a wrong answer of theirs reads first that it is to be corrected first."""
    words = said(square, depends_on=("half", "third")).splitlines()
    says = "It uses your half and third, which are not right yet; correct them first."
    assert says in " ".join(" ".join(words).split())


def test_errors_are_told_with_their_call():
    """An exception is told with its type and its words, and with the call that raised it."""
    words = said(lambda x: [][0])
    assert "\n  It raised IndexError: list index out of range, in the line `" in words
    assert "\n  Where it fails:\n    double(2.0)\n" in words
    assert words.count("IndexError") == 1


def test_a_run_that_fails_is_told_with_its_time():
    """The sentence about the run stands by itself, and nobody "raised controller failed"."""
    loop = Loop(Hold(np.zeros(7), 0.1), expected={"max_mm": 1.0})
    question = replace(DOUBLE, tests=(Test("a run", (loop,)),), mistakes=())
    words = said(lambda state, target: [][0], question)
    assert "\n  The controller failed at t = 0.000 s, tick 0: IndexError: list" in words
    assert "raised" not in words and "raised IndexError" in said(lambda x: [][0])


def test_a_run_over_its_limit_is_told_with_its_arm_and_its_controller():
    """Of which run the number is, is in the sentence with the number, and not again below it."""
    target = Hold(robot("left").ready + 0.1, 0.1)
    loop = Loop(target, expected={"max_mm": 1.0})
    question = replace(DOUBLE, tests=(Test("a run", (loop,)),), mistakes=())
    words = " ".join(said(lambda state, target: JointVelocity(np.zeros(7)), question).split())
    run = "a run of the left arm (ideal) with double as its controller"
    assert f"mm; the limit is 1 mm. This was {run}. [failed]" in words
    assert words.count("a run of") == 1 and "Where it fails" not in words


def test_a_long_call_can_be_tried():
    """A call that nobody could type comes with the line that fetches it."""
    question = replace(DOUBLE, tests=(Test("a long one", (Call((np.eye(3),), expected=1.0),)),))
    words = said(lambda x: 2.0, replace(question, mistakes=()))
    assert '    args, kwargs = lk.course.case("double")\n      double(*args, **kwargs)' in words
    assert "lk.course.case" not in said(square)


def test_the_number_that_is_farthest_off_is_named():
    """Of a vector, the sentence tells which number, what it is and what it should be."""
    call = Call((1.0,), expected=np.arange(4.0))
    question = replace(DOUBLE, tests=(Test("a vector", (call,)),), mistakes=())
    words = said(lambda x: np.array([0.0, 1.0, 9.0, 3.5]), question).splitlines()
    first = " ".join(map(str.strip, words[1:3]))
    assert first == "In `double(1.0)`, the number at index 2 is farthest off: it is 9 instead of 2."


@pytest.mark.parametrize("expected", [1 / 3, np.sin(np.arange(4.0)), np.sin(np.ones((5, 7)))])
def test_numbers_that_differ_little_do_not_look_the_same(expected):
    """The digits show the difference, and float32, if that is the cause, is named."""
    tests = (Test("a", (Call((), expected=expected),)),)
    question = replace(DOUBLE, judge=Close(rtol=1e-9), tests=tests, mistakes=())
    for given, cause in ((np.float32(expected), True), (expected * (1.0 + 2e-7), False)):
        words = " ".join(said(lambda given=given: given, question).split())
        shown = re.search(r"expected ([^,]*?|\[.*?\]),? got ([^,]*?|\[.*?\]) Stuck", words)
        assert shown and shown[1] != shown[2]
        assert ("t is float32, which has 7 digits; compute in float64" in words) == cause


def test_a_withheld_tool_is_an_outcome_of_its_own():
    """An answer that uses one is not counted, whatever it gives; the sentence names the tool."""
    verdict = not_counted(DOUBLE, ("labkit.Circle", "numpy.multiply"))
    words = " ".join(str(message(DOUBLE, verdict)).split())
    assert words.startswith(
        "double: not counted: uses lk.Circle and numpy.multiply, which this question asks you to "
        "write. 0 of 4 points. "
    )
    assert "write them yourself" in words and "passed" not in words
    assert head(not_counted(DOUBLE, ("pinocchio",))) == (
        "double: not counted: uses pinocchio, which may not be used in this answer. 0 of 4 points."
    )


def test_prints_are_shown_in_part():
    """What the code printed is shown; where a long line or many lines are cut, three dots are."""
    words = said(double, printed="\n".join(["x" * 500, "y" * 160, *map(str, range(19))]))
    assert "x...\n" in words and "y\n" in words
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
    assert lines[1] == '  In the test "a long one", it has the other sign.'


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


def test_a_test_that_nobody_can_see_is_told():
    """A test without a public case has not passed, whether the rest is right or wrong."""
    question = replace(COMPLETE, tests=(*COMPLETE.tests, Test("elsewhere", ())))
    assert "Not tried here, although it earns points: elsewhere." in said(double, question)
    assert "Not tried here" not in said(double)
    for wrong in (square, lambda x: None, lambda x: 1 / 0):
        assert (
            "  [not tried here] elsewhere (worth 0.8 of 4 points)"
            in said(wrong, question).splitlines()
        )
    assert "double: right on all cases here" in said(double, question)


def test_the_same_failure_is_told_once():
    """What went wrong in the same way again is not told again."""
    words = said(lambda x: None)
    assert words.count("t returned nothing (None)") == 1
    assert words.count("[failed]") == 3 and words.count("double(") == 1
    tests = [Test(name, CALLS[:1]) for name in ("one", "a tour")]
    words = said(lambda x: 5.0, replace(DOUBLE, tests=tuple(tests), mistakes=()))
    assert words.count("double(2.0): expected 4, got 5") == 1


@pytest.mark.parametrize(
    ("given", "first"),
    [
        ((-1.0, 2.0), "In `double(1.0)`, kp is -1 instead of 1."),
        ((float("inf"), 2.0), "kp is inf; look for a division by zero"),
        ((1.0, 2.5), "In `double(1.0)`, kd is 2.5 instead of 2."),
        ((1.0,), "It should be 2 values (kp, kd), not 1."),
    ],
)
def test_a_sentence_says_which_part_it_is_about_and_keeps_its_letters(given, first):
    """The gain kp is not Kp, and "the other sign" alone would leave open of what."""
    calls = (Call((1.0,), expected=(1.0, 2.0)),)
    judge = Close(parts=("kp", "kd"))
    question = replace(DOUBLE, judge=judge, tests=(Test("two gains", calls),), mistakes=())
    assert said(lambda x: given, question).splitlines()[1].strip().startswith(first)
