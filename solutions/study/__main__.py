"""Run the campaign: every controller on every task, and make its tables."""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

from labkit import Model
from labkit.errors import LabkitError

from .campaign import (
    BASELINE,
    FEED_FORWARD,
    claims,
    converge,
    derivative,
    gain_grid,
    grid,
    noise_grid,
    numbers,
    tables,
)
from .claims import verdicts
from .gains import all_controllers
from .grid import Job, Meter, Row, work_through
from .recording import save_campaign


def main() -> None:
    """Run the campaign and write build/campaign.json and build/campaign/."""
    parser = argparse.ArgumentParser(prog="python -m solutions.study", description=__doc__)
    parser.add_argument("--seeds", type=int, default=10, help="how many seeds (10)")
    parser.add_argument("--jobs", type=int, default=None, help="processes (one for each core)")
    parser.add_argument("--out", type=Path, default=Path("build"), help="folder (build)")
    parser.add_argument("--keep", action="store_true", help="keep the rows for notebook 07")
    controllers = [*all_controllers(Model("left")), FEED_FORWARD, BASELINE]
    only = "run only this and print it; more than once for more: " + ", ".join(controllers)
    parser.add_argument(
        "--controller", action="append", choices=controllers, metavar="NAME", help=only
    )
    options = parser.parse_args()
    began = time.monotonic()

    def done(job: Job, grid: list[Row], what: str) -> list[Row]:
        return work_through(job, grid, jobs=options.jobs, progress=Meter(what))

    if options.controller:
        print(tables(done(numbers, grid(options.seeds, options.controller), "runs")))
        return
    rows = done(numbers, grid(options.seeds), "runs")
    seconds = time.monotonic() - began
    gains = done(converge, gain_grid(options.seeds), "gains")
    noise = done(derivative, noise_grid(options.seeds), "noise")
    judged = verdicts(rows, gains, noise) if options.seeds > 1 else []
    folder = options.out / "campaign"
    folder.mkdir(parents=True, exist_ok=True)
    text = tables(rows) + claims(judged)
    (folder / "tables.md").write_text(text)
    found = {
        "seeds": options.seeds,
        "seconds": round(seconds, 1),
        "rows": rows,
        "gains": gains,
        "noise": noise,
        "verdicts": [v.as_data() for v in judged],
    }
    path = options.out / "campaign.json"
    path.write_text(json.dumps(found, indent=1, allow_nan=False) + "\n")
    if options.keep:
        save_campaign(found)
    print(text)
    print(f"{len(rows)} runs in {seconds:.0f} s; {path}, {folder}/tables.md")


if __name__ == "__main__":
    try:
        main()
    except LabkitError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
