"""Rigid motion against the matrix exponential, SciPy's rotations and its own inverses."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from labkit import se3

vectors = arrays(np.float64, 3, elements=st.floats(-2.0, 2.0))
unit = vectors.filter(lambda v: np.linalg.norm(v) > 1e-3).map(lambda v: v / np.linalg.norm(v))
angles = st.one_of(
    st.floats(0.0, np.pi - 1e-9),
    st.floats(0.0, 2e-4),  # around the switch to the series
    st.floats(2.9, np.pi - 1e-9),  # around the switch to the symmetric part
    st.sampled_from([0.0, 1e-12, 1e-8, 1e-4, 3.0, np.pi - 1e-7]),
)
turns = st.builds(lambda axis, angle: axis * angle, unit, angles)
twists = st.builds(lambda v, w: np.concatenate([v, w]), vectors, turns)
poses = twists.map(lambda V: se3.pose(se3.rotation(V[3:]), V[:3]))


@given(vectors, vectors)
def test_hat_is_the_cross_product_and_vee_undoes_it(w, x):
    """hat(w) x is w cross x, and vee gives w to the bit."""
    assert_allclose(se3.hat(w) @ x, np.cross(w, x), rtol=0, atol=1e-14)
    assert_allclose(se3.vee(se3.hat(w)), w, rtol=0, atol=0)


@given(turns)
def test_rotation_is_the_matrix_exponential(phi):
    """It is the one that SciPy computes, and orthogonal."""
    R = se3.rotation(phi)
    assert_allclose(R, expm(se3.hat(phi)), rtol=0, atol=2e-14)
    assert_allclose(R.T @ R, np.eye(3), rtol=0, atol=2e-14)


@given(turns)
def test_log_undoes_rotation_up_to_half_a_turn(phi):
    """Any axis and angle below pi come back from their rotation."""
    assert_allclose(se3.rotation_log(se3.rotation(phi)), phi, rtol=0, atol=2e-9)


@given(turns.filter(lambda phi: 1e-3 < np.linalg.norm(phi) < 3.0))
def test_log_is_the_matrix_logarithm(phi):
    """Between 0.001 and 3 rad it is the one that SciPy computes."""
    R = se3.rotation(phi)
    assert_allclose(se3.hat(se3.rotation_log(R)), logm(R).real, rtol=0, atol=1e-11)


@given(unit)
def test_half_a_turn_gives_back_the_same_rotation(axis):
    """Its logarithm has the length pi and gives the same matrix, whichever sign its axis has."""
    R = 2.0 * np.outer(axis, axis) - np.eye(3)
    phi = se3.rotation_log(R)
    assert_allclose(np.linalg.norm(phi), np.pi, rtol=0, atol=1e-9)
    assert_allclose(se3.rotation(phi), R, rtol=0, atol=1e-9)


@given(turns, unit)
def test_log_takes_rotations_of_scipy_also_near_half_a_turn_and_no_turn(phi, axis):
    """Made by SciPy, to 1e-12; near half a turn the axis is as sure as elsewhere."""
    for turn in (phi, axis * (np.pi - 1e-6), axis * 1e-7):
        R = Rotation.from_rotvec(turn).as_matrix()
        assert_allclose(se3.rotation(turn), R, rtol=0, atol=1e-14)
        found, wanted = se3.rotation_log(R), Rotation.from_matrix(R).as_rotvec()
        if np.linalg.norm(turn) < np.pi - 1e-7:
            assert_allclose(found, wanted, rtol=0, atol=1e-9)
        assert np.linalg.norm(found) <= np.pi + 1e-12
        x = se3.quaternion(R)
        assert x[3] >= 0.0
        assert_allclose(Rotation.from_quat(x).as_matrix(), R, rtol=0, atol=1e-12)


@given(poses, poses)
def test_the_inverse_undoes_and_reverses_products(T_ab, T_bc):
    """The inverse times the pose is the identity, and that of a product is the reversed one."""
    assert_allclose(se3.inverse(T_ab) @ T_ab, np.eye(4), rtol=0, atol=1e-13)
    product = se3.inverse(T_bc) @ se3.inverse(T_ab)
    assert_allclose(se3.inverse(T_ab @ T_bc), product, rtol=0, atol=1e-13)


@given(turns, turns)
def test_the_orientation_error_takes_the_actual_to_the_desired(a, b):
    """As a rotation before the actual one it gives the desired; its length is their angle."""
    R_wd, R_wt = se3.rotation(a), se3.rotation(b)
    e = se3.orientation_error(R_wd, R_wt)
    assert_allclose(se3.rotation(e) @ R_wt, R_wd, rtol=0, atol=1e-8)
    assert_allclose(np.linalg.norm(e), se3.angle_between(R_wd, R_wt), rtol=0, atol=1e-9)


@given(turns, vectors)
def test_the_orientation_error_has_the_sign_of_target_minus_actual(phi, w):
    """A body that turns at w on its way to the target makes the error shrink along w."""
    R_wt, small = se3.rotation(phi), 1e-4 * w
    assert_allclose(
        se3.orientation_error(se3.rotation(small) @ R_wt, R_wt), small, rtol=0, atol=1e-12
    )


def test_a_pose_is_made_of_its_parts():
    """The rotation is its upper left part, and the origin goes to the given point."""
    R, p = se3.rotation([0.1, 0.2, 0.3]), [1.0, 2.0, 3.0]
    T = se3.pose(R, p)
    assert_allclose(T[:3, :3], R)
    assert_allclose(T @ [0, 0, 0, 1], [1, 2, 3, 1])
