"""Chapter "Torque control": a drawing, calculations by hand, and a weight that the law ignores."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from scipy.optimize import fsolve

import labkit as lk
from labkit import metrics
from labkit.plotting import curve
from solutions.study import tasks
from solutions.study.joint_torque import ComputedTorque, IntegralTorque

from .claims import holds, shows
from .page import figure, number, numbers, shown, table
from .torque import (
    DAMPER,
    KP,
    ON_CIRCLE,
    ON_CIRCLE_KD,
    REPORT_KD,
    REPORT_KP,
    SPRING,
    circle_run,
    radius,
)

WEIGHT = 0.5
"""Mass of the thing in the hand, in [kg]."""


def columns() -> HTML:
    """The torques that computed torque demands of all joints if one is off its target."""
    model = lk.Model("left", lk.IDEAL)
    M = model.mass_matrix(model.robot.ready)
    away = 0.1
    shows("only s0 is 0.1 rad away from its target", 0.1, away)
    accelerate = KP * away
    holds(
        model.mass_matrix(np.zeros(7))[0, 0] > 1.3 * M[0, 0] > 0.0,
        "more inertia with the arm stretched out than with the arm folded",
    )
    tau = M[:, 0] * accelerate
    number("hand_t2", tau[2])
    holds(
        0.039 < (1.0 + math.sqrt(KP) * 0.5) * math.exp(-math.sqrt(KP) * 0.5) < 0.042,
        "has 4 % of its error left after 0.5 s",
    )
    holds(tau[2] > 10.0, "is the torque that keeps e0 still while s0 accelerates")
    rows = [
        (name.removeprefix("left_"), shown(m, ".2f"), shown(t, ".1f"))
        for name, m, t in zip(model.robot.joint_names, M[:, 0], tau, strict=True)
    ]
    head = ("Joint", "first column of M [kg m²]", "torque [N m]")
    return table(head, rows, "What computed torque asks of each joint while s0 alone is off")


def springs() -> None:
    """The damping ratio and the frequency of one joint's spring under augmented PD."""
    M = lk.Model("left", lk.BAXTER).mass_matrix(lk.robot("left").ready)
    omega = [math.sqrt(SPRING[k] / M[k, k]) for k in (0, 5)]
    zeta = [DAMPER[k] / (2.0 * math.sqrt(SPRING[k] * M[k, k])) for k in (0, 5)]
    numbers({"omega_s0": omega[0], "omega_w1": omega[1]}, ".2g")
    numbers({"zeta_s0": zeta[0], "zeta_w1": zeta[1]}, ".2g")
    shows("200 N m/rad and 30 N m s/rad at s0", (200.0, 30.0), (SPRING[0], DAMPER[0]))
    numbers({"inertia_s0": M[0, 0], "inertia_w1": M[5, 5]})
    shows("At a joint with 2.17 kg m² on a spring of 200 N m/rad an acceleration of 1 rad/s² "
          "leaves 0.011 rad", (2.17, 200.0, 1.0, 0.011),
          (M[0, 0], SPRING[0], 1.0, M[0, 0] / SPRING[0]), 0.02)  # fmt: skip


def ticks() -> None:
    """The bare wrist at 200 Hz: trace and determinant, and their conditions against eigenvalues."""
    model = lk.Model("left", lk.IDEAL)
    I = float(model.mass_matrix(lk.robot("left").neutral)[6, 6])
    rate, moving = 200.0, 1.0
    h = 1.0 / rate
    shows(
        "With 8 N m/rad and 1.5 N m s/rad at 200 Hz",
        (8.0, 1.5, 200.0),
        (REPORT_KP, REPORT_KD, rate),
    )
    shows("start at its target with a speed of 1 rad/s", 1.0, moving)
    a, c = REPORT_KP * h**2 / (2.0 * I), REPORT_KD * h / I
    trace, det = 2.0 - a - c, 1.0 + a - c
    numbers({"tick_a": a, "tick_c": c, "tick_trace": trace, "tick_det": det}, ".3g")
    root = math.sqrt(trace**2 - 4.0 * det)
    large = min(0.5 * (trace - root), 0.5 * (trace + root))
    number("tick_root", large, ".3g")
    holds(
        math.isclose(-large, radius(I, REPORT_KP, REPORT_KD, h), rel_tol=1e-06),
        "Its size is the spectral radius given above",
    )
    random = np.random.default_rng(0)
    tried = []
    for _ in range(400):
        kp, kd, inertia = random.uniform((1.0, 0.01, 0.001), (200.0, 5.0, 0.05))
        said = kd * h / inertia < 2.0 and kp * h / 2.0 < kd
        tried.append(said == (radius(inertia, kp, kd, h) < 1.0))
    holds(sum(tried) == 400, "together they are sufficient")
    step = np.array([[1.0, h], [0.0, 1.0]]) - np.outer((h * h / 2, h), (8.0, 1.5)) / 0.051
    x = [np.array([0.0, moving])]
    for _ in range(400):
        x.append(step @ x[-1])
    q = [float(one[0]) for one in x]
    numbers({"bump_mrad": 1e3 * max(q), "bump_ticks": int(np.argmax(q))}, ".2g")
    holds(
        q[0] == 0.0 and max(q) > 0.02 and (0.0 < q[-1] < 0.001 * max(q)),
        "It leaves the target before it returns",
    )


def lifted() -> None:
    """Gravity added twice: the calculation by hand, the solution of the balance, and the run."""
    model = lk.Model("left", lk.BAXTER)
    q0, K = np.array(model.robot.ready), np.array(SPRING)
    g, J = model.gravity(q0), model.tip_jacobian(q0)
    numbers({"lift_g1": -g[1], "lift_g3": -g[3], "lift_j1": -J[2, 1], "lift_j3": -J[2, 3]}, ".3g")
    numbers({"lift_q1": -g[1] / K[1], "lift_q3": -g[3] / K[3]}, ".2g")
    shows("N m on a spring of 200 N m/rad", 200.0, K[1])
    shows("N m on 100 N m/rad", 100.0, K[3])
    by_hand = 1e3 * float(J[2] @ (g / K))
    number("lift_hand", by_hand, ".3g")
    rest = fsolve(lambda q: K * (q0 - q) + model.gravity(q), q0)
    number("lift_exact", 1e3 * float(model.pose(rest)[2, 3] - model.pose(q0)[2, 3]), ".2g")


def cut() -> None:
    """The error of s0 at which its motor reaches its limit."""
    inertia = float(lk.Model("left", lk.BAXTER).mass_matrix(lk.robot("left").ready)[0, 0])
    shows("With $K_p = 100$ 1/s² and 2.17 kg m² an error of 0.25 rad at rest asks s0 for 54 N m, "
          "and its limit is 50 N m", (100.0, 2.17, 0.25, 54.0, 50.0),
          (KP, inertia, 0.25, KP * inertia * 0.25, lk.robot("left").effort[0]), 0.01)  # fmt: skip


def wrists() -> None:
    """The joints that friction holds away from their targets on the circle."""
    off = 1e3 * np.sqrt((metrics.joint_error(circle_run()) ** 2).mean(axis=0))
    numbers({"rms_s0": off[0]}, ".1g")  # to its spread over ten seeds, 0.1
    numbers({"rms_w1": off[5]}, ".2g")
    model = lk.Model("left", lk.BAXTER)
    M = model.mass_matrix(model.robot.ready)
    alone, coupled = [], []
    for q, dq in zip(circle_run().q[::7], circle_run().dq[::7], strict=True):
        drag = np.array(lk.BAXTER.stiction) * np.sign(dq) + lk.BAXTER.viscous[0] * dq
        inertia = model.mass_matrix(q)
        alone.append(drag[5] / inertia[5, 5] / ON_CIRCLE)
        coupled.append(np.linalg.solve(inertia, drag)[5] / ON_CIRCLE)
    x = [*(1000.0 * math.sqrt(np.square(one).mean()) for one in (alone, coupled)), float(off[5])]
    holds(
        0.0 < abs(x[1] / x[2] - 1.0) < 0.2 and x[0] < 0.7 * x[2],
        "because the other joints' friction reaches it through $M^{-1}$",
    )
    numbers({"spring_s0": ON_CIRCLE * M[0, 0], "spring_w1": ON_CIRCLE * M[5, 5]}, ".2g")
    shows("On the circle, with 225 1/s²", 225.0, ON_CIRCLE)
    shows("A friction of 0.3 N m alone", 0.3, lk.BAXTER.stiction[5])
    number("held_w1", 1e3 * lk.BAXTER.stiction[5] / (ON_CIRCLE * M[5, 5]), ".2g")
    holds(off[5] > 10.0 * off[0] > 0.0, "times the shoulder's")


def payload() -> HTML:
    """The place where the hand comes to rest with half a kilogram that the law ignores."""
    model = lk.Model("left", lk.IDEAL)
    q0 = model.robot.ready
    J = model.tip_jacobian(q0)
    mobility = J @ np.linalg.solve(model.mass_matrix(q0), J.T)
    _, ax = plt.subplots(figsize=(6.0, 2.9))
    shows("Put 0.5 kg into the hand", 0.5, WEIGHT)
    force, ends, said = 9.81 * WEIGHT, [], []
    gains = (100.0, 400.0)
    shows("and $K_p$ is 400 1/s²", 400.0, gains[1])
    for k, gain in enumerate(gains):
        law = ComputedTorque(model, gain, 2.0 * math.sqrt(gain))
        with lk.Arm("left", replace(lk.IDEAL, name="with a weight", payload=WEIGHT), q0=q0) as arm:
            log = lk.run(arm, lk.Hold(q0, 1.5), law, rate=1000)
        sag = 1e3 * metrics.tip_error(log)[:, 2]
        expected = 1e3 * force * mobility[2, 2] / gain
        ax.plot(log.t, sag, **curve(k))
        ax.text(1.5, sag[-1] - 0.3, f"Kp = {gain:g} 1/s²", ha="right", va="top")
        ax.axhline(expected, color="#999999", linestyle=":")
        ends.append((float(sag[-1]), float(expected)))
        said.append(f"{sag[-1]:.3g} mm for Kp = {gain:g}")
    holds(
        all(math.isclose(one[0], one[1], rel_tol=0.05) for one in ends)
        and 1.0 < ends[1][0] < 0.3 * ends[0][0],
        "the hand comes to rest where the formula says",
    )
    numbers({"sag_hand": ends[1][1], "sag_run": ends[1][0]}, ".3g")
    numbers({"sag_soft": ends[0][0], "mobility_z": mobility[2, 2]}, ".3g")
    weight = np.array((0.0, 0.0, -force, 0.0, 0.0, 0.0))
    rest = fsolve(
        lambda q: model.mass_matrix(q) @ (gains[0] * (q0 - q)) + model.tip_jacobian(q).T @ weight,
        q0,
    )
    exact = 1e3 * float(model.pose(q0)[2, 3] - model.pose(rest)[2, 3])
    numbers({"sag_soft_sum": ends[0][1], "sag_soft_exact": exact})
    number("sag_force", force, ".3g")
    ax.set(xlabel="time [s]", ylabel="hand below its target [mm]", ylim=(0, None))
    return figure(
        "The hand sags under 0.5 kg that the model does not have. The run ends near the formula, "
        "which is dotted; four times the gain leaves a quarter.",
        f"Two curves that rise and settle: {', '.join(said)}; the dotted lines of the formula "
        "are near the ends of the curves, and a little above where the gain is small.",
    )


KI, SEEDS = 1000.0, 10
"""Gain of the integral, in [1/s^3], and the number of seeds for its table."""


def integral() -> HTML:
    """What an integral gains and costs: the circle, then ten seconds at rest, over the seeds."""
    model, task = lk.Model("left", lk.BAXTER), tasks.circle()
    gains = model, ON_CIRCLE, ON_CIRCLE_KD
    laws = {
        "computed torque": ComputedTorque(*gains, gravity=False),
        "with the integral": IntegralTorque(*gains, KI, gravity=False),
    }
    found = {
        name: np.array([_circle_then_rest(law, task, seed) for seed in range(SEEDS)])
        for name, law in laws.items()
    }
    plain, better = (x.mean(axis=0) for x in found.values())
    holds(better[0] < 0.7 * plain[0], "the integral tracks better")
    holds((better[1:3] > 1.05 * plain[1:3]).all(), "it pays with speed error and with hunting")
    rows = [
        (name, *(f"{m:.3g} ± {s:.1g}" for m, s in zip(x.mean(0), x.std(0, ddof=1), strict=True)))
        for name, x in found.items()
    ]
    head = ("", "error on the circle [mm]", "speed error there [mm/s]", "speed at rest [mm/s]",
            "error at rest [mm]")  # fmt: skip
    return table(
        head, rows, f"RMS at the tip, realistic arm: mean and standard deviation of {SEEDS} seeds"
    )


def _circle_then_rest(law: Any, task: tasks.Task, seed: int) -> tuple[float, ...]:
    """RMS errors of place and speed on the circle, speed and error at rest, in [mm] and [mm/s]."""
    with lk.Arm("left", lk.BAXTER, seed, q0=task.start(seed)) as arm:
        runs = lk.run(arm, task.joints, law), lk.run(arm, lk.Hold(task.q0, 10.0), law)
    moving, still = (metrics.since(log, at) for log, at in zip(runs, (1.0, 2.0), strict=True))
    return (
        1e3 * metrics.rms(metrics.tip_error(moving)[:, :3]),
        1e3 * metrics.rms(metrics.velocity_error(moving)),
        1e3 * metrics.rms(metrics.tip_velocities(still)),
        1e3 * metrics.rms(metrics.tip_error(still)[:, :3]),
    )
