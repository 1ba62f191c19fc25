"""Kinematics: Jacobians are slopes, and inverse kinematics comes back."""

import re

import numpy as np
import pytest
from arms import FILES, arm
from curves import assert_slopes, slope_along
from numpy.testing import assert_allclose

import labkit as lk
from labkit import se3
from labkit.errors import JointLimitExceeded, LabkitWarning, Unreachable

STEP = 1e-6


def test_the_three_jacobians_are_the_slopes_of_the_pose(side, model, states):
    """Each for its twist: body, spatial by the twist as a matrix, tip by origin and orientation."""
    for q, dq in states(side):
        before, T, after = (model.pose(q + k * STEP * dq) for k in (-1, 0, 1))
        dT = (after - before) / (2 * STEP)
        body, space = (
            np.concatenate([hat[:3, 3], se3.vee(hat[:3, :3])])
            for hat in (se3.inverse(T) @ dT, dT @ se3.inverse(T))
        )
        turn = se3.orientation_error(after[:3, :3], before[:3, :3])
        tip = np.concatenate([after[:3, 3] - before[:3, 3], turn]) / (2 * STEP)
        assert_allclose(model.body_jacobian(q) @ dq, body, rtol=0, atol=1e-7)
        assert_allclose(model.spatial_jacobian(q) @ dq, space, rtol=0, atol=1e-7)
        assert_allclose(model.tip_jacobian(q) @ dq, tip, rtol=0, atol=1e-7)


def test_the_jacobians_are_one_another_seen_from_elsewhere(side, model, states):
    """The pose's adjoint makes the body Jacobian the spatial one, its rotation the tip's."""
    for q, _ in states(side):
        T, J_b = model.pose(q), model.body_jacobian(q)
        turn, across = np.kron(np.eye(2), T[:3, :3]), np.eye(6)
        across[:3, 3:] = se3.hat(T[:3, 3])
        assert_allclose(model.spatial_jacobian(q), across @ turn @ J_b, rtol=0, atol=1e-12)
        assert_allclose(model.tip_jacobian(q), turn @ J_b, rtol=0, atol=1e-12)


def test_the_jacobians_rate_is_its_slope(side, model, states):
    """The rate is the slope of the tip's Jacobian along the motion."""
    for q, dq in states(side):
        assert_allclose(
            model.tip_jacobian_rate(q, dq),
            slope_along(model.tip_jacobian, q, dq),
            rtol=0,
            atol=2e-8,
        )


def test_a_point_of_each_body_moves_by_its_jacobian(side, model, states):
    """On the seven bodies and in the tip's frame."""
    point = np.array([0.1, -0.2, 0.3])
    for body, (q, dq) in enumerate(states(side, 8)):
        slope = slope_along(lambda q, k=body: model.point_on(q, k, point)[0], q, dq)
        assert_allclose(model.point_on(q, body, point)[1] @ dq, slope, rtol=0, atol=1e-7)


def test_manipulability_is_the_volume_and_nearness_the_shortest_axis(side, model, states):
    """Both are those of the ellipsoid of J J^T: product of the axes and least axis."""
    for q, _ in states(side):
        J = model.tip_jacobian(q)
        axes = np.sqrt(np.linalg.eigvalsh(J @ J.T))
        assert model.manipulability(q) == pytest.approx(np.prod(axes))
        assert model.nearness_to_singularity(q) == pytest.approx(axes[0], rel=1e-6)


def test_a_stretched_arm_is_nearer_to_a_singularity_than_a_bent_one(model):
    """At zero angles both measures are below 0.3 of what they are in the ready pose."""
    stretched, bent = np.zeros(7), model.robot.ready
    for measure in (model.nearness_to_singularity, model.manipulability):
        assert measure(stretched) < 0.3 * measure(bent)


def test_inverse_kinematics_returns_to_the_pose(side, model, random):
    """From the ready pose to poses of nearby angles, within limits and to seven digits."""
    r = model.robot
    for _ in range(30):
        T = model.pose(r.ready + random.uniform(-0.3, 0.3, 7))
        q = model.inverse_kinematics(T, r.ready)
        assert_allclose(model.pose(q), T, rtol=0, atol=2e-9)
        assert (r.lower <= q).all()
        assert (q <= r.upper).all()


def test_of_all_answers_it_gives_the_one_nearest_to_the_posture(side, model, random):
    """What remains of the way to the posture cannot be gone without moving the tip."""
    r = model.robot
    for _ in range(10):
        T = model.pose(r.ready + random.uniform(-0.2, 0.2, 7))
        q = model.inverse_kinematics(T, r.ready)
        *_, null = np.linalg.svd(model.tip_jacobian(q))
        assert null[-1] @ (r.ready - q) == pytest.approx(0.0, abs=1e-8)


def test_the_answer_is_the_posture_itself_where_that_fits(model):
    """With the ready angles as posture, a search for the ready pose from 0.1 rad off ends there."""
    r = model.robot
    q = model.inverse_kinematics(model.pose(r.ready), r.ready + 0.1, posture=r.ready)
    assert_allclose(q, r.ready, rtol=0, atol=1e-8)


def circle(model, turns=1.0):
    p = model.pose(model.robot.ready)[:3, 3]
    return lk.Trajectory(lk.Circle(p, p - [0.1, 0.0, 0.0], turns), lk.Quintic(4.0))


def test_a_joint_trajectory_keeps_the_tip_on_its_path(model):
    """On a circle the tip is at its target to 1e-6 m and keeps its orientation."""
    q0 = model.robot.ready
    target, R = circle(model), model.pose(q0)[:3, :3]
    joints = model.joint_trajectory(target, q0)
    for t in np.linspace(0.0, 4.0, 57):
        T = model.pose(joints(t).position)
        assert_allclose(T[:3, 3], target(t).position, rtol=0, atol=1e-6)
        assert_allclose(T[:3, :3], R, rtol=0, atol=1e-6)


def test_a_closed_path_gives_closed_joints(model):
    """After a whole circle the joint angles are those of its start."""
    q0 = model.robot.ready
    joints = model.joint_trajectory(circle(model), q0)
    assert_allclose(joints(0.0).position, q0, rtol=0, atol=1e-8)
    assert_allclose(joints(4.0).position, joints(0.0).position, rtol=0, atol=1e-8)


@pytest.mark.parametrize("t", [0.31, 1.0, 2.2, 3.7])
def test_a_joint_trajectorys_velocity_and_acceleration_are_its_slopes(model, t):
    """Its velocity also moves the tip at the path's, to 1e-4 m/s."""
    joints = model.joint_trajectory(circle(model), model.robot.ready)
    assert_slopes(joints, t)
    x, dx, _ = joints(t)
    assert_allclose(model.tip_jacobian(x)[:3] @ dx, circle(model)(t).velocity, rtol=0, atol=1e-4)


def test_a_joint_trajectory_follows_poses_that_turn(model):
    """Place and orientation are the target's to 1e-6 at 23 times of a line with a turn."""
    q0 = model.robot.ready
    T = model.pose(q0)
    goal = se3.rotation([0.0, 0.3, 0.2]) @ T[:3, :3]
    path = lk.PosePath(lk.Line(T[:3, 3], T[:3, 3] + [0.05, 0.1, 0.05]), T[:3, :3], goal)
    target = lk.Trajectory(path, lk.Cubic(2.0))
    joints = model.joint_trajectory(target, q0)
    for t in np.linspace(0.0, 2.0, 23):
        assert_allclose(model.pose(joints(t).position), target(t).pose, rtol=0, atol=1e-6)


def test_a_chain_stays_a_chain_and_is_continuous(model):
    """Its parts, nested ones too, keep their starts, and the joint angles jump at none of them."""
    q0 = model.robot.ready
    p = model.pose(q0)[:3, 3]
    corners = [p, p + [0.1, 0, 0], p + [0.1, 0.1, 0], p]
    parts = [lk.Trajectory(line, lk.Quintic(1.0)) for line in lk.Polyline(corners).lines]
    joints = model.joint_trajectory(lk.Chain([parts[0], lk.Chain(parts[1:])]), q0)
    assert joints.starts == [0.0, 1.0, 2.0]
    for t in (1.0, 2.0):
        assert_allclose(joints(t - 1e-9).position, joints(t).position, rtol=0, atol=1e-7)
    assert_allclose(joints(3.0).position, q0, rtol=0, atol=1e-7)


def test_a_hold_becomes_a_hold_of_joint_angles(model):
    """A pose or a point held for 2 s becomes the present joint angles held for 2 s."""
    q0 = model.robot.ready
    for place in (model.pose(q0), model.pose(q0)[:3, 3]):
        hold = model.joint_trajectory(lk.Hold(place, 2.0), q0)
        assert hold.duration == 2.0
        assert_allclose(hold(1.0).position, q0, rtol=0, atol=1e-8)


def test_a_pose_that_another_start_reaches_is_not_called_out_of_reach():
    """A search from the ready pose fails, one from the pose's own angles does not."""
    model, q = lk.Model("left"), np.array([0.13, -0.73, 2.63, 0.06, 1.42, 0.68, -2.89])
    with pytest.raises(Unreachable, match="was not found from this q0") as got:
        model.inverse_kinematics(model.pose(q), model.robot.ready)
    assert "cannot" not in str(got.value)
    assert_allclose(model.inverse_kinematics(model.pose(q), q), q, rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", ["left", *FILES])
def test_no_pose_that_the_arm_has_is_called_out_of_reach(name, random, monkeypatch):
    """Of three robots, 500 angles each within the limits; one step is too short a search."""
    monkeypatch.setattr("labkit.inverse._ITERATIONS", 1)
    model = lk.Model(arm(name) if name in FILES else name)
    robot = model.robot
    for q in random.uniform(robot.lower, robot.upper, (500, robot.n)):
        with pytest.raises(Unreachable, match="was not found from this q0"):
            model.inverse_kinematics(model.pose(q), robot.ready)


@pytest.mark.parametrize("name", ["left", *FILES])
def test_a_pose_two_metres_above_the_ready_one_is_called_out_of_reach(name):
    """On each of three robots, from a start that has the first joint elsewhere too."""
    model = lk.Model(arm(name) if name in FILES else name)
    T = model.pose(model.robot.ready)
    T[2, 3] += 2.0
    for turn in (0.0, 1.0):
        q0 = model.robot.ready + turn * np.eye(model.robot.n)[0]
        with pytest.raises(Unreachable, match=r"cannot be reached: .* bring it nearer"):
            model.inverse_kinematics(T, q0)


def test_the_error_says_how_near_the_search_came_not_where_it_ended():
    """Of a line that goes 1 cm from pose to pose, no error is larger than 1 cm."""
    model = lk.Model("left")
    q0 = model.robot.ready
    p = model.pose(q0)[:3, 3]
    for way in ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.7, 0.7, 0.0], [0.0, 0.0, -1.0]):
        line = lk.Trajectory(lk.Line(p, p + way), lk.Quintic(2.0))
        with pytest.raises(Unreachable) as got:
            model.joint_trajectory(line, q0)
        assert float(re.search(r"nearest found: (\S+) mm", str(got.value))[1]) <= 10.0


def test_angles_in_degrees_are_no_start_and_no_posture(model):
    """A measured start 0.05 rad beyond a limit is one."""
    ready, T = model.robot.ready, model.pose(model.robot.ready)
    with pytest.raises(JointLimitExceeded, match=r"^q0: joint .* in degrees\?"):
        model.inverse_kinematics(T, np.degrees(ready))
    with pytest.raises(JointLimitExceeded, match=r"^posture: joint .* in degrees\?"):
        model.inverse_kinematics(T, ready, posture=np.degrees(ready))
    q0 = np.array(ready)
    q0[6] = model.robot.upper[6] + 0.05
    assert_allclose(model.inverse_kinematics(T, q0, posture=ready), ready, rtol=0, atol=1e-8)


def test_too_much_speed_is_a_warning_with_the_time_that_would_do(recwarn):
    """A duration that it names is accepted without a warning."""
    model = lk.Model()
    ready, p = model.robot.ready, model.pose(model.robot.ready)[:3, 3]
    line = lk.Line(p, p + [0.1, 0.2, 0.1])
    with pytest.warns(LabkitWarning) as got:
        model.joint_trajectory(lk.Trajectory(line, lk.Quintic(0.2)), ready)
    enough = float(str(got[0].message).rsplit("takes ", 1)[1].split()[0])
    assert 0.2 < enough < 2.0
    model.joint_trajectory(lk.Trajectory(line, lk.Quintic(1.01 * enough)), ready)
    assert not recwarn.list
