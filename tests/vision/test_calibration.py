"""Calibration finds the camera, says how well, and says when it cannot."""

import numpy as np
import pytest

import labkit as lk
from labkit import se3
from labkit.vision.calibration import SingularViews, calibrate_fixed_camera, calibrate_hand_camera

TIP_TO_TAG = se3.pose(se3.rotation(np.array([0.2, -0.1, 0.9])), np.array([0.02, -0.03, 0.05]))
WORLD_TO_CAMERA = lk.looking_at((1.6, 0.2, 0.6), (0.6, 0.3, 0.1))


def tips(count, random, turn=0.6):
    home = lk.Model("left").pose(lk.robot("left").ready)
    return np.array(
        [home @ se3.exp(random.uniform(-1, 1, 6) * ([0.1] * 3 + [turn] * 3)) for _ in range(count)]
    )


def jostled(poses, random, place=5e-4, turn=2e-3):
    size = np.array([place] * 3 + [turn] * 3)
    return np.array([T @ se3.exp(size * random.standard_normal(6)) for T in poses])


def off(T, truth):
    e = se3.pose_error(truth, T)
    return np.linalg.norm(e[:3]), np.linalg.norm(e[3:])


def test_a_fixed_camera_is_found_exactly_from_exact_views():
    T_wt = tips(6, np.random.default_rng(0))
    T_cm = np.array([se3.inverse(WORLD_TO_CAMERA) @ T @ TIP_TO_TAG for T in T_wt])
    found = calibrate_fixed_camera(T_wt, T_cm)
    np.testing.assert_allclose(found.camera, WORLD_TO_CAMERA, atol=1e-8)
    np.testing.assert_allclose(found.tag, TIP_TO_TAG, atol=1e-8)
    assert found.residual_mm < 1e-5 and found.views == 6


def test_a_camera_in_the_hand_is_found_exactly_from_exact_views():
    robot = lk.robot("left")
    T_tc = se3.inverse(robot.T_hand_tip) @ robot.T_hand_camera
    T_wm = se3.pose(se3.rotation(np.array([0.0, 0.1, 0.4])), np.array([0.7, 0.3, -0.3]))
    T_wt = tips(6, np.random.default_rng(1))
    T_cm = np.array([se3.inverse(T @ T_tc) @ T_wm for T in T_wt])
    found = calibrate_hand_camera(T_wt, T_cm)
    np.testing.assert_allclose(found.camera, T_tc, atol=1e-8)
    np.testing.assert_allclose(found.tag, T_wm, atol=1e-8)


def test_more_views_make_it_better_and_the_residual_tells_the_noise():
    """Four times as many views, about half the error; the residual is of the noise's size."""
    random = np.random.default_rng(2)
    errors = {}
    for count in (6, 24):
        places = []
        for _ in range(8):
            T_wt = tips(count, random)
            exact = [se3.inverse(WORLD_TO_CAMERA) @ T @ TIP_TO_TAG for T in T_wt]
            found = calibrate_fixed_camera(T_wt, jostled(exact, random))
            places.append(off(found.camera, WORLD_TO_CAMERA)[0])
            assert 0.2 < found.residual_mm < 5.0
        errors[count] = np.sqrt(np.mean(np.square(places)))
    assert errors[24] < 0.75 * errors[6]


def test_views_that_turn_about_one_axis_only_are_refused():
    home = tips(1, np.random.default_rng(3))[0]
    spun = np.array([home @ se3.exp(np.array([0, 0, 0, 0, 0, a])) for a in (0, 0.4, 0.8, 1.2)])
    T_cm = np.array([se3.inverse(WORLD_TO_CAMERA) @ T @ TIP_TO_TAG for T in spun])
    with pytest.raises(SingularViews, match=r"turns about one axis only.*tilt the gripper"):
        calibrate_fixed_camera(spun, T_cm)
    with pytest.raises(SingularViews, match="does not turn"):
        calibrate_hand_camera(spun[[0, 0, 0, 0]], T_cm[[0, 0, 0, 0]])


def test_two_views_are_too_few():
    T = tips(2, np.random.default_rng(4))
    with pytest.raises(SingularViews, match="at least 3"):
        calibrate_fixed_camera(T, T)


def test_real_pictures_calibrate_the_hand_camera():
    """Ten views of a tag by the hand camera find it to 3 mm and half a degree."""
    with lk.Arm("left") as arm:
        home, camera = arm.robot.ready, lk.Camera.in_hand(arm)
        arm.reset(home)
        at = camera.T_wc[:3, 3] + 0.5 * camera.T_wc[:3, 2]
        lk.Board(arm.world, lk.Tag(), se3.pose(np.eye(3), at))
        random, T_wt, T_cm = np.random.default_rng(5), [], []
        T_home = arm.model.pose(home)
        while len(T_wt) < 10:
            turn = random.uniform(-0.3, 0.3, 3)
            goal = T_home @ se3.exp(np.concatenate([[turn[1] * -0.4, turn[0] * 0.4, 0], turn]))
            try:
                arm.reset(arm.model.inverse_kinematics(goal, home))
            except lk.errors.Unreachable:
                continue
            seen = lk.detect_tags(camera.glimpse(), camera, {0: 0.1})
            if seen:
                T_wt.append(arm.model.pose(arm.state().q))
                T_cm.append(seen[0].T_cm)
        found = calibrate_hand_camera(T_wt, T_cm)
        place, turn = off(found.camera, se3.inverse(arm.robot.T_hand_tip) @ arm.robot.T_hand_camera)
    assert place < 3e-3 and np.degrees(turn) < 0.5
