"""Instructor's guide: the cost of grading a class, from the measured time of a submission."""

from __future__ import annotations

import json
from pathlib import Path

from IPython.display import HTML
from myst_nb import glue

from labkit.grader.doctor import elsewhere
from labkit.grader.sandbox.limits import Limits

from .page import table

BENCH = Path(__file__).parents[2] / "build/bench.json"
MEASURED = {
    "grading_overhead_s": 0.16,
    "notebook_mb": 357.0,
    "notebook_s": 9.4,
    "cost_open_s": 0.314,
    "cost_open_per_minute": 382.0,
    "cost_open_own_share": 0.196,
    "cost_loops_s": 1.20,
    "cost_loops_per_minute": 99.6,
    "cost_loops_own_share": 0.358,
    "cost_answer_s": 8.97,
    "cost_endless_s": 45.3,
}
"""Results of ``python -m tests.bench`` on two quiet cores, with the names that it prints."""
CLASSES, CORES = (40, 400, 10_000), (2, 8, 64)


def _measured(key: str) -> tuple[float, str]:
    """A number of the bench, and its origin."""
    here = json.loads(BENCH.read_text()).get(key) if BENCH.exists() else None
    if here is not None:
        return float(here), "as tests.bench measured on this machine"
    return MEASURED[key], "as tests.bench measured on two quiet cores"


def table_of_effort() -> HTML:
    """The time to grade classes of several sizes on several numbers of cores."""
    seconds, origin = _measured("grading_overhead_s")
    told = f"A solved notebook 00 takes a worker {seconds:.2g} s, {origin}."
    glue("origin", told, display=False)
    glue("memory", f"{Limits().memory}", display=False)
    rows = [(f"{n:,}", *(_said(n * seconds / cores) for cores in CORES)) for n in CLASSES]
    head = ("Submissions", *(f"{cores} cores" for cores in CORES))
    return table(
        head, rows, "Time to grade a class with notebook 00, which has almost nothing to compute"
    )


COSTS = (
    ("a solved 01, open questions", "open"),
    ("a solved 05, closed loops", "loops"),
    ("a 01 with one answer that never ends", "answer"),
    ("a 01 in which no answer ends", "endless"),
)
"""Kinds of submissions, and their names in ``python -m tests.bench grading``."""
ENDLESS = ("answer", "endless")
"""Kinds for which only the time is measured, because the limits determine it."""


def table_of_costs() -> HTML:
    """The cost of different kinds of submissions, and the share of the students' own code."""
    parts = (("s", "{:.2g} s"), ("own_share", "{:.0%}"), ("per_minute", "{:.0f}"))
    rows = [(words, *(_cost(key, *part) for part in parts)) for words, key in COSTS]
    head = (
        "Submission",
        "time of a worker",
        "share of student code",
        "submissions per minute",
    )
    origin = _measured("cost_open_s")[1]
    title = f"What a submission costs, and how many are graded in a minute, {origin}"
    return table(head, rows, title)


def _cost(key: str, part: str, form: str) -> str:
    """A number of ``python -m tests.bench grading``, or an empty cell if there is none."""
    name = f"cost_{key}_{part}"
    if key in ENDLESS and part != "s":
        return ""
    return form.format(_measured(name)[0])


def kernel() -> None:
    """The most time and memory that the kernel of a solved notebook needs."""
    megabytes, origin = _measured("notebook_mb")
    seconds, _ = _measured("notebook_s")
    glue("kernel_mb", f"{megabytes:.0f}", display=False)
    glue("kernel_s", f"{seconds:.0f}", display=False)
    glue("kernel_origin", origin, display=False)


def isolation() -> None:
    """What a sandbox needs in the places where people grade, in the words of `labkit doctor`."""
    print(elsewhere())


def _said(seconds: float) -> str:
    if seconds < 90:
        return f"{max(1.0, seconds):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
