"""What the model texts of the whys say of a run is what a run gives."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course.notebook import WORDS, words_of
from labkit.replay.session import STRONGEST, Hand
from solutions.torque_control.answers import computed_torque
from solutions.velocity_control.answers import joint_velocity_pd

TORQUE = Path("solutions/torque_control/04_torque_control.py")
VELOCITY = Path("solutions/velocity_control/03_velocity_control.py")


@pytest.mark.parametrize("path", sorted(Path("solutions").glob("*/*_*.py")), ids=lambda x: x.stem)
def test_a_model_text_keeps_to_the_limits_that_students_have(path):
    """It has as many words as a why must have, and no more than it may."""
    for why in path.read_text(encoding="utf-8").split('# %% [markdown] why="')[1:]:
        model = why.split("# ### BEGIN SOLUTION\n")[1].split("# ### END SOLUTION")[0]
        assert WORDS[0] <= len(words_of(model.replace("\n# ", "\n")[2:])) <= WORDS[1]


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


def test_only_at_a_torque_limit_does_velocity_mode_give_way():
    """The push that notebook 03 names brings a motor to its limit; a third of it moves nothing."""
    text = VELOCITY.read_text(encoding="utf-8").replace("\n# ", " ")
    (said,) = re.findall(r"push the tip with (\d+) N along \+y", text)
    assert float(said) == STRONGEST
    model = lk.Model("left")
    T = model.pose(model.robot.ready)
    circle = lk.Circle(T[:3, 3], T[:3, 3] + [0.0, -0.12, 0.0])
    poses = lk.Trajectory(lk.PosePath(circle, T[:3, :3]), lk.Quintic(5.0))
    joints = model.joint_trajectory(poses, model.robot.ready)

    def pushed(newtons: float) -> tuple[bool, float]:
        """Whether a motor reaches its limit, and how far the tip gets off its circle in [mm]."""
        with lk.Arm("left", lk.BAXTER, q0=model.robot.ready) as arm:
            hand = Hand(arm)
            arm.world.put(hand)
            hand.push(arm.robot.n, np.zeros(3), [0.0, newtons, 0.0])
            spent = []

            def law(state: lk.State, target: lk.Sample) -> lk.JointVelocity:
                spent.append((np.abs(arm.torque) >= 0.999 * arm.robot.effort).any())
                return joint_velocity_pd(state, target, kp=5.0, kd=0.0)

            off = lk.metrics.tip_error(lk.run(arm, joints, law))[:, :3]
        return any(spent), float(1e3 * np.linalg.norm(off, axis=1).max())

    (third, little), (whole, much) = pushed(STRONGEST / 3.0), pushed(STRONGEST)
    assert (third, whole) == (False, True)
    assert little < 10.0 < 100.0 < much
