"""The realistic arm under each of the five controllers."""

from time import perf_counter

import numpy as np

import labkit as lk
from solutions.study.gains import course_controllers

SECONDS = 2.0


def measure():
    """The real-time factor of the slowest of the five controllers on the BAXTER plant."""
    model = lk.Model("left", lk.BAXTER)
    q0 = model.robot.ready
    T = model.pose(q0)
    path = lk.PosePath(lk.Line(T[:3, 3], T[:3, 3] + np.array([0.1, 0.1, 0.1])), T[:3, :3])
    line = lk.Trajectory(path, lk.Quintic(SECONDS))
    speeds = []
    for tuned in course_controllers(model).values():
        target, times = tuned.target(model, line, q0), []
        for _ in range(3):
            with lk.Arm("left", lk.BAXTER, q0=q0) as arm:
                start = perf_counter()
                lk.run(arm, target, tuned.controller, tuned.rate)
                times.append(perf_counter() - start)
        speeds.append(SECONDS / sorted(times)[1])
    return {"realistic_rtf": min(speeds)}
