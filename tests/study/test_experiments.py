"""Impedance you can feel: the experiments give what the equations promise, and differ visibly."""

import numpy as np
import pytest

import labkit as lk
from solutions.study import experiments
from solutions.study.gains import TIP_SPRING

K = np.array(TIP_SPRING)


def by_name(encounters):
    return {met.name: met for met in encounters}


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_static_push_moves_the_ideal_tip_by_force_over_stiffness(axis, sign):
    """10 N, or 1 N m, for 3 s: K^-1 F within 3 % in each direction, and nothing across."""
    wrench = sign * (10.0 if axis < 3 else 1.0) * np.eye(6)[axis]
    (met,) = experiments.push(wrench[:3], moment=wrench[3:], names=("workspace impedance",))
    moved = np.concatenate([met.displacement[-1], met.turn[-1]])
    assert moved == pytest.approx(wrench / K, abs=0.03 * abs(wrench / K).max())


def test_a_push_tells_the_controllers_apart():
    """Position mode does not give way, impedance by F/K, the others by what their gains make."""
    met = by_name(experiments.push((0.0, 10.0, 0.0)))
    gave = {name: m.at_rest[1] for name, m in met.items()}
    assert abs(gave["position"]) < 1e-4
    assert gave["workspace impedance"] == pytest.approx(10.0 / 300.0, rel=0.03)
    assert gave["joint torque"] > 1.3 * gave["workspace impedance"]
    assert gave["joint impedance"] > 2.0 * gave["joint torque"]
    assert abs(met["workspace impedance"].at_rest[2]) < 1e-4  # straight; joint springs go askew
    assert abs(met["joint impedance"].at_rest[2]) > 5e-3


def test_after_a_push_the_ideal_arm_comes_back():
    """Let go, every contender of the ideal arm returns to its place."""
    for met in experiments.push((0.0, 10.0, 0.0), duration=1.0, rest=3.0):
        assert np.linalg.norm(met.displacement[-1]) < 2e-3, met.name


@pytest.mark.parametrize("stiffness", [500.0, 5_000.0, 50_000.0])
def test_a_wall_is_pressed_as_the_springs_in_series_predict(stiffness):
    """Force within 5 % of K, wall and tip in series."""
    (met,) = experiments.wall(stiffness=stiffness, names=("workspace impedance",))
    face = experiments.the_wall(stiffness=stiffness)
    predicted = experiments.predicted_wall_force(face, K[0], 0.03)
    assert -met.force_at_rest[0] == pytest.approx(predicted, rel=0.05)


def test_a_wall_tells_the_controllers_apart():
    """Position mode presses several times as hard as the impedance controllers."""
    met = by_name(experiments.wall())
    force = {name: -m.force_at_rest[0] for name, m in met.items()}
    assert force["position"] > 4.0 * force["workspace impedance"]
    assert 0.5 < force["joint impedance"] < force["workspace impedance"]


def test_a_spring_tells_the_controllers_apart():
    """Tied to a spring, position mode arrives, impedance stops where the two springs balance."""
    met = by_name(experiments.spring(stiffness=200.0, way=0.1))
    assert np.linalg.norm(met["position"].at_rest) < 1e-3
    short = -met["workspace impedance"].at_rest[1]
    assert short == pytest.approx(0.1 * 200.0 / (200.0 + 300.0), rel=0.03)
    assert -met["joint torque"].at_rest[1] > 1.2 * short
    assert -met["joint impedance"].at_rest[1] > -met["joint torque"].at_rest[1]


def test_dry_friction_makes_a_dead_band():
    """The ideal tip obeys the smallest push; Baxter's gives way to none below its stiction."""
    forces = (1.0, 2.0, 8.0)
    ideal, baxter = (experiments.dead_band(p, forces=forces) for p in (lk.IDEAL, lk.BAXTER))
    assert ideal.width == 0.0
    assert ideal.pushed == pytest.approx(ideal.force / ideal.stiffness, rel=0.03)
    assert np.abs(ideal.released).max() < 1e-4
    assert baxter.width == 1.0
    assert (baxter.pushed < ideal.pushed).all()
    assert baxter.released[-1] > 3e-3  # and stays where the friction can hold it
