"""Run: the loop does what the textbook says, and names whoever breaks it."""

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import labkit as lk
from labkit.errors import ControllerError, Diverged, TypeMismatch

WAY = np.array([0.4, 0.2, -0.3, 0.3, 0.2, -0.3, 0.4])


def computed_torque(model, kp=100.0, kd=20.0):
    """Tau = M (ddq_d + Kp e + Kd de) + C dq + g (MLS eq. 4.47)."""

    def controller(state, target):
        e, de = target.position - state.q, target.velocity - state.dq
        ddq = target.acceleration + kp * e + kd * de
        return lk.JointTorque(model.mass_matrix(state.q) @ ddq + model.bias(state.q, state.dq))

    return controller


def swing(arm, seconds=5.0):
    q0 = arm.robot.neutral
    way = WAY if arm.robot.name == "left" else -WAY * [1, -1, 1, -1, 1, -1, 1]
    return lk.Trajectory(lk.Line(q0, q0 + way), lk.Quintic(seconds))


def follow(state, target):
    return lk.JointPosition(target.position)


def still(arm, seconds=0.2):
    return lk.Hold(arm.robot.neutral, seconds)


# What it does


def test_computed_torque_follows_a_smooth_trajectory_to_5e_5_rad(side):
    """Ideal plant, 1 kHz, 5 s: nothing is left but the integrator's own step."""
    with lk.Arm(side) as arm:
        log = lk.run(arm, swing(arm), computed_torque(arm.model), rate=1000)
    assert np.abs(lk.metrics.joint_error(log)).max() <= 5e-5
    assert not log.saturated.any()


def test_a_log_has_a_row_for_each_tick_and_both_ends(ideal):
    """Half a second at 100 Hz gives 51 rows in each column, and the log knows who ran."""
    log = lk.run(ideal, still(ideal, 0.5), follow, rate=100)
    assert len(log) == 51
    assert_allclose(log.t, np.arange(51) * 0.01, rtol=0, atol=1e-12)
    for rows in (log.q, log.dq, log.tau, log.command, log.measured.q, log.target.position):
        assert rows.shape == (51, 7)
    assert log.saturated.shape == (51,)
    assert log.command_type is lk.JointPosition
    assert (log.controller, log.plant, log.robot.name) == ("follow", lk.IDEAL, "left")


def test_a_log_cannot_be_written_to(ideal):
    """Each column is read-only, and none can be replaced."""
    log = lk.run(ideal, still(ideal), follow)
    arrays = [log.t, log.q, log.dq, log.tau, log.command, log.saturated, *log.target, *log.measured]
    for rows in arrays:
        with pytest.raises(ValueError, match="read-only"):
            rows[0] = 0
    with pytest.raises(dataclasses.FrozenInstanceError):
        log.t = log.t


def test_the_torque_in_a_row_is_what_drove_the_arm_until_the_next_one(ideal):
    """It is the row's own command, and in the last row that of the row before."""
    log = lk.run(ideal, swing(ideal, 1.0), computed_torque(ideal.model), rate=1000)
    assert_array_equal(log.tau[:-1], log.command[:-1])
    assert_array_equal(log.tau[-1], log.tau[-2])


def test_at_a_slower_rate_the_command_is_held_between_ticks(ideal):
    """At 50 Hz the controller is asked at every 20 ms, both ends of 0.1 s included."""
    calls = []

    def controller(state, target):
        calls.append(state.t)
        return lk.JointVelocity(np.full(7, 0.1))

    lk.run(ideal, still(ideal, 0.1), controller, rate=50)
    assert_allclose(calls, np.arange(6) * 0.02, rtol=0, atol=1e-12)
    assert ideal.world.t == pytest.approx(0.1)


def test_a_second_run_starts_its_own_clock_where_the_arm_is(ideal):
    """Its times begin at 0 and its angles at the arm's, while the state's own time goes on."""
    lk.run(ideal, swing(ideal, 0.5), follow)
    q = ideal.state().q
    log = lk.run(ideal, lk.Hold(q, 0.1), follow)
    assert log.t[0] == 0.0
    assert_array_equal(log.q[0], q)
    assert log.measured.t[0] == pytest.approx(0.5)


def test_poses_are_logged_as_poses(ideal):
    """A target of poses gives 4 x 4 matrices and twists of six, one for each row."""
    T = ideal.model.pose(ideal.robot.neutral)
    log = lk.run(ideal, lk.Hold(T, 0.1), lambda s, x: lk.JointVelocity(np.zeros(7)), rate=100)
    assert isinstance(log.target, lk.PoseSample)
    assert log.target.pose.shape == (11, 4, 4)
    assert log.target.twist.shape == (11, 6)
    assert_array_equal(log.target.pose[5], T)


def test_a_target_of_plain_lists_is_read(ideal):
    """A sample made of lists is logged as numbers."""
    zeros = [0.0] * 7
    log = lk.run(ideal, lambda t: lk.Sample([t] * 7, zeros, zeros), follow, duration=0.1)
    assert_allclose(log.target.position[:, 0], log.t)


@pytest.mark.parametrize("dtype", [int, np.float32, ">f8", float])
@pytest.mark.parametrize("order", ["rows", "columns"])
def test_numbers_are_logged_as_what_they_mean_however_they_lie_in_memory(ideal, dtype, order):
    """The log keeps bytes: whole numbers, single precision and columns of a table are numbers."""
    table = np.zeros((7, 3), dtype).T if order == "columns" else np.zeros((3, 7), dtype)
    table[:] = [[0] * 7, [1] * 7, [2] * 7]
    seen = []

    def controller(state, target):
        seen.append(target)
        return lk.JointVelocity(np.zeros(7))

    log = lk.run(ideal, lambda t: lk.Sample(*table), controller, duration=0.05)
    for k, part in enumerate(log.target):
        assert_array_equal(part, np.full((len(log), 7), float(k)))
    assert_array_equal(log.target.velocity, [target.velocity for target in seen])


def test_a_target_that_writes_on_its_own_array_does_not_rewrite_history(ideal):
    """Each row keeps its position though the target reuses one array."""
    buffer = np.zeros((3, 7))

    def target(t):
        buffer[0] = t
        return lk.Sample(*buffer)

    log = lk.run(ideal, target, follow, duration=0.1)
    assert_allclose(log.target.position[:, 0], log.t)


def test_a_run_may_last_no_time_at_all(ideal):
    """A duration of zero gives one row, of the arm where it is."""
    log = lk.run(ideal, still(ideal, 0.0), follow)
    assert len(log) == 1
    assert_array_equal(log.q[0], ideal.robot.neutral)


@pytest.mark.parametrize("plant", [lk.IDEAL, lk.BAXTER])
def test_a_controller_that_writes_on_what_it_sees_changes_neither_arm_nor_log(plant):
    """State and sample are its own: SciPy, which writes to what it gets, may have them."""

    def tidy(state, target):
        return lk.JointPosition(target.position)

    def writes(state, target):
        command = lk.JointPosition(target.position)
        for part in (*state[1:], *target):
            part[:] = 7.0
        return command

    logs = []
    for controller in (tidy, writes):
        with lk.Arm(plant=plant, seed=1) as arm:
            logs.append(lk.run(arm, swing(arm, 0.1), controller))
    for name in ("q", "command"):
        assert_array_equal(getattr(logs[0], name), getattr(logs[1], name))
    assert_array_equal(logs[0].measured.q, logs[1].measured.q)
    assert_array_equal(logs[0].target.position, logs[1].target.position)


def test_an_interrupt_ends_the_run_and_keeps_what_there_is(ideal):
    """Ctrl+C in the eleventh tick leaves a log of ten, and an arm at rest that runs again."""

    def controller(state, target):
        if state.t > 0.0995:
            raise KeyboardInterrupt
        return follow(state, target)

    log = lk.run(ideal, still(ideal, 1.0), controller, rate=100)
    assert len(log) == 10
    assert_stopped(ideal)


def test_the_same_seed_gives_the_same_log():
    """Angles and noise are equal to the bit with one seed, and the noise differs with another."""
    logs = []
    for seed in (1, 1, 2):
        with lk.Arm(plant=lk.BAXTER, seed=seed) as arm:
            logs.append(lk.run(arm, swing(arm, 0.5), follow))
    assert_array_equal(logs[0].measured.dq, logs[1].measured.dq)
    assert_array_equal(logs[0].q, logs[1].q)
    assert (logs[0].measured.dq != logs[2].measured.dq).any()


# What it refuses


def assert_stopped(arm):
    """At rest soon, and ready for the next run."""
    arm.world.step(100)
    assert_allclose(arm.state().dq, np.zeros(7), rtol=0, atol=1e-3)
    q = np.clip(arm.state().q, arm.robot.lower, arm.robot.upper)
    assert len(lk.run(arm, lk.Hold(q, 0.05), follow)) == 11


def late(answer, otherwise=follow):
    """A controller that does well until 0.1 s, and then gives ``answer``."""

    def controller(state, target):
        if state.t < 0.0995:
            return otherwise(state, target)
        return answer(state, target)

    return controller


def fails(state, target):
    raise ZeroDivisionError("division by zero")


def speed(state, target):
    return lk.JointVelocity(np.zeros(7))


CONTROLLERS = {
    "none": lambda s, x: None,
    "array": lambda s, x: np.zeros(7),
    "class": lambda s, x: lk.JointTorque,
    "other": speed,
    "raises": fails,
    "column": lambda s, x: lk.JointPosition(np.zeros((7, 1))),
    "six": lambda s, x: lk.JointPosition(np.zeros(6)),
    "nan": lambda s, x: lk.JointPosition(s.q * np.nan),
    "limit": lambda s, x: lk.JointPosition(np.full(7, 2.5)),
    "too few arguments": lambda: None,
}


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_controller_that_fails_is_named_with_the_time(ideal, name):
    """The rows up to then are kept, and the arm comes to rest."""
    controller = late(lambda s, x: CONTROLLERS[name](s, x))
    controller.__name__ = "the law"
    with pytest.raises(ControllerError, match=r"the law .*t = 0\.100 s") as caught:
        lk.run(ideal, still(ideal, 0.5), controller, rate=100)
    assert len(str(caught.value)) < 400
    assert len(caught.value.log) == 10 + (name == "limit")
    assert_stopped(ideal)


ZERO = np.zeros(7)
TARGETS = {
    "none": lambda t: None,
    "array": lambda t: ZERO,
    "tuple": lambda t: (ZERO, ZERO, ZERO),
    "raises": lambda t: 1 / 0,
    "nan": lambda t: lk.Sample(ZERO * np.nan, ZERO, ZERO),
    "unused nan": lambda t: lk.Sample(ZERO, ZERO * np.nan, ZERO),
    "short": lambda t: lk.Sample(ZERO, ZERO[1:], ZERO),
    "column": lambda t: lk.Sample(*np.zeros((3, 7, 1))),
    "words": lambda t: lk.Sample("here", ZERO, ZERO),
    "pose": lambda t: lk.PoseSample(np.eye(3), np.zeros(6), np.zeros(6)),
}


@pytest.mark.parametrize("when", [0.0, 0.1])
@pytest.mark.parametrize("name", TARGETS)
def test_a_target_that_fails_is_named_and_not_the_controller(ideal, name, when):
    """With the time, at the start or after 0.1 s, and the arm comes to rest."""

    def target(t):
        early = t < when - 1e-9
        return lk.Sample(ideal.robot.neutral, ZERO, ZERO) if early else TARGETS[name](t)

    with pytest.raises(ControllerError, match="the target target") as caught:
        lk.run(ideal, target, follow, rate=100, duration=0.5)
    assert "follow" not in str(caught.value)
    assert f"t = {when:.0f}" in str(caught.value) or f"t = {when:.3f}" in str(caught.value)
    assert_stopped(ideal)


def test_a_target_may_not_turn_from_points_into_poses(ideal):
    """A target that changes its kind of sample in the run is refused."""
    T = ideal.model.pose(ideal.robot.neutral)
    joints, pose = lk.Hold(ideal.robot.neutral, 1.0), lk.Hold(T, 1.0)
    with pytest.raises(ControllerError, match=r"PoseSample.*the same kind at all times"):
        lk.run(ideal, lambda t: (joints if t < 0.1 else pose)(t), follow, duration=0.5)


def test_a_wrong_sign_is_stopped_with_the_time_the_joint_and_the_log(ideal):
    """The log ends above 50 rad/s, and the arm comes to rest and runs again."""

    def pushes(state, target):
        g = ideal.model.gravity(state.q)
        return lk.JointTorque(g - 300.0 * (target.position - state.q) + 0.1)

    words = r"pushes lost the arm at t = .* joint left_.. turns at .*the sign of the error.*\.log"
    with pytest.raises(Diverged, match=words) as caught:
        lk.run(ideal, still(ideal, 5.0), pushes, rate=1000)
    log = caught.value.log
    assert isinstance(log, lk.Log)
    assert len(log) > 10
    assert np.linalg.norm(log.dq[-1]) > 50.0
    assert_stopped(ideal)
    q = ideal.truth().q
    again = lk.run(ideal, lk.Hold(q, 0.1), follow)
    assert_allclose(again.q[-1], q, rtol=0, atol=1e-3)


def test_run_and_live_have_one_order_and_one_sentence_when_it_is_not_kept(ideal):
    """Target and controller swapped: the same TypeMismatch; also with a plain function of time."""
    told = []
    for verb in (lk.run, lk.live):
        for target in (still(ideal), lambda t: still(ideal)(t)):
            with pytest.raises(TypeMismatch) as caught:
                verb(ideal, follow, target)
            told.append(str(caught.value))
    assert told[:2] == told[2:]


class Counting:
    """A controller with memory: its commands grow from tick to tick."""

    def reset(self):
        self.ticks = 0

    def __call__(self, state, target):
        self.ticks += 1
        return lk.JointVelocity(np.full(7, 0.001 * self.ticks))


def test_a_controller_with_memory_forgets_at_the_start_of_each_run(ideal):
    """Two runs with one object have the same commands."""
    controller = Counting()
    a, b = (lk.run(ideal, still(ideal, 0.1), controller).command for _ in range(2))
    np.testing.assert_array_equal(a, b)


def test_a_reset_that_fails_is_an_error_of_the_controller(ideal):
    """It is named, and the arm stays usable."""
    controller = Counting()
    controller.reset = lambda: 1 / 0
    with pytest.raises(ControllerError, match="Counting"):
        lk.run(ideal, still(ideal, 0.1), controller)
    assert_stopped(ideal)
