"""Each effect of a plant, shown alone: what it does to an arm that otherwise is ideal."""

from dataclasses import replace

import numpy as np
import pytest

import labkit as lk
from labkit.errors import Diverged, JointLimitExceeded
from labkit.plant import EVIDENCE
from solutions.study.joint_torque import AugmentedPD
from solutions.study.joint_velocity import JointVelocityPD

READY = lk.robot("left").ready
SWAY = lk.Trajectory(lk.Line(READY, READY + 0.2), lk.Quintic(1.0))


def steps(arm, command, count):
    """Give one command and read the true state after each physics step."""
    arm.apply(command)
    out = []
    for _ in range(count):
        arm.world.step()
        out.append(arm.truth())
    return out


def velocity(q=0.3):
    return lk.JointVelocity(np.full(7, q))


# What the arm reports


def test_a_state_published_at_100_hz_is_seen_twice_by_a_200_hz_loop():
    """Every second tick sees the state that the tick before it saw."""
    with lk.Arm(plant=lk.Plant(state_rate=100.0), q0=READY) as arm:
        log = lk.run(arm, SWAY, JointVelocityPD(), rate=200)
    ages = log.t - log.measured.t
    assert log.measured.t[1::2] == pytest.approx(log.measured.t[:-1:2])
    assert np.unique(ages.round(6)).tolist() == [0.0, 0.005]


def test_a_state_arrives_as_late_as_the_plant_says():
    """With a delay of 4 ms every state is 4 ms old, once the first has come."""
    with lk.Arm(plant=lk.Plant(state_delay=0.004), q0=READY) as arm:
        log = lk.run(arm, SWAY, JointVelocityPD(), rate=500)
    assert (log.t - log.measured.t)[2:] == pytest.approx(0.004)
    assert log.measured.q[2:] == pytest.approx(log.q[:-2])


def test_speeds_are_noisy_and_angles_are_not():
    """The measured speeds scatter by the stated deviation; the angles are exact."""
    deviation = np.array([0.01, 0.01, 0.01, 0.01, 0.03, 0.03, 0.03])
    with lk.Arm(plant=lk.Plant(velocity_noise=deviation), q0=READY) as arm:
        log = lk.run(arm, lk.Hold(READY, 4.0), JointVelocityPD(Kp=0.0), rate=1000)
    noise = (log.measured.dq - log.dq)[1:]
    assert noise.std(axis=0) == pytest.approx(deviation, rel=0.06)
    assert noise.mean(axis=0) == pytest.approx(np.zeros(7), abs=2e-3)
    assert (log.measured.q == log.q).all()


def test_the_external_torque_is_noisy_and_lags():
    """Its scatter is the stated one; after a push of one time constant it has reached 63 %."""
    push = lk.Push((0.0, 20.0, 0.0), start=0.1)
    plant = lk.Plant(torque_noise=0.2, torque_lag=0.05, gravity_compensation=True)
    with lk.Arm(plant=plant, q0=READY, world=lk.World(things=[push])) as arm:
        log = lk.run(arm, lk.Hold(READY, 2.0), JointVelocityPD(Kp=0.0), rate=1000)
    felt = log.measured.tau_ext
    full = arm.model.tip_jacobian(READY)[1] * 20.0
    assert felt[1:100].std(axis=0) == pytest.approx(np.full(7, 0.2), rel=0.3)
    assert felt[500:].mean(axis=0) == pytest.approx(full, abs=0.05)
    share = (felt[148:153] @ full).mean() / (full @ full)
    assert share == pytest.approx(1.0 - np.exp(-1.0), abs=0.03)


def test_a_long_delay_keeps_every_report_until_it_arrives():
    """Nobody asks for 0.4 s; then the state is exactly the delay old."""
    with lk.Arm(plant=lk.Plant(state_delay=0.15), q0=READY) as arm:
        path = steps(arm, velocity(0.1), 400)
        assert arm.state().t == pytest.approx(arm.world.t - 0.15)
        assert arm.state().q == pytest.approx(path[249].q)


@pytest.mark.parametrize("plant", [lk.BAXTER, lk.Plant(velocity_noise=0.02)])
def test_the_same_seed_gives_the_same_run_bit_for_bit(plant):
    """Noise and late ticks come from the arm's seed alone; another seed gives another run."""

    def log(seed):
        with lk.Arm(plant=plant, seed=seed, q0=READY) as arm:
            return lk.run(arm, SWAY, JointVelocityPD(Kp=3.0, Kd=0.1))

    a, b, c = log(7), log(7), log(8)
    for x, y in ((a.q, b.q), (a.tau, b.tau), (a.measured.dq, b.measured.dq)):
        assert x.tobytes() == y.tobytes()
    assert not np.array_equal(a.measured.dq, c.measured.dq)


# How it obeys


def test_the_velocity_mode_follows_with_a_first_order_lag():
    """The speed is 1 - exp(-t / lag) of a step."""
    with lk.Arm(plant=lk.Plant(velocity_lag=0.03), q0=READY) as arm:
        path = steps(arm, velocity(), 90)
    speed = np.array([s.dq for s in path])
    for t in (30, 60, 90):
        assert speed[t - 1] == pytest.approx(np.full(7, 0.3 * (1 - np.exp(-t / 30))), rel=0.02)


def test_the_position_mode_closes_a_gap_at_its_gain():
    """With a gain of 20 / s the gap falls by e in 50 ms."""
    with lk.Arm(plant=lk.Plant(position_gain=20.0), q0=READY) as arm:
        path = steps(arm, lk.JointPosition(READY + 0.02), 100)
    gap = READY + 0.02 - np.array([s.q for s in path])
    assert gap[99] / gap[49] == pytest.approx(np.full(7, 1.0 / np.e), rel=0.02)


def test_a_command_that_comes_too_late_is_not_used():
    """With every tick lost nothing moves; with none lost the run follows."""
    with lk.Arm(plant=lk.Plant(lost_ticks=1.0), q0=READY) as arm:
        log = lk.run(arm, SWAY, JointVelocityPD())
        assert np.abs(log.q - READY).max() < 1e-4
        assert np.abs(log.command).max() > 0.1
    with lk.Arm(plant=lk.Plant(lost_ticks=0.3), seed=4) as arm:
        assert np.mean(arm.lost_ticks(10_000)) == pytest.approx(0.3, abs=0.02)


def test_an_arm_without_commands_holds_its_place_after_the_timeout():
    """It obeys the last command for 0.2 s and then stands still."""
    with lk.Arm(q0=READY) as arm:
        path = steps(arm, velocity(), 800)
    assert path[199].dq == pytest.approx(np.full(7, 0.3), abs=1e-4)
    assert np.abs(path[-1].dq).max() < 1e-6
    assert path[-1].q == pytest.approx(path[199].q, abs=1e-3)


# Friction, inertia, weight


def test_dry_friction_holds_until_the_torque_exceeds_it():
    """Just below the stiction nothing moves; above it the joint runs with the difference."""
    plant = lk.Plant(stiction=1.0, gravity_compensation=True)
    push = np.eye(7)[0]
    with lk.Arm(plant=plant, q0=READY) as arm:
        assert np.abs(steps(arm, lk.JointTorque(0.99 * push), 100)[-1].dq).max() < 1e-4
        assert steps(arm, lk.JointTorque(1.5 * push), 20)[-1].dq[0] > 1e-3


def test_dry_friction_leaves_an_error_that_a_pd_cannot_remove():
    """A joint rests anywhere within stiction / Kp of its target: the report's plateaus."""
    offset = 0.04  # 25 N m/rad * 0.04 rad = 1 N m
    plant = lk.Plant(stiction=1.01, gravity_compensation=True)
    with lk.Arm(plant=plant, q0=READY) as arm:
        pd = AugmentedPD(arm.model, 25.0, 10.0, gravity=False)
        log = lk.run(arm, lk.Hold(READY + offset, 1.0), pd, rate=1000)
    assert np.abs(log.q[-1] - READY).max() < 1e-3


def test_viscous_friction_costs_torque_in_proportion_to_speed():
    """Motor torque is what the motion takes plus the friction, to 1e-6 N m."""
    plant = lk.Plant(viscous=0.7)
    with lk.Arm(plant=plant, q0=READY) as arm:
        before = steps(arm, velocity(), 20)[-1]
        after = steps(arm, velocity(0.31), 1)[0]
        ddq = (after.dq - before.dq) / arm.world.dt
        needed = arm.model.inverse_dynamics(before.q, before.dq, ddq)
        assert arm.torque - needed == pytest.approx(0.7 * before.dq, abs=1e-6)


def test_rotor_inertia_keeps_the_reports_torque_gains_from_exploding():
    """At 200 Hz they lose an arm without rotors, and hold one with 0.05 kg m^2."""
    Kp = 8.0 * np.array([1, 1, 1.5, 1.5, 1, 1, 1])
    Kd = 5.0 * np.array([2, 2, 1, 1, 0.8, 0.3, 0.3])
    for armature, stable in ((0.0, False), (0.05, True)):
        plant = lk.Plant(armature=armature, gravity_compensation=True)
        with lk.Arm(plant=plant, q0=READY) as arm:
            pd = AugmentedPD(arm.model, Kp, Kd, gravity=False)
            if stable:
                log = lk.run(arm, lk.Hold(READY + 0.02, 4.0), pd)
                assert np.abs(log.dq[-1]).max() < 0.02
            else:
                with pytest.raises(Diverged, match="turns at") as caught:
                    lk.run(arm, lk.Hold(READY + 0.02, 4.0), pd)
                assert len(caught.value.log) > 1


def test_a_payload_pulls_on_an_arm_that_does_not_know_of_it():
    """The arm carries its own weight only: it sags by K^-1 of the rest, and feels m g downwards."""
    plant = lk.Plant(payload=1.0, gravity_compensation=True, armature=0.05)
    Kp = np.array([400.0, 400, 200, 200, 50, 50, 50])
    with lk.Arm(plant=plant, q0=READY) as arm:
        pd = AugmentedPD(lk.Model("left", replace(plant, payload=0.0)), Kp, 0.2 * Kp, gravity=False)
        log = lk.run(arm, lk.Hold(READY, 4.0), pd, rate=1000)
        model, q = arm.model, log.q[-1]
        weight = model.tip_jacobian(q)[2] * -9.81
        wrench = model.tip_wrench(q, log.measured.tau_ext[-1])
    assert Kp * (q - READY) == pytest.approx(weight, abs=0.01)
    assert wrench == pytest.approx([0, 0, -9.81, 0, 0, 0], abs=0.02)


def test_gravity_compensation_is_a_switch():
    """With it zero torque holds the arm still; without it the arm falls."""
    with lk.Arm(plant=lk.Plant(gravity_compensation=True), q0=READY) as arm:
        assert np.abs(steps(arm, lk.JointTorque(np.zeros(7)), 150)[-1].q - READY).max() < 1e-6
    with lk.Arm(q0=READY) as arm:
        assert np.abs(steps(arm, lk.JointTorque(np.zeros(7)), 150)[-1].q - READY).max() > 0.1


# Limits


def test_speeds_are_cut_and_logged_tick_by_tick():
    """Above 1.5 rad/s the shoulder goes at 1.5, and exactly those ticks are marked."""
    wish = lk.Trajectory(lk.Line(READY, READY + 0.6 * np.eye(7)[0]), lk.Cubic(0.5))
    with lk.Arm(q0=READY) as arm:
        log = lk.run(arm, wish, lambda state, target: lk.JointVelocity(target.velocity))
    beyond = np.abs(log.command[:-1, 0]) > 1.5
    assert beyond.any()
    assert not beyond.all()
    assert (log.saturated[:-1] == beyond).all()
    assert log.dq[:, 0].max() == pytest.approx(1.5, abs=1e-3)


def test_torques_are_cut_the_arms_own_share_included():
    """A torque that fits alone is cut where gravity compensation takes the rest of the motor."""
    plant = lk.Plant(gravity_compensation=True)
    q = np.array([-0.5, -0.3, 0.0, 0.6, 0.0, 0.9, 0.0])
    with lk.Arm(plant=plant, q0=q) as arm:
        own = arm.model.gravity(q)[1]
        push = np.copysign(arm.robot.effort[1] - 0.5 * abs(own), own) * np.eye(7)[1]
        arm.apply(lk.JointTorque(push))
        assert not arm.saturated
        arm.world.step()
        assert arm.saturated
        assert abs(arm.torque[1]) == arm.robot.effort[1]


def test_motors_that_give_all_they_can_are_logged_as_saturated():
    """In velocity mode a wall stops the arm at the motors' strength, and the log says so."""
    tip = lk.Model().pose(READY)[:3, 3]
    face = lk.Wall(tip + 0.03 * np.eye(3)[0], (-1, 0, 0), stiffness=1e5)
    way = lk.Trajectory(lk.Line(tip, tip + 0.15 * np.eye(3)[0]), lk.Quintic(1.0))
    with lk.Arm(q0=READY, world=lk.World(things=[face])) as arm:
        target = arm.model.joint_trajectory(way, READY)
        log = lk.run(arm, target, JointVelocityPD(Kp=20.0))
        full = (np.abs(log.tau) >= arm.robot.effort * (1 - 1e-9)).any(axis=1)
    assert not log.saturated[:20].any()
    assert full.any()
    assert log.saturated[full].all()


def test_a_joint_stops_at_its_end():
    """No command takes a joint beyond its range: positions are refused, speeds run into a stop."""
    with lk.Arm(q0=READY) as arm:
        with pytest.raises(JointLimitExceeded, match="left_e1"):
            arm.apply(lk.JointPosition(READY + 1.5 * np.eye(7)[3]))
        for _ in range(20):
            q = steps(arm, lk.JointVelocity(np.eye(7)[3]), 100)[-1].q
        assert q[3] == pytest.approx(arm.robot.upper[3], abs=0.02)


def test_an_encoder_that_is_off_leaves_the_hand_off_and_the_controller_content():
    """The arm reports its target and is beside it by just the offset."""
    off = EVIDENCE["encoder_offset"].most
    plant = lk.Plant(encoder_offset=off)
    with lk.Arm(plant=plant, q0=READY) as arm:
        log = lk.run(arm, lk.Hold(READY, 3.0), JointVelocityPD(Kp=5.0))
        miss = arm.tip()[0] - arm.model.pose(READY)[:3, 3]
    assert log.measured.q[-1] == pytest.approx(READY, abs=1e-5)
    assert log.q[-1] + off == pytest.approx(READY, abs=1e-5)
    assert 4e-3 < np.linalg.norm(miss) < 6e-3


def test_an_encoder_reads_whole_steps():
    """Each angle read is a multiple of the step, and half a step or less from where the arm is."""
    step = 0.01
    with lk.Arm(plant=lk.Plant(encoder_step=step), q0=READY) as arm:
        read = arm.state().q / step
        assert read == pytest.approx(np.round(read), abs=1e-9)
        assert arm.state().q == pytest.approx(READY, abs=0.5 * step + 1e-12)
