"""The joint solver: the torques of motors, dry friction and stops are what their laws say."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import labkit as lk
from labkit.joints import HIGH, LOW, SLIP_DOWN, SLIP_UP, STICK, joint_torques

MODEL = lk.Model("left", lk.BAXTER)


def problems(random, count):
    """Random joints: heavy and light, motors and friction, some of them next to a stop."""
    for k in range(count):
        q = random.uniform(MODEL.robot.lower, MODEL.robot.upper)
        G = 1e-3 * np.linalg.inv(MODEL.mass_matrix(q))
        u = random.normal(size=7) * random.choice([0.01, 0.5, 3.0])
        target = random.normal(size=7) * random.choice([0.0, 0.5])
        bound = MODEL.robot.effort if k % 2 else np.array(lk.BAXTER.stiction)
        near = random.random(7) < 0.3
        slowest = np.where(near, random.uniform(-0.5, 0.2, 7), -1e3)
        fastest = np.where(near, slowest + random.uniform(0.01, 0.5, 7), 1e3)
        yield G, u, target, bound, slowest, fastest


@pytest.mark.parametrize("where", [LOW, STICK, HIGH])
def test_every_joint_obeys_its_law_wherever_the_search_begins(random, where):
    """At its stop, slipping with all there is, or at its target: one of them, to rounding."""
    for G, u, target, bound, slowest, fastest in problems(random, 1000):
        y, stands = joint_torques(G, u, target, bound, slowest, fastest, [where] * 7)
        v, k = u + G @ y, np.array(stands)
        goal = np.clip(target, slowest, fastest)
        assert_allclose(v[k == LOW], slowest[k == LOW], rtol=0, atol=1e-9)
        assert_allclose(v[k == STICK], goal[k == STICK], rtol=0, atol=1e-9)
        assert_allclose(v[k == HIGH], fastest[k == HIGH], rtol=0, atol=1e-9)
        assert_allclose(y[k == SLIP_UP], bound[k == SLIP_UP])
        assert_allclose(y[k == SLIP_DOWN], -bound[k == SLIP_DOWN])
        assert (y >= bound - 1e-9)[k == LOW].all()
        assert (np.abs(y) <= bound + 1e-9)[k == STICK].all()
        assert (y <= 1e-9 - bound)[k == HIGH].all()
        assert (v <= goal + 1e-9)[k == SLIP_UP].all()
        assert (v >= goal - 1e-9)[k == SLIP_DOWN].all()
        assert ((slowest - 1e-9 <= v) & (v <= fastest + 1e-9)).all()


@pytest.mark.parametrize(("state", "way"), [(SLIP_UP, 1.0), (SLIP_DOWN, -1.0)])
def test_a_joint_that_just_comes_to_its_target_keeps_its_state(state, way):
    """With all of its bound, neither faster nor slower."""
    one, far = np.ones(2), np.full(2, np.inf)
    y, states = joint_torques(np.eye(2), 0.0 * one, way * one, one, -far, far, [state] * 2)
    assert states == [state] * 2
    assert y.tolist() == [way] * 2


def test_a_search_without_an_end_is_a_sentence(random, monkeypatch):
    """It does not return torques that nobody found."""
    (problem,) = problems(random, 1)
    monkeypatch.setattr("labkit.joints._ROUNDS", 1)
    with pytest.raises(lk.LabkitError, match=r"not found in 1 rounds.*check those of the robot"):
        joint_torques(*problem, [LOW] * 7)


def test_no_motor_leaves_the_range_of_its_joint():
    """A torque into the stop ends on it and stays there; away from it, the joint comes free."""
    with lk.Arm(q0=MODEL.robot.ready) as arm:
        gravity = arm.model.gravity
        push = np.array([0, 0, 0, 0, 0, 0, 5.0])
        for sign, stop in ((1.0, arm.robot.upper[6]), (-1.0, arm.robot.lower[6])):
            for _ in range(600):
                arm.apply(lk.JointTorque(gravity(arm.truth().q) + sign * push))
                arm.world.step()
            assert arm.truth().q[6] == pytest.approx(stop, abs=1e-9)
            assert arm.truth().dq[6] == pytest.approx(0.0, abs=1e-9)
