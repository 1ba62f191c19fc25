"""The report's tuning procedure."""

import numpy as np
import pytest

import labkit as lk
from labkit.stability import VelocityJoint, ultimate_gain
from solutions.study import speed_gains
from solutions.study.gains import KD
from solutions.study.report_procedure import decay_ratio, report_procedure

DT, DELAY, LAG = 0.001, 0.02, 0.03


def simulated(Kp, Kd, duration=4.0):
    """A joint with lag and delay comes back to zero: forward Euler, one millisecond."""
    n, wait = int(duration / DT), int(DELAY / DT)
    q, v, asked = 1.0, 0.0, [0.0] * wait
    errors = np.empty(n)
    for k in range(n):
        errors[k] = -q
        asked.append(-Kp * q - Kd * v)
        v += (asked[-1 - wait] - v) * DT / LAG
        q += v * DT
        if abs(q) > 100.0:
            raise lk.errors.Diverged("ran away")
    return np.arange(n) * DT, errors


def test_the_decay_of_a_damped_swing_is_its_formula():
    """e^{-zeta w t} cos(w_d t): from one extreme to the next, pi / w_d later."""
    t = np.linspace(0.0, 10.0, 20001)
    found = decay_ratio(np.exp(-0.5 * t) * np.cos(4.0 * t))
    assert found == pytest.approx(np.exp(-0.5 * np.pi / 4.0), rel=1e-3)
    assert decay_ratio(np.exp(-t)) == 0.0


def test_the_procedure_finds_the_ultimate_gain_and_halves_it():
    """It is the computed one to 12 %, and of the Kd tried the best is kept."""
    joint = VelocityJoint(LAG, DELAY)
    found = report_procedure(simulated, growth=1.1, most=60)
    assert found.ultimate == pytest.approx(ultimate_gain(joint), rel=0.12)
    assert found.Kp == found.ultimate / 2.0
    assert found.steps[0].why == "feed-forward alone" and found.steps[0].rms == 1.0
    rms = {step.Kd: step.rms for step in found.steps if step.Kp == found.Kp}
    assert rms[found.Kd] == min(rms.values()), "more damping was no better"


@pytest.mark.soak
def test_the_compared_derivative_gain_is_what_the_tuning_finds():
    """For both velocity controllers, on two paths."""
    rows = speed_gains.trials(seeds=2)
    assert {speed_gains.best(rows, controller) for controller in speed_gains.CONTROLLERS} == {KD}
