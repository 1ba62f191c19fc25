"""The landing page."""

from __future__ import annotations

import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics
from solutions.study.joint_velocity import JointVelocityPD

from .page import holds, numbers, replay

SEED = 1


def welcome() -> HTML:
    """A line, then a circle, by the joint velocity PD on the realistic arm."""
    model = lk.Model("left")
    q0 = model.robot.ready
    T_wt = model.pose(q0)
    start, R = T_wt[:3, 3], T_wt[:3, :3]
    corner = start + np.array((0.05, -0.12, 0.12))
    circle = lk.Circle(corner, corner + np.array((0.0, -0.09, 0.0)))
    target = lk.Chain(
        [
            lk.Trajectory(lk.PosePath(lk.Line(start, corner), R), lk.Quintic(2.5)),
            lk.Trajectory(lk.PosePath(circle, R), lk.Quintic(5.0)),
        ]
    )
    with lk.Arm("left", lk.BAXTER, SEED, q0=q0) as arm:
        log = lk.run(arm, model.joint_trajectory(target, q0), JointVelocityPD(5.0))
    found = metrics.summary(log)
    holds(found.max_mm < 10.0, "the tip stays within a centimetre of its target")
    numbers({"rms": found.rms_mm, "worst": found.max_mm}, ".2g")
    return replay(
        log,
        "Baxter's left arm draws a line and a circle",
        "A recorded run on the realistic arm, with the error and the motor torques.",
        label="joint velocity PD",
    )
