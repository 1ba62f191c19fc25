"""A verdict is data: it travels as it is, is read strictly, and holds no sentence of ours."""

import json

import numpy as np
import pytest
from questions import DOUBLE, double, square

from labkit.course.marking import all_alike, mark, not_counted
from labkit.course.notebook import verdict_in, verdict_metadata
from labkit.course.serialize import read_record, record_data
from labkit.course.verdict import Kind, Outcome, Verdict
from labkit.errors import LabkitError
from labkit.formats import FORMAT, stamp


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


def test_verdicts_without_a_trial_travel_too():
    """Not counted, not attempted, lost: each is a verdict like any other."""
    for verdict in (
        not_counted(DOUBLE, ("labkit.Circle",)),
        all_alike(DOUBLE, Outcome.NOT_ATTEMPTED),
        all_alike(DOUBLE, Outcome.ERROR, Kind.OTHER),
    ):
        assert travelled(verdict) == verdict


def test_a_difference_says_what_where_and_by_how_much():
    """The expected and the found number, and the factor between them, as numbers."""
    (_, three, _) = mark(DOUBLE, lambda x: -2.0 * x).tests
    assert three.call == "double(3.0)"
    found = three.difference
    assert (found.kind, found.expected, found.found) == (Kind.NUMBERS, 6.0, -6.0)
    assert found.times == pytest.approx(-1.0)


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


def test_a_verdict_of_another_version_is_none():
    """What another labkit wrote into a notebook counts as not run."""
    metadata = verdict_metadata(mark(DOUBLE, double))
    for number in ({"format": FORMAT + 1}, {"physics": 0}):
        assert verdict_in({"metadata": {"labkit": metadata["labkit"] | number}}) is None
