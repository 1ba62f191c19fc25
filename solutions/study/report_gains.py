"""The gains and the procedure of the report, run on `BAXTER`.

The gains are those printed in the report, the torque gains in N m/rad; where a row lacks its
seventh entry, it is 1.  The larger column for the workspace impedance is taken as the stiffness.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from labkit import BAXTER, Arm, Model, Plant, metrics, run

from . import tasks
from .gains import Candidate
from .joint_impedance import JointImpedance
from .joint_torque import AugmentedPD
from .joint_velocity import JointVelocityPD
from .workspace_impedance import WorkspaceImpedance
from .workspace_velocity import WorkspaceVelocityPD


def _v(factor: float, *entries: float) -> Any:
    return factor * np.array(entries)


TABLE_1: Mapping[str, Callable[[Model], Candidate]] = {
    "workspace velocity": lambda model: Candidate(
        WorkspaceVelocityPD(
            model, _v(4.0, 1, 0.65, 0.1, 0.01, 0.01, 0.01), _v(0.07, 3, 0.5, 1, 1, 1, 1)
        ),
        200.0,
        False,
    ),
    "joint velocity": lambda model: Candidate(JointVelocityPD(3.0, 1e-4), 200.0, True),
    "joint torque": lambda model: Candidate(
        AugmentedPD(
            model, _v(8.0, 1, 1, 1.5, 1.5, 1, 1, 1), _v(5.0, 2, 2, 1, 1, 0.8, 0.3, 0.3), False
        ),
        200.0,
        True,
    ),
    "workspace impedance": lambda model: Candidate(
        WorkspaceImpedance(
            model, _v(3.0, 15, 5, 9, 0.1, 0.1, 0.1), _v(0.5, 1, 1, 1, 0.2, 0.2, 0.2), gravity=False
        ),
        200.0,
        False,
    ),
    "joint impedance": lambda model: Candidate(
        JointImpedance(
            model,
            _v(8.0, 1, 1, 1.5, 1, 0.5, 0.5, 0.3),
            _v(3.0, 2, 2, 1, 1, 0.3, 0.3, 0.3),
            gravity=False,
        ),
        200.0,
        True,
    ),
}
"""The report's controllers with the report's gains."""


def late_rms_mm(controller: str, task: str) -> float:
    """RMS error of a controller with the printed gains after the first second, in [mm]."""
    goal = tasks.line() if task == "line" else tasks.circle()
    model = Model("left", Plant(armature=BAXTER.armature))
    tuned = TABLE_1[controller](model)
    target = tuned.target(model, goal.target, goal.q0)
    with Arm(goal.side, BAXTER, 0, q0=goal.start(0)) as arm:
        log = run(arm, target, tuned.controller, rate=tuned.rate)
    return 1e3 * metrics.rms(metrics.tip_error(log, model)[log.t >= 1.0, :3])
