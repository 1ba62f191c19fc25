"""Energy is accounted for, and the functions that should fall do fall."""

import numpy as np
import pytest
from energy import energy_balance, lyapunov

import labkit as lk
from solutions.study.gains import all_controllers
from solutions.study.joint_torque import AugmentedPD, ComputedTorque

MODEL = lk.Model()
READY = MODEL.robot.ready
TIP = MODEL.pose(READY)[:3, 3]


@pytest.mark.parametrize("name", ["joint torque", "augmented PD", "joint impedance"])
def test_energy_balances_along_a_tracked_line(name):
    """Work and change of energy agree within 0.1 % of all that passed through the motors."""
    line = lk.Trajectory(lk.Line(TIP, TIP + np.array([0.1, 0.15, 0.1])), lk.Quintic(3.0))
    tuned = all_controllers(MODEL)[name]
    with lk.Arm(q0=READY) as arm:
        log = lk.run(arm, MODEL.joint_trajectory(line, READY), tuned.controller, rate=1000)
    balance = energy_balance(log)
    assert balance.throughput > 1.0
    assert np.abs(balance.residual).max() < 1e-3 * balance.throughput


def test_viscous_friction_is_on_the_bill():
    """With friction the residual stays as small, and the friction is what M, g do not explain."""
    with lk.Arm(plant=lk.Plant(viscous=0.7), q0=READY) as arm:
        target = lk.Trajectory(lk.Line(READY, READY + 0.4), lk.Quintic(2.0))
        log = lk.run(arm, target, ComputedTorque(MODEL), rate=1000)
    balance = energy_balance(log)
    assert balance.friction[-1] > 0.3
    assert np.abs(balance.residual).max() < 1e-3 * balance.throughput


def fall(dt):
    """Let go of the ideal arm at rest for 0.3 s, before any joint reaches its end."""
    with lk.Arm(q0=READY, world=lk.World(dt=dt)) as arm:
        limp = lk.JointTorque(np.zeros(7))
        log = lk.run(arm, lk.Hold(READY, 0.3), lambda state, target: limp, rate=1.0 / dt)
        assert (log.q > arm.robot.lower + 0.1).all()
        assert (log.q < arm.robot.upper - 0.1).all()
    balance = energy_balance(log)
    return balance.residual[-1] / balance.kinetic.max()


def test_the_drift_of_a_free_swing_falls_with_the_physics_step():
    """At 1 kHz a fall of 0.3 s loses 0.37 % of its kinetic energy; half the step, half of it."""
    drift = [fall(dt) for dt in (1e-3, 5e-4, 2.5e-4)]
    assert drift[0] == pytest.approx(-0.0037, abs=3e-4)
    assert drift[0] / drift[1] == pytest.approx(2.0, abs=0.05)
    assert drift[1] / drift[2] == pytest.approx(2.0, abs=0.05)


KP = np.array([200.0, 200, 100, 100, 10, 10, 2])
KD = np.array([40.0, 40, 15, 12, 1, 1, 0.05])


def test_the_lyapunov_function_of_the_augmented_pd_falls_at_its_rate():
    """On a moving target V falls at every tick, by de^T Kd de (MLS, Proposition 4.10)."""
    target = lk.Trajectory(lk.Line(READY, READY + 0.3), lk.Quintic(1.5))
    with lk.Arm(q0=READY - 0.1) as arm:
        log = lk.run(arm, target, AugmentedPD(MODEL, KP, KD), rate=1000)
    V = lyapunov(log, KP)
    de = log.target.velocity - log.dq
    mean = 0.5 * (de[1:] + de[:-1])
    lost = np.concatenate([[0.0], np.cumsum((mean**2) @ KD) * 1e-3])
    assert V[0] > 1.0
    assert np.diff(V).max() < 1e-4 * V[0]
    assert V + lost == pytest.approx(np.full(len(V), V[0]), abs=0.02 * V[0])
    assert V[-1] < 0.01 * V[0]


def test_the_lyapunov_function_of_computed_torque_has_unit_inertia():
    """V with the identity for M falls for computed torque, whatever the arm's own inertia."""
    with lk.Arm(q0=READY - 0.1) as arm:
        log = lk.run(arm, lk.Hold(READY, 1.5), ComputedTorque(MODEL, 100.0, 14.0), rate=1000)
    V = lyapunov(log, np.full(7, 100.0), inertia=np.eye(7))
    assert np.diff(V).max() < 1e-4 * V[0]
    assert V[-1] < 1e-6 * V[0]


def test_a_wrong_sign_makes_the_lyapunov_function_rise():
    """The check can fail: negative damping feeds the error."""

    def wrong(state, target):
        e, de = target.position - state.q, target.velocity - state.dq
        return lk.JointTorque(MODEL.bias(state.q, state.dq) + KP * e - 0.05 * KD * de)

    with lk.Arm(q0=READY - 0.05) as arm:
        log = lk.run(arm, lk.Hold(READY, 0.3), wrong, rate=1000)
    V = lyapunov(log, KP)
    assert V[-1] > 1.02 * V[0]
