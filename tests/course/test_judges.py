"""Judges: the same, or how it differs."""

import json

import numpy as np
import pytest
from questions import says

import labkit as lk
from labkit.course import (
    AtMost,
    AtTip,
    Call,
    Close,
    Gains,
    Letter,
    Outcome,
    Question,
    Response,
    Test,
    TipTorque,
    question_data,
    read_question,
)
from labkit.course.judges import MOST_COEFFICIENTS, UNSAID, Ratio, as_expected, factor, value
from labkit.course.marking import mark
from labkit.course.verdict import Kind
from labkit.errors import OutOfRange

CLOSE = Close(rtol=1e-6, atol=1e-9)
V = np.array([1.0, 2.0, 3.0])


@pytest.mark.parametrize("answer", [V, [1, 2, 3], (1.0, 2.0, 3.0), V + 1e-7, np.float32(V)])
def test_lists_and_rounding_are_the_same(answer):
    """Whatever numpy reads as the same numbers passes."""
    assert CLOSE(answer, V) is None


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (V + 1e-3, "expected"),
        (V[:, None], "shape"),
        (V[:2], "shape"),
        (None, "expected 3 real numbers"),
        ("abc", "real numbers"),
        ([1, 2, np.nan], "nan"),
        ([1, 2, np.inf], "inf"),
        (np.float64("nan"), "shape"),
        (lk.JointVelocity(np.zeros(7)), "the answer should be plain numbers, not a JointVelocity"),
        ([[1], [2, 3]], "different lengths"),
    ],
)
def test_differences_are_sentences(answer, words):
    """A wrong shape, a NaN, a missing return: each says what came."""
    assert words in says(CLOSE(answer, V))


def test_a_command_is_asked_for_by_name():
    """Plain numbers are told how to become a command, another command is called by its name."""
    velocity = lk.JointVelocity(np.zeros(7))
    assert CLOSE(lk.JointVelocity(np.zeros(7)), velocity) is None
    for answer, found in ((np.ones(7), ""), (lk.JointTorque(np.ones(7)), "JointTorque")):
        differs = CLOSE(answer, velocity)
        assert (differs.kind, differs.expected, differs.found) == (
            Kind.TYPE,
            "JointVelocity",
            found,
        )
    assert CLOSE(lk.JointVelocity(np.ones(7)), velocity).kind is Kind.NUMBERS


def test_mistakes_are_alike_within_a_rounding():
    """A mistake is known by its number, however far it was written out; an answer is not."""
    assert CLOSE.same(1.96 * V, 1.959964 * V) and CLOSE(1.96 * V, 1.959964 * V) is not None


def test_numbers_are_numbers():
    """Python's, numpy's and zero-dimensional arrays are one number; None is not."""
    for answer in (2, 2.0, np.float64(2.0), np.int64(2), np.array(2.0)):
        assert CLOSE(answer, 2.0) is None
    assert "got 3" in says(CLOSE(3.0, 2.0))
    assert CLOSE(None, 2.0) is not None
    assert CLOSE(float("nan"), 2.0) is not None


def test_parts_are_named():
    """In a tuple the part that differs is called by its name; too few parts are counted."""
    judge = Close(parts=("s", "ds", "dds"))
    assert judge((1.0, 2.0, 3.0), (1.0, 2.0, 3.0)) is None
    assert says(judge([1.0, 2.0, 4.0], (1.0, 2.0, 3.0))).startswith("dds")
    assert "3 values (s, ds, dds), not 2" in says(judge((1.0, 2.0), (1.0, 2.0, 3.0)))
    assert "3 values" in says(judge(1.0, (1.0, 2.0, 3.0)))


def test_samples_tables_and_texts():
    """A tuple passes for a sample; a dict misses a key; a text is compared as it is."""
    sample = lk.Sample(V, V, V)
    assert CLOSE((V, V, V), sample) is None
    assert says(CLOSE((V, V, 2 * V), sample)).startswith("acceleration")
    assert "'b' is missing" in says(CLOSE({"a": 1.0}, {"a": 1.0, "b": 2.0}))
    assert CLOSE("yes", "yes") is None
    assert CLOSE("no", "yes") is not None
    assert CLOSE(1, True) is not None


def test_a_letter_is_one_of_some_and_not_told():
    """Where nothing is expected any of them will do; no message holds the right one."""
    judge = Letter("abh-")
    assert judge("A", "a") is None and judge("-", "-") is None and judge("h", UNSAID) is None
    assert "a" not in judge("b", "a").found.split()
    for odd in ("?", "x", "ab", 1, None):
        assert judge(odd, UNSAID).kind is Kind.REFUSED


def test_at_most():
    """The first measure beyond its limit is told with its unit; NaN is beyond any."""
    judge = AtMost()
    assert judge({"max_mm": 1.0, "effort": 2.0}, {"max_mm": 1.5}) is None
    found = judge({"max_mm": 2.0}, {"max_mm": 1.5})
    assert (found.kind, found.part, found.found) == (Kind.MEASURE, "max_mm", 2.0)
    assert judge({"max_mm": float("nan")}, {"max_mm": 1.5}) is not None


def test_a_mistake_that_is_not_a_number_is_known_by_it():
    """NaN where the known mistake has NaN; a right answer is no such mistake."""
    nan = np.array([1.0, np.nan, 3.0])
    assert CLOSE.same(nan, nan) and CLOSE(nan, V) is not None
    assert not CLOSE.same(V, nan) and not CLOSE.same(nan, V)


def at_tip():
    """An arm's torque as the tip feels it, and a joint acceleration that it does not feel."""
    model = lk.Model("left", lk.BAXTER)
    q = model.robot.ready + 0.1
    M, J = model.mass_matrix(q), model.tip_jacobian(q)
    unfelt = np.linalg.svd(J)[2][-1]
    tau = np.linspace(-20.0, 30.0, 7)
    return TipTorque(tau, np.linalg.solve(M, J.T).T, unfelt), M @ unfelt


def test_torques_are_judged_by_what_the_tip_does():
    """Any torque with the expected acceleration of the tip is right, and none with another."""
    judge, (expected, unfelt) = AtTip(), at_tip()
    assert np.linalg.norm(unfelt) > 0.05, "a torque of which the joints feel a good deal"
    for share in (0.0, 1.0, -30.0):
        answer = lk.JointTorque(expected.value + share * unfelt)
        assert judge(answer, expected) is None
    for joint in np.eye(7):
        answer = lk.JointTorque(expected.value + 0.01 * joint)
        words = says(judge(answer, expected))
        assert (
            words.startswith("expected [")
            and "or any that moves the tip in the same way, got [" in words
        )


def test_a_question_of_torques_travels():
    """Its expected answers come out of JSON as they went in."""
    expected, unfelt = at_tip()
    test = Test("torques", (Call((1.0,), expected=expected),))
    question = Question("torque", 1.0, "Give a torque.", AtTip(), (test,))
    again = read_question(json.loads(json.dumps(question_data(question))))
    answer = lk.JointTorque(expected.value + unfelt)
    assert mark(again, lambda x: answer).outcome is Outcome.RIGHT


def test_a_known_mistake_is_known_beside_a_damper_that_moves_the_tip():
    """What a damper behind I - pinv(J) J adds hides no mistake; the answer is still not right."""
    judge, (expected, _) = AtTip(), at_tip()
    assert np.abs(expected.accelerates @ expected.elbow).max() > 0.1, "the tip feels it"
    braked = lk.JointTorque(expected.value - 3.0 * expected.elbow)
    assert judge(braked, expected) is not None and judge.same(braked, expected)
    for joint in np.eye(7):
        assert not judge.same(lk.JointTorque(braked.value + 0.1 * joint), expected)


NAN = float("nan")


@pytest.mark.parametrize(
    ("shown", "as_value"),
    [
        (3, 3.0),
        (np.float32(0.5), 0.5),
        (np.arange(3), (0.0, 1.0, 2.0)),
        (np.eye(3), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
        (np.arange(10), "array([0, 1, 2, 3, 4, 5, 6, 7, 8, 9])"),
        (np.zeros((1, 1, 1)), "array([[[0.]]])"),
        (NAN, "nan"),
        (True, "True"),
        ("x" * 58, repr("x" * 58)),
        ("x" * 59, f"'{'x' * 56}..."),
        ([1,  2], "[1, 2]"),
    ],
)  # fmt: skip
def test_a_value_is_a_few_finite_numbers_or_a_short_text(shown, as_value):
    """Nine numbers in at most two dimensions, or sixty characters."""
    assert value(shown) == as_value


@pytest.mark.parametrize(
    ("a", "b", "times"),
    [
        ([2.0, 4.0], [1.0, 2.0], 2.0),
        ([-1.0, 0.0], [1.0, 0.0], -1.0),
        ([0.0, 0.0], [1.0, 2.0], 0.0),
        ([2.0, 5.0], [1.0, 2.0], None),
        ([1.0, 1e-3], [1.0, 0.0], None),
        ([1.0, 2.0], [0.0, 0.0], None),
    ],
)
def test_a_factor_is_that_of_all_numbers(a, b, times):
    """None where there is none, or nothing to multiply."""
    assert factor(np.array(a), np.array(b)) == times


@pytest.mark.parametrize(
    ("kp", "alike"), [(40.0, True), (59.0, True), (61.0, False), (27.0, True), (26.0, False)]
)
def test_gains_are_alike_within_half_as_much_again(kp, alike):
    """Either way, and what is no pair of gains is like none."""
    assert Gains().same((kp, 5.0), (40.0, 5.0)) == alike
    assert not Gains().same((kp,), (40.0, 5.0))


@pytest.mark.parametrize(
    ("answer", "right"), [(1.0 + 0.9e-6, True), (1.0 + 2e-6, False), (NAN, False), (None, False)]
)
def test_the_tolerance_is_relative_and_absolute(answer, right):
    """Of the expected value, of a command's numbers, and of each entry of a dict."""
    judge = Close(rtol=1e-6, atol=0.0)
    assert (judge(answer, 1.0) is None) == right
    assert (judge({"a": answer}, {"a": 1.0}) is None) == right
    assert judge({"b": 1.0}, {"a": 1.0}) is not None
    if answer is not None and answer == answer:
        command = lk.JointTorque(np.full(7, answer))
        assert (judge(command, lk.JointTorque(np.ones(7))) is None) == right
        assert judge(command, lk.JointVelocity(np.ones(7))) is not None


def test_a_polynomial_has_at_most_fifty_coefficients():
    """A longer one would take a judge long."""
    assert Ratio((1.0,) * MOST_COEFFICIENTS, (1.0,))(1.0) == MOST_COEFFICIENTS
    with pytest.raises(OutOfRange):
        Ratio((1.0,), (1.0,) * (MOST_COEFFICIENTS + 1))


def test_only_a_torque_is_compared_at_the_tip():
    """The answer of a known mistake takes the form of the expected one; others stay."""
    expected, _ = at_tip()
    torque, speed = lk.JointTorque(np.ones(7)), lk.JointVelocity(np.ones(7))
    assert np.array_equal(as_expected(torque, expected).value, torque.value)
    assert as_expected(torque, expected).elbow is expected.elbow
    assert as_expected(speed, expected) is speed and as_expected(torque, V) is torque


@pytest.mark.parametrize("other", [1.001 * V, 1.5 * V, V[:2], None, object(), "abc"])
def test_what_differs_is_not_the_same(other):
    """By more than a rounding, in shape, or in kind."""
    assert not CLOSE.same(V, other) and not CLOSE.same(other, V)


def test_a_transfer_function_is_judged_by_its_response():
    """At each frequency, within the tolerance of its size; whatever else is told what it is."""
    judge, right = Response((1.0, 10.0), rtol=0.02), Ratio((2.0,), (1.0, 1.0))
    for answer, kind in (
        (Ratio((2.03,), (1.0, 1.0)), None),
        (Ratio((4.0,), (2.0, 2.0)), None),
        (Ratio((2.05,), (1.0, 1.0)), Kind.RESPONSE),
        (Ratio((2.0,), (1.0, 1.05)), Kind.RESPONSE),
        (lambda s: 2.0 / (s + 1.0), Kind.TYPE),
    ):
        found = judge(answer, right)
        assert (found and found.kind) == kind
    assert judge.same(right, right) and not judge.same(right, Ratio((3.0,), (1.0, 1.0)))


def test_a_position_alone_is_no_sample():
    """It is told that parts are missing; three rows of an array are three parts."""
    sample = lk.Sample(V, V, V)
    assert CLOSE(V, sample).kind is Kind.PARTS
    assert CLOSE(np.stack([V, V, V]), sample) is None


def test_motions_are_compared_up_to_a_quarter_beyond_their_end():
    """Another path, another duration and a sample in its place are told."""
    a, b, c = np.zeros(3), V, V[::-1].copy()
    line = lk.Trajectory(lk.Line(a, b), lk.Quintic(2.0))
    assert CLOSE(lk.Trajectory(lk.Line(a, b), lk.Quintic(2.0)), line) is None
    for other in (lk.Line(a, c), lk.Quintic(2.0)), (lk.Line(a, b), lk.Quintic(2.2)):
        assert "of the line at" in CLOSE(lk.Trajectory(*other), line).part
    assert CLOSE(line(0.0), line).kind is Kind.TYPE
