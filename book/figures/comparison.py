"""Page "Comparison" and the galleries: the campaign's runs, made by `solutions.campaign`."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from myst_nb import glue

import labkit as lk
from labkit import metrics
from labkit.plotting import AXES, STYLES
from labkit.replay.motion import JOINTS
from labkit.study.campaign import pick
from solutions import campaign
from solutions.campaign import BASELINE, FEED_FORWARD, FIVE, TABLES, WAYS
from solutions.claims import IMPEDANCE, THREE

from .page import figure, holds, numbers, replay, table

FOUND = Path(__file__).parents[2] / "build/book/campaign.json"
FILMS = Path(__file__).parents[2] / "build/campaign.json"
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


def numbers_told() -> None:
    """Numbers and conclusions of the page."""
    rows = found()["rows"]
    holds(not [row for row in rows if row["failed"]], "every run was finished")
    tasks = tuple(campaign.TASKS)

    def error(way: str, plant: str) -> float:
        return float(np.mean([_mean(way, task, plant, "late_rms_mm") for task in tasks]))

    real = {way: error(way, "baxter") for way in WAYS}
    ideal = {way: error(way, "ideal") for way in WAYS}
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
    """Tracking error of every way, on both arms."""
    tasks = tuple(campaign.TASKS)
    _, ax = plt.subplots(figsize=(6.2, 3.8))
    told = []
    for k, (plant, hatch) in enumerate((("ideal", "//"), ("baxter", ""))):
        mean = [np.mean([_mean(w, t, plant, "late_rms_mm") for t in tasks]) for w in WAYS]
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
        "Mean over tasks and seeds, on the ideal and the realistic arm; the scale is logarithmic.",
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
        ghosts={w: _cut(run_of(w, task), task) for w in ("workspace impedance",)},
    )


def _cut(log: lk.Log, task: str) -> lk.Log:
    """The same ticks as the run it is shown beside."""
    base = run_of("joint velocity", task)
    q = np.column_stack([np.interp(base.t, log.t, column) for column in log.q.T])
    return replace(log, t=base.t, q=q)


def film(task: str) -> HTML:
    """The film of a task, where `make campaign` has left one; else where to get it."""
    told = json.loads(FILMS.read_text())["films"] if FILMS.exists() else []
    row = next((row for row in told if row["task"] == task), None)
    if row is None:
        return HTML("<p><code>make campaign</code> before the book adds a film of this task.</p>")
    name = f"../_static/films/{row['file']}"
    return HTML(
        f'<figure class="lab-figure"><video class="lab-svg" controls preload="none" '
        f'poster="../_static/films/{row["poster"]}" src="{name}" aria-label="{escape(row["alt"])}">'
        f"</video><figcaption>Joint velocity control, seed 0; without sound."
        f"<details><summary>Description in words</summary><p>{escape(row['alt'])}</p></details>"
        "</figcaption></figure>"
    )


def everything(way: str, task: str) -> HTML:
    """One run in six panels, thinned for the page."""
    log, model = run_of(way, task), lk.Model("left", lk.BAXTER)
    thin = slice(None, None, max(1, len(log) // 300))
    t = log.t[thin]
    e = metrics.tip_error(log, model)
    p, d = metrics.tip_poses(log, model)[:, :3, 3], metrics.target_poses(log, model)[:, :3, 3]
    v, w = metrics.tip_velocities(log, model), metrics.target_velocities(log, model)
    wanted_at = campaign.joints(way, task, 0)
    wanted = np.array([wanted_at(x).position for x in log.t])
    _, axes = plt.subplots(6, 1, figsize=(6.2, 10.6), sharex=True)
    for k, axis in enumerate(AXES):
        style = f"C{k}{STYLES[k]}"
        axes[0].plot(t, d[thin, k], "#999999", linewidth=4, label="target" if k == 0 else None)
        axes[0].plot(t, p[thin, k], style, label=axis)
        axes[1].plot(t, w[thin, k], "#999999", linewidth=4, label="target" if k == 0 else None)
        axes[1].plot(t, v[thin, k], style, label=axis)
        axes[2].plot(t, 1e3 * e[thin, k], style, label=axis)
        axes[3].plot(t, np.degrees(e[thin, 3 + k]), style, label=axis)
    for k, name in enumerate(JOINTS):
        style = f"C{k}{STYLES[k % 4]}"
        axes[4].plot(t, np.degrees(wanted - log.q)[thin, k], style, linewidth=1.2, label=name)
        axes[5].plot(t, log.tau[thin, k], style, linewidth=1.2, label=name)
    labels = ("tip [m]", "tip speed [m/s]", "error [mm]", "turn error [°]", "joint error [°]",
              "torque [N m]")  # fmt: skip
    for ax, label in zip(axes, labels, strict=True):
        ax.set_ylabel(label)
        ax.legend(fontsize="small", ncols=7, loc="lower right", bbox_to_anchor=(1.0, 1.0),
                  borderaxespad=0.0, handlelength=1.6, columnspacing=0.8)  # fmt: skip
    axes[-1].set_xlabel("time [s]")
    found = metrics.summary(log, model)
    return figure(
        f"{way.capitalize()} on the {task}, realistic arm.",
        f"{way.capitalize()} on the {task}: {found}.",
        f"Six panels over {found.duration:.3g} s: position and speed of the tip over its target, "
        "its position error along x, y and z, its orientation error, the error of each joint and "
        f"the torque of each motor. {found}. The largest joint error is "
        f"{np.degrees(np.abs(wanted - log.q)).max():.2g} degrees, the largest torque "
        f"{np.abs(log.tau).max():.3g} N m, the last error "
        f"{1e3 * np.linalg.norm(e[-1, :3]):.2g} mm.",
    )
