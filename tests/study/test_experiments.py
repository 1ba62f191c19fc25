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
    """The ideal tip obeys the smallest push; Baxter's does not move below its stiction."""
    forces = np.array([1.0, 2.0, 8.0])
    given = forces / TIP_SPRING[2]

    def moved(plant):
        """Where each push holds the tip, and where the tip rests afterwards, in [m]."""
        how = {"duration": 2.0, "rest": 2.0, "plant": plant, "names": ("workspace impedance",)}
        runs = [experiments.push(np.array([0.0, 0.0, force]), **how)[0] for force in forces]
        ends = [(np.searchsorted(run.t, 2.0 - 1e-9), -1) for run in runs]
        return np.array([run.displacement[k, 2] for run, k in zip(runs, ends, strict=True)]).T

    pushed, released = moved(lk.IDEAL)
    assert pushed == pytest.approx(given, rel=0.03) and np.abs(released).max() < 1e-4
    stiff, stuck = moved(lk.BAXTER)
    assert list(stiff < 0.1 * given) == [True, False, False]
    assert (stiff < pushed).all()
    assert stuck[-1] > 3e-3  # and stays where the friction can hold it
