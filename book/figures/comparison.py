"""Page "Comparison": the campaign's runs, made by `solutions.study.campaign`."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import recordings
from labkit.shapes import Array
from solutions.study import campaign, native, tasks
from solutions.study.campaign import BASELINE, CONTROLLERS, FEED_FORWARD, FIVE, TABLES
from solutions.study.claims import IMPEDANCE, THREE, interval, verdicts
from solutions.study.grid import pick

from .claims import holds, shows
from .page import figure, number, numbers, replay, shown, table

ARMS = {"ideal": "ideal", "baxter": "realistic"}
"""The names of the arms in the text."""
WITH_TORQUES = ("joint torque", "joint impedance")
SHOWN = ("late_rms_mm", "late_max_mm")
SIGNS = {"held": "✓", "did not hold": "✗", "undecided": "?"}


@cache
def found() -> dict[str, Any]:
    """The rows of the recorded campaign, and the verdicts on the report's claims."""
    rows, *others = (
        [row | {"failed": None} for row in recordings.campaign(name)]
        for name in ("rows", "gains", "noise")
    )
    return {"rows": rows, "verdicts": [v.as_data() for v in verdicts(rows, *others)]}


def _mean(controller: str, task: str, plant: str, name: str) -> float:
    rows = pick(found()["rows"], controller=controller, task=task, plant=plant)
    return float(np.mean([row[name] for row in rows]))


def _of_seeds(controller: str, task: str) -> Array:
    """The errors of a method on the realistic arm, one for each seed, in [mm]."""
    rows = pick(found()["rows"], controller=controller, task=task, plant="baxter")
    return np.array([row["late_rms_mm"] for row in sorted(rows, key=lambda row: row["seed"])])


def _on_paths(controller: str, plant: str) -> float:
    """The mean error over all tasks except the tag, in which the methods have different targets."""
    paths = (task for task in campaign.TASKS if task != "tag")
    return float(np.mean([_mean(controller, task, plant, "late_rms_mm") for task in paths]))


def _tip(task: tasks.Task) -> Array:
    """The wanted positions of the tip during a task, shape (N, 3) in [m]."""
    times = np.linspace(0.0, task.duration, 400)
    return np.array([task.target(float(t)).pose[:3, 3] for t in times])


def numbers_told() -> None:
    """Numbers and conclusions of the page."""
    rows = found()["rows"]
    seeds = {row["seed"] for row in rows}
    holds(len(rows) == len(campaign.grid(len(seeds))), "every run was finished")
    real = {controller: _on_paths(controller, "baxter") for controller in CONTROLLERS}
    ideal = {controller: _on_paths(controller, "ideal") for controller in CONTROLLERS}
    soft, stiff = IMPEDANCE, THREE
    holds(
        0.0 < max([real[w] for w in stiff]) < 0.6 * real[FEED_FORWARD],
        "it keeps the error that it starts with",
    )
    holds(min([real[w] for w in soft]) > 2.0 * max([real[w] for w in stiff]), "softer and worse")
    paths = [task for task in campaign.TASKS if task != "tag"]
    plain = np.concatenate([_of_seeds(FEED_FORWARD, task) for task in paths])
    holds(plain.max() > 4.0 * plain.min(), "it has no feedback, so the initial error remains")
    numbers({"plain_least": plain.min(), "plain_most": plain.max()}, ".0f")
    holds(
        all(0.0 < ideal[w] < min(1.0, 0.1 * real[w]) for w in FIVE),
        "On the ideal arm, which has no friction and no delay, the errors of all five,",
    )
    line = tasks.line()
    tips = [lk.Model("left").pose(q)[:3, 3] for q in (line.q0, *map(line.start, range(10)))]
    beside = np.linalg.norm(np.subtract(tips[1:], tips[0]), axis=1)
    holds(0.005 < np.mean(beside) < 0.025, "a centimetre or two beside its path")
    shows("The line is 0.21 m long", 0.21, np.linalg.norm(np.ptp(_tip(line), axis=0)), 0.03)
    first = min(FIVE, key=lambda w: real[w])
    numbers(
        {
            "best": real[first],
            "stiff_worst": max(real[w] for w in stiff),
            "soft": np.mean([real[w] for w in soft]),
            "ideal_worst": max(ideal[w] for w in FIVE),
            "baseline": real[BASELINE],
        },
        ".2g",
    )
    shows(
        "With ten seeds that makes 640 runs", (10, 640), (len({r["seed"] for r in rows}), len(rows))
    )


def checked() -> HTML:
    """The errors with the lab's friction and with MuJoCo's own, at a full and at half a step."""
    steps = (1e-3, 5e-4)
    own = {w: [native.lab(w, dt) for dt in steps] for w in ("joint velocity", *WITH_TORQUES)}
    other = {w: [native.mujoco_alone(w, dt) for dt in steps] for w in WITH_TORQUES}
    apart = {w: 1e3 * np.abs(own[w][0].q - other[w][0].q).max() for w in WITH_TORQUES}
    late = [1e3 * lk.metrics.rms(lk.metrics.tip_error(log)[log.t >= 1.0, :3])
            for log in own["joint velocity"]]  # fmt: skip
    moved = abs(late[1] - late[0])
    holds(0.0 < max(apart.values()) < 1.0, "MuJoCo's own friction moves the arm alike")
    holds(0.002 < moved / late[0] < 0.022, "half the step moves it by one or two hundredths")
    rows = [
        (f"{name}, step of {1e3 * dt:g} ms", *(
            f"{native.rms(logs[w][k]):.3f}" if w in logs else "–" for w in own))
        for name, logs in (("the lab's friction", own), ("MuJoCo's friction", other))
        for k, dt in enumerate(steps)
    ]  # fmt: skip
    return table(
        ("Physics", *own), rows,
        "RMS error of the tip on the line in mm, the start included; realistic arm without noise "
        "and delay, seed 0",
    )  # fmt: skip


def one_table(name: str, plant: str) -> HTML:
    """A table of one number for every method and task: the mean over the seeds, and the range."""
    body = []
    for controller in CONTROLLERS:
        cells = []
        for task in campaign.TASKS:
            x = [
                row[name]
                for row in pick(found()["rows"], controller=controller, task=task, plant=plant)
            ]
            least, most = f"{min(x):.2g}", f"{max(x):.2g}"
            span = f' <span class="lab-range">[{least}, {most}]</span>' * (least != most)
            star = "*" * ((controller, task) == (BASELINE, "tag"))
            cells.append(f"{np.mean(x):.2g}{star}{span}")
        body.append((controller, *cells))
    caption = (
        f"{TABLES[name]}, {ARMS[plant]} arm. * Measured from the place where the tag was last "
        "seen, not from the tag"
    )
    return table(("Method", *campaign.TASKS), body, caption)


def tables(plant: str) -> HTML:
    """The most important numbers, each in its own table."""
    return HTML("".join(one_table(name, plant).data for name in SHOWN))


def bars() -> HTML:
    """Tracking error of every method on the paths, on both arms."""
    _, ax = plt.subplots(figsize=(6.2, 3.8))
    told = []
    for k, plant in enumerate(ARMS):
        mean = [_on_paths(controller, plant) for controller in CONTROLLERS]
        y = np.arange(len(CONTROLLERS)) + 0.16 - 0.32 * k
        ax.plot(mean, y, "os"[k], color=f"C{1 - k}", label=ARMS[plant])
        for at, x in zip(y, mean, strict=True):
            ax.text(x * 1.2, at, f"{x:.2g}", va="center", fontsize="small")
        told.append(
            f"{ARMS[plant]} arm: "
            + ", ".join(f"{w} {x:.2g}" for w, x in zip(CONTROLLERS, mean, strict=True))
        )
    ax.set(xscale="log", xlabel="RMS error after the first second [mm]")
    ax.set_yticks(np.arange(len(CONTROLLERS)), CONTROLLERS)
    ax.invert_yaxis()
    ax.grid(axis="x", color="#999999", alpha=0.3)
    ax.set_xlim(right=ax.get_xlim()[1] * 1.6)
    ax.legend(fontsize="small")
    return figure(
        "Mean error of each method over the three paths and the seeds, on a logarithmic scale. On "
        "the realistic arm each of the five controllers errs more than ten times as much.",
        f"Points in millimetres. {'. '.join(told)}.",
    )


def claims() -> HTML:
    """The claims of the report, judged over all tasks and for each task."""
    rows = []
    for v in found()["verdicts"]:
        x, unit = v["overall"], v["unit"]
        tasks = sorted(v["tasks"], key=lambda t: campaign.TASKS.index(t["of"]))
        alone = [f"{t['of']} {SIGNS[t['outcome']]} {shown(t['mean'], '+.2g')}" for t in tasks]
        fine = max(0, 1 - math.floor(math.log10(x["half_width"])))  # with equal decimals
        fine += f"{abs(x['mean']):.{fine}f}" == f"{x['half_width']:.{fine}f}"  # and not alike
        mean = shown(x["mean"], f"+.{fine}f")
        said = f"{mean} ± {x['half_width']:.{fine}f} {unit}, {x['units']} {x['of']}"
        rows.append((v["claim"], x["outcome"], said, "<br>".join(alone) or "–"))
    return table(
        ("Claim", "Outcome", "Difference", "Task by task"), rows,
        "Paired differences; a positive one supports the claim. Intervals hold jointly, at 95 %, "
        "for all claims of a kind. Task by task: ✓ held, ✗ did not hold, ? undecided",
    )  # fmt: skip


def verdicts_told() -> None:
    """Numbers and conclusions about the verdicts."""
    judged = {v["claim"]: v for v in found()["verdicts"]}
    v = judged["the built-in method tracks better than joint velocity"]
    pairs = [t["mean"] for t in v["tasks"]]
    x = v["overall"]
    number("built_in_mean", x["mean"], "+.2f")
    number("built_in_half", x["half_width"], ".2f")
    holds(all(a < 0.0 for a in pairs), "on each of the three paths the claim did not hold")
    holds(
        0.7 * -x["mean"] < x["half_width"] < 1.2 * -x["mean"],
        "the half width of the interval is about the difference itself",
    )
    torque = judged["the built-in method tracks better than joint torque"]
    d = [t["mean"] for t in torque["tasks"]]
    holds(
        min(d) > 0.0
        and max(d) > 1.5 * min(d)
        and (abs(torque["overall"]["mean"]) < torque["overall"]["half_width"]),
        "the tasks' means agree in sign and not in size",
    )
    errors = {
        (r["controller"], r["task"], r["seed"]): r for r in pick(found()["rows"], plant="baxter")
    }
    pairs = [
        errors["joint torque", task, seed]["late_rms_mm"] - row["late_rms_mm"]
        for (controller, task, seed), row in errors.items()
        if controller == BASELINE and task != "tag"
    ]
    pooled = interval("pairs", pairs, 8)
    tracking = [v for v in judged.values() if v["unit"] == "mm" and v["overall"]["of"] == "tasks"]
    holds(len(tracking) == 8, "each at $1 - 0.05/8$")
    holds(
        pooled.mean > pooled.half_width > 0.0 and pooled.units == 30,
        "Thirty pooled pairs would have called it held",
    )
    number("torque_mean", torque["overall"]["mean"], "+.2f")
    number("torque_half", torque["overall"]["half_width"], ".1f")
    gain = judged["Kd = 0.5 tracks better than Kd = 0"]["overall"]
    holds(gain["mean"] > gain["half_width"] > 0.0, "a derivative gain tracks better")
    pair = judged["joint velocity tracks better than workspace velocity"]["overall"]
    others = [w for w in FIVE if "velocity" not in w]
    holds(
        0.0
        < max([_on_paths(w, "baxter") for w in FIVE if w not in others])
        < min([_on_paths(w, "baxter") for w in others])
        and abs(pair["mean"]) < pair["half_width"],
        "The two velocity controllers are the best of the five, and these runs cannot",
    )
    ideal = judged["four times the gain converges faster on the ideal arm"]["overall"]
    number("tick", 1e3 * ideal["half_width"], ".2g")


@cache
def run_of(controller: str, task: str) -> lk.Log:
    """One run of the campaign on the realistic arm, seed 0."""
    return campaign.perform(controller, task, "baxter", 0)


def side_by_side(task: str = "square") -> HTML:
    """Two controllers through one task, in 3-D."""
    return replay(
        run_of("joint velocity", task),
        f"The {task}, two controllers",
        "A square by the joint velocity PD and, see-through, by the workspace impedance. Both "
        "start at the same place beside the path.",
        label="joint velocity",
        ghosts={"impedance": run_of("workspace impedance", task)},
    )
