"""Values and verdicts as JSON and back; they are read strictly."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from questions import DOUBLE, double, square

import labkit as lk
from labkit.course.marking import mark
from labkit.course.notebook import verdict_in, verdict_metadata
from labkit.course.serialize import decode, decode_answer, encode, read_record, record_data
from labkit.course.verdict import Verdict
from labkit.errors import LabkitError, TypeMismatch
from labkit.formats import stamp

Q = np.linspace(-0.5, 0.5, 7)


def there_and_back(value, read=decode):
    return read(json.loads(json.dumps(encode(value), allow_nan=False)))


plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.tuples(inner, inner)
        | st.dictionaries(st.text(), inner, max_size=3)
    ),
    max_leaves=12,
)


@given(plain)
def test_plain_data_keeps_every_bit(value):
    """Numbers, texts, lists, tuples and dicts come back equal, by either reader."""
    assert there_and_back(value) == value
    assert there_and_back(value, decode_answer) == value


@pytest.mark.parametrize("shape", [(), (0,), (7,), (6, 7), (2, 3, 4)])
def test_arrays_keep_shape_and_bits(shape):
    """Arrays come back read-only, with their shape, NaN and infinities too."""
    a = np.random.default_rng(0).standard_normal(shape)
    if a.size > 1:
        a.flat[:2] = np.nan, -np.inf
    b = there_and_back(a)
    assert b.shape == shape and np.array_equal(a, b, equal_nan=True)
    assert not b.flags.writeable


def test_trajectories_say_the_same_afterwards():
    """Paths, scalings and chains of them are rebuilt and move alike."""
    line = lk.Trajectory(lk.Line([0.6, 0.1, 0.2], [0.7, 0.0, 0.3]), lk.Quintic(2.0))
    there = lk.Hold([0.7, 0.0, 0.3], 2.0)
    ring = lk.Trajectory(lk.PosePath(lk.Circle([0.8, 0, 0], [0.6, 0, 0]), np.eye(3)), lk.Cubic(3.0))
    bent = lk.Trajectory(
        lk.paths.Spline(np.linspace(0, 1, 9), np.outer(np.arange(9), Q)), lk.Cubic(1.0)
    )
    for target in (line, ring, bent, lk.Chain([line, there]), lk.Hold(Q, 1.0)):
        again = there_and_back(target)
        for t in (0.0, 0.7, 1.9, 5.0):
            for a, b in zip(target(t), again(t), strict=True):
                assert np.array_equal(a, b)


def test_a_model_and_its_methods():
    """A model travels as side and plant, a method with it."""
    model = lk.Model("right", lk.BAXTER)
    again = there_and_back(model)
    assert np.array_equal(model.gravity(Q), again.gravity(Q))
    assert again.plant == lk.BAXTER
    assert np.array_equal(there_and_back(model.mass_matrix)(Q), model.mass_matrix(Q))


def test_a_log_is_the_same_log():
    """A run travels whole."""
    with lk.Arm() as arm:
        log = lk.run(arm, lk.Hold(arm.state().q, 0.05), lambda s, x: lk.JointVelocity(np.zeros(7)))
    again = there_and_back(log)
    assert np.array_equal(log.q, again.q) and again.command_type is lk.JointVelocity
    assert np.array_equal(log.target.position, again.target.position)
    assert np.array_equal(log.measured.dq, again.measured.dq) and again.plant == log.plant


@pytest.mark.parametrize("value", [object(), {1: 2}, np.array(["a"]), 1j, {1, 2}, open])
def test_what_cannot_travel_is_a_sentence(value):
    """Anything else is refused with a sentence, never pickled."""
    with pytest.raises(TypeMismatch, match=r"travels|compared"):
        encode(value)


@pytest.mark.parametrize(
    "data",
    [
        encode(lk.Model("left")),
        encode(lk.Hold(Q, 1.0)),
        {"$": "method", "of": 1, "name": "bit_length"},
        {"$": "Line"},
        {"$": "nonsense"},
        {"no": "kind"},
        {"$": "array", "shape": [3], "numbers": [1.0]},
        {"$": "array", "shape": [1], "numbers": [{"$": "float", "value": "spam"}]},
        {"$": "JointVelocity", "value": 1.0},
        {"$": "tuple", "items": 3},
        {"$": "dict", "items": 3},
        {"$": "array", "shape": [float("inf")], "numbers": [1.0]},
        {"$": "array", "shape": [1], "numbers": [10**400]},
    ],
)
def test_answers_build_only_data(data):
    """An answer written by somebody else cannot build machinery, and garbage is a sentence."""
    with pytest.raises(TypeMismatch):
        decode_answer(data)


def travelled(verdict):
    return read_record(Verdict, json.loads(json.dumps(record_data(verdict), allow_nan=False)))


@pytest.mark.parametrize(
    "answer",
    [
        double, square, lambda x: None, lambda x: "twice", lambda x: [x, x], lambda x: 1 / 0,
        lambda x: np.nan, lambda x: np.inf, lambda x: np.ones((2, 3)), lambda x: object(),
    ],
)  # fmt: skip
def test_any_verdict_survives_its_json(answer):
    """Whatever an answer is, what came of it is read back equal, and has no NaN in it."""
    verdict = mark(DOUBLE, answer)
    assert travelled(verdict) == verdict
    assert verdict_in({"metadata": verdict_metadata(verdict)}) == verdict


@pytest.mark.parametrize(
    "change",
    [{"earned": "4"}, {"earned": -1.0}, {"outcome": "perfect"}, {"name": "../up"}, {"tests": {}},
     {"tests": [{"name": 1}]}, {"mistake": "squared"}, {"withheld": [1]}],
)  # fmt: skip
def test_what_is_not_a_verdict_is_refused(change):
    """A field of another type or beyond its range is refused; a notebook's output shows nothing."""
    data = record_data(mark(DOUBLE, square)) | change
    with pytest.raises(LabkitError):
        read_record(Verdict, data)
    assert verdict_in({"metadata": {"labkit": stamp() | {"verdict": data}}}) is None
