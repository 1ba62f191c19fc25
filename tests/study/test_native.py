"""The lab's own friction and step against physics that the lab did not write."""

import numpy as np
import pytest

from solutions.study import native


def test_mujocos_own_friction_moves_the_arm_alike():
    """Within 0.5 mrad at every tick, and within half a per cent of the RMS error."""
    own, other = native.lab("joint torque"), native.mujoco_alone("joint torque")
    assert 0.0 < np.abs(own.q - other.q).max() < 5e-4
    assert native.rms(own) == pytest.approx(native.rms(other), rel=5e-3)


def test_half_the_step_changes_little():
    """The velocity controller's RMS error moves by a hundredth of a millimetre or two."""
    one, half = (native.rms(native.lab("joint velocity", dt)) for dt in (1e-3, 5e-4))
    assert 0.005 < abs(one - half) < 0.025
