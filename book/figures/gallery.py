"""The galleries, each with a run of every method on one task, drawn to the same scales."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics
from labkit.plotting import AXES, curve
from solutions.study import campaign
from solutions.study.campaign import BASELINE, FIVE

from .claims import holds
from .comparison import run_of
from .page import figure, replay, table

FILMS = Path(__file__).parents[2] / "build/campaign.json"
SHOWN = (*FIVE, BASELINE)
JOINTS = tuple(name.removeprefix("left_") for name in lk.robot("left").joint_names)
LATE = 1.0
"""Time from which errors count, in [s]; before it every method still approaches the path."""


def all_methods(task: str) -> HTML:
    """A drawing with the errors of every method."""
    _, ax = plt.subplots(figsize=(6.2, 3.8))
    for k, controller in enumerate(SHOWN):
        log = run_of(controller, task)
        thin = slice(None, None, max(1, len(log) // 300))
        ax.plot(log.t[thin], _off(log)[thin], **curve(k), label=controller)
    ax.set(xlabel="time [s]", ylabel="error of the tip [mm]", yscale="log")
    ax.set_ylim(bottom=max(ax.get_ylim()[0], 0.02))
    ax.legend(fontsize="small", ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    told = "; ".join(f"{controller} {_numbers(controller, task)[0]:.2g} mm" for controller in SHOWN)
    return figure(
        f"How far the tip is from its target on the {task}, by method; the scale is logarithmic.",
        f"Curves of the error over time. RMS after the first second: {told}.",
    )


def all_numbers(task: str) -> HTML:
    """A table of the numbers of these runs; each name is a link to its run."""
    rows = [
        (
            f'<a href="#{_place(controller)}">{controller}</a>',
            *map(_told, _numbers(controller, task)),
        )
        for controller in SHOWN
    ]
    if task == "tag":  # the most important number comes first
        rows = [(name, x[-1], *x[:-1]) for name, *x in rows]
    if task == "tag":
        found = {controller: _numbers(controller, task) for controller in SHOWN}
        holds(found[BASELINE][0] < 1.0, "the baseline obeys to a millimetre")
        holds(
            found[BASELINE][-1] > 2.0 * max(found[controller][-1] for controller in FIVE),
            "and misses the tag",
        )
    head = [
        "Method",
        "RMS [mm]",
        "largest [mm]",
        "error at the end [mm]",
        "orientation error, RMS [°]",
        "torque beyond gravity, RMS [N m]",
    ]
    head[1:1] = ["from the tag, RMS [mm]"] if task == "tag" else []
    return table(head, rows, f"The {task}, realistic arm, seed 0; errors after the first second")


def _told(x: float) -> str:
    return f"{x:.3g}" if x >= 1e-3 else "&lt; 0.001"


def beside(task: str) -> HTML:
    """A 3-D replay of three methods on one task."""
    first, *others = ("joint velocity", "joint torque", "workspace impedance")
    return replay(
        run_of(first, task),
        f"The {task}, three methods",
        f"Joint velocity PD; see-through: {' and '.join(others)}.",
        label=first,
        ghosts={controller: run_of(controller, task) for controller in others},
    )


def film(task: str) -> HTML:
    """The film of a task, if `make campaign` has made one."""
    told = json.loads(FILMS.read_text())["films"] if FILMS.exists() else []
    row = next((row for row in told if row["task"] == task), None)
    if row is None:
        return HTML("")
    name = f"../_static/films/{row['file']}"
    return HTML(
        f'<figure class="lab-figure"><video class="lab-svg" controls preload="none" '
        f'poster="../_static/films/{row["poster"]}" src="{name}" aria-label="{escape(row["alt"])}">'
        f"</video><figcaption>Joint velocity control, seed 0; without sound."
        f"<details><summary>Description in words</summary><p>{escape(row['alt'])}</p></details>"
        "</figcaption></figure>"
    )


def everything(controller: str, task: str) -> HTML:
    """One run in six panels with reduced samples; the scales are the same for all methods."""
    log = run_of(controller, task)
    thin = slice(None, None, max(1, len(log) // 300))
    _, axes = plt.subplots(6, 1, figsize=(6.2, 10.6), sharex=True)
    for ax, (label, values, target), limits in zip(
        axes, _panels(controller, task), _limits(task), strict=True
    ):
        names = AXES if values.shape[1] == 3 else JOINTS
        for k, name in enumerate(names):
            if target is not None:
                ax.plot(
                    log.t[thin],
                    target[thin, k],
                    "#999999",
                    linewidth=4,
                    label="" if k else "target",
                )
            ax.plot(log.t[thin], values[thin, k], **curve(k), label=name,
                    linewidth=1.8 if names is AXES else 1.2)  # fmt: skip
        ax.set(ylabel=label, ylim=limits)
        ax.legend(fontsize="small", ncols=7, loc="lower right", bbox_to_anchor=(1.0, 1.0),
                  borderaxespad=0.0, handlelength=1.6, columnspacing=0.8)  # fmt: skip
    axes[-1].set_xlabel("time [s]")
    found = metrics.summary(log, _model())
    e, off, torque = (_panels(controller, task)[k][1] for k in (2, 4, 5))
    drawn = figure(
        f"{controller.capitalize()} on the {task}, realistic arm. RMS error of the tip: "
        f"{_numbers(controller, task)[0]:.3g} mm after the first second, "
        f"{found.rms_mm:.3g} mm with the start.",
        f"{controller.capitalize()} on the {task}: {found}.",
        f"Six panels over {found.duration:.3g} s: position and speed of the tip and of its target, "
        "its position error along x, y and z, its orientation error, the error of each joint and "
        f"the torque of each motor beyond gravity. {found}. The largest joint error is "
        f"{np.abs(off).max():.2g} degrees, the largest torque "
        f"beyond gravity {np.abs(torque).max():.3g} N m, the "
        f"last error {_told(float(np.linalg.norm(e[-1]))).replace('&lt;', 'below')} mm. All errors "
        "here are those of the whole run, and the RMS torque includes the arm's weight.",
    )
    links = " · ".join(_elsewhere(controller, task))
    return HTML(
        f'<p class="lab-one">{controller.capitalize()} on {links}; '
        f'<a href="#all-methods">all methods</a></p>{drawn.data}'
    )


def _elsewhere(controller: str, task: str) -> Iterator[str]:
    """Links to the same method on every task."""
    for other in campaign.TASKS:
        link = f'<a href="{other}.html#{_place(controller)}">the {other}</a>'
        yield f"<strong>the {other}</strong>" if other == task else link


def _place(controller: str) -> str:
    return controller.replace(" ", "-")


@cache
def _model() -> lk.Model:
    return lk.Model("left", lk.BAXTER)


def _off(log: lk.Log) -> np.ndarray:
    """The distance of the tip from its target, shape (N,), in [mm]."""
    return 1e3 * np.linalg.norm(metrics.tip_error(log, _model())[:, :3], axis=1)


def _beyond_gravity(log: lk.Log) -> np.ndarray:
    """The motors' torques without the part that holds the arm's weight, shape (N, 7), in [N m]."""
    return log.tau - np.array([_model().gravity(q) for q in log.q])


def _numbers(controller: str, task: str) -> tuple[float, ...]:
    """One row of the table."""
    log = run_of(controller, task)
    told = campaign.measured(log, campaign.joints(controller, task, 0))
    late = log.t >= LATE
    names = ("late_rms_mm", "late_max_mm", "end_mm", "late_rms_deg")
    found = (*(told[name] for name in names), metrics.rms(_beyond_gravity(log)[late]))
    if task != "tag":
        return found
    tips = metrics.tip_poses(log, _model())[late, :3, 3]
    return *found, 1e3 * metrics.rms(campaign.chase(controller, 0).miss(log.t[late], tips))


@cache
def _panels(controller: str, task: str) -> list[tuple[str, np.ndarray, np.ndarray | None]]:
    """The label, the values of shape (N, k) and the target, if it is drawn, of each panel."""
    log, model = run_of(controller, task), _model()
    e = metrics.tip_error(log, model)
    p, d = metrics.tip_poses(log, model)[:, :3, 3], metrics.target_poses(log, model)[:, :3, 3]
    v, w = metrics.tip_velocities(log, model), metrics.target_velocities(log, model)
    wanted = campaign.joints(controller, task, 0)
    off = np.array([wanted(t).position for t in log.t]) - log.q
    return [
        ("tip [m]", p, d),
        ("tip speed [m/s]", v[:, :3], w[:, :3]),
        ("error [mm]", 1e3 * e[:, :3], None),
        ("turn error [°]", np.degrees(e[:, 3:]), None),
        ("joint error [°]", np.degrees(off), None),
        ("torque [N m]", _beyond_gravity(log), None),
    ]


@cache
def _limits(task: str) -> list[tuple[float, float]]:
    """Limits of the panels that show the runs of all methods in full."""
    found = []
    for panels in zip(*(_panels(controller, task) for controller in SHOWN), strict=True):
        values = np.concatenate([panel[1].ravel() for panel in panels])
        edge = 0.05 * np.ptp(values)
        found.append((float(values.min() - edge), float(values.max() + edge)))
    return found
