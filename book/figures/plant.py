"""Page "What is known of this arm": the evidence, what depends on it, and the report's gains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit.plant import EVIDENCE
from solutions.study import assumptions, report_gains
from solutions.study.assumptions import SMALL
from solutions.study.claims import Outcome
from solutions.study.gains import KP
from solutions.study.grid import Row, pick
from solutions.study.report_procedure import OSCILLATES
from solutions.study.tuning import tune

from .claims import holds, shows
from .page import figure, numbers, shown, table


def _shown(value: Any) -> str:
    """A number of the plant in a form for readers."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float | int):
        return f"{value:g}"
    parts = list(dict.fromkeys(f"{x:g}" for x in value))
    return ", ".join(parts)


def evidence() -> HTML:
    """A table of the numbers of the realistic arm, with their sources and ranges."""
    rows = [
        (
            f"<code>{name}</code>",
            f"{_shown(getattr(lk.BAXTER, name))} {e.unit}".strip(),
            "assumed" if e.assumed else "sourced",
            e.source,
            _shown(e.least) if e.least == e.most else f"{_shown(e.least)} to {_shown(e.most)}",
        )
        for name, e in EVIDENCE.items()
    ]
    assumed = sum(e.assumed for e in EVIDENCE.values())
    numbers({"assumed": assumed, "parameters": len(EVIDENCE)}, ".0f")
    return table(
        ("Number", "Value", "Known?", "From", "Range"), rows,
        "Every number of lk.BAXTER; where joints differ, from shoulder to wrist",
    )  # fmt: skip


def hangs() -> HTML:
    """A table of the assumptions that change verdicts on the line."""
    rows = assumptions.recorded()["assumptions"]
    names, claims = list(assumptions.plants()), list(assumptions.CLAIMS)
    found = {(c, n): assumptions.difference(rows, c, assumption=n) for c in claims for n in names}
    base = {c: found[c, "as assumed"] for c in claims}
    _, ax = plt.subplots(figsize=(5.4, 7.4))
    turned: dict[str, list[str]] = {c: [] for c in claims}
    for i, name in enumerate(names):
        for j, c in enumerate(claims):
            over = found[c, name].outcome != base[c].outcome
            if over:
                turned[c].append(name)
                ax.add_patch(plt.Rectangle((j - 0.5, i - 0.5), 1, 1, color="#b3001b", alpha=0.25))
            text, weight = shown(found[c, name].mean, "+.1f"), "bold" if over else "normal"
            ax.text(j, i, text, ha="center", va="center", fontsize="small", weight=weight)
    ax.set(xlim=(-0.5, len(claims) - 0.5), ylim=(len(names) - 0.5, -0.5))
    ax.set_yticks(range(len(names)), [n.replace("_", " ") for n in names], fontsize="small")
    heads = [c.replace(" over ", "\nbetter than ") for c in claims]
    ax.set_xticks(range(len(claims)), heads, rotation=90, va="bottom", fontsize="small")
    ax.xaxis.tick_top()
    ax.tick_params(length=0)
    ax.spines[:].set_visible(False)
    sure = [c for c, x in base.items() if x.outcome is Outcome.HELD and not turned[c]]
    gains = assumptions.recorded()["gains"]
    error = {gain: _mean(gains, position_gain=gain) for gain in {r["position_gain"] for r in gains}}
    joint, torque = (
        _mean(rows, controller=controller, assumption="as assumed")
        for controller in ("joint velocity", "joint torque")
    )
    levels = (joint + SMALL, torque + SMALL, torque - SMALL)
    where = [_crosses(error, level) for level in levels]
    holds(
        min(error) < where[1] < where[2] < where[0] < max(error)
        and 0.0 < max(abs(joint - e) for gain, e in error.items() if gain > where[0]) < SMALL,
        "Above that nothing is decided, since the two differ by less than half a",
    )
    named = {"stiction, least", "position_gain, least", "position_gain, most",
             "encoder_offset, most"}  # fmt: skip
    over = {n for c in claims if c.startswith("built-in") for n in turned[c]}
    holds(over == named, "the ranking of the built-in method turns with these three numbers alone")
    torque_too = "built-in method over joint torque"
    holds(
        found[torque_too, "stiction, least"].outcome is Outcome.DID_NOT_HOLD
        and base[torque_too].outcome is Outcome.HELD,
        "with the least stiction joint torque control is better than the built-in",
    )
    velocity = [f"built-in method over {space} velocity" for space in ("joint", "workspace")]
    holds(
        all(
            base[c].outcome is Outcome.DID_NOT_HOLD
            and found[c, "encoder_offset, most"].outcome is not Outcome.DID_NOT_HOLD
            for c in velocity
        ),
        "with the largest encoder_offset the velocity controllers lose their lead",
    )
    impedances = [f"built-in method over {space} impedance" for space in ("workspace", "joint")]
    holds(
        {*sure} == {"the three over both impedances", *impedances},
        "What stands in every row is that the impedance controllers track worse",
    )
    names_of = ("flip_velocity", "torque_better", "torque_worse")
    numbers(dict(zip(names_of, where, strict=True)), ".0f")
    ends = min(error), max(error)
    shows("if it is below 0.5 mm", 0.5, SMALL)
    shows("from 10 to 100 1/s the error of the built-in method falls", (10.0, 100.0), ends)
    numbers({"hang_low": error[ends[0]], "hang_high": error[ends[1]]}, ".2g")
    words = "; ".join(f"{c}: {', '.join(t) or 'never'}" for c, t in turned.items())
    return figure(
        "Differences of the RMS errors on the line in mm, one assumption at a time at an end of "
        "its range. Positive where the claim above is true, red where the verdict has changed.",
        f"A table of {len(names)} plants and {len(claims)} claims. The "
        f"assumptions that change verdicts are: {words}.",
    )


def _mean(rows: Sequence[Row], **names: Any) -> float:
    """The RMS error of a method over its seeds, in [mm]."""
    return float(np.mean([row["late_rms_mm"] for row in pick(rows, **names)]))


def _crosses(error: dict[float, float], level: float) -> float:
    """The gain at which a falling error passes a level, interpolated in its logarithm."""
    at = np.array(sorted(error))
    x = np.log([error[k] for k in at])
    return float(np.exp(np.interp(-np.log(level), -x, np.log(at))))


def table_1() -> HTML:
    """A table of runs with the report's gains as printed."""
    found = {
        controller: [report_gains.late_rms_mm(controller, task) for task in ("line", "circle")]
        for controller in report_gains.TABLE_1
    }
    torque = found["joint torque"]
    holds(all(x > 20.0 for x in torque), "centimetres, not millimetres")
    return table(
        ("Controller", "line", "circle"),
        [(controller, *(f"{x:.2g}" for x in errors)) for controller, errors in found.items()],
        "RMS error in mm after the first second, gains of the report's Table 1, one run each",
    )


def tuning() -> HTML:
    """The report's tuning procedure for s0."""
    found = tune(0, lk.BAXTER)
    steps = [s for s in found.steps if s.Kd == 0.0 < s.Kp and s.why != "half of that"]
    _, ax = plt.subplots(figsize=(6.2, 3.0))
    ax.semilogx([s.Kp for s in steps], [s.decay for s in steps], "C0o-", markersize=4)
    ax.axvline(found.Kp, color="C0", linestyle=":")
    ax.axhline(OSCILLATES, color="C5", linewidth=1.0)
    ax.set(xlabel="Kp [1/s]", ylabel="size of a swing,\nthe one before = 1")
    shows("The report ended at $K_p$ = 3 1/s", 3.0, KP)
    numbers({"procedure": found.Kp, "factor": found.Kp / KP}, ".2g")
    return figure(
        "The report's procedure on joint s0. The gain rises by 30 % at a time until each swing "
        f"has {OSCILLATES:g} of the one before (grey line); half of that gain is taken (dotted).",
        f"Swing left over against gain. The arm oscillates at {found.ultimate:.3g} 1/s, which "
        f"gives {found.Kp:.2g}.",
    )
