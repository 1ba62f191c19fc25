"""Which verdicts depend on which assumption: ``python -m solutions.study.assumptions``.

Each number of the plant that nobody measured is set to the least and to the largest plausible value
(`labkit.plant.EVIDENCE`), one at a time and with the same gains; then every method follows the line
again.  If a verdict changes, it depends on that number.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from labkit import BAXTER, Arm, Model, Plant, metrics, run
from labkit.plant import EVIDENCE

from .campaign import BASELINE, FIVE, joints, task_of
from .claims import IMPEDANCE, THREE, Interval, interval
from .gains import Candidate, all_controllers
from .grid import Meter, Row, cells, pick, work_through

KEPT = Path(__file__).with_name("assumptions.json")
CONTROLLERS = (*FIVE, BASELINE)
GAINS = (10.0, 14.0, 20.0, 30.0, 45.0, 60.0, 100.0)
"""Gains of the position mode, in [1/s], which no source gives and on which much depends."""
SEEDS, SMALL = 10, 0.5
"""How many runs each plant has, and the least half width of an interval, in [mm]."""
CLAIMS: Mapping[str, tuple[Sequence[str], Sequence[str]]] = {
    "joint velocity over workspace velocity": (("workspace velocity",), ("joint velocity",)),
    "joint impedance over workspace impedance": (("workspace impedance",), ("joint impedance",)),
    "the three over both impedances": (IMPEDANCE, THREE),
    **{f"built-in method over {controller}": ((controller,), (BASELINE,)) for controller in FIVE},
}
"""For each claim "b over a", the controllers a and b; it is true if a has the larger error."""


def plants() -> dict[str, Plant]:
    """`BAXTER`, and each plant that differs from it in one assumption, by name."""
    made = {"as assumed": BAXTER}
    for name, evidence in EVIDENCE.items():
        if not evidence.assumed:
            continue
        for end in ("least", "most"):
            changed: dict[str, Any] = {name: getattr(evidence, end)}
            plant = replace(BAXTER, **changed)
            if plant != BAXTER:
                made[f"{name}, {end}"] = plant
    return made


def trial(controller: str, assumption: str) -> Mapping[str, Any]:
    """The job: one controller along the line; its RMS error after the first second, each seed."""
    return _line(controller, plants()[assumption])


def gain(controller: str, position_gain: float) -> Mapping[str, Any]:
    """The job for one gain of the position mode; see `trial`."""
    return _line(controller, replace(BAXTER, position_gain=position_gain))


def _line(controller: str, plant: Plant) -> Mapping[str, Any]:
    return {"late_rms_mm": [_error(controller, plant, seed) for seed in range(SEEDS)]}


def _error(controller: str, plant: Plant, seed: int) -> float:
    goal, model = task_of("line", controller, seed), Model("left", Plant(armature=BAXTER.armature))
    if controller == BASELINE:
        from . import baseline

        tuned = Candidate(baseline.PositionServer(), baseline.RATE, True)
    else:
        tuned = all_controllers(model, BAXTER)[controller]
    target = joints(controller, "line", seed) if tuned.joints else goal.target
    with Arm(goal.side, plant, seed, q0=goal.start(seed)) as arm:
        log = run(arm, target, tuned.controller, rate=tuned.rate)
    e = metrics.tip_error(log, model)[log.t >= 1.0, :3]
    return float(f"{1e3 * metrics.rms(e):.4g}")


def difference(rows: Sequence[Row], claim: str, **names: Any) -> Interval:
    """The paired differences for a claim over the seeds, in [mm]."""
    a, b = (
        np.mean([pick(rows, controller=name, **names)[0]["late_rms_mm"] for name in side], axis=0)
        for side in CLAIMS[claim]
    )
    return interval("seeds", a - b, len(CLAIMS), SMALL)


def recorded() -> Mapping[str, list[Row]]:
    """The recorded rows, under "assumptions" and "gains"."""
    found: Mapping[str, list[Row]] = json.loads(KEPT.read_text())
    return found


def main() -> None:
    """Run the study and keep its rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=None, help="processes (one for each core)")
    chosen = parser.parse_args()
    asked = cells(controller=CONTROLLERS, assumption=tuple(plants()))
    rows = work_through(trial, asked, jobs=chosen.jobs, progress=Meter("plants"))
    asked = cells(controller=(BASELINE,), position_gain=GAINS)
    gains = work_through(gain, asked, jobs=chosen.jobs, progress=Meter("gains"))
    parts = {"assumptions": rows, "gains": gains}
    lines = (f'"{k}": [\n' + ",\n".join(map(json.dumps, part)) + "\n]" for k, part in parts.items())
    KEPT.write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    from solutions.study import assumptions  # by its full name, so that workers find the jobs

    assumptions.main()
