"""Chapter "Torque control"."""

from __future__ import annotations

from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics
from labkit.plotting import curve
from solutions.study.joint_torque import AugmentedPD, ComputedTorque

from .claims import holds, shows
from .page import Question, figure, number, numbers, quiz, replay, table, tracking
from .velocity import circle_task

SEED = 5
KP, KD, ON_CIRCLE, ON_CIRCLE_KD = 100.0, 20.0, 225.0, 30.0
RATES = (200.0, 1000.0)
SPRING = (200.0, 200.0, 100.0, 100.0, 15.0, 15.0, 10.0)
DAMPER = (30.0, 30.0, 15.0, 15.0, 2.0, 2.0, 1.5)
REPORT_KP, REPORT_KD = 8.0, 1.5
"""The gains of the re-examined report at its last joint, in N m/rad and N m s/rad."""


def responses() -> HTML:
    """The responses of the two laws if every joint starts 0.1 rad from its target."""
    q0 = lk.robot("left").ready
    model = lk.Model("left")
    laws = {
        "computed torque": ComputedTorque(model, KP, KD),
        "augmented PD": AugmentedPD(model, np.array(SPRING), np.array(DAMPER)),
    }
    _, axes = plt.subplots(1, 2, figsize=(6.2, 3.0), sharey=True)
    spread = {}
    for ax, (name, law) in zip(axes, laws.items(), strict=True):
        with lk.Arm("left", lk.IDEAL, q0=q0 - 0.1) as arm:
            log = lk.run(arm, lk.Hold(q0, 1.5), law, rate=1000)
        e = metrics.joint_error(log) / 0.1
        for k, joint in enumerate(lk.robot("left").joint_names):
            ax.plot(
                log.t,
                e[:, k],
                **curve(k),
                label=joint.removeprefix("left_"),
                linewidth=1.4,
            )
        ax.set(xlabel="time [s]", title=name)
        spread[name] = float(np.ptp(e, axis=1).max())
    exact = (1.0 + 10.0 * log.t) * np.exp(-10.0 * log.t)
    axes[0].plot(log.t, exact, color="#999999", linewidth=9, alpha=0.6, zorder=0)
    axes[0].set_ylabel("error / initial error")
    axes[1].legend(ncols=2, fontsize="small")
    same, different = spread.values()
    holds(same < 1e-6, "under computed torque all joints answer alike")
    holds(different > 0.3, "Under augmented PD each joint is its own oscillator")
    number("spread_apd", 100.0 * different, ".2g")
    return figure(
        "Seven joints, each 0.1 rad away, ideal arm at 1 kHz. On the left all follow the solution "
        "of the linear error equation, in grey; on the right each has its own course.",
        "Left, computed torque: the seven curves lie on each other and on the critically damped "
        f"solution. Right, augmented PD: they differ by {100 * different:.2g} % of the start.",
    )


def radius(inertia: float, kp: float, kd: float, period: float) -> float:
    """The spectral radius of a joint whose torque is held between ticks."""
    A = np.array([[1.0, period], [0.0, 1.0]])
    B = np.array([[0.5 * period**2], [period]]) / inertia
    return float(np.abs(np.linalg.eigvals(A - B @ np.array([[kp, kd]]))).max())


def sampled() -> HTML:
    """The inertia that a held torque can control."""
    inertia = np.geomspace(3e-4, 1.0, 400)
    bare = float(lk.Model("left", lk.IDEAL).mass_matrix(lk.robot("left").neutral)[6, 6])
    real = float(lk.Model("left", lk.BAXTER).mass_matrix(lk.robot("left").neutral)[6, 6])
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    for k, rate in enumerate(RATES):
        radii = [radius(i, REPORT_KP, REPORT_KD, 1.0 / rate) for i in inertia]
        ax.plot(inertia, radii, **curve(k), label=f"{rate:.0f} Hz")
    ax.axhline(1.0, color="C5", linewidth=1.0)
    for x, name in ((bare, "w2 without rotor"), (real, "w2 with rotor")):
        ax.axvline(x, color="C5", linestyle=":")
        ax.text(x * 1.08, 2.55, name, fontsize="small", rotation=90, va="top")
    ax.set(xscale="log", xlabel="inertia of the joint [kg m²]", ylabel="spectral radius",
           ylim=(0.6, 2.6))  # fmt: skip
    ax.legend(loc="upper right")
    values = {
        "bare_200": radius(bare, REPORT_KP, REPORT_KD, 1 / RATES[0]),
        "bare_1000": radius(bare, REPORT_KP, REPORT_KD, 1 / RATES[1]),
        "real_200": radius(real, REPORT_KP, REPORT_KD, 1 / RATES[0]),
        "bare_c": REPORT_KD / (RATES[1] * bare),
    }
    shows("At 200 Hz its spectral radius is", 200.0, RATES[0])
    shows("kg m² and at 200 Hz the radius is", 200.0, RATES[0])
    holds(
        values["bare_200"] > 2.0
        and 0.0 < values["bare_1000"] < 1.0
        and (0.0 < values["real_200"] < 1.0),
        "the error is several times larger after every tick",
    )
    holds(values["bare_200"] > 1.0, "larger than one in size, the error grows without end")
    numbers(values, ".3g")
    number("bare", bare, ".3g")
    number("real", real, ".2g")
    return figure(
        "A joint under kp = 8 N m/rad, kd = 1.5 N m s/rad, with the torque held between ticks. "
        "Above one the error grows: at 200 Hz, w2 needs its rotor.",
        f"Spectral radius against inertia, for 200 Hz and 1 kHz. At the bare wrist, {bare:.3g} "
        f"kg m², it is {values['bare_200']:.3g} at 200 Hz; with its rotor, {real:.2g} kg m², it is "
        f"{values['real_200']:.3g}.",
    )


@cache
def weight_runs() -> dict[str, lk.Log]:
    """Hold still on the arm that carries its own weight, with and without adding g again."""
    q0 = lk.robot("left").ready
    model = lk.Model("left", lk.BAXTER)
    runs = {}
    for name, added in (("g left to the arm", False), ("g added once more", True)):
        law = AugmentedPD(model, np.array(SPRING), np.array(DAMPER), gravity=added)
        with lk.Arm("left", lk.BAXTER, SEED, q0=q0) as arm:
            runs[name] = lk.run(arm, lk.Hold(q0, 2.0), law)
    return runs


def weight() -> HTML:
    """Show that gravity compensation applied twice lifts the arm."""
    _, ax = plt.subplots(figsize=(6.0, 2.8))
    ends = {}
    for k, (name, log) in enumerate(weight_runs().items()):
        e = 1e3 * metrics.tip_error(log)[:, 2]
        ax.plot(log.t, -e, **curve(k))
        ax.text(2.0, 4.0 - e[-1] - 20.0 * k, name, ha="right")
        ends[name] = -float(e[-1])
    ax.set(xlabel="time [s]", ylabel="height gained [mm]")
    once, twice = ends.values()
    holds(
        abs(once) < 0.1 and twice > 10.0,
        "Left to the arm, the hand stays within 0.1 mm of its height",
    )
    holds(twice > 50.0, "Added a second time it lifts the arm")
    number("twice", twice, ".2g")
    return figure(
        "Holding still on an arm that carries its own weight. A second g lifts the hand at once.",
        f"Height of the hand above its target over two seconds. Left to the arm, it stays within "
        f"0.1 mm; with gravity added again it rises by {twice:.0f} mm.",
    )


@cache
def circle_run() -> lk.Log:
    """The circle by computed torque on the realistic arm."""
    _, joints = circle_task()
    law = ComputedTorque(lk.Model("left", lk.BAXTER), ON_CIRCLE, ON_CIRCLE_KD, gravity=False)
    with lk.Arm("left", lk.BAXTER, SEED, q0=lk.robot("left").ready) as arm:
        return lk.run(arm, joints, law)


def circle_replay() -> HTML:
    """The circle by computed torque, in 3-D."""
    caption = "Computed torque on the circle. Nearly all of the torque carries the arm's weight."
    return replay(
        circle_run(), "A circle by computed torque", caption, label="computed torque", torque=True
    )


def circle_tracking() -> HTML:
    """The circle by computed torque, as curves and with its error."""
    holds(5.0 < metrics.summary(circle_run()).rms_mm < 6.0, "The tip is off by 5 to 6 mm")
    shows("Computed torque with $K_p = 225$ 1/s² and $K_d = 30$ 1/s", (225.0, 30.0),
          (ON_CIRCLE, ON_CIRCLE_KD))  # fmt: skip
    return tracking(circle_run(), "The circle by computed torque. Friction leaves millimetres.")


def speeds() -> HTML:
    """A table which shows that larger gains settle faster, but only up to a point."""
    rows = []
    for kp in (1.0, 4.0, 16.0, 64.0, 256.0):
        slowest = float(-np.roots((1.0, 4.0, kp)).real.max())
        rows.append((f"{kp:g}", f"{slowest:.3g}"))
    holds(rows[1][1] == rows[-1][1] == "2", "beyond critical damping the rate stays at Kd / 2")
    return table(("Kp [1/s²]", "decay rate [1/s]"), rows,
                 "The slowest part of ë + 4 ė + Kp e = 0")  # fmt: skip


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            "In which law do the gains have the unit N m/rad?",
            [
                ("Computed torque", "There M multiplies them, and their unit is 1/s²."),
                ("Augmented PD", "It puts a spring at each joint."),
                ("Both", "Where M multiplies a gain, the gain is an acceleration for an angle."),
            ],
            1,
        ),
        Question(
            "Baxter's arm adds its gravity compensation by itself. Your controller adds g(q) too, "
            "and the arm drifts up. Someone multiplies g by 0.05 and is content. What was that?",
            [
                ("A calibration of the model", "The model's g is right; it was added twice."),
                ("A step towards the right factor, 0", "On this arm the factor is zero."),
                ("A better estimate of the gravity constant", "9.81 is not in doubt."),
            ],
            1,
        ),
        Question(
            r"Which product does the augmented law need?",
            [
                (r"\(C\,\dot q\)", "That belongs to computed torque, which cancels what is there."),
                (
                    r"\(C\,\dot q_d\)",
                    r"Then \(C\dot e\) remains, which cancels \(\tfrac12\dot M\dot e\) in the "
                    "energy.",
                ),
            ],
            1,
        ),
    )
