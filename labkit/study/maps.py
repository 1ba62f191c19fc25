"""Error over a plane of gains: made once by ``python -m solutions.maps``, read by notebooks."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..errors import UnknownName

_FOLDER = Path(__file__).parents[1] / "data" / "maps"


@dataclass(frozen=True)
class ErrorMap:
    """RMS error of the tip for each pair of gains.

    Attributes:
        title: Controller, plant and task, as a figure's title.
        Kp: Proportional gains, ascending, m of them.
        Kd: Derivative gains, ascending, n of them.
        rms_mm: m rows of n RMS errors in [mm], the mean over the seeds; None where a run was
            stopped because the arm ran away.
        unit: The units of Kp and of Kd.
        about: How it was measured.
    """

    title: str
    Kp: tuple[float, ...]
    Kd: tuple[float, ...]
    rms_mm: tuple[tuple[float | None, ...], ...]
    unit: tuple[str, str]
    about: str

    def array(self) -> Array:
        """The errors, shape (m, n), NaN where the arm ran away."""
        return np.array(self.rms_mm, dtype=float)

    @property
    def best(self) -> tuple[float, float, float]:
        """The gains with the least error, Kp and Kd, and that error in [mm]."""
        i, j = np.unravel_index(int(np.nanargmin(self.array())), self.array().shape)
        return self.Kp[i], self.Kd[j], float(self.array()[i, j])

    def describe(self) -> str:
        """The map in words, for readers who do not see it."""
        Kp, Kd, least = self.best
        lost = int(np.isnan(self.array()).sum())
        return (
            f"RMS error of {self.title} for Kp from {self.Kp[0]:g} to {self.Kp[-1]:g} "
            f"[{self.unit[0]}] and Kd from {self.Kd[0]:g} to {self.Kd[-1]:g} [{self.unit[1]}]: "
            f"least {least:.3g} mm at Kp = {Kp:.3g}, Kd = {Kd:.3g}; largest "
            f"{np.nanmax(self.array()):.3g} mm; {lost} of {self.array().size} pairs lost the arm."
        )

    def save(self, path: Path) -> None:
        """Write it as JSON."""
        path.write_text(json.dumps(asdict(self)) + "\n")


def names() -> tuple[str, ...]:
    """The maps that come with labkit."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.json")))


def error_map(name: str) -> ErrorMap:
    """One of the maps that come with labkit.

    Args:
        name: One of `names`.

    Raises:
        UnknownName: There is no such map.
    """
    if name not in names():
        raise UnknownName("error map", name, names())
    data = json.loads((_FOLDER / f"{name}.json").read_text())
    for key in ("Kp", "Kd", "unit"):
        data[key] = tuple(data[key])
    data["rms_mm"] = tuple(tuple(row) for row in data["rms_mm"])
    return ErrorMap(**data)
