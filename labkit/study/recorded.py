"""Runs kept as files: a log that someone without the planner, or without a controller, can study.

The numbers are single precision: good to a micrometre, half the size.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import locked
from ..commands import COMMANDS, State
from ..errors import UnknownName
from ..log import Log
from ..motion import PoseSample, Sample
from ..plant import Plant

_ROWS = ("t", "q", "dq", "tau", "command", "saturated")
FOLDER = Path(__file__).parents[1] / "data" / "recorded"
"""Where those lie that come with labkit."""


def names() -> tuple[str, ...]:
    """The recorded runs that come with labkit."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.npz")))


def recorded(name: str) -> Log:
    """One of the runs that come with labkit, made by ``python -m labkit.baseline``.

    Args:
        name: One of `names`.

    Raises:
        UnknownName: There is no such recording.
    """
    if name not in names():
        raise UnknownName("recorded run", name, names())
    return load(FOLDER / f"{name}.npz")


_CAMPAIGN = FOLDER.with_name("campaign.json")
_KEPT = ("way", "task", "plant", "seed", "late_rms_mm", "late_max_mm", "settling", "effort")


def campaign() -> list[dict[str, Any]]:
    """Every controller on every task over five seeds, from ``solutions.campaign --keep``.

    Returns:
        One row for each run: its "way", "task", "plant" and "seed", and its errors.
    """
    rows: list[dict[str, Any]] = json.loads(_CAMPAIGN.read_text())
    return rows


def keep_campaign(rows: Iterable[Mapping[str, Any]]) -> None:
    """Write the rows that `campaign` reads, those of runs that were stopped left out."""
    kept = [{key: _short(row[key]) for key in _KEPT} for row in rows if not row["failed"]]
    _CAMPAIGN.write_text("[" + ",\n".join(json.dumps(row) for row in kept) + "]\n")


def _short(x: Any) -> Any:
    return float(f"{x:.4g}") if isinstance(x, float) else x


def save(log: Log, path: Path) -> None:
    """Write a log to a file with the ending ``.npz``."""
    columns = {name: getattr(log, name) for name in _ROWS}
    columns |= {f"target.{name}": part for name, part in log.target._asdict().items()}
    columns |= {f"measured.{name}": part for name, part in log.measured._asdict().items()}
    single = {name: _single(column) for name, column in columns.items()}
    about = {
        "target": type(log.target).__name__,
        "command": log.command_type.__name__,
        "controller": log.controller,
        "plant": asdict(log.plant),
        "side": log.side,
    }
    np.savez_compressed(path, about=np.array(json.dumps(about)), **single)


def load(path: Path) -> Log:
    """Read a log that `save` wrote."""
    with np.load(path) as file:
        about = json.loads(str(file["about"]))
        column = {name: _double(file[name]) for name in file.files if name != "about"}
    kind = {c.__name__: c for c in (Sample, PoseSample)}[about["target"]]
    plant = about["plant"] | {k: tuple(v) for k, v in about["plant"].items() if isinstance(v, list)}
    return Log(
        **{name: column[name] for name in _ROWS},
        target=kind(*(column[f"target.{f}"] for f in kind._fields)),
        measured=State(*(column[f"measured.{f}"] for f in State._fields)),
        command_type={c.__name__: c for c in COMMANDS}[about["command"]],
        controller=about["controller"],
        plant=Plant(**plant),
        side=about["side"],
    )


def _single(x: Any) -> Any:
    return x if x.dtype == bool else x.astype(np.float32)


def _double(x: Any) -> Any:
    return x if x.dtype == bool else locked(x.astype(np.float64))
