"""The report's tracking figures, 4 to 23, with the right axes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

from labkit import Log, Model, PoseSample, metrics, plotting
from labkit.plotting import AXES, curve, curves

from .campaign import FIVE, TASKS, joints, perform
from .grid import cells


def grid(folder: Path) -> list[dict[str, Any]]:
    """Cells of the figures: five controllers on every task."""
    return cells(controller=FIVE, task=TASKS, folder=(str(folder),))


def draw(controller: str, task: str, folder: str) -> Mapping[str, Any]:
    """The job: run once on Baxter's plant, draw the figure and describe it in words.

    Returns:
        "figure", its number in the report; "file", its name; "alt", its description in words.
    """
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    number = 4 + 4 * FIVE.index(controller) + TASKS.index(task)
    log = perform(controller, task, "baxter", 0)
    figure = overview(
        log, joints=joints(controller, task, 0), title=f"{controller}, {task}, baxter arm"
    )
    name = f"figure_{number:02d}_{controller.replace(' ', '_')}_{task}.png"
    figure.savefig(Path(folder) / name, dpi=90)
    plt.close(figure)
    return {"figure": number, "file": name, "alt": f"{task}: {plotting.describe(log)}"}


def overview(
    log: Log, model: Model | None = None, *, joints: Any = None, title: str | None = None
) -> Any:
    """Draw one run on one page: position, velocity and errors of the tip; all joints; all torques.

    Args:
        log: The run.
        model: The model of the arm; None makes that of the log.
        joints: For a run along poses, the joint angles for them as a function of time, which are
            drawn with the joints; None draws none.
        title: The title of the page; None names controller and arm.

    Returns:
        The figure.
    """
    model = model or metrics.model_of(log)
    arm = model.robot
    from matplotlib import pyplot as plt

    figure = plt.figure(figsize=(13, 10), layout="constrained")
    figure.suptitle(title or f"{log.controller} on the {log.plant.name} {log.robot.name} arm")
    columns = figure.add_gridspec(1, 3, width_ratios=(1.35, 1, 1))
    left, middle, right = (columns[k].subgridspec(n, 1) for k, n in enumerate((4, 7, 7)))
    e = metrics.tip_error(log, model)
    tip = [figure.add_subplot(left[k]) for k in range(4)]
    T_wt, T_wd = metrics.tip_poses(log, model), metrics.target_poses(log, model)
    curves(tip[0], log, T_wt[:, :3, 3], T_wd[:, :3, 3], "tip position [m]")
    v_wt = metrics.tip_velocities(log, model)
    v_wd = v_wt + metrics.velocity_error(log, model)
    curves(tip[1], log, v_wt, v_wd, "tip velocity [m/s]")
    for ax in tip[:2]:
        _legend_above(ax)
    for ax, error, label in (
        (tip[2], 1e3 * e[:, :3], "position error [mm]"),
        (tip[3], np.degrees(e[:, 3:]), "orientation error [deg]"),
    ):
        for k, name in enumerate(AXES):
            ax.plot(log.t, error[:, k], **curve(k), label=name)
        ax.plot(log.t, np.linalg.norm(error, axis=1), "k", linewidth=0.8, label="length")
        ax.set_ylabel(label)
        _legend_above(ax)
    wanted, meaning = None, "inverse kinematics"
    if not isinstance(log.target, PoseSample):
        wanted, meaning = log.target.position, "target"
    elif joints is not None:
        wanted = np.array([joints(t).position for t in log.t])
    for i, name in enumerate(arm.joint_names):
        ax, below = figure.add_subplot(middle[i]), figure.add_subplot(right[i])
        if wanted is not None:
            ax.plot(log.t, wanted[:, i], "0.6", linewidth=4, label=meaning)
        ax.plot(log.t, log.q[:, i], "C0", label="actual")
        below.plot(log.t, log.tau[:, i], "C1", linewidth=0.8)
        below.axhline(0.0, color="0.8", linewidth=0.8, zorder=0)
        for ax_i in (ax, below):
            ax_i.set_ylabel(name.split("_")[1], rotation=0, labelpad=12)
            ax_i.tick_params(labelsize="x-small", labelbottom=i == 6)
        if i == 0:
            ax.set_title("angles [rad]", loc="left", fontsize="medium")
            _legend_above(ax)
            below.set_title("torques [N m]", loc="left", fontsize="medium")
    for ax in (tip[3], figure.axes[-2], figure.axes[-1]):
        ax.set_xlabel("time [s]")
    return figure


def _legend_above(ax: Any) -> None:
    """Put the legend above the axes, where there is room for it."""
    ax.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=0.0,
        frameon=False,
        ncols=4,
        fontsize="x-small",
    )
