"""What the model texts of the whys say of a run is what a run gives."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import labkit as lk
from solutions.torque_control.answers import computed_torque

TORQUE = Path("solutions/torque_control/04_torque_control.py")


def _sag(plant: lk.Plant, controller: object) -> float:
    """By how much the tip sags at the ready pose, in [mm]."""
    ready = lk.Model("left").robot.ready
    with lk.Arm("left", plant, q0=ready) as arm:
        z = lk.metrics.tip_poses(lk.run(arm, lk.Hold(ready, 3.0), controller))[:, 2, 3]
    return float(1e3 * (z[0] - z[-1]))


def test_springs_sag_further_under_the_load_than_computed_torque_of_the_same_number():
    """The tip sags by 21 mm under computed torque with kp = 40, by 38 mm with springs of 40."""
    text = TORQUE.read_text(encoding="utf-8").split('why="why_unknown_load"')[1]
    plant = lk.Plant(name="self-carrying", armature=0.05, gravity_compensation=True)
    model, loaded = lk.Model("left", plant), replace(plant, payload=0.5)

    def computed(state: lk.State, target: lk.Sample) -> lk.JointTorque:
        gains = {"kp": 40.0, "kd": 2 * 40.0**0.5, "arm_compensates": True}
        return computed_torque(state, target, model, **gains)

    assert f"sagged by {_sag(loaded, computed):.0f} mm" in text
    assert f"{_sag(loaded, lk.control.springs(40.0, 12.0)):.0f} mm" in text
    stiffness = 40.0 * np.diag(model.mass_matrix(model.robot.ready))
    assert np.allclose(stiffness[:2], 80.0, atol=5.0)
    assert stiffness[4:].min() > 1.9
    assert stiffness[4:].max() < 4.2
