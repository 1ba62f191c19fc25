"""Recorded trials of gains: what was recorded, what lies between, what nobody recorded."""

import numpy as np
import pytest

from labkit.errors import OutOfRange
from labkit.study.trials import LINE, Runner, Trials, read_trials

TRIALS = Trials(("a", "b"), (1.0, 100.0), (0.0, 0.5), (((4.0, 2.0), (8.0, None)), ((1, 1), (1, 1))))


def test_between_recorded_gains_the_error_is_interpolated():
    """Evenly in the logarithm of Kp and in Kd; infinite where the arm was lost."""
    assert TRIALS.error(0, 1.0, 0.5) == 2.0
    assert TRIALS.error(0, 10.0, 0.0) == pytest.approx(6.0)
    assert TRIALS.error(0, 1.0, 0.25) == pytest.approx(3.0)
    assert TRIALS.error(0, 100.0, 0.1) == np.inf
    assert TRIALS.worst(1.0, 0.0) == 4.0


def test_what_nobody_recorded_is_a_sentence():
    for case in (2, -1, 0.5, "0"):
        with pytest.raises(OutOfRange, match=f"there are cases 0 to 1, not {case!r}"):
            TRIALS.error(case, 1.0, 0.0)
    with pytest.raises(OutOfRange, match="Kp = 200 was not recorded; take 1 to 100"):
        TRIALS.error(0, 200.0, 0.0)


def test_tries_are_counted():
    runner = Runner(TRIALS, budget=1)
    assert runner(1.0, 0.0, seed=1) == 1.0 and runner.left == 0
    with pytest.raises(OutOfRange, match="all 1 tries are used up"):
        runner(1.0, 0.0)


def test_trials_are_the_same_from_their_file(tmp_path):
    trials = read_trials(LINE)
    trials.save(tmp_path / "again.json")
    assert read_trials(tmp_path / "again.json") == trials


def test_nobody_writes_to_what_was_recorded():
    """A runner is handed to students: what one of them does to it is nothing to the next."""
    runner = Runner(read_trials(LINE))
    with pytest.raises(TypeError, match="does not support item assignment"):
        runner.trials.rms_mm[0][0][0] = 0.0
