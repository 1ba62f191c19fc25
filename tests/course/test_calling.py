"""How a student's function is asked: what it is given stays whole, what it gives is data."""

import _thread
import json
import signal
from collections import OrderedDict

import control
import numpy as np
import pytest
from questions import DOUBLE
from scipy.spatial.transform import Rotation

import labkit as lk
from labkit.course import Outcome, Response
from labkit.course import calling as reply_module
from labkit.course.calling import ArgumentChanged, LocalFunction, NoAnswer, answer, call, reply
from labkit.course.judges import Ratio
from labkit.course.marking import mark
from labkit.course.messages import message, why
from labkit.errors import LabkitError


def pops(durations, t):
    return durations.pop(0)


def writes_deep(rows):
    rows[0][0] = 5.0
    return 0


@pytest.mark.parametrize(
    ("function", "args"),
    [
        (pops, ([2.0, 0.5], 1.5)),
        (dict.clear, ({"a": 1},)),
        (writes_deep, ([[1.0]],)),
        (writes_deep, (([1.0],),)),
    ],
)
def test_what_is_changed_is_told_and_whole_again(function, args):
    """A function that writes to a list or dict hears of it, and the next call has it whole."""
    before = json.dumps(args)
    for _ in range(2):
        with pytest.raises(ArgumentChanged):
            call(function, args, {})
    assert json.dumps(args) == before
    assert mark(DOUBLE, LocalFunction(lambda x: call(function, args, {}))).outcome is Outcome.WRONG


def test_arrays_are_copies_that_can_be_written_to_and_a_change_is_told():
    """In lists, dicts, states and samples too, locked or not, and the next call has them whole."""
    a, b = np.zeros(3), np.zeros(3)
    b.setflags(write=False)
    for given in (a, b, [a], {"a": b}, lk.State(0.0, b, b), lk.Sample(a, a, a), (1.0, (a,))):

        def write(x):
            while not isinstance(x, np.ndarray):
                x = x["a"] if isinstance(x, dict) else x[-1]
            x += 1.0

        with pytest.raises(ArgumentChanged):
            call(write, (given,), {})
    assert not a.any() and not b.any()


def test_scipy_can_read_what_a_function_is_given():
    """`Rotation` reads only what it may write to, and NaN is no change."""
    R, p = np.eye(3), np.array([1.0, 2.0, 3.0])
    for x in (R, p):
        x.setflags(write=False)
    turned = call(lambda R, p, x: Rotation.from_matrix(R).apply(p), (R, p, np.full(2, np.nan)), {})
    assert np.array_equal(turned, p)
    assert call(lambda v: Rotation.from_rotvec(v).magnitude(), (p,), {}) > 0.0


class Raises:
    """Whatever is asked of it, it raises."""

    def __getattribute__(self, name):
        raise RuntimeError

    def __repr__(self):
        raise RuntimeError

    __eq__ = __hash__ = __len__ = __iter__ = __float__ = __bool__ = __repr__


class Mute(Exception):
    """Has no message."""

    def __str__(self):
        raise ValueError


class Base(BaseException):
    """Passes by whoever catches exceptions."""


def throw(error):
    def f(x):
        raise error

    return f


def deep():
    x = []
    for _ in range(100_000):
        x = [x]
    return x


ODD = [
    Raises, deep, OrderedDict,
    lambda: "\ud800" * 10_000_000, lambda: 1j, lambda: 10**5000, lambda: [[1], [1, 2]],
    lambda: {1: 2}, lambda: range(10**12), lambda: lk.State, lambda: np.array([Raises(), 1]),
    lambda: np.zeros((0, 10**9)), lambda: np.float32(4.5), lambda: np.ma.masked,
]  # fmt: skip


@pytest.mark.parametrize("make", ODD)
def test_no_answer_is_too_odd(make):
    """Whatever comes back, there is a verdict and a sentence, and it is short enough to read."""
    verdict = mark(DOUBLE, LocalFunction(lambda x: make()))
    words = str(message(DOUBLE, verdict))
    assert verdict.outcome in (Outcome.WRONG, Outcome.ERROR)
    assert len(words) < 3000 and max(map(len, words.splitlines())) < 300


@pytest.mark.parametrize(
    "error",
    [
        Mute(), Base("\ud800"), SystemExit("x" * 10_000_000), StopIteration(3),
        ValueError(Raises()), MemoryError(), LabkitError("odd"), NoAnswer("TypeError", "forged"),
    ],
)  # fmt: skip
def test_no_exception_is_too_odd(error):
    """Whatever is raised is an error of the student's code, told in a sentence."""
    verdict = mark(DOUBLE, LocalFunction(throw(error)))
    assert verdict.outcome is Outcome.ERROR
    assert len(str(message(DOUBLE, verdict))) < 3000


def test_an_answer_is_judged_as_the_data_that_a_grader_gets():
    """What cannot travel is refused here too; what can is judged as it arrives."""
    assert reply(lambda: lambda s: 1 / s, (), {})["raised"] == "NotComparable"
    given = answer(json.loads(json.dumps(reply(lambda: [np.float64(2), (1, None)], (), {}))))
    assert given == [2.0, (1, None)]


def test_a_state_space_model_is_judged_as_its_transfer_function():
    """Both have the same frequency response, which is all that counts."""
    loop = control.ss([[-20.0, 0.0], [1.0, 0.0]], [[80.0], [0.0]], [[0.0, 1.0]], [[0.0]])
    given = answer(json.loads(json.dumps(reply(lambda: loop, (), {}))))
    assert Response((1.0, 25.0), 1e-6)(given, Ratio((80.0,), (1.0, 20.0, 0.0))) is None


@pytest.mark.parametrize("interrupt", [reply_module._interrupt, _thread.interrupt_main])
def test_a_loop_without_end_is_stopped(interrupt, monkeypatch):
    """A call is stopped after its time, says so, and no further call is made; as on Windows, too.

    Ctrl-C means afterwards what it meant before.
    """
    monkeypatch.setattr(reply_module, "_interrupt", interrupt)
    calls, before = [], signal.getsignal(signal.SIGINT)

    def endless(x):
        calls.append(x)
        while True:
            pass

    verdict = mark(DOUBLE, LocalFunction(endless, seconds=0.2))
    assert verdict.outcome is Outcome.ERROR and len(calls) == 1
    assert "TimeoutError: it did not return within 0.2 s; does every" in why(verdict.tests[0])
    assert signal.getsignal(signal.SIGINT) is before
