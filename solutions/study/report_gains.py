"""Run the gains and the procedure of the report: ``python -m solutions.study.report_gains``.

The plants are `BAXTER` and the same arm with springs in its joints.  The gains are those printed in
the report, the torque gains in N m/rad; where a row lacks its seventh entry, it is 1.  The larger
column for the workspace impedance is taken as the stiffness.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from labkit import BAXTER, Arm, LabkitError, Model, Plant, metrics, run
from labkit.plant import SPRINGS

from . import tasks
from .gains import Candidate
from .grid import Meter, Row, cells, work_through
from .joint_impedance import JointImpedance
from .joint_torque import AugmentedPD
from .joint_velocity import JointVelocityPD
from .tuning import tune
from .workspace_impedance import WorkspaceImpedance
from .workspace_velocity import WorkspaceVelocityPD

KEPT = Path(__file__).with_name("report_gains.json")
PLANTS = {"realistic": BAXTER, "with joint springs": replace(BAXTER, **SPRINGS)}


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


def table_1(controller: str, task: str, plant: str) -> Mapping[str, Any]:
    """The job: one controller with the printed gains; its RMS error after the first second."""
    goal = tasks.line() if task == "line" else tasks.circle()
    model = Model("left", Plant(armature=BAXTER.armature))
    tuned = TABLE_1[controller](model)
    target = tuned.target(model, goal.target, goal.q0)
    with Arm(goal.side, PLANTS[plant], 0, q0=goal.start(0)) as arm:
        log = run(arm, target, tuned.controller, rate=tuned.rate)
    e = metrics.tip_error(log, model)[log.t >= 1.0, :3]
    return {"late_rms_mm": float(f"{1e3 * metrics.rms(e):.4g}")}


def procedure(plant: str, joint: int) -> Mapping[str, Any]:
    """The job: the report's procedure on one joint."""
    found = tune(joint, PLANTS[plant])
    steps = [[s.Kp, s.Kd, s.decay, s.why] for s in found.steps if np.isfinite(s.decay)]
    return asdict(replace(found, steps=())) | {"steps": steps}


def recorded() -> Mapping[str, list[Row]]:
    """The recorded rows, under "table_1" and "procedure"."""
    found: Mapping[str, list[Row]] = json.loads(KEPT.read_text())
    return found


def main() -> None:
    """Run both and write the rows."""
    grid = cells(controller=tuple(TABLE_1), task=("line", "circle"), plant=tuple(PLANTS))
    rows = work_through(table_1, grid, progress=Meter("Table 1"))
    tuned = work_through(
        procedure, cells(plant=tuple(PLANTS), joint=(0,)), progress=Meter("tuning")
    )
    parts = {"table_1": rows, "procedure": tuned}
    lines = (f'"{k}": [\n' + ",\n".join(map(json.dumps, part)) + "\n]" for k, part in parts.items())
    KEPT.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    for row in rows:
        print(*row.values())
    for row in tuned:
        print(row["plant"], row["joint"], row.get("ultimate"), row.get("Kp"), row.get("Kd"))


if __name__ == "__main__":
    from solutions.study import report_gains  # by its own name, so that workers find the jobs

    try:
        report_gains.main()
    except LabkitError as error:
        raise SystemExit(str(error)) from error
