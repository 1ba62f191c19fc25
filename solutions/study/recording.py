"""Write trials and rows to the files that `labkit.recordings` reads."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from labkit.recordings import DATA, Trials

_KEPT = {
    "rows": ("controller", "task", "plant", "seed", "late_rms_mm", "late_max_mm"),
    "gains": ("Kp", "plant", "seed", "tenth_s"),
    "noise": ("Kd", "plant", "seed", "late_rms_mm", "shake_mm_s"),
}


def save_trials(trials: Trials, path: Path) -> None:
    """Write trials as JSON."""
    path.write_text(json.dumps(vars(trials)) + "\n")


def save_campaign(found: Mapping[str, Any], path: Path = DATA / "campaign.json") -> None:
    """Write the runs that `recordings.campaign` reads, without those that were stopped."""
    tables = []
    for name, heads in _KEPT.items():
        runs = [[_short(run[key]) for key in heads] for run in found[name] if not run["failed"]]
        lines = ",\n".join(json.dumps(row) for row in (heads, *runs))
        tables.append(f'"{name}": [{lines}]')
    path.write_text(f"{{{', '.join(tables)}}}\n")


def _short(x: Any) -> Any:
    return float(f"{x:.4g}") if isinstance(x, float) else x
