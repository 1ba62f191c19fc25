"""Keep runs and rows as the files that `labkit.recordings` reads."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from labkit import Log
from labkit.recordings import DATA, Trials

_ROWS = ("t", "q", "dq", "tau", "command", "saturated")
_KEPT = ("way", "task", "plant", "seed", "late_rms_mm", "late_max_mm", "settling", "effort")


def save(log: Log, path: Path) -> None:
    """Write a log to a file with the ending ``.npz``, in single precision: half the size."""
    columns = {name: getattr(log, name) for name in _ROWS}
    columns |= {f"target.{name}": part for name, part in log.target._asdict().items()}
    columns |= {f"measured.{name}": part for name, part in log.measured._asdict().items()}
    single = {x: a if a.dtype == bool else a.astype(np.float32) for x, a in columns.items()}
    about = {
        "target": type(log.target).__name__,
        "command": log.command_type.__name__,
        "controller": log.controller,
        "plant": asdict(log.plant),
        "side": log.side,
    }
    np.savez_compressed(path, about=np.array(json.dumps(about)), **single)


def save_trials(trials: Trials, path: Path) -> None:
    """Write trials as JSON."""
    path.write_text(json.dumps(vars(trials)) + "\n")


def save_campaign(rows: Iterable[Mapping[str, Any]]) -> None:
    """Write the rows that `recordings.campaign` reads, those of runs that were stopped left out."""
    kept = [{key: _short(row[key]) for key in _KEPT} for row in rows if not row["failed"]]
    lines = ",\n".join(json.dumps(row) for row in kept)
    (DATA / "campaign.json").write_text(f"[{lines}]\n")


def _short(x: Any) -> Any:
    return float(f"{x:.4g}") if isinstance(x, float) else x
