"""Are gains good, or only good on the path they were tuned on?  One controller on held-out cases.

The case "as tuned" is the usual line; each other case changes one thing: the path, the speed, what
the arm carries.  All start off the path and on Baxter's plant, once for each seed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache

from ..arm import Arm
from ..errors import Diverged
from ..metrics import summary
from ..plant import BAXTER, Plant
from ..run import Controller, run
from . import tasks
from .campaign import Row
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
    controller: Controller,
    *,
    follows: str = "joints",
    rate: float = 200.0,
    cases: Iterable[Case] = CASES,
    seeds: Iterable[int] = range(3),
) -> list[Row]:
    """Try a controller, gains and all, on every case and seed.

    Args:
        controller: Any controller that keeps no memory between runs.
        follows: Whether its target gives "joints" or "poses".
        rate: How often it is asked, in [Hz].
        cases: What to try it on.
        seeds: Of the start, the noise and the late ticks.

    Returns:
        Rows for `campaign.table`, with "case", "seed", "rms_mm", "max_mm", "rms_deg", "settling",
        and a sentence under "failed" where the arm was lost.
    """
    rows: list[Row] = []
    for case in cases:
        task = case.task()
        target = task.joints if follows == "joints" else task.target
        for seed in seeds:
            with Arm(task.side, case.plant, seed, q0=task.start(seed)) as arm:
                cell = {"case": case.name, "seed": seed}
                try:
                    s = summary(run(arm, target, controller, rate=rate))
                except Diverged as error:
                    rows.append({**cell, "failed": str(error)})
                    continue
            numbers = {k: getattr(s, k) for k in ("rms_mm", "max_mm", "rms_deg", "settling")}
            rows.append({**cell, **numbers, "failed": None})
    return rows


@cache
def _task(make: Callable[[], Task]) -> Task:
    return make()
