"""Are gains good, or only good where they were tuned?  ``python -m solutions.study.scoring``.

The case "as tuned" is the usual line; each other case changes one thing: the path, the speed, what
the arm carries.  All start off the path and on Baxter's plant, once for each seed.
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
    """What a controller is tried on.

    Attributes:
        name: What tables call it.
        make: Gives the task.
        plant: The plant to drive.
    """

    name: str
    make: Callable[[], Task]
    plant: Plant = BAXTER

    def task(self) -> Task:
        """The task; made once."""
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
    """Try a controller, gains and all, on every case and seed.

    Args:
        tuned: The controller; it keeps no memory between runs.
        cases: What to try it on.
        seeds: Of the start, the noise and the late ticks.

    Returns:
        Rows for `campaign.table`, with "case", "seed", "rms_mm", "max_mm", "rms_deg", "settling",
        and a sentence under "failed" where the arm was lost.
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
    """The five controllers with the gains of the campaign, on every case."""
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
