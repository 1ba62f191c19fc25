"""Instructor's guide: what a class costs to grade, from the measured overhead of one submission."""

from __future__ import annotations

import json
from pathlib import Path

from IPython.display import HTML
from myst_nb import glue

from labkit.grade.doctor import elsewhere
from labkit.grade.limits import Limits

from .page import table

BENCH = Path(__file__).parents[2] / "build/bench.json"
MEASURED = 0.16
"""Seconds of a worker for one submission of 00_warmup, by ``python -m bench.grading``."""
CLASSES, CORES = (40, 400, 10_000), (2, 8, 64)


def _overhead() -> tuple[float, str]:
    """Seconds for each submission, and where the number is from."""
    if BENCH.exists():
        told = json.loads(BENCH.read_text()).get("grading_overhead_s")
        if told is not None:
            return float(told), "as measured on this machine by make bench."
    return (
        MEASURED,
        "as measured on two quiet cores; python -m bench.grading measures yours.",
    )


def table_of_effort() -> HTML:
    """How long classes take on how many cores."""
    seconds, origin = _overhead()
    limits = Limits()
    glue("origin", f"A solved notebook 00 takes a worker {seconds:.2g} s, {origin}", display=False)
    glue("memory", f"{limits.memory}", display=False)
    rows = [(f"{n:,}", *(_said(n * seconds / cores) for cores in CORES)) for n in CLASSES]
    head = ("Submissions", *(f"{cores} cores" for cores in CORES))
    return table(head, rows, "Time to grade a class, where hardly anything is to be computed")


def ways_to_isolate() -> None:
    """What a sandbox takes, in the places where people grade, as `labkit doctor` says it."""
    print(elsewhere())


def _said(seconds: float) -> str:
    if seconds < 90:
        return f"{max(1.0, seconds):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
