"""One joint's loop in formulas."""

import numpy as np
import pytest

import labkit as lk
from labkit.analysis import Loop, velocity_joint
from solutions.comparison import kp_for_margin, open_loop


@pytest.mark.parametrize("lag", [0.0, 0.03, 0.2])
@pytest.mark.parametrize("delay", [0.0, 0.01, 0.05])
@pytest.mark.parametrize("margin", [5.0, 45.0, 80.0])
def test_the_gain_has_the_margin_that_was_asked_for(lag, delay, margin):
    if lag == delay == 0.0:
        return
    kp = kp_for_margin(lag, delay, margin)
    assert Loop(velocity_joint(lag, delay), kp).margins().phase == pytest.approx(margin, abs=1e-3)


def test_the_open_loop_is_gain_over_integrator_and_lag():
    w = 7.0
    found = open_loop(3.0, 0.1, 0.02)(1j * w)
    exact = 3.0 * np.exp(-1j * w * 0.02) / (1j * w * (0.1j * w + 1.0))
    assert found == pytest.approx(exact, rel=1e-6)
    assert np.min(np.abs(open_loop(3.0, 0.1, 0.02).poles())) < 1e-9, "one integrator"


def test_impossible_margins_are_sentences():
    with pytest.raises(lk.LabkitError, match="less than 90 degrees"):
        kp_for_margin(0.1, 0.0, 95.0)
    with pytest.raises(lk.LabkitError, match="at any gain"):
        kp_for_margin(0.0, 0.0, 45.0)
