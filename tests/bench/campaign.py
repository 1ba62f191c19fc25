"""The time for one seed of the whole campaign on two cores."""

import os
import time

from solutions.study.campaign import grid, numbers
from solutions.study.grid import work_through


def measure():
    """Seconds for one seed of every method, task and plant, with the start of the workers."""
    began = time.perf_counter()
    rows = work_through(numbers, grid(1), jobs=min(2, os.cpu_count() or 1))
    seconds = time.perf_counter() - began
    failed = [row["failed"] for row in rows if row["failed"]]
    if failed:
        raise RuntimeError(f"{len(failed)} of {len(rows)} runs failed, the first: {failed[0]}")
    return {"campaign_one_seed_s": seconds}
