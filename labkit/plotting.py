"""Figures from a log; most functions take axes to draw on, or None, and return the axes.

`show` and `dials` are for notebooks: their output appears below the cell.

Curves differ by line style as well as by colour, and `describe` puts a run into words.
"""

from __future__ import annotations

from collections.abc import Callable
from textwrap import fill
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from . import metrics
from .log import Log
from .model import Model

try:
    from IPython.core.getipython import get_ipython
    from IPython.display import display
except ModuleNotFoundError:  # a script, without the extra `notebook`

    def get_ipython() -> None:  # type: ignore[misc]
        """Say that there is no notebook."""


AXES = ("x", "y", "z")


def curve(k: int) -> dict[str, Any]:
    """The look of curve ``k``, from 0, for `plot`: up to eight differ without their colours."""
    return {
        "color": f"C{k}",
        "linestyle": ("-", "--", "-.", ":")[k % 4],
        "marker": "o" if k > 3 else "",
        "markersize": 4,
        "markevery": 0.12,  # of the axes' diagonal
    }


def tracking(log: Log, model: Model | None = None, *, axes: Any = None) -> Any:
    """Plot the tip and its target above, and the length of the position error below.

    Args:
        log: The run.
        model: The arm's model; None makes one from the log.
        axes: Two axes to draw on; None makes a figure.

    Returns:
        The two axes.
    """
    model = model or metrics.model_of(log)
    if axes is None:
        _, axes = plt.subplots(2, 1, figsize=(8, 5.2), sharex=True, layout="constrained")
    above, below = axes
    T_wt, T_wd = metrics.tip_poses(log, model), metrics.target_poses(log, model)
    curves(above, log, T_wt[:, :3, 3], T_wd[:, :3, 3], "tip position [m]")
    _legend_beside(above)
    e = metrics.tip_error(log, model)
    below.plot(log.t, 1e3 * np.linalg.norm(e[:, :3], axis=1), "C3-")
    below.set_ylabel("tip error [mm]")
    below.set_xlabel("time [s]")
    return axes


def scaling(*scalings: Any, axes: Any = None) -> Any:
    """Plot s, ds/dt and d2s/dt2 over time, with one line style for each time scaling.

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
            ax.plot(t, column, **curve(k), label=name)
    for ax, label in zip(axes, ("s", "ds/dt [1/s]", "d²s/dt² [1/s²]"), strict=True):
        ax.set_ylabel(label)
    axes[0].legend(frameon=False)
    axes[-1].set_xlabel("time [s]")
    return axes


def curves(ax: Any, log: Log, actual: Any, target: Any, label: str) -> None:
    """Plot three coordinates over time, each on top of its target, a broad grey line."""
    for k, name in enumerate(AXES):
        ax.plot(log.t, target[:, k], "0.6", linewidth=4, label="target" if k == 0 else None)
        ax.plot(log.t, actual[:, k], **curve(k), label=name)
    ax.set_ylabel(label)


def _legend_beside(ax: Any) -> None:
    """Put the legend beside the axes, where no curve can cross it."""
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def show(caption: str) -> None:
    """Show the current figure with a caption, which is also its alternative text.

    Args:
        caption: What the figure shows, with its numbers; printed under the figure.
    """
    figure = plt.gcf()
    if get_ipython() is not None:
        display(figure, metadata={"image/png": {"alt": caption}})
    print(_folded(caption))
    plt.close(figure)


def _folded(caption: str) -> str:
    """A caption broken into lines between words; a browser would break it within them."""
    return fill(caption.replace(" %", "\N{NO-BREAK SPACE}%"), 79)


def answers(call: str, expected: Any, given: Any) -> Any:
    """Plot the numbers of an answer beside the expected ones.

    Args:
        call: The call that was made, used as the title.
        expected: Expected numbers, shape (n,).
        given: Numbers of the answer, shape (n,).

    Returns:
        A new figure, which is not shown.
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
    _legend_beside(ax)
    return figure


def describe(log: Log, model: Model | None = None) -> str:
    """Describe a figure of this run in words, for readers who cannot see it."""
    numbers = metrics.summary(log, model)
    return (
        f"Tracking by {log.controller} on the {log.plant.name} {log.robot.name} arm over "
        f"{numbers.duration:.3g} s: {numbers}."
    )


def dials(
    draw: Callable[..., tuple[Figure, str]],
    **ranges: tuple[float, float, float] | tuple[float, float, float, str],
) -> dict[str, Any]:
    """Show a figure under sliders that change it.

    Where nobody can move the sliders, only the figure of their starting values appears, so a
    notebook runs the same without a browser.

    Args:
        draw: A function of the sliders' values, by name, that returns a figure and its caption.
        ranges: For each slider its least, largest and starting values, and perhaps a unit.

    Returns:
        The sliders by name; setting a slider's `value` redraws.
    """
    import ipywidgets

    from .replay.player import in_its_place

    def drawn() -> tuple[dict[str, Any], dict[str, Any]]:
        figure, told = draw(**{name: slider.value for name, slider in sliders.items()})
        plt.close(figure)
        picture = {"obj": figure, "metadata": {"image/png": {"alt": told}}}
        return picture, {"obj": {"text/plain": _folded(told)}, "raw": True}

    def redraw(_: Any) -> None:
        for place, now in zip(places, drawn(), strict=True):
            place.update(**now)

    sliders, rows, spans = {}, [], []
    for name, (a, b, start, *unit) in ranges.items():
        words = " ".join([f"{name} from {a:g} to {b:g}", *unit])
        sliders[name] = ipywidgets.FloatSlider(
            start, min=a, max=b, step=(b - a) / 100, description=name, tooltip=words,
            continuous_update=False,
        )  # fmt: skip
        ends = ipywidgets.Label(" ".join([f"{a:g} to {b:g}", *unit]))
        rows.append(ipywidgets.HBox([sliders[name], ends]))
        spans.append(words)
    words = f"Dials: {', '.join(spans)}"
    display(in_its_place(f"{words}; run the cell to turn them."), raw=True)
    display(ipywidgets.VBox(rows)._repr_mimebundle_() | {"text/plain": words}, raw=True)
    places = [display(one.pop("obj"), display_id=True, **one) for one in drawn()]
    for slider in sliders.values():
        slider.observe(redraw, "value")
    return sliders
