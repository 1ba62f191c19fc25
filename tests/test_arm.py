"""The arm: holds, obeys, keeps its limits, and says what it will not do."""

import os
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import labkit as lk
from labkit.errors import (
    ControllerError,
    JointLimitExceeded,
    LabkitError,
    NotFinite,
    ShapeError,
)


@pytest.fixture
def arm(side):
    """Each ideal arm at rest in its neutral pose."""
    with lk.Arm(side) as arm:
        yield arm


def test_it_starts_at_rest_in_rethinks_neutral_pose(arm):
    """At t = 0 its angles are exactly the neutral ones and its speeds exactly zero."""
    t, q, dq, _ = arm.state()
    assert t == 0.0
    assert_array_equal(q, arm.robot.neutral)
    assert_array_equal(dq, np.zeros(7))


@pytest.mark.parametrize("mode", ["position", "velocity", "torque"])
def test_it_holds_the_neutral_pose_in_each_mode_with_torque_to_spare(arm, mode):
    """After 1 s it is within 1e-4 rad, and never took 60 % of a motor's torque."""
    q = arm.robot.neutral
    command = {
        "position": lk.JointPosition(q),
        "velocity": lk.JointVelocity(np.zeros(7)),
        "torque": lk.JointTorque(arm.model.gravity(q)),
    }[mode]
    for _ in range(10):
        arm.apply(command)
        arm.world.step(100)
        assert (np.abs(arm.torque) < 0.6 * arm.robot.effort).all()
    assert_allclose(arm.state().q, q, rtol=0, atol=1e-4)
    assert_allclose(arm.torque, arm.model.gravity(q), rtol=0, atol=0.02)
    assert not arm.saturated


def steps():
    """A step of 0.3 rad for each joint alone, and for all of them together."""
    return [*(0.3 * np.eye(7)), np.full(7, 0.3)]


@pytest.mark.parametrize("plant", [lk.IDEAL, lk.BAXTER], ids=lambda plant: plant.name)
@pytest.mark.parametrize("step", steps(), ids=[*"1234567", "all"])
def test_a_step_of_position_settles_without_ringing(side, plant, step):
    """Its motors brake in time: overshoot below 1 % of the step, within 1 % after 0.5 s."""
    with lk.Arm(side, plant) as arm:
        q0 = arm.robot.neutral
        step = np.where((q0 + step < arm.robot.upper), step, -step)
        arm.apply(lk.JointPosition(q0 + step))
        over = []
        for _ in range(500):
            arm.world.step()
            over.append(np.sign(step) * (arm.truth().q - q0 - step))
        moved = step != 0.0
        assert np.max(over, axis=0)[moved].max() <= 0.003
        assert np.abs(over[-1][moved]).max() <= 0.003


def test_it_turns_at_a_speed(arm):
    """After 0.1 s it has the speed to 1e-4 rad/s, and it covers the angles that the speed gives."""
    speed = np.array([0.2, -0.1, 0.3, 0.1, -0.4, 0.2, 0.5])
    arm.apply(lk.JointVelocity(speed))
    arm.world.step(100)
    assert_allclose(arm.state().dq, speed, rtol=0, atol=1e-4)
    before = arm.state().q
    arm.world.step(100)
    assert_allclose(arm.state().q, before + 0.1 * speed, rtol=0, atol=1e-5)


def test_a_torque_accelerates_it_as_the_equations_of_motion_say(arm):
    """In the first step from rest the acceleration is M^-1 (tau - g)."""
    tau = arm.model.gravity(arm.robot.neutral) + [1.0, -1.0, 0.5, 0.5, 0.2, -0.2, 0.1]
    arm.apply(lk.JointTorque(tau))
    arm.world.step()
    M, g = arm.model.mass_matrix(arm.robot.neutral), arm.model.gravity(arm.robot.neutral)
    assert_allclose(arm.state().dq / arm.world.dt, np.linalg.solve(M, tau - g), rtol=0, atol=1e-6)
    assert_array_equal(arm.torque, tau)


def test_speeds_and_torques_beyond_the_limits_are_cut_and_it_says_so(arm):
    """A command beyond a limit is cut to it and sets saturated; one at the limit does not."""
    arm.apply(lk.JointTorque(np.full(7, 1e3)))
    assert arm.saturated
    arm.world.step()
    assert_array_equal(arm.torque, arm.robot.effort)
    arm.apply(lk.JointVelocity(np.full(7, -9.0)))
    assert arm.saturated
    arm.apply(lk.JointTorque(arm.robot.effort))
    assert not arm.saturated
    arm.apply(lk.JointVelocity(-arm.robot.speed))
    assert not arm.saturated


def test_the_motors_never_give_more_than_their_limits(arm):
    """Torque keeps its limits for 20 steps at full speed and 20 at full speed the other way."""
    for sign in (1.0, -1.0):
        arm.apply(lk.JointVelocity(sign * arm.robot.speed))
        for _ in range(20):
            arm.world.step()
            assert (np.abs(arm.torque) <= arm.robot.effort * (1 + 1e-9)).all()


def test_after_the_command_timeout_it_holds_its_place(arm):
    """As Rethink's arm does after 0.2 s: a program that hangs does not keep the arm moving."""
    arm.apply(lk.JointVelocity(np.full(7, 0.2)))
    arm.world.step(200)
    assert_allclose(arm.state().dq, np.full(7, 0.2), rtol=0, atol=1e-4)
    arm.world.step(50)
    place = arm.state().q
    arm.world.step(1000)
    assert_allclose(arm.state().q, place, rtol=0, atol=2e-3)
    assert_allclose(arm.state().dq, np.zeros(7), rtol=0, atol=1e-4)


def test_reset_puts_it_anywhere_at_rest(arm):
    """A moving arm has exactly the new angles and no speed, stays there, and returns to neutral."""
    arm.apply(lk.JointVelocity(np.full(7, 0.5)))
    arm.world.step(100)
    arm.reset(arm.robot.ready)
    assert_array_equal(arm.state().q, arm.robot.ready)
    assert not arm.state().dq.any()
    arm.world.step(100)
    assert_allclose(arm.state().q, arm.robot.ready, rtol=0, atol=1e-5)
    arm.reset()
    assert_array_equal(arm.state().q, arm.robot.neutral)


BAD = [
    (np.zeros((7, 1)), ShapeError, "ravel"),
    (np.zeros(6), ShapeError, "give 7 numbers"),
    (np.full(7, np.nan), NotFinite, "nan at index 0"),
    ("neutral", LabkitError, "neutral"),
    (np.full(7, 3.0), JointLimitExceeded, r"_s0 at 3 rad is outside \[-1\.702, 1\.702\] rad"),
    (np.full(7, -57.0), JointLimitExceeded, "in degrees"),
]


@pytest.mark.parametrize(("q", "error", "words"), BAD)
def test_angles_that_cannot_be_are_refused_and_the_arm_stays_usable(arm, q, error, words):
    """Reset, JointPosition and a new Arm name what is wrong, and the arm holds its pose."""
    for use in (arm.reset, lambda q: arm.apply(lk.JointPosition(q)), lambda q: lk.Arm(q0=q)):
        with pytest.raises(error, match=words) as caught:
            use(q)
        assert isinstance(caught.value, LabkitError)
    arm.world.step(50)
    assert_allclose(arm.state().q, arm.robot.neutral, rtol=0, atol=1e-5)


@pytest.mark.parametrize("command", [None, np.zeros(7), [0.0] * 7, "stop", lk.JointTorque])
def test_what_is_no_command_is_refused_with_those_that_are(arm, command):
    """The error lists the commands in under 300 characters, and the arm holds its pose."""
    with pytest.raises(ControllerError, match=r"not a command.*JointPosition, JointV") as caught:
        arm.apply(command)
    assert len(str(caught.value)) < 300
    arm.world.step(50)
    assert_allclose(arm.state().q, arm.robot.neutral, rtol=0, atol=1e-5)


def test_it_leaves_no_file_that_somebody_could_take_away(tmp_path):
    """A cleaner of temporary folders, or the end of a forked process, harms no later arm."""
    program = (
        "import labkit, os, tempfile; arm = labkit.Arm(); print(os.listdir(tempfile.gettempdir()))"
    )
    words = [sys.executable, "-W", "error", "-c", program]
    env = os.environ | {"TMPDIR": str(tmp_path)}
    done = subprocess.run(words, capture_output=True, text=True, check=True, env=env)
    assert (done.stdout.strip(), done.stderr) == ("[]", "")
