"""One joint's loop on paper, against closed forms and against the simulated arm."""

from dataclasses import replace

import control
import numpy as np
import pytest

import labkit as lk
from labkit.stability import VelocityJoint, margins, mean_age, ultimate_gain, velocity_joint_of
from solutions.study.report_procedure import decay_ratio
from solutions.study.tuning import trial_on

INTEGRATOR = VelocityJoint(0.0, delay=0.05)


def test_margins_of_an_integrator_with_delay_are_the_closed_form():
    """L = K e^{-sd}/s: crossover K, phase margin 90 deg - K d, gain margin pi / (2 K d)."""
    K, d = 4.0, INTEGRATOR.delay
    found = margins(INTEGRATOR, K)
    assert found.crossover == pytest.approx(K, rel=1e-6)
    assert found.phase == pytest.approx(90.0 - np.degrees(K * d), rel=1e-6)
    assert found.gain == pytest.approx(np.pi / (2 * K * d), rel=1e-5)
    assert found.delay == pytest.approx(np.pi / (2 * K) - d, rel=1e-5)
    assert found.stable and not margins(INTEGRATOR, 40.0).stable


def test_without_delay_the_margins_of_a_lagging_joint_are_the_closed_form():
    """PD on a joint with lag: phase margin 90 deg + atan(w Kd / Kp) - atan(w lag)."""
    Kp, Kd, lag = 20.0, 0.5, 0.1
    found = margins(VelocityJoint(lag), Kp, Kd)
    w = found.crossover
    assert Kp**2 + (Kd * w) ** 2 == pytest.approx(w**2 * (1.0 + (lag * w) ** 2), rel=1e-6)
    phase = 90.0 + np.degrees(np.arctan2(Kd * w, Kp) - np.arctan(lag * w))
    assert found.phase == pytest.approx(phase, rel=1e-6)
    assert found.gain == np.inf and found.stable


def test_a_loop_whose_gain_is_nowhere_1_has_nothing_to_lose():
    """Damping alone below 1: whatever the phase."""
    found = margins(VelocityJoint(0.1), 0.0, 0.5)
    assert found.crossover == found.phase == found.delay == np.inf


def step_response(joint, Kp, t):
    """The joint's angle after a unit step of the wanted angle, without feed-forward."""
    loop = Kp / (control.tf("s") * (joint.lag * control.tf("s") + 1.0))
    if joint.delay:
        loop *= control.tf(*control.pade(joint.delay, 4))
    return control.step_response(control.feedback(loop), T=t).outputs


def test_the_age_of_the_state_is_the_one_in_the_log():
    """At 200 Hz mean age and Baxter's log agree to 0.2 ms, and the ideal arm's age is zero."""
    with lk.Arm(plant=lk.BAXTER, q0=lk.robot("left").ready) as arm:
        log = lk.run(arm, lk.Hold(arm.robot.ready, 2.0), still)
    told = np.mean((log.t - log.measured.t)[10:])
    assert told == pytest.approx(mean_age(lk.BAXTER, 200.0), abs=2e-4)
    assert mean_age(lk.IDEAL, 200.0) == 0.0


def still(state, target):
    return lk.JointVelocity(target.velocity)


@pytest.mark.parametrize("joint", [0, 3, 6])
def test_the_arm_oscillates_where_its_loop_says(joint):
    """On Baxter's plant: a fifth below the predicted gain swings die, a fifth above they stay."""
    predicted = ultimate_gain(velocity_joint_of(lk.BAXTER))
    trial = trial_on(joint, replace(lk.BAXTER, velocity_noise=0.0, lost_ticks=0.0))
    below, above = (decay_ratio(trial(f * predicted, 0.0)[1]) for f in (0.8, 1.2))
    assert below < 0.9 < 0.97 < above


@pytest.mark.parametrize("Kp", [20.0, 40.0])
def test_the_arm_overshoots_as_its_loop_says(Kp):
    """Joint velocity control on Baxter's plant, back to rest, against the step response."""
    trial = trial_on(0, replace(lk.BAXTER, velocity_noise=0.0, lost_ticks=0.0))
    t, e = trial(Kp, 0.0)
    predicted = 1.0 - step_response(velocity_joint_of(lk.BAXTER), Kp, t)
    actual = e / e[0]
    assert actual.min() == pytest.approx(predicted.min(), abs=0.03)
    assert t[actual.argmin()] == pytest.approx(t[predicted.argmin()], abs=0.015)
