r"""Tune the derivative gain of the velocity controllers: ``python -m solutions.study.speed_gains``.

With a drive that follows its command with a lag :math:`\tau`, the command
:math:`u = \dot q_d + K_p e + K_d \dot e` leads to the error equation

.. math:: \tau\,\ddot e + (1 + K_d)\,\dot e + K_p\,e = \tau\,\ddot q_d .

Its right side drives the error whenever the target accelerates, and :math:`1 + K_d` divides the
effect.  The price is noise, because the measured speeds times :math:`K_d` enter the command.  So,
with the report's :math:`K_p`, the gain is raised step by step until a step is no longer worthwhile.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from itertools import pairwise

import numpy as np

from labkit import BAXTER, Arm, Model, metrics, run

from . import tasks
from .gains import KP, Candidate
from .grid import Meter, Row, cells, pick, table, work_through
from .joint_velocity import JointVelocityPD
from .tasks import Task
from .workspace_velocity import WorkspaceVelocityPD

PAYS = 0.02
"""The share of the error that a step of the gain must remove to be worth its noise."""
TRIED = (0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9)
CONTROLLERS = ("joint velocity", "workspace velocity")


@cache
def _task(name: str) -> Task:
    return tasks.line() if name == "line" else tasks.circle()


def trial(controller: str, task: str, Kd: float, seed: int) -> Mapping[str, float]:
    """One run on Baxter's plant.

    Returns:
        "late_rms_mm", the RMS error after the first second, and "shake_mm_s", the RMS speed of the
        tip in the last half second, when it should stand still.
    """
    goal, model = _task(task), Model("left")
    joints = Candidate(JointVelocityPD(KP, Kd), 200.0, True)
    poses = Candidate(WorkspaceVelocityPD(model, KP, Kd), 200.0, False)
    tuned = joints if controller == CONTROLLERS[0] else poses
    target = goal.joints if tuned.joints else goal.target
    with Arm(goal.side, BAXTER, seed, q0=goal.start(seed)) as arm:
        log = run(arm, target, tuned.controller, rate=tuned.rate)
    e, v = metrics.tip_error(log, model), metrics.tip_velocities(log, model)
    return {
        "late_rms_mm": 1e3 * metrics.rms(e[log.t >= 1.0, :3]),
        "shake_mm_s": 1e3 * metrics.rms(v[log.t >= log.t[-1] - 0.5]),
    }


def trials(seeds: int = 2, jobs: int | None = None, progress: Meter | None = None) -> list[Row]:
    """Try every gain on two paths with both velocity controllers."""
    grid = cells(controller=CONTROLLERS, task=("line", "circle"), Kd=TRIED, seed=range(seeds))
    return work_through(trial, grid, jobs=jobs, progress=progress)


def best(rows: list[Row], controller: str) -> float:
    """The largest gain up to which each step removed at least `PAYS` of the mean error."""
    errors = [
        np.mean([r["late_rms_mm"] for r in pick(rows, controller=controller, Kd=Kd)])
        for Kd in TRIED
    ]
    pays = [after < (1.0 - PAYS) * before for before, after in pairwise(errors)]
    return TRIED[[*pays, False].index(False)]


def main() -> None:
    """Try the gains, print the tables and the choice."""
    rows = trials(progress=Meter("runs"))
    for controller in CONTROLLERS:
        for number in ("late_rms_mm", "shake_mm_s"):
            its = table(pick(rows, controller=controller), "Kd", "task", number)
            print(f"{controller}, {number}\n\n{its}\n")
        print(f"{controller}: Kd = {best(rows, controller):g} at Kp = {KP:g} 1/s\n")


if __name__ == "__main__":
    from solutions.study import speed_gains  # by its own name, so that workers find the job

    speed_gains.main()
