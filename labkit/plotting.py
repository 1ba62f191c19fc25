"""Figures from a log.  Each takes the value and `ax=None`, returns what it drew on, shows nothing.

Curves differ by line style as well as by colour, and `describe` gives each figure words.
"""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from . import metrics
from .model import Model
from .run import Log

STYLES = ("-", "--", "-.", ":")
AXES = ("x", "y", "z")


def tracking(log: Log, model: Model | None = None, *, axes: Any = None) -> Any:
    """The tip against its target, and the error: three coordinates above, lengths below.

    Args:
        log: The run.
        model: The arm's model; None makes the log's own.
        axes: Two axes to draw on; None makes a figure.

    Returns:
        The two axes.
    """
    model = model or metrics.model_of(log)
    if axes is None:
        _, axes = plt.subplots(2, 1, figsize=(8, 5.2), sharex=True, layout="constrained")
    above, below = axes
    T_wt, T_wd = metrics.tip_poses(log, model), metrics.target_poses(log, model)
    for k, (name, style) in enumerate(zip(AXES, STYLES, strict=False)):
        above.plot(log.t, T_wd[:, k, 3], "0.6", linewidth=4, label="target" if k == 0 else None)
        above.plot(log.t, T_wt[:, k, 3], f"C{k}{style}", label=f"{name} of the tip")
    above.set_ylabel("position [m]")
    above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    e = metrics.tip_error(log, model)
    below.plot(log.t, 1e3 * np.linalg.norm(e[:, :3], axis=1), "C3-", label="position [mm]")
    below.plot(
        log.t, np.degrees(np.linalg.norm(e[:, 3:], axis=1)), "C4--", label="orientation [deg]"
    )
    below.set_ylabel("error")
    below.set_xlabel("time [s]")
    below.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    above.set_title(f"{log.controller} on the {log.plant.name} arm", loc="left", fontsize="medium")
    return axes


def scaling(*scalings: Any, axes: Any = None) -> Any:
    """s, its speed and its acceleration over time, one line style for each time scaling.

    Args:
        scalings: Time scalings, or pairs (name, scaling).
        axes: Three axes to draw on; None makes a figure.

    Returns:
        The three axes.
    """
    if axes is None:
        _, axes = plt.subplots(3, 1, figsize=(8, 6), sharex=True, layout="constrained")
    for k, item in enumerate(scalings):
        name, s_of_t = item if isinstance(item, tuple) else (type(item).__name__, item)
        t = np.linspace(-0.1, 1.1, 601) * s_of_t.duration
        rows = np.array([s_of_t(x) for x in t])
        for ax, column in zip(axes, rows.T, strict=True):
            ax.plot(t, column, f"C{k}{STYLES[k % 4]}", label=name)
    for ax, label in zip(axes, ("s", "ds/dt [1/s]", "d²s/dt² [1/s²]"), strict=True):
        ax.set_ylabel(label)
    axes[0].legend(frameon=False)
    axes[-1].set_xlabel("time [s]")
    return axes


def answers(call: str, expected: Any, given: Any) -> Any:
    """The numbers of an answer beside those expected.

    Args:
        call: What was asked, as a title.
        expected: Shape (n,).
        given: Shape (n,).

    Returns:
        A figure of its own, not shown.
    """
    figure = Figure(figsize=(6.4, 2.2), layout="constrained")
    ax = figure.add_subplot()
    index = np.arange(len(expected))
    ax.vlines(index, expected, given, color="0.7")
    ax.plot(index, expected, "o", mfc="none", ms=9, color="C0", label="expected")
    ax.plot(index, given, "x", ms=8, color="C3", label="yours")
    ax.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)
    ax.set_xlabel("number in the answer")
    ax.set_xticks(index[:: max(1, len(index) // 14)])
    ax.set_title(call, loc="left", fontsize="small", family="monospace")
    ax.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def describe(log: Log, model: Model | None = None) -> str:
    """A figure of this run in words, for readers who do not see it."""
    numbers = metrics.summary(log, model)
    return (
        f"Tracking by {log.controller} on the {log.plant.name} {log.side} arm over "
        f"{numbers.duration:.3g} s: {numbers}."
    )
