"""The report's tuning procedure on one joint of the arm: ``python -m solutions.study.tuning``."""

from __future__ import annotations

from typing import Any

import numpy as np

from labkit import BAXTER, Arm, Hold, Plant, robot, run
from labkit.metrics import joint_error
from labkit.shapes import Array
from labkit.stability import ultimate_gain, velocity_joint_of

from .joint_velocity import JointVelocityPD
from .report_procedure import Trial, Tuning, report_procedure

OFF = 0.005
"""How far off its target the joint starts, in [rad]; more would saturate speed or torque."""


def trial_on(joint: int, plant: Plant = BAXTER, *, duration: float = 2.0, seed: int = 0) -> Trial:
    """A trial for `report_procedure` in which a joint in velocity mode returns to the ready pose.

    Args:
        joint: The number of the joint, from 0 at the shoulder.
        plant: The plant to drive.
        duration: How long the joint is observed, in [s].
        seed: The seed of the noise and the late ticks.
    """
    ready = robot("left").ready

    def trial(Kp: float, Kd: float) -> tuple[Array, Array]:
        here, only = np.array(ready), np.eye(7)[joint]
        here[joint] += OFF
        controller = JointVelocityPD(np.where(only, Kp, 2.0), Kd * only)
        with Arm("left", plant, seed, q0=here) as arm:
            log = run(arm, Hold(ready, duration), controller)
        return log.t, joint_error(log)[:, joint]

    return trial


def tune(joint: int, plant: Plant = BAXTER, **options: Any) -> Tuning:
    """The report's procedure on one joint; ``options`` go to `report_procedure`."""
    return report_procedure(trial_on(joint, plant), **options)


def main() -> None:
    """Tune three joints and compare the oscillation with what the loop's analysis predicts."""
    predicted = ultimate_gain(velocity_joint_of(BAXTER))
    print(f"predicted to oscillate at Kp = {predicted:.3g} 1/s")
    for joint in (0, 3, 6):
        found = tune(joint)
        print(
            f"{robot('left').joint_names[joint]}: oscillates at {found.ultimate:.3g} 1/s, "
            f"take Kp = {found.Kp:.3g} 1/s, Kd = {found.Kd:.3g}"
        )
        for step in found.steps:
            print(
                f"    Kp {step.Kp:8.3f}  Kd {step.Kd:6.3f}  a swing keeps {step.decay:5.2f}  "
                f"RMS {1e3 * step.rms:6.2f} mrad  {step.why}"
            )


if __name__ == "__main__":
    main()
