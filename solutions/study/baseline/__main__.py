"""Record the built-in method, so nobody needs a planner: ``python -m solutions.study.baseline``."""

from __future__ import annotations

import argparse

from labkit.arm import Arm
from labkit.log import Log
from labkit.metrics import summary
from labkit.plant import BAXTER
from labkit.recordings import DATA
from labkit.run import run
from labkit.scene import Table
from labkit.trajectory import Chain, Hold

from .. import tasks
from ..tasks import Task
from . import RATE, PlanningScene, PositionServer, VelocityServer, along, plan, quickest


def drive(task: Task, server: PositionServer | VelocityServer, seed: int = 0) -> tuple[Log, Log]:
    """Run the built-in method from neutral through a task; return both logs, approach and task."""
    with Arm(task.side, BAXTER, seed) as arm:
        scene = PlanningScene(task.side, (Table(),))
        approach = quickest(plan(scene, arm.robot.neutral, task.q0, seed=seed))
        there = Chain([approach, Hold(task.q0, 1.0)])
        first = run(arm, there, server, rate=RATE)
        return first, run(arm, along(scene, arm.model, task.target, task.q0), server, rate=RATE)


def main() -> None:
    """Write the files and print what they contain."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    position, velocity = PositionServer(), VelocityServer()
    logs = {}
    for task in (tasks.line(), tasks.circle(), tasks.square()):
        logs["baseline_approach"], logs[f"baseline_{task.name}"] = drive(task, position)
    logs["baseline_line_velocity"] = drive(tasks.line(), velocity)[1]
    for name, log in logs.items():
        path = DATA / "recorded" / f"{name}.npz"
        log.save(path, single=True)
        print(f"{path.name}: {path.stat().st_size / 1024:.0f} kB, {log}, {summary(log)}")


if __name__ == "__main__":
    main()
