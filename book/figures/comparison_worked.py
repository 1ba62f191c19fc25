"""Page "Comparison": what chance does to a mean, and the report's claims worked by hand."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from scipy.stats import norm
from scipy.stats import t as student

from labkit import metrics
from solutions.comparison.answers import paired_difference
from solutions.study import campaign
from solutions.study.campaign import BASELINE
from solutions.study.claims import Interval, Outcome, interval
from solutions.study.grid import pick

from .claims import holds, shows
from .comparison import found
from .facts import CLAIMS, LEVEL
from .page import Question, figure, number, numbers, quiz

PATHS = [task for task in campaign.TASKS if task != "tag"]
FIRST = (10.4, 8.8, 12.1, 9.5, 11.2)
SECOND = (9.9, 8.1, 11.7, 8.7, 10.6)
"""Errors of two made-up controllers in [mm], seed by seed."""


def differences(controller: str) -> dict[str, list[float]]:
    """A controller's error minus the baseline's in [mm], for each path, seed by seed."""
    rows = {(r["controller"], r["task"], r["seed"]): r["late_rms_mm"]
            for r in pick(found()["rows"], plant="baxter")}  # fmt: skip
    seeds = sorted({seed for name, task, seed in rows if task in PATHS})
    return {
        task: [
            rows[controller, task, seed] - rows[BASELINE, task, seed]
            for seed in seeds
            if (controller, task, seed) in rows and (BASELINE, task, seed) in rows
        ]
        for task in PATHS
    }


def one_number() -> None:
    """The error of a run, computed by hand."""
    e = np.array(((3.0, 4.0, 0.0), (0.0, 0.0, 1.0)))
    shows("the RMS error is 3.6 mm", 3.6, metrics.rms(e), 0.01)
    shows("the number would be 2.1 mm", 2.1, float(np.sqrt(np.mean(e**2))), 0.02)
    lengths = np.linalg.norm(e, axis=1)
    shows("Their lengths are 5 and 1 mm, so the mean length is 3 mm", (5.0, 1.0, 3.0),
          (*lengths, lengths.mean()))  # fmt: skip


def intervals() -> None:
    """Check the derivations' statements about levels, factors and outcomes."""
    factors = [float(student.ppf(0.975, n - 1)) for n in (2, 3, 5, 10)] + [norm.ppf(0.975)]
    holds(
        np.allclose(factors, (12.7, 4.3, 2.78, 2.26, 1.96), rtol=0.004)
        and factors[0] - factors[2] > 20.0 * (factors[3] - factors[4]) > 0.0,
        "The step from two to five is worth far more than the one from ten to infinity",
    )
    shows("intervals 30 % too short", 0.30, 1.0 - factors[4] / factors[2], 0.03)
    shows("An interval with 95 % confidence is wrong in one of twenty cases", (0.95, 20.0),
          (LEVEL, 1.0 / (1.0 - LEVEL)))  # fmt: skip
    true, pooled = 1.0 / 3.0 + 0.25 / 15.0, 1.25 / 15.0
    shows("its variance is too small by a factor of 4.2", 4.2, true / pooled)
    kinds = (Outcome.HELD, Outcome.DID_NOT_HOLD, Outcome.UNDECIDED)
    holds(
        tuple(Interval("", m, 0.5, 2).outcome for m in [1.0, -1.0, 0.2]) == kinds,
        "held if the whole interval is above zero, it did not hold if the whole",
    )


def five_pairs() -> None:
    """Two made-up controllers, compared with pairs and without."""
    mean, half = paired_difference(FIRST, SECOND)
    d = np.subtract(FIRST, SECOND)
    shows("The mean difference is 0.60 mm", 0.60, mean)
    shows("have a standard deviation of 0.158 mm", 0.158, d.std(ddof=1))
    shows("0.158/\\sqrt5$ = 0.0707 mm", 0.0707, d.std(ddof=1) / math.sqrt(5.0))
    shows("the half width is 0.20 mm", 0.20, half, 0.03)
    spread = [float(np.std(x, ddof=1)) for x in (FIRST, SECOND)]
    holds(np.allclose(spread, (1.31, 1.45), rtol=0.005), "scatter by 1.31 mm and 1.45 mm")
    alone, t = math.hypot(*spread) / math.sqrt(5.0), float(student.ppf(0.975, 8))
    shows(
        "= 0.87 mm and, with the factor 2.306 for eight degrees of freedom, an interval of "
        "± 2.0 mm "
        "about the same 0.60 mm",
        (0.87, 2.306, 2.0, 0.60),
        (alone, t, t * alone, mean),
        0.02,
    )
    rho = float(np.corrcoef(FIRST, SECOND)[0, 1])
    shows("a correlation of 0.998", 0.998, rho, 0.002)


def units() -> None:
    """The claim about the joint torque PD, worked by hand from the tasks' means."""
    means = [float(np.mean(d)) for d in differences("joint torque").values()]
    whole = interval("tasks", means, CLAIMS)
    deviation = float(np.std(means, ddof=1))
    numbers({f"unit_{task}": m for task, m in zip(PATHS, means, strict=True)}, ".2f")
    number("unit_mean", whole.mean, ".2f")
    number("unit_deviation", deviation, ".2f")
    number("unit_error", deviation / math.sqrt(3.0), ".2f")
    number("unit_half", whole.half_width, ".1f")
    shows("is 12.59 instead of 4.30", 12.59, student.ppf(1.0 - 0.025 / CLAIMS, 2), 1e-3)
    shows("instead of 4.30", 4.30, student.ppf(0.975, 2), 1e-3)
    holds(_decided("joint torque") == 3, "Each of the three paths is decided")


def _decided(controller: str) -> int:
    """The number of paths on which the interval over the seeds does not contain zero."""
    alone = [interval(task, d, CLAIMS) for task, d in differences(controller).items()]
    return sum(abs(x.mean) > x.half_width for x in alone)


def more_seeds() -> None:
    """How little more seeds would help: the shares of the variance, and what would remain."""
    d = np.array(list(differences("joint torque").values()))
    within = float(np.mean(d.var(axis=1, ddof=1)))
    tasks = float(d.mean(axis=1).var(ddof=1))
    between = tasks - within / d.shape[1]
    t = float(student.ppf(1.0 - 0.025 / CLAIMS, 2))
    endless = t * math.sqrt(between / 3.0)
    holds(endless > 2.0 * d.mean() > 0.0, "No number of seeds would decide it")
    numbers({"within": within, "between": between, "endless": endless}, ".2g")
    t = float(student.ppf(1.0 - 0.025 / CLAIMS, 11))
    number("factor_twelve", t, ".2g")
    number("twelve_tasks", t * math.sqrt((between + within / d.shape[1]) / 12.0), ".1f")


def luck() -> None:
    """How often pure noise looks like a result."""
    shows("of them exclude the truth, instead of 5 %", 5.0, 100.0 * (1.0 - LEVEL))
    random = np.random.default_rng(3)
    many = 4000
    b, w = random.standard_normal((many, 3, 1)), 0.5 * random.standard_normal((many, 3, 5))
    d = b + w

    def wrong(x: np.ndarray) -> float:
        n = x.shape[1]
        half = student.ppf(0.5 + LEVEL / 2.0, n - 1) * x.std(axis=1, ddof=1) / math.sqrt(n)
        return 100.0 * float(np.mean(np.abs(x.mean(axis=1)) > half))

    pooled, by_task = wrong(d.reshape(many, 15)), wrong(d.mean(axis=2))
    holds(
        pooled > 20.0 > 7.0 > by_task > 3.0,
        "Pooled, the intervals are wrong far more often than they say",
    )
    numbers({"wrong_pooled": pooled, "wrong_tasks": by_task}, ".1g")


def two_units() -> HTML:
    """Every difference of one claim, and two intervals that they could support."""
    d = differences("joint torque")
    _, ax = plt.subplots(figsize=(6.2, 3.3))
    for k, x in enumerate(d.values()):
        y = 2.0 - k + 0.03 * (np.arange(len(x)) - 4.5)
        ax.plot(x, y, "o", color=f"C{k}", mfc="none")
        ax.plot(np.mean(x), 2.0 - k, "|", color=f"C{k}", markersize=24, markeredgewidth=2.5)
    means = [float(np.mean(x)) for x in d.values()]
    pairs = [x for row in d.values() for x in row]
    kinds = ((f"the {len(pairs)} pairs, pooled", interval("pairs", pairs, CLAIMS), "C5", -1.0),
             ("the 3 tasks", interval("tasks", means, CLAIMS), "C4", -2.0))  # fmt: skip
    for _, mean, ink, height in kinds:
        ax.errorbar(mean.mean, height, xerr=mean.half_width, color=ink, capsize=6, fmt="s")
    ax.axvline(0.0, color="#57606a", linewidth=0.9)
    ax.set_yticks([2.0, 1.0, 0.0, -1.0, -2.0], [*PATHS, *(name for name, *_ in kinds)])
    ax.set(xlabel="joint torque PD minus baseline [mm]", ylim=(-2.6, 2.6))
    told = "; ".join(f"on the {t} {np.mean(x):.2g} mm" for t, x in d.items())
    pooled, tasks = (x for _, x, _, _ in kinds)
    return figure(
        "Error of the joint torque PD minus that of the baseline: a ring for each seed, a bar for "
        "the mean of each path. Pooled, the runs seem to decide; the paths do not.",
        f"Rings in three rows; their means are {told}. Both intervals are wide enough for eight "
        f"questions at once. The interval of the pooled pairs is "
        f"{pooled.mean:.2g} ± {pooled.half_width:.2g} mm and does not reach zero; that of the "
        f"three tasks is {tasks.mean:.2g} ± {tasks.half_width:.2g} mm and holds zero.",
    )


def pairing() -> HTML:
    """Two groups of errors that overlap, and their paired differences, which have one sign."""
    _, (left, right) = plt.subplots(1, 2, figsize=(6.4, 2.9), width_ratios=(1.6, 1.0))
    for a, b in zip(FIRST, SECOND, strict=True):
        left.plot([0.0, 1.0], [a, b], "-", color="#999999", linewidth=1.0)
    left.plot(np.zeros(5), FIRST, "C0o")
    left.plot(np.ones(5), SECOND, "C1s")
    left.set_xticks([0.0, 1.0], ["first", "second"])
    left.set(xlim=(-0.4, 1.4), ylabel="error [mm]")
    mean, half = paired_difference(FIRST, SECOND)
    right.plot(np.zeros(5), np.subtract(FIRST, SECOND), "C3o", mfc="none")
    right.errorbar(0.35, mean, yerr=half, color="C3", fmt="s", capsize=6)
    right.axhline(0.0, color="#57606a", linewidth=0.9)
    right.set_xticks([0.0, 0.35], ["each", "mean"])
    right.set(xlim=(-0.3, 0.65), ylabel="first minus second [mm]", ylim=(-0.2, 1.1))
    return figure(
        "Five pairs of made-up errors, and their differences with the interval of the mean. The "
        "two clouds overlap, and yet all differences have one sign.",
        f"On the left five falling lines between two clouds that overlap almost wholly, from "
        f"{min(SECOND)} to {max(FIRST)} mm. On the right five differences from 0.4 to 0.8 mm and "
        f"their mean {mean:.2g} ± {half:.2g} mm, well above zero.",
    )


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            "Ten seeds on one circle give 0.8 ± 0.1 mm for the difference of two controllers. What "
            "has been decided?",
            [
                ("The first tracks worse", "Perhaps only on circles; no other path was run."),
                ("The first tracks worse on this circle", "Ten seeds are ten looks at one circle."),
                ("Nothing, ten are too few", "The interval knows that there were ten."),
            ],
            1,
        ),
        Question(
            "The interval over the tasks is 1.1 ± 5 mm. What may you write?",
            [
                ("The controllers are equally good", "It could be 6 mm in favour of one of them."),
                ("The first is worse by 1.1 mm", "That is the estimate without its uncertainty."),
                ("Undecided; between −4 and 6 mm", "The interval is the result."),
            ],
            2,
        ),
        Question(
            "You have time for 20 more runs. What narrows the interval over three tasks most?",
            [
                ("Twenty more seeds on the line", "They only sharpen the mean of one task."),
                ("Four new paths with five seeds each", "It makes seven tasks of three."),
                ("Six more seeds on each path", "The spread between the paths stays as it is."),
            ],
            1,
        ),
    )
