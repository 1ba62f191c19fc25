"""Explanatory drawings, in which everything is computed by formulas and nothing is measured."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from solutions.study.singular import damped_inverse
from solutions.study.workspace_velocity import WorkspaceVelocityPD

from .page import FAINT, FRAME, figure

ROD = 0.4


def where_and_when() -> HTML:
    """A curve on two schedules, and the two parts of the acceleration at one point."""
    s = np.linspace(0.0, 1.0, 201)
    x, y = _arc(s)
    fig, (top, side) = plt.subplots(1, 2, figsize=(6.4, 2.9), width_ratios=(1.25, 1.0))
    for k, (name, schedule, away) in enumerate(
        (("constant pace", None, 0.06), ("quintic", lk.Quintic(1.0), -0.06))
    ):
        at = np.linspace(0.0, 1.0, 11)
        at = at if schedule is None else np.array([schedule(t)[0] for t in at])
        px, py = _arc(at, 1.0 + away)
        top.plot(*_arc(s, 1.0 + away), color=FAINT, linewidth=1.0)
        top.plot(px, py, f"C{k}{'os'[k]}", markersize=5, label=name)
    top.set(title="Where the hand is at equal times", xlim=(-1.2, 1.2), ylim=(-0.1, 1.5))
    top.legend(loc="upper center", ncols=2, fontsize="small")
    side.plot(x, y, color=FAINT, linewidth=1.4)
    here = np.array(_arc(np.array([0.3]))).ravel()
    along = np.array((np.sin(0.3 * np.pi), np.cos(0.3 * np.pi)))
    across = -here
    for vector, ink, text, shift in (
        (0.55 * along, "C1", "x′ s̈", (0.03, 0.05)),
        (0.6 * across, "C2", "x″ ṡ²", (0.05, -0.1)),
        (0.55 * along + 0.6 * across, "C0", "sum", (0.05, -0.02)),
    ):
        _arrow(side, here, vector, ink)
        side.text(*(here + vector + shift), text, color=ink, fontsize="small")
    side.plot(*here, "o", color=FRAME, markersize=5)
    side.set(title="Its acceleration at one point", xlim=(-1.2, 1.2), ylim=(-0.1, 1.5))
    for ax in (top, side):
        ax.set_aspect("equal")
        ax.axis("off")
    return figure(
        "One path on two schedules, and the acceleration at one of its points. The part along the "
        "path changes the pace; the part across it is the price of the bend.",
        "Left: a half circle drawn twice with eleven dots at equal times. At constant pace the "
        "dots are evenly spaced; on the quintic they are close together at both ends and far "
        "apart in the middle. Right: at one point of the half circle an arrow along it, x prime "
        "times s double dot, an arrow to the centre, x double prime times s dot squared, and "
        "their sum.",
        fig=fig,
    )


def _arc(s: np.ndarray, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """A half circle from left to right."""
    return -radius * np.cos(np.pi * s), radius * np.sin(np.pi * s)


def two_links() -> HTML:
    """The arm of two rods at the pose of the calculation by hand, and its Jacobian's columns."""
    shoulder, elbow, hand = np.array(((0.0, 0.0), (ROD, 0.0), (ROD, ROD)))
    _, axes = plt.subplots(1, 2, figsize=(6.4, 3.4))
    left, right = axes
    for ax in axes:
        ax.plot(*np.array((shoulder, elbow, hand)).T, color=FRAME, linewidth=4)
        ax.plot(*shoulder, "s", color=FRAME, markersize=9)
        ax.plot(*np.array((elbow, hand)).T, "o", color=FRAME, markersize=8)
    left.plot(*np.array((shoulder, hand)).T, ":", color=FAINT, linewidth=1.4)
    for start, text, ink, shift in (
        (shoulder, "shoulder alone", "C0", (-0.16, 0.05)),
        (elbow, "elbow alone", "C1", (-0.2, -0.06)),
    ):
        arm = hand - start
        turned = 0.6 * np.array((-arm[1], arm[0]))
        _arrow(left, hand, turned, ink)
        left.text(*(hand + turned + shift), text, color=ink, fontsize="small")
    left.text(0.04, -0.09, "m₁ = 4 kg at the elbow", fontsize="small")
    left.text(0.44, 0.36, "m₂ = 2 kg", fontsize="small")
    left.text(-0.1, 0.86, "What each joint does to the hand")
    angle = np.linspace(0.0, 2.0 * np.pi, 121)
    J = np.array(((-ROD, -ROD), (ROD, 0.0)))
    ring = hand[:, None] + 0.45 * J @ np.array((np.cos(angle), np.sin(angle)))
    right.plot(*ring, "C2-")
    _arrow(right, hand, (0.18, 0.0), "C3")
    _arrow(right, hand, (0.0, 0.18), "C4")
    right.text(0.67, 0.385, "feels 2 kg", color="C3", fontsize="small")
    right.text(0.42, 0.6, "feels 6 kg", color="C4", fontsize="small")
    right.text(0.03, 0.66, "speeds\nof the hand", color="C2", fontsize="small")
    right.text(-0.1, 0.86, "Directions are not alike")
    for ax in axes:
        ax.set(xlim=(-0.12, 0.92), ylim=(-0.16, 0.94), aspect="equal")
        ax.axis("off")
    return figure(
        "The arm of two rods, its upper arm level, its forearm upright. Left: the columns of its "
        "Jacobian. Right: how fast the hand can move, and what a push at it feels.",
        "A shoulder at the left, an elbow 0.4 m to its right with a mass of 4 kg, a hand 0.4 m "
        "above the elbow with a mass of 2 kg. Left: the shoulder alone moves the hand back and up, "
        "at right angles to the dotted line from shoulder to hand; the elbow alone moves it "
        "straight back. Right: an ellipse of the hand's speeds, long towards back and up; a "
        "horizontal push feels 2 kg and a vertical one 6 kg.",
    )


def damped() -> HTML:
    """The commands of an inverse and of a damped inverse, and the motion that the latter loses."""
    damping = WorkspaceVelocityPD.damping
    sigma = np.linspace(0.004, 0.4, 200)
    factor = np.array([damped_inverse(np.array([[x]]), damping)[0, 0] for x in sigma])
    _, (left, right) = plt.subplots(1, 2, figsize=(6.4, 2.8))
    left.plot(sigma, 1.0 / sigma, "C1--", label="1/σ")
    left.plot(sigma, factor, "C0-", label="σ/(σ² + λ²)")
    left.axvline(np.sqrt(damping), color=FAINT, linestyle=":")
    left.set(
        xlabel="singular value σ [m/rad]", ylabel="joint speed for 1 m/s [rad/s]", ylim=(0, 20)
    )
    left.legend(fontsize="small")
    right.plot(sigma, 100.0 * (1.0 - sigma * factor), "C0-")
    right.axvline(np.sqrt(damping), color=FAINT, linestyle=":")
    right.set(
        xlabel="singular value σ [m/rad]", ylabel="lost share of the motion [%]", ylim=(0, 100)
    )
    return figure(
        f"Inverse and damped inverse with λ² = {damping:g}. At σ = λ, dotted, half is lost.",
        f"Left: one over sigma grows without bound towards sigma = 0, the damped factor peaks at "
        f"{factor.max():.1f} where sigma is {sigma[factor.argmax()]:.3f} and falls to zero. Right: "
        "the share of the motion that is lost, all of it at sigma = 0, half of it at sigma = "
        f"lambda, {100 * (1 - sigma[-1] * factor[-1]):.1f} per cent at {sigma[-1]:g}.",
    )


def _arrow(ax: Any, start: Any, along: Any, ink: str) -> None:
    """Draw a vector from a point."""
    ax.annotate("", np.add(start, along), start,
                arrowprops={"arrowstyle": "-|>", "color": ink, "linewidth": 1.8,
                            "shrinkA": 0, "shrinkB": 0})  # fmt: skip
