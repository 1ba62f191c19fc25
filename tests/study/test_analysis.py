"""One joint's loop on paper, against closed forms and against the simulated arm."""

from dataclasses import replace

import numpy as np
import pytest

import labkit as lk
from labkit.study import analysis
from labkit.study.analysis import Joint, Loop, velocity_joint, velocity_joint_of
from solutions.report_procedure import decay_ratio
from solutions.tuning import trial_on

INTEGRATOR = Joint((1.0,), (1.0, 0.0), delay=0.05)


def test_margins_of_an_integrator_with_delay_are_the_closed_form():
    """L = K e^{-sd}/s: crossover K, phase margin 90 deg - K d, gain margin pi / (2 K d)."""
    K, d = 4.0, INTEGRATOR.delay
    found = Loop(INTEGRATOR, K).margins()
    assert found.crossover == pytest.approx(K, rel=1e-6)
    assert found.phase == pytest.approx(90.0 - np.degrees(K * d), rel=1e-6)
    assert found.gain == pytest.approx(np.pi / (2 * K * d), rel=1e-5)
    assert found.delay == pytest.approx(np.pi / (2 * K) - d, rel=1e-5)
    assert found.stable and not Loop(INTEGRATOR, 40.0).margins().stable


def test_without_delay_the_margins_of_an_inertia_are_the_closed_form():
    """PD on a double integrator: phase margin atan(Kd w / Kp), and any gain is stable."""
    found = Loop(Joint((1.0,), (2.0, 0.0, 0.0)), 200.0, 40.0).margins()
    w = found.crossover
    assert 200.0**2 + (40.0 * w) ** 2 == pytest.approx((2.0 * w * w) ** 2, rel=1e-6)
    assert found.phase == pytest.approx(np.degrees(np.arctan2(40.0 * w, 200.0)), rel=1e-6)
    assert found.gain == np.inf and found.stable


def test_a_loop_whose_gain_is_nowhere_1_says_so():
    """Damping alone below 1: whatever the phase, there is nothing to lose."""
    found = Loop(velocity_joint(0.1), 0.0, 0.5).margins()
    assert found.crossover == found.phase == found.delay == np.inf
    assert str(found) == "gain margin inf, and at no frequency is the loop's gain 1"


def test_the_step_response_of_a_plain_integrator_is_the_exponential():
    t = np.linspace(0.0, 2.0, 200)
    found = Loop(velocity_joint(0.0), 3.0).step(t)
    np.testing.assert_allclose(found, 1.0 - np.exp(-3.0 * t), atol=1e-6)


def test_the_poles_of_the_root_locus_solve_the_characteristic_equation():
    """Lag s^2 + (1 + k Kd) s + k Kp = 0 for every factor k."""
    loop, factors = Loop(velocity_joint(0.1), 2.0, 0.3), [0.5, 1.0, 4.0]
    for k, poles in zip(factors, loop.locus(factors), strict=True):
        expected = np.roots([0.1, 1.0 + 0.3 * k, 2.0 * k])
        np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(expected), rtol=1e-9)


def test_the_age_of_the_state_is_the_one_in_the_log():
    with lk.Arm(plant=lk.BAXTER, q0=lk.robot("left").ready) as arm:
        log = lk.run(arm, lk.Hold(arm.robot.ready, 2.0), still)
    told = np.mean((log.t - log.measured.t)[10:])
    assert told == pytest.approx(analysis.mean_age(lk.BAXTER, 200.0), abs=2e-4)
    assert analysis.mean_age(lk.IDEAL, 200.0) == 0.0


def still(state, target):
    return lk.JointVelocity(target.velocity)


@pytest.mark.parametrize("joint", [0, 3, 6])
def test_the_arm_oscillates_where_its_loop_says(joint):
    """On Baxter's plant: a fifth below the predicted gain swings die, a fifth above they stay."""
    predicted = analysis.ultimate_gain(velocity_joint_of(lk.BAXTER))
    trial = trial_on(joint, replace(lk.BAXTER, velocity_noise=0.0, lost_ticks=0.0))
    below, above = (decay_ratio(trial(f * predicted, 0.0)[1]) for f in (0.8, 1.2))
    assert below < 0.9 < 0.97 < above


@pytest.mark.parametrize("Kp", [20.0, 40.0])
def test_the_arm_overshoots_as_its_loop_says(Kp):
    """Joint velocity control on Baxter's plant, back to rest, against the step response."""
    trial = trial_on(0, replace(lk.BAXTER, velocity_noise=0.0, lost_ticks=0.0))
    t, e = trial(Kp, 0.0)
    predicted = 1.0 - Loop(velocity_joint_of(lk.BAXTER), Kp).step(t)
    actual = e / e[0]
    assert actual.min() == pytest.approx(predicted.min(), abs=0.03)
    assert t[actual.argmin()] == pytest.approx(t[predicted.argmin()], abs=0.015)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Loop(INTEGRATOR, -1.0), "Kp is -1, it must be at least 0"),
        (lambda: Loop(INTEGRATOR, 1.0, float("nan")), "Kd is nan"),
        (lambda: Loop(INTEGRATOR, 0.0).margins(), "Kp and Kd are both 0"),
        (lambda: Loop(INTEGRATOR, 1.0).step(2.0), r"t is array\(2\.\).*evenly spaced times from 0"),
        (lambda: Loop(INTEGRATOR, 1.0).step([0.0, 0.1, 0.5]), "evenly spaced times from 0"),
        (lambda: velocity_joint(0.1, -0.1), "delay is -0.1"),
    ],
)
def test_bad_input_is_a_sentence(make, sentence):
    with pytest.raises(lk.LabkitError, match=sentence):
        make()
