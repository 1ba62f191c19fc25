"""Walls, tables, springs and pushes, and what the arm feels of them."""

import numpy as np
import pytest

import labkit as lk
from labkit.scene import TIP_RADIUS, TIP_STIFFNESS, contact_stiffness

READY = lk.robot("left").ready
MODEL = lk.Model()
TIP = MODEL.pose(READY)[:3, 3]
WRENCH = np.array([3.0, -5.0, 7.0, 0.3, 0.2, -0.4])


def swing(arm, kind, steps=60):
    """Move the arm about and give the states before and after the last step."""
    for k in range(steps):
        before = arm.truth()
        wish = 0.4 * np.sin(0.05 * k + np.arange(7))
        if kind is lk.JointTorque:
            wish = wish + arm.model.gravity(before.q) * (not arm.plant.gravity_compensation)
        elif kind is lk.JointPosition:
            wish = READY + 0.1 * wish
        arm.apply(kind(wish))
        arm.world.step()
    return before, arm.truth()


@pytest.mark.parametrize("kind", [lk.JointTorque, lk.JointVelocity, lk.JointPosition])
@pytest.mark.parametrize(
    "plant", [lk.IDEAL, lk.Plant(gravity_compensation=True, viscous=0.7, stiction=0.3)]
)
def test_the_arm_feels_a_push_in_every_mode_and_no_friction_of_its_own(plant, kind):
    """tau_ext is J^T F to 1e-6 N m, whatever the mode, the motion and the friction."""
    push = lk.Push(WRENCH[:3], WRENCH[3:], start=0.03)
    with lk.Arm(plant=plant, q0=READY, world=lk.World(things=[push])) as arm:
        before, after = swing(arm, kind)
        assert np.abs(before.dq).max() > 1e-3
        J = arm.model.tip_jacobian(before.q)
        assert after.tau_ext == pytest.approx(J.T @ WRENCH, abs=1e-6)
        assert arm.model.tip_wrench(before.q, after.tau_ext) == pytest.approx(WRENCH, abs=1e-5)


def test_nothing_is_felt_before_and_after_the_window():
    """A push acts from its start for its duration, and not one physics step longer."""
    push = lk.Push((0.0, 0.0, 5.0), start=0.010, duration=0.020)
    with lk.Arm(q0=READY, world=lk.World(things=[push])) as arm:
        felt = []
        for _ in range(50):
            arm.apply(lk.JointTorque(arm.model.gravity(arm.truth().q)))
            arm.world.step()
            felt.append(np.abs(arm.truth().tau_ext).max() > 1e-3)
    assert np.flatnonzero(felt).tolist() == list(range(10, 30))


def test_an_empty_world_is_felt_as_exactly_nothing():
    """Without things and payload the estimate is zero, and costs nothing."""
    with lk.Arm(q0=READY) as arm:
        _, after = swing(arm, lk.JointTorque)
        assert not after.tau_ext.any()
        assert not lk.State(0.0, READY, READY).tau_ext.any()


def press(thing, depth=0.03, K=300.0):
    """Press on a face with a spring to a place behind it; the wrench and the tip's position."""
    goal = TIP - depth * thing.T_wf[:3, 2]
    with lk.Arm(q0=READY, world=lk.World(things=[thing])) as arm:

        def pull(state, target):
            J = MODEL.tip_jacobian(state.q)
            f = K * (goal - MODEL.pose(state.q)[:3, 3])
            tau = (
                J[:3].T @ f
                + MODEL.gravity(state.q)
                - [8.0, 8.0, 4.0, 4.0, 0.1, 0.1, 0.05] * (state.dq)
            )
            return lk.JointTorque(tau)

        log = lk.run(arm, lk.Hold(READY, 4.0), pull, rate=1000)
    wrench = MODEL.tip_wrench(log.q[-1], log.measured.tau_ext[-1])
    return wrench, MODEL.pose(log.q[-1])[:3, 3]


@pytest.mark.parametrize("stiffness", [1e3, 1e4, 1e5])
def test_contact_stiffnesses_are_in_series(stiffness):
    """Force over penetration is 1/(1/k_wall + 1/k_tip)."""
    wall = lk.Wall(TIP + (TIP_RADIUS + 0.002) * np.eye(3)[0], (-2.0, 0, 0), stiffness=stiffness)
    wrench, p = press(wall)
    penetration = TIP_RADIUS - (p - wall.point) @ wall.normal
    series = stiffness * TIP_STIFFNESS / (stiffness + TIP_STIFFNESS)
    assert contact_stiffness(wall) == pytest.approx(series)
    assert wrench[:3] @ wall.normal / penetration == pytest.approx(series, rel=1e-4)
    assert wrench[3:] == pytest.approx(np.zeros(3), abs=1e-3)  # through the ball's centre


def test_contact_dampings_add_up():
    """What a tip feels that is driven into a face is k depth + (d1 + d2) v, at the step's end."""
    face = lk.Wall(TIP + 0.004 * np.eye(3)[0], (-1.0, 0, 0), stiffness=2000.0, damping=300.0)
    inwards = np.linalg.pinv(MODEL.tip_jacobian(READY))[:, 0] * 0.05
    with lk.Arm(q0=READY, world=lk.World(things=[face])) as arm:
        arm.apply(lk.JointVelocity(inwards))
        for _ in range(5):
            before = arm.truth()
            arm.world.step()
        after = arm.truth()
        felt = MODEL.tip_wrench(before.q, after.tau_ext)
    v = MODEL.tip_jacobian(before.q)[0] @ after.dq
    depth = TIP_RADIUS + MODEL.pose(before.q)[0, 3] + 1e-3 * v - face.point[0]
    assert felt[0] == pytest.approx(-contact_stiffness(face) * depth - 320.0 * v, rel=1e-6)
    assert felt[[1, 2]] == pytest.approx(np.zeros(2), abs=1e-6)


def test_a_wall_of_any_damping_lets_go_and_never_pulls():
    """A tip that leaves is not held: from a heavily damped face, too."""
    face = lk.Wall(TIP + 0.004 * np.eye(3)[0], (-1.0, 0, 0), stiffness=2000.0, damping=1e5)
    away = np.linalg.pinv(MODEL.tip_jacobian(READY))[:, 0] * -0.2
    with lk.Arm(q0=READY, world=lk.World(things=[face])) as arm:
        arm.apply(lk.JointVelocity(away))
        for _ in range(50):
            arm.world.step()
            force = MODEL.tip_wrench(READY, arm.truth().tau_ext)[0]
            assert force < 1e-9
        assert force == pytest.approx(0.0, abs=1e-9)


def test_the_table_holds_the_tip_up():
    """Pressed with 9 N from above, the tip stays on the table top, a millimetre deep."""
    table = lk.Table(height=TIP[2] - TIP_RADIUS - 0.002)
    wrench, p = press(table)
    assert table.height + TIP_RADIUS - 2e-3 < p[2] < table.height + TIP_RADIUS
    assert wrench[2] == pytest.approx(300.0 * (0.03 - (TIP[2] - p[2])), rel=0.01)


def test_a_spring_pulls_by_its_law():
    """The felt force of a spring is k (anchor - p) - d v, where the step ends."""
    spring = lk.Spring(TIP + 0.1 * np.ones(3), stiffness=80.0, damping=6.0)
    with lk.Arm(q0=READY, world=lk.World(things=[spring])) as arm:
        before, after = swing(arm, lk.JointVelocity)
        p, v = MODEL.pose(before.q)[:3, 3], MODEL.tip_jacobian(before.q)[:3] @ after.dq
        wrench = MODEL.tip_wrench(before.q, after.tau_ext)
    assert wrench[:3] == pytest.approx(spring.force(p + 1e-3 * v, v), abs=1e-9)
    assert np.abs(wrench[:3]).max() > 5.0
