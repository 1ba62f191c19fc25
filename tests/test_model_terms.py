"""The model's calls made for controllers say the same as its single ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import labkit as lk
from labkit import se3
from labkit.errors import ShapeError

MODEL = lk.Model("left", lk.BAXTER)


@st.composite
def motions(draw):
    """Angles within the limits, speeds and accelerations."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    q = rng.uniform(MODEL.robot.lower, MODEL.robot.upper)
    return q, rng.uniform(-2, 2, 7), rng.uniform(-5, 5, 7)


@given(motions())
def test_inverse_dynamics_is_the_equation_of_motion(motion):
    """M ddq + C dq + g."""
    q, dq, ddq = motion
    sum_ = MODEL.mass_matrix(q) @ ddq + MODEL.coriolis(q, dq) @ dq + MODEL.gravity(q)
    assert MODEL.inverse_dynamics(q, dq, ddq) == pytest.approx(sum_, abs=1e-9)


@given(motions())
def test_a_wrench_is_found_again_from_its_joint_torques(motion):
    """tip_wrench(q, J^T F) is F, away from singularities."""
    q, force, _ = motion
    if MODEL.nearness_to_singularity(q) > 0.02:
        F = force[:6]
        assert MODEL.tip_wrench(q, MODEL.tip_jacobian(q).T @ F) == pytest.approx(F, abs=1e-8)


@given(motions())
def test_a_pose_error_is_target_minus_actual(motion):
    """Following the error from the actual pose, turning in world axes, reaches the target."""
    q, dq, _ = motion
    T_wt, T_wd = MODEL.pose(q), MODEL.pose(np.clip(q + 0.2 * dq, *_limits()))
    e = se3.pose_error(T_wd, T_wt)
    assert T_wt[:3, 3] + e[:3] == pytest.approx(T_wd[:3, 3])
    assert se3.rotation(e[3:]) @ T_wt[:3, :3] == pytest.approx(T_wd[:3, :3], abs=1e-9)
    assert MODEL.pose_error(T_wd, q) == pytest.approx(e)


def test_wrong_shapes_are_sentences():
    """Six torques, or a wrench in their place, are refused."""
    with pytest.raises(ShapeError, match="tau_ext"):
        MODEL.tip_wrench(MODEL.robot.ready, np.zeros(6))
    with pytest.raises(ShapeError, match="dq"):
        MODEL.bias(MODEL.robot.ready, np.zeros(6))


def _limits():
    return MODEL.robot.lower, MODEL.robot.upper
