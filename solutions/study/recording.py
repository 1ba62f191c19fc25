"""Write trials and rows to the files that `labkit.recordings` reads."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from labkit.recordings import DATA, Trials

_KEPT = ("controller", "task", "plant", "seed", "late_rms_mm", "late_max_mm", "settling", "effort")


def save_trials(trials: Trials, path: Path) -> None:
    """Write trials as JSON."""
    path.write_text(json.dumps(vars(trials)) + "\n")


def save_campaign(rows: Iterable[Mapping[str, Any]]) -> None:
    """Write the rows that `recordings.campaign` reads, without those of runs that were stopped."""
    kept = [{key: _short(row[key]) for key in _KEPT} for row in rows if not row["failed"]]
    lines = ",\n".join(json.dumps(row) for row in kept)
    (DATA / "campaign.json").write_text(f"[{lines}]\n")


def _short(x: Any) -> Any:
    return float(f"{x:.4g}") if isinstance(x, float) else x
