"""Test whether gains are good beyond their tuning: ``python -m solutions.study.scoring``.

The case "as tuned" is the usual line; each other case changes one thing, such as the path, the
speed or the payload.  Every run starts off the path, on Baxter's plant, once for each seed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache

from labkit import BAXTER, Arm, Model, Plant, run
from labkit.errors import Diverged
from labkit.metrics import summary

from . import tasks
from .gains import Candidate, course_controllers
from .grid import Row, table
from .tasks import Task


@dataclass(frozen=True)
class Case:
    """A task and a plant on which a controller is tried.

    Attributes:
        name: Its name in tables.
        make: Makes the task.
        plant: The plant to drive.
    """

    name: str
    make: Callable[[], Task]
    plant: Plant = BAXTER

    def task(self) -> Task:
        """The task, which is made once."""
        return _task(self.make)


CASES = (
    Case("as tuned", tasks.line),
    Case("another path", tasks.square),
    Case("twice as fast", lambda: tasks.line(v_max=0.4, a_max=2.0)),
    Case("carrying 1 kg", tasks.line, replace(BAXTER, payload=1.0)),
)


def score(
    tuned: Candidate, cases: Iterable[Case] = CASES, seeds: Iterable[int] = range(3)
) -> list[Row]:
    """Try a controller with its gains on every case and seed.

    Args:
        tuned: The controller, which must not have a state that outlives a run.
        cases: The cases to try.
        seeds: The seeds of the start, the noise and the late ticks.

    Returns:
        Rows for `grid.table`, with "case", "seed", "rms_mm", "max_mm", "rms_deg", "settling",
        and a sentence under "failed" if the run was stopped.
    """
    rows: list[Row] = []
    for case in cases:
        task = case.task()
        target = task.joints if tuned.joints else task.target
        for seed in seeds:
            with Arm(task.side, case.plant, seed, q0=task.start(seed)) as arm:
                cell = {"case": case.name, "seed": seed}
                try:
                    s = summary(run(arm, target, tuned.controller, rate=tuned.rate))
                except Diverged as error:
                    rows.append({**cell, "failed": str(error)})
                    continue
            numbers = {k: getattr(s, k) for k in ("rms_mm", "max_mm", "rms_deg", "settling")}
            rows.append({**cell, **numbers, "failed": None})
    return rows


@cache
def _task(make: Callable[[], Task]) -> Task:
    return make()


def main() -> None:
    """Try the five controllers with the gains of the campaign on every case."""
    controllers = course_controllers(Model("left"), BAXTER)
    rows = [
        {"controller": controller, **row}
        for controller, tuned in controllers.items()
        for row in score(tuned)
    ]
    print("RMS position error [mm], the start included\n")
    print(table(rows, "controller", "case", "rms_mm"))


if __name__ == "__main__":
    main()
