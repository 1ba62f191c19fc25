"""Baxter's data: the lumped arm is the whole robot's arm, whoever computes it."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from make_urdf import JOINTS, full_model
from numpy.testing import assert_allclose

import labkit as lk
from labkit.robot import _rpy

FULL = full_model()
ROTORS = lk.Plant(name="rotors", armature=lk.BAXTER.armature)


def expanded(side, x, fill):
    """A vector of the whole robot that is ``x`` at this arm's joints and ``fill`` elsewhere."""
    out = np.array(fill, dtype=float)
    for joint, value in zip(JOINTS, x, strict=True):
        out[FULL.joints[FULL.getJointId(f"{side}_{joint}")].idx_v] = value
    return out


def test_the_lumped_arm_has_the_dynamics_of_the_whole_robot(side, states, random):
    """Torques for random motions agree to 1e-9 N m with all of Baxter, every fixed link kept."""
    data, model = FULL.createData(), lk.Model(side)
    idle = np.zeros(FULL.nv)
    arm = expanded(side, np.ones(7), idle).astype(bool)
    for q, dq in states(side, 500):
        ddq = random.uniform(-10.0, 10.0, 7)
        full = pin.rnea(FULL, data, *(expanded(side, x, idle) for x in (q, dq, ddq)))
        lumped = model.mass_matrix(q) @ ddq + model.bias(q, dq)
        assert_allclose(lumped, full[arm], rtol=0, atol=1e-9)


def test_the_tip_is_where_the_whole_robot_has_its_gripper(side, states):
    """In 50 random poses the lumped arm puts the gripper where all of Baxter has it."""
    data, model = FULL.createData(), lk.Model(side)
    tip = FULL.getFrameId(f"{side}_gripper")
    for q, _ in states(side, 50):
        pin.framesForwardKinematics(FULL, data, expanded(side, q, np.zeros(FULL.nq)))
        assert_allclose(model.pose(q), data.oMf[tip].homogeneous, rtol=0, atol=1e-12)


def test_limits_are_rethinks(side):
    """Torque and speed limits are the published ones, and the ranges of angle those of the URDF."""
    r = lk.robot(side)
    assert r.effort.tolist() == [50, 100, 50, 50, 15, 15, 15]
    assert r.speed.tolist() == [1.5, 1.5, 1.5, 1.5, 4, 4, 4]
    for i, joint in enumerate(JOINTS):
        v = FULL.joints[FULL.getJointId(f"{side}_{joint}")].idx_v
        assert (r.lower[i], r.upper[i]) == pytest.approx(
            (FULL.lowerPositionLimit[v], FULL.upperPositionLimit[v])
        )
    assert r.joint_names == tuple(f"{side}_{j}" for j in JOINTS)


@pytest.mark.parametrize("pose", ["neutral", "ready"])
def test_named_poses_lie_inside_the_limits(side, pose):
    """Neutral and ready pose are strictly within the range of each joint."""
    r = lk.robot(side)
    q = getattr(r, pose)
    assert (r.lower < q).all()
    assert (q < r.upper).all()


def test_a_payload_hangs_at_the_tip(side, states):
    """The torque it adds is J^T times its weight."""
    light, heavy = lk.Model(side), lk.Model(side, lk.Plant(payload=2.0))
    for q, _ in states(side, 20):
        weight = light.tip_jacobian(q)[2] * 2.0 * 9.81
        assert_allclose(heavy.gravity(q) - light.gravity(q), weight, rtol=0, atol=1e-12)


def test_rotors_add_to_the_diagonal_of_the_mass_matrix_and_no_weight(side, states):
    """Reflected inertia: a rotor turns fast with its joint, and hardly by being carried."""
    light, heavy = lk.Model(side), lk.Model(side, ROTORS)
    for q, dq in states(side, 20):
        more = heavy.mass_matrix(q) - light.mass_matrix(q)
        assert_allclose(more, np.diag(ROTORS.armature), rtol=0, atol=1e-12)
        assert_allclose(heavy.bias(q, dq), light.bias(q, dq), rtol=0, atol=1e-12)
        energy = heavy.kinetic_energy(q, dq) - light.kinetic_energy(q, dq)
        assert_allclose(energy, 0.5 * dq @ more @ dq, rtol=0, atol=1e-12)


def test_a_rotation_survives_being_written_as_roll_pitch_yaw(side, random):
    """Also at a pitch of a quarter turn, where roll and yaw are one, and next to it."""
    for nearly in (0.0, 1e-16, 5e-12, 1e-8, 1e-3, 1.0):
        for pitch in (np.pi / 2 - nearly, nearly - np.pi / 2):
            R = pin.rpy.rpyToMatrix(random.uniform(-3, 3), pitch, random.uniform(-3, 3))
            assert_allclose(pin.rpy.rpyToMatrix(_rpy(R)), R, rtol=0, atol=5e-12)


def test_the_data_cannot_be_changed_by_accident(side):
    """Neither a number in a robot's limits nor the limits themselves can be replaced."""
    r = lk.robot(side)
    with pytest.raises(ValueError, match="read-only"):
        r.effort[0] = 1e9
    with pytest.raises(dataclasses.FrozenInstanceError):
        r.effort = np.ones(7)
