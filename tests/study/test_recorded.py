"""Logs as files."""

import numpy as np
import pytest

import labkit as lk
from labkit import metrics
from labkit.study import recorded, tasks


def test_a_saved_log_reads_back_to_single_precision(tmp_path):
    task = tasks.line()

    def forward(state, target):
        return lk.JointVelocity(target.velocity)

    with lk.Arm(plant=lk.BAXTER, q0=task.q0) as arm:
        log = lk.run(arm, task.joints, forward, duration=0.5)
    recorded.save(log, tmp_path / "run.npz")
    back = recorded.load(tmp_path / "run.npz")
    for name in ("t", "q", "dq", "tau", "command", "saturated"):
        np.testing.assert_allclose(getattr(back, name), getattr(log, name), rtol=1e-6, atol=1e-7)
    np.testing.assert_allclose(back.measured.dq, log.measured.dq, rtol=1e-6, atol=1e-7)
    assert (back.plant, back.side, back.controller) == (log.plant, log.side, "forward")
    assert back.command_type is lk.JointVelocity
    assert metrics.summary(back).rms_mm == pytest.approx(metrics.summary(log).rms_mm, rel=1e-3)


def test_every_recording_that_ships_is_a_run_one_can_study():
    assert recorded.names()
    for name in recorded.names():
        assert metrics.summary(recorded.recorded(name)).rms_mm < 100.0


def test_an_unknown_recording_is_a_sentence_with_the_known_ones():
    with pytest.raises(
        lk.errors.UnknownName, match="no recorded run 'bsaeline'; there is 'baseline"
    ):
        recorded.recorded("bsaeline")
