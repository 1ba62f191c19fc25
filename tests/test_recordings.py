"""Recorded runs and trials: what was recorded, what lies between, what nobody recorded."""

import dataclasses

import numpy as np
import pytest

import labkit as lk
from labkit import metrics, recordings
from labkit.errors import OutOfRange
from labkit.recordings import LINE, Runner, Trials, read_trials
from solutions.study import tasks
from solutions.study.recording import save_trials


def test_a_saved_log_reads_back_to_single_precision(tmp_path):
    """Columns agree to 1e-6 and the RMS error to 0.1 %; plant, robot and names are the same."""
    task = tasks.line()

    def forward(state, target):
        return lk.JointVelocity(target.velocity)

    with lk.Arm(plant=lk.BAXTER, q0=task.q0) as arm:
        log = lk.run(arm, task.joints, forward, duration=0.5)
    log.save(tmp_path / "run.npz", single=True)
    back = lk.Log.load(tmp_path / "run.npz")
    for name in ("t", "q", "dq", "tau", "command", "saturated"):
        np.testing.assert_allclose(getattr(back, name), getattr(log, name), rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(back.measured.dq, log.measured.dq, rtol=1e-6, atol=1e-7)
    assert (back.plant, back.robot.name, back.controller) == (log.plant, log.robot.name, "forward")
    assert back.command_type is lk.JointVelocity
    assert metrics.summary(back).rms_mm == pytest.approx(metrics.summary(log).rms_mm, rel=1e-3)


def short():
    with lk.Arm(REPLACED, q0=REPLACED.ready) as arm:
        return lk.run(arm, lk.Hold(REPLACED.ready, 0.02), lk.control.hold(REPLACED.ready))


REPLACED = dataclasses.replace(lk.robot("left"), T_hand_camera=np.eye(4))


def test_what_was_replaced_in_a_robot_is_saved_with_its_log(tmp_path):
    """Such as the place of the hand's camera in Baxter's left arm."""
    short().save(tmp_path / "run.npz")
    back = lk.Log.load(tmp_path / "run.npz")
    assert back.robot.data() == REPLACED.data()


def test_every_recording_that_ships_is_a_run_one_can_study():
    """There is at least one, and each has an RMS error below 100 mm."""
    assert recordings.names()
    for name in recordings.names():
        assert metrics.summary(recordings.load(name)).rms_mm < 100.0


TRIALS = Trials(("a", "b"), (1.0, 100.0), (0.0, 0.5), (((4.0, 2.0), (8.0, None)), ((1, 1), (1, 1))))


def test_between_recorded_gains_the_error_is_interpolated():
    """Evenly in the logarithm of Kp and in Kd; infinite where none was recorded."""
    assert TRIALS.error(0, 1.0, 0.5) == 2.0
    assert TRIALS.error(0, 10.0, 0.0) == pytest.approx(6.0)
    assert TRIALS.error(0, 1.0, 0.25) == pytest.approx(3.0)
    assert TRIALS.error(0, 100.0, 0.1) == np.inf
    assert TRIALS.worst(1.0, 0.0) == 4.0


def test_tries_are_counted():
    """With a budget of one the second try is refused."""
    runner = Runner(TRIALS, budget=1)
    assert runner(1.0, 0.0, seed=1) == 1.0 and runner.left == 0
    with pytest.raises(OutOfRange, match="all 1 tries are used up"):
        runner(1.0, 0.0)


def test_trials_are_the_same_from_their_file(tmp_path):
    """The trials that ship are equal after they are saved and read again."""
    trials = read_trials(LINE)
    save_trials(trials, tmp_path / "again.json")
    assert read_trials(tmp_path / "again.json") == trials


def test_nobody_writes_to_what_was_recorded():
    """A runner is handed to students: what one of them does to it is nothing to the next."""
    runner = Runner(read_trials(LINE))
    with pytest.raises(TypeError, match="does not support item assignment"):
        runner.trials.rms_mm[0][0][0] = 0.0
