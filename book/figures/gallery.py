"""The gallery: the error of every method on every task over time, one run each."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics
from labkit.plotting import curve
from solutions.study import campaign
from solutions.study.campaign import BASELINE, FIVE

from .claims import holds
from .comparison import run_of
from .page import figure, table

SHOWN = (*FIVE, BASELINE)
LATE = 1.0
"""Time from which errors count, in [s]; before it every method still approaches the path."""


def all_methods(task: str) -> HTML:
    """A drawing with the errors of every method."""
    _, ax = plt.subplots(figsize=(6.2, 3.8))
    told = []
    for k, controller in enumerate(SHOWN):
        log = run_of(controller, task)
        off = 1e3 * np.linalg.norm(_error(log), axis=1)
        thin = slice(None, None, max(1, len(log) // 300))
        ax.plot(log.t[thin], off[thin], **curve(k), label=controller)
        told.append(f"{controller} {metrics.rms(off[log.t >= LATE]):.2g} mm")
    ax.set(xlabel="time [s]", ylabel="error of the tip [mm]", yscale="log")
    ax.set_ylim(bottom=max(ax.get_ylim()[0], 0.02))
    ax.legend(fontsize="small", ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return figure(
        f"Error of the tip on the {task} by each method. The scale is logarithmic, from 0.02 mm.",
        f"Curves of the error over time. RMS after the first second: {'; '.join(told)}.",
    )


def from_the_tag() -> HTML:
    """A table: each method's distance from the target it received, and from the tag itself."""
    rows = []
    for controller in SHOWN:
        log = run_of(controller, "tag")
        late = log.t >= LATE
        tips = metrics.tip_poses(log, _model())[late, :3, 3]
        miss = 1e3 * metrics.rms(campaign.chase(controller, 0).miss(log.t[late], tips))
        rows.append((controller, 1e3 * metrics.rms(_error(log)[late]), miss))
    *others, (_, obeys, misses) = rows
    holds(obeys < 1.0 and misses > 2.0 * max(row[2] for row in others), "it obeys and misses")
    return table(
        ("Method", "from its target [mm]", "from the tag [mm]"),
        [(name, f"{x:.2g}", f"{y:.2g}") for name, x, y in rows],
        "The tag, realistic arm, seed 0: RMS distances after the first second",
    )


def _model() -> lk.Model:
    return lk.Model("left", lk.BAXTER)


def _error(log: lk.Log) -> np.ndarray:
    """The error of the tip's position, shape (N, 3) in [m]."""
    return metrics.tip_error(log, _model())[:, :3]
