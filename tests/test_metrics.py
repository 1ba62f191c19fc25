"""Metrics: numbers from a log, with the sign of target minus actual."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose

import labkit as lk
from labkit import metrics, se3
from labkit.errors import OutOfRange, TypeMismatch

errors = arrays(np.float64, (8, 3), elements=st.floats(-1.0, 1.0))


@pytest.fixture
def joint_log(ideal):
    """A run that follows joint angles and lags behind."""
    q = ideal.robot.neutral
    turn = lk.Trajectory(lk.Line(q, q + 0.2), lk.Quintic(1.0))
    return lk.run(ideal, turn, lambda s, x: lk.JointVelocity(0.5 * x.velocity), rate=1000)


@pytest.fixture
def pose_log(ideal):
    """A run whose target is a pose 10 mm above and a tenth of a radian from where the arm stays."""
    T = ideal.model.pose(ideal.robot.neutral)
    T = se3.pose(se3.rotation([0, 0, 0.1]) @ T[:3, :3], T[:3, 3] + [0, 0, 0.01])
    return lk.run(ideal, lk.Hold(T, 0.2), lambda s, x: lk.JointVelocity(np.zeros(7)), rate=100)


def test_joint_error_is_target_minus_actual(joint_log):
    """An arm that lags behind a rising target ends with errors above 0.05 rad: positive ones."""
    e = metrics.joint_error(joint_log)
    assert_allclose(e, joint_log.target.position - joint_log.q)
    assert (e[-1] > 0.05).all()


def test_tip_error_is_target_minus_actual_in_world_axes(pose_log):
    """A target 10 mm above and turned by 0.1 rad about z gives just these numbers."""
    e = metrics.tip_error(pose_log)
    assert_allclose(e, np.tile([0, 0, 0.01, 0, 0, 0.1], (len(pose_log), 1)), rtol=0, atol=1e-5)


def test_the_tip_error_of_a_joint_run_is_that_of_its_poses(joint_log):
    """It is the model's pose error between target and actual angles."""
    model = metrics.model_of(joint_log)
    e = metrics.tip_error(joint_log, model)
    for k in (0, 500, 1000):
        T_wd = model.pose(joint_log.target.position[k])
        assert_allclose(e[k], model.pose_error(T_wd, joint_log.q[k]), rtol=0, atol=1e-12)


def test_velocity_error_is_the_slope_of_the_position_error(joint_log):
    """Apart from five ticks at either end the two agree to 1 mm/s."""
    e = metrics.tip_error(joint_log)[:, :3]
    slope = np.gradient(e, joint_log.t, axis=0)
    assert_allclose(metrics.velocity_error(joint_log)[5:-5], slope[5:-5], rtol=0, atol=1e-3)


def test_a_run_after_points_is_told_how_to_make_poses_of_them(ideal):
    """No orientation was asked for, so the tip has no error of it."""
    p = ideal.model.pose(ideal.robot.neutral)[:3, 3]
    log = lk.run(ideal, lk.Hold(p, 0.1), lambda s, x: lk.JointVelocity(np.zeros(7)))
    for ask in (metrics.joint_error, metrics.tip_error, metrics.velocity_error, metrics.summary):
        with pytest.raises(TypeMismatch, match=r"points of 3 numbers.*PosePath"):
            ask(log)


def test_since_keeps_the_rows_from_a_time_on(joint_log):
    """Times, targets and states begin there; the error for a later time has the run's end."""
    rest = metrics.since(joint_log, 0.75)
    assert (rest.t[0], rest.t[-1]) == (0.75, 1.0)
    assert_allclose(rest.target.position, joint_log.target.position[750:])
    assert_allclose(rest.measured.q, joint_log.measured.q[750:])
    with pytest.raises(OutOfRange, match="t is 2 s, and this run ends at 1 s"):
        metrics.since(joint_log, 2.0)


def test_a_log_knows_its_model(joint_log):
    """The model of a log has the robot and the plant of its run."""
    model = metrics.model_of(joint_log)
    assert (model.robot.name, model.plant) == ("left", lk.IDEAL)


@given(errors, st.floats(0.01, 100.0))
def test_rms_scales_with_the_error_and_is_below_the_largest(e, k):
    """It is the root of the mean square of the rows' lengths, so k errors give k times it."""
    assert metrics.rms(k * e) == pytest.approx(k * metrics.rms(e))
    assert metrics.rms(e) <= np.linalg.norm(e, axis=1).max() * (1 + 1e-12)
    assert metrics.rms(e) == pytest.approx(np.sqrt(np.mean(np.sum(e**2, axis=1))))


def test_rms_of_a_constant_is_its_length():
    """Rows of (3, 4) give 5, and plain numbers of 2 and -2 give 2."""
    assert metrics.rms(np.tile([3.0, 4.0], (10, 1))) == pytest.approx(5.0)
    assert metrics.rms([2.0, -2.0]) == pytest.approx(2.0)


def test_settling_is_the_last_time_outside():
    """It counts from the first time, is 0 if all is inside, and infinite if the end is not."""
    t = np.arange(5.0)
    assert metrics.settling_time(t, [3, 2, 1, 0.1, 0.1], 0.5) == 3.0
    assert metrics.settling_time(t, [0, 0, 3, 0, 0], 0.5) == 3.0
    assert metrics.settling_time(t, [0, 0, 0, 0, 0], 0.5) == 0.0
    assert metrics.settling_time(t, [0, 0, 0, 0, 3], 0.5) == float("inf")
    assert metrics.settling_time(t + 7.0, [3, 0, 0, 0, 0], 0.5) == 1.0


def test_a_summary_is_what_its_parts_say(pose_log):
    """A target 10 mm and 0.1 rad away gives both, the run's effort and duration, and a sentence."""
    numbers = metrics.summary(pose_log)
    assert numbers.rms_mm == pytest.approx(10.0, abs=0.01)
    assert numbers.max_mm == pytest.approx(10.0, abs=0.01)
    assert numbers.max_deg == pytest.approx(np.degrees(0.1), abs=0.01)
    assert numbers.saturated == 0.0
    assert numbers.duration == pytest.approx(0.2)
    assert numbers.effort == pytest.approx(metrics.rms(pose_log.tau))
    assert str(numbers).startswith("RMS 10 mm, max 10 mm and 5.73 degrees")
