"""Record the trials of notebook 07: ``python -m solutions.study.trials``.

The training runs, on the line, are shipped with labkit; the held-out cases are not.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from labkit import BAXTER, Arm, metrics, run
from labkit.errors import Diverged
from labkit.recordings import LINE, Trials

from . import tasks
from .grid import Meter, cells, pick, work_through
from .joint_velocity import JointVelocityPD
from .recording import save_trials

HELD_OUT = Path(__file__).parents[1] / "comparison" / "trials.json"

KP = (2.0, 4.0, 8.0, 14.0, 22.0, 34.0, 50.0, 70.0, 100.0)
KD = (0.0, 0.4, 1.0)
SEEDS = range(5)

CASES: dict[str, Any] = {
    "line": (tasks.line, BAXTER),
    "square": (tasks.square, BAXTER),
    "line, twice as fast": (lambda: tasks.line(v_max=0.4, a_max=2.0), BAXTER),
    "line, carrying 1 kg": (tasks.line, replace(BAXTER, payload=1.0)),
    "line, state 8 ms older": (
        tasks.line,
        replace(BAXTER, state_delay=BAXTER.state_delay + 0.008),
    ),
}
_made: dict[str, Any] = {}


def rms(case: str, Kp: float, Kd: float, seed: int) -> Mapping[str, float]:
    """The job: RMS error of the tip in one run."""
    make, plant = CASES[case]
    task = _made.setdefault(case, make())
    with Arm("left", plant, seed, q0=task.start(seed)) as arm:
        try:
            log = run(arm, task.joints, JointVelocityPD(Kp, Kd), rate=200.0)
        except Diverged:
            return {"rms_mm": float("nan")}
        return {"rms_mm": 1e3 * metrics.rms(metrics.tip_error(log)[:, :3])}


def record(cases: list[str], jobs: int | None) -> Trials:
    """Try all gains on some cases, with each seed as a case of its own."""
    rows = work_through(
        rms, cells(case=cases, Kp=KP, Kd=KD, seed=SEEDS), jobs=jobs, progress=Meter("trials")
    )

    def one(case: str, seed: int, Kp: float, Kd: float) -> float | None:
        (row,) = pick(rows, case=case, seed=seed, Kp=Kp, Kd=Kd)
        value = row["rms_mm"]
        return float(f"{value:.4g}") if value == value else None

    return Trials(
        cases=tuple(f"{case}, seed {seed}" for case in cases for seed in SEEDS),
        Kp=KP,
        Kd=KD,
        rms_mm=tuple(
            [[one(case, seed, Kp, Kd) for Kd in KD] for Kp in KP]
            for case in cases
            for seed in SEEDS
        ),
    )


def main() -> None:
    """Record the trials and print a summary."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=None)
    options = parser.parse_args()
    for path, cases in ((LINE, ["line"]), (HELD_OUT, [case for case in CASES if case != "line"])):
        trials = record(cases, options.jobs)
        save_trials(trials, path)
        print(f"{path.name}: {len(trials.cases)} cases, {len(KP) * len(KD)} pairs of gains each")


if __name__ == "__main__":
    from solutions.study import trials  # by its own name, so that workers find the job

    trials.main()
