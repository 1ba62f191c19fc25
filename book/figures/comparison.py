"""Page "Comparison": the campaign's runs, made by `solutions.study.campaign`."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from myst_nb import glue

import labkit as lk
from solutions.study import campaign
from solutions.study.campaign import BASELINE, FEED_FORWARD, FIVE, TABLES, WAYS
from solutions.study.claims import IMPEDANCE, THREE
from solutions.study.grid import pick

from .page import figure, holds, numbers, replay, table

FOUND = Path(__file__).parents[2] / "build/book/campaign.json"
ARMS = {"ideal": "ideal", "baxter": "realistic"}
"""The arms as the text calls them."""
SHOWN = ("late_rms_mm", "late_max_mm", "effort")


@cache
def found() -> dict[str, Any]:
    """What the build tool measured, or `make campaign` before it."""
    told: dict[str, Any] = json.loads(FOUND.read_text())
    return told


def _mean(way: str, task: str, plant: str, name: str) -> float:
    rows = pick(found()["rows"], way=way, task=task, plant=plant)
    return float(np.mean([row[name] for row in rows if not row["failed"]]))


def _on_paths(way: str, plant: str) -> float:
    """The error over all tasks but the tag, where not every way is told the same."""
    paths = (task for task in campaign.TASKS if task != "tag")
    return float(np.mean([_mean(way, task, plant, "late_rms_mm") for task in paths]))


def numbers_told() -> None:
    """Numbers and conclusions of the page."""
    rows = found()["rows"]
    holds(not [row for row in rows if row["failed"]], "every run was finished")
    real = {way: _on_paths(way, "baxter") for way in WAYS}
    ideal = {way: _on_paths(way, "ideal") for way in WAYS}
    soft, stiff = IMPEDANCE, THREE
    holds(max(real[w] for w in stiff) < 0.6 * real[FEED_FORWARD], "looking helps")
    holds(max(real[w] for w in stiff) < min(real[w] for w in soft), "the soft ones are last")
    holds(min(real[w] for w in soft) > real[FEED_FORWARD], "softness costs more than not looking")
    holds(max(ideal[w] for w in FIVE) < 1.0, "on the ideal arm all five are below a millimetre")
    holds(all(ideal[w] < 0.1 * real[w] for w in FIVE), "the plant makes the difference")
    first = min(FIVE, key=lambda w: real[w])
    numbers(
        {
            "plain": real[FEED_FORWARD],
            "best": real[first],
            "stiff_worst": max(real[w] for w in stiff),
            "soft_best": min(real[w] for w in soft),
            "soft_worst": max(real[w] for w in soft),
            "ideal_worst": max(ideal[w] for w in FIVE),
            "baseline": real[BASELINE],
        },
        ".2g",
    )
    glue("first", first, display=False)
    glue("runs", f"{len(rows)}", display=False)
    glue("seeds", _seeds(), display=False)
    glue("source", found().get("source", "what make campaign left"), display=False)


def _seeds() -> str:
    """How many, and where they were fewer."""
    counts = {x: len({r["seed"] for r in pick(found()["rows"], task=x)}) for x in campaign.TASKS}
    most = max(counts.values())
    fewer = [f"{n} on the {task}" for task, n in counts.items() if n < most]
    return f"{most} seeds" + (f" ({', '.join(fewer)})" if fewer else "")


def one_table(name: str, plant: str) -> HTML:
    """One number of every way on every task: mean over the seeds and its range."""
    body = []
    for way in WAYS:
        cells = []
        for task in campaign.TASKS:
            x = [row[name] for row in pick(found()["rows"], way=way, task=task, plant=plant)]
            span = f'<span class="lab-range">[{min(x):.3g}, {max(x):.3g}]</span>'
            cells.append(f"{np.mean(x):.3g} {span}")
        body.append((way, *cells))
    return table(("Way", *campaign.TASKS), body, f"{TABLES[name]}, {ARMS[plant]} arm")


def tables(plant: str) -> HTML:
    """The numbers that matter most, one table each."""
    return HTML("".join(one_table(name, plant).data for name in SHOWN))


def bars() -> HTML:
    """Tracking error of every way on the paths, on both arms."""
    _, ax = plt.subplots(figsize=(6.2, 3.8))
    told = []
    for k, (plant, hatch) in enumerate((("ideal", "//"), ("baxter", ""))):
        mean = [_on_paths(way, plant) for way in WAYS]
        y = np.arange(len(WAYS)) + 0.2 - 0.4 * k
        ax.barh(
            y, mean, 0.38, color=f"C{1 - k}", hatch=hatch, label=ARMS[plant], edgecolor="#ffffff"
        )
        for at, x in zip(y, mean, strict=True):
            ax.text(x * 1.06, at, f"{x:.2g}", va="center", fontsize="small")
        told.append(
            f"{ARMS[plant]} arm: "
            + ", ".join(f"{w} {x:.2g}" for w, x in zip(WAYS, mean, strict=True))
        )
    ax.set(xscale="log", xlabel="RMS error of the tip after the first second [mm]")
    ax.set_yticks(np.arange(len(WAYS)), WAYS)
    ax.set_xlim(right=ax.get_xlim()[1] * 1.6)
    ax.legend(fontsize="small")
    return figure(
        "Mean over the three paths and the seeds, on the ideal and the realistic arm; the scale is "
        "logarithmic.",
        f"Bars in millimetres. {'. '.join(told)}.",
    )


def claims() -> HTML:
    """What the report claimed, judged."""
    rows = [
        (
            v["claim"],
            v["outcome"],
            f"{v['difference']:+.3g} ± {v['half_width']:.2g} {v['unit']}",
            str(v["pairs"]),
        )
        for v in found()["verdicts"]
    ]
    return table(
        ("Claim", "Outcome", "Difference", "Pairs"), rows,
        "Paired differences with 95 % intervals; positive speaks for the claim",
    )  # fmt: skip


@cache
def run_of(way: str, task: str) -> lk.Log:
    """One run of the campaign on the realistic arm, seed 0."""
    return campaign.perform(way, task, "baxter", 0)


def side_by_side(task: str = "square") -> HTML:
    """Two ways through one task, in 3-D."""
    return replay(
        run_of("joint velocity", task),
        f"The {task}, two ways",
        "Joint velocity PD; see-through: workspace impedance. Each starts about a centimetre "
        "beside its path.",
        label="joint velocity",
        ghosts={"workspace impedance": run_of("workspace impedance", task)},
    )
