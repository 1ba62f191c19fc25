"""Figures of tags read and followed.  Each takes values and `axes=None`, gives what it drew on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from ..log import Log
from ..motion import PoseSample
from ..plotting import STYLES
from .sensing import Quality, Readings

UNITS = {
    "distance": "distance [m]",
    "tilt": "tilt [degrees]",
    "resolution": "pixels along each side, times",
    "noise": "image noise [grey levels]",
    "size": "size of the tag [m]",
}


def sensor(sweeps: Mapping[str, Mapping[float, Quality]], *, axes: Any = None) -> Any:
    """Bias and spread of a tag's pose over each dial: position above, orientation below.

    Args:
        sweeps: What `sensing.sweep` gave, by the name of its dial.
        axes: Two rows of axes, one column for each sweep; None makes a figure.

    Returns:
        The axes, shape (2, sweeps).
    """
    if axes is None:
        _, axes = plt.subplots(
            2, len(sweeps), figsize=(2.9 * len(sweeps), 5), layout="constrained", squeeze=False
        )
    for column, (dial, results) in zip(np.asarray(axes).T, sweeps.items(), strict=True):
        x = np.array(list(results))
        x = np.degrees(x) if dial == "tilt" else x
        bias = np.array([q.bias for q in results.values()])
        spread = np.array([q.spread for q in results.values()])
        for ax, part, scale in zip(column, (slice(0, 3), slice(3, 6)), (1e3, 57.2958), strict=True):
            for k, (name, rows) in enumerate((("bias", bias), ("spread", spread))):
                size = scale * np.linalg.norm(rows[:, part], axis=1)
                ax.plot(x, size, f"C{k}o{STYLES[k]}", label=name, markersize=4)
            ax.set_ylim(bottom=0.0)
        column[1].set_xlabel(UNITS[dial])
    axes[0][0].set_ylabel("position [mm]")
    axes[1][0].set_ylabel("orientation [degrees]")
    axes[0][0].legend(frameon=False)
    return axes


def ambiguity(readings: Readings, *, ax: Any = None) -> Any:
    """Orientation error and ambiguity ratio over the tilt: near frontal views are a guess.

    Args:
        readings: What `sensing.read` gave.
        ax: Axes to draw on; None makes a figure.

    Returns:
        The axes.
    """
    if ax is None:
        _, ax = plt.subplots(figsize=(7, 4), layout="constrained")
    tilt = np.degrees(readings.tilt[readings.found])
    turn = np.degrees(np.linalg.norm(readings.error[:, 3:], axis=1))
    safe = readings.ratio[readings.found] >= 2.0
    ax.semilogy(tilt[safe], turn[safe], "C0o", markersize=4, label="other pose fits worse")
    ax.semilogy(tilt[~safe], turn[~safe], "C3x", label="other pose fits about as well (ratio < 2)")
    ax.set_xlabel("tilt [degrees]")
    ax.set_ylabel("orientation error [degrees]")
    ax.legend(frameon=False)
    return ax


def following(runs: Mapping[str, tuple[Log, Any]], *, axes: Any = None) -> Any:
    """Runs after a moving tag: distance from where the tip should be, and the reference's speed.

    Args:
        runs: For each name a log and the tip's error, shape (N, 3) in [m].
        axes: Two axes to draw on; None makes a figure.

    Returns:
        The two axes.
    """
    if axes is None:
        _, axes = plt.subplots(2, 1, figsize=(8, 5), sharex=True, layout="constrained")
    above, below = axes
    for k, (name, (log, error)) in enumerate(runs.items()):
        look: dict[str, Any] = {"color": f"C{k}", "linestyle": STYLES[k % 4], "label": name}
        above.semilogy(log.t, 1e3 * np.linalg.norm(error, axis=1), **look)
        wanted = log.target
        v = wanted.twist[:, :3] if isinstance(wanted, PoseSample) else wanted.velocity
        below.plot(log.t, np.linalg.norm(v, axis=1), **look)
    above.set_ylim(bottom=0.5)
    above.set_ylabel("tip's error [mm]")
    below.set_ylabel("reference's speed [m/s]")
    below.set_xlabel("time [s]")
    above.legend(frameon=False)
    return axes
