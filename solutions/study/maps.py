"""Maps of the RMS error over (Kp, Kd), shipped as data: ``python -m solutions.study.maps``."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import BAXTER, IDEAL, Arm, Model, Plant, metrics, run
from labkit.recordings import DATA, Trials

from . import tasks
from .grid import Meter, cells, pick, work_through
from .joint_torque import ComputedTorque
from .joint_velocity import JointVelocityPD
from .recording import save_trials

FOLDER = DATA / "maps"
PLANTS = {"ideal": IDEAL, "baxter": BAXTER}
LINE = tasks.line()


@dataclass(frozen=True)
class Plane:
    """The gains to try with one kind of controller.

    Attributes:
        make: Makes the controller from the two gains and the plant.
        Kp: Proportional gains, in [1/s], or in [1/s^2] for the torque controller.
        Kd: Derivative gains, without unit, or in [1/s] for the torque controller.
        rate: How often the controller is called, in [Hz].
    """

    make: Callable[[float, float, Plant], Any]
    Kp: tuple[float, ...]
    Kd: tuple[float, ...]
    rate: float


def _grid(low: float, high: float, count: int) -> tuple[float, ...]:
    return tuple(float(f"{x:.3g}") for x in np.geomspace(low, high, count))


PLANES = {
    "joint velocity PD": Plane(
        lambda Kp, Kd, plant: JointVelocityPD(Kp, Kd),
        Kp=_grid(1.0, 160.0, 12),
        Kd=(0.0, *_grid(0.05, 6.0, 8)),
        rate=200.0,
    ),
    "joint torque PD": Plane(
        lambda Kp, Kd, plant: ComputedTorque(
            Model("left", Plant(armature=plant.armature)), Kp, Kd, not plant.gravity_compensation
        ),
        Kp=_grid(25.0, 6400.0, 12),
        Kd=_grid(2.0, 250.0, 9),
        rate=200.0,
    ),
}


def rms(controller: str, plant: str, Kp: float, Kd: float, seed: int) -> Mapping[str, float]:
    """The job: RMS error of the tip on the line for one pair of gains."""
    plane = PLANES[controller]
    with Arm("left", PLANTS[plant], seed, q0=LINE.start(seed)) as arm:
        log = run(arm, LINE.joints, plane.make(Kp, Kd, PLANTS[plant]), rate=plane.rate)
    return {"rms_mm": 1e3 * metrics.rms(metrics.tip_error(log)[:, :3])}


def make(controller: str, plant: str, seeds: int, jobs: int | None) -> Trials:
    """One map, averaged over seeds; every joint has the same gains."""
    plane = PLANES[controller]
    grid = cells(
        controller=[controller], plant=[plant], Kp=plane.Kp, Kd=plane.Kd, seed=range(seeds)
    )
    rows = work_through(rms, grid, jobs=jobs, progress=Meter(f"{controller}, {plant}"))

    def mean(Kp: float, Kd: float) -> float | None:
        here = pick(rows, Kp=Kp, Kd=Kd)
        if any(row["failed"] for row in here):
            return None
        return float(f"{np.mean([row['rms_mm'] for row in here]):.4g}")

    return Trials(
        cases=(f"{controller} on the {plant} arm, line",),
        Kp=plane.Kp,
        Kd=plane.Kd,
        rms_mm=([[mean(Kp, Kd) for Kd in plane.Kd] for Kp in plane.Kp],),
    )


def main() -> None:
    """Write the maps and print what they show."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--jobs", type=int, default=None)
    options = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    for controller in PLANES:
        for plant in PLANTS:
            found = make(controller, plant, options.seeds, options.jobs)
            path = FOLDER / f"{controller.replace(' ', '_').lower()}_{plant}.json"
            save_trials(found, path)
            print(f"{path.name}: {found.describe()}")


if __name__ == "__main__":
    from solutions.study import maps  # by its own name, so that workers find the job

    maps.main()
