"""Chapter "Velocity control"."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import control
import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from scipy.optimize import brentq

import labkit as lk
from labkit import metrics
from labkit.plotting import curve
from solutions.study import speed_gains
from solutions.study.joint_velocity import JointVelocityPD
from solutions.study.workspace_velocity import WorkspaceVelocityPD

from .claims import holds, shows
from .embed import demo_html
from .page import Question, figure, number, numbers, quiz, replay, still, tracking

SEED = 3
OFFSET = 0.1
ENOUGH = 60.0
"""A phase margin that leaves little overshoot, in [degrees]."""
DELAY = 0.004 + 0.5 / 100.0 + 0.5 / 200.0
"""The average delay in the loop: the state's age, half its period, half a control period."""


@cache
def step_run(
    kp: float, kd: float = 0.0, plant: lk.Plant = lk.IDEAL, seconds: float = 2.0
) -> lk.Log:
    """Run with joint s0 a tenth of a radian away from its target at the start."""
    q0 = lk.robot("left").ready
    goal = q0 + OFFSET * np.eye(7)[0]
    with lk.Arm("left", plant, SEED, q0=q0) as arm:
        return lk.run(arm, lk.Hold(goal, seconds), JointVelocityPD(kp, kd))


def _error(log: lk.Log) -> np.ndarray:
    return metrics.joint_error(log)[:, 0]


def damping() -> HTML:
    """The D term slows a joint under velocity control, and above one it makes the loop unstable."""
    _, (ax, below) = plt.subplots(2, 1, figsize=(6.0, 5.0), height_ratios=(3, 2))
    told, rates = [], []
    for k, kd in enumerate((0.0, 0.5, 0.9)):
        log = step_run(2.0, kd)
        e = _error(log)
        rate = -np.log(e[200] / e[0]) / log.t[200]
        ax.plot(log.t, e, **curve(k), label=f"Kd = {kd:g}")
        told.append(f"Kd = {kd:g}: {rate:.2f} per second")
        number(f"rate_{k}", rate, ".2f")
        rates.append(float(rate))
    holds(
        all(abs(x - 2.0 / (1.0 + kd)) < 0.02 for x, kd in zip(rates, (0.0, 0.5, 0.9), strict=True)),
        "as $2/(1+K_d)$ says",
    )
    wild = step_run(2.0, 1.1)
    e = _error(wild)
    ax.plot(wild.t, e, **curve(3), label="Kd = 1.1")
    calm = step_run(2.0, 0.9)
    for k, log, name in ((2, calm, "Kd = 0.9"), (3, wild, "Kd = 1.1")):
        below.plot(log.t[:40], log.command[:40, 0], **curve(k) | {"marker": "."}, label=name)
    swings = [np.abs(np.diff(log.command[:, 0])) for log in (wild, calm)]
    grows, fades = (float(x[8] / x[2]) for x in swings)  # later a limit stops the growing one
    holds(grows > 1.5 and 0.2 < fades < 0.9, "a sequence that grows if $K_d > 1$")
    ax.set(xlabel="time [s]", ylabel="error of s0 [rad]")
    below.set(xlabel="time [s]", ylabel="command to s0 [rad/s]", ylim=(0.0, None))
    ax.legend()
    return figure(
        "A joint that starts 0.1 rad away, Kp = 2 1/s, ideal arm at 200 Hz, and its first 40 "
        "commands. More Kd is slower; above one the command swings up to a limit.",
        f"Error of joint s0 over two seconds. Measured decay: {'; '.join(told)}. With Kd = 1.1 the "
        "error leaves the exponential; from 0.1 to 1.5 s the command jumps by "
        f"{swings[0][20]:.2g} rad/s at every tick.",
    )


def derivative() -> HTML:
    """The effect of the D term on the error on a curve, and its cost, on the realistic arm."""
    kds = (0.0, 0.3, 0.6, 0.9)
    runs = [[speed_gains.trial("joint velocity", "circle", k, s) for s in range(10)] for k in kds]
    found = np.array([[[x["late_rms_mm"], x["shake_mm_s"]] for x in row] for row in runs])
    (error, shake), (off, unrest) = found.mean(axis=1).T, found.std(axis=1, ddof=1).T
    _, (left, right) = plt.subplots(1, 2, figsize=(6.2, 2.8))
    left.errorbar(kds, error, off, fmt="C0o-", markersize=4)
    left.set(xlabel="Kd", ylabel="RMS error on the circle [mm]", ylim=(0, None))
    right.errorbar(kds, shake, unrest, fmt="C1s--", markersize=4)
    right.set(xlabel="Kd", ylabel="RMS speed at rest [mm/s]", ylim=(0, None))
    holds(
        all(b < a for a, b in pairwise(error)) and 0.7 < error[2] / error[0] < 0.8,
        "the same D that slows the return makes the error on a curve smaller",
    )
    holds(all(b > a for a, b in pairwise(shake)) and shake[0] > 0.0, "the hand shakes more at rest")
    rows = "; ".join(
        f"Kd = {kd:g}: {e:.3g} mm, {v:.2g} mm/s" for kd, e, v in zip(kds, error, shake, strict=True)
    )
    return figure(
        "What Kd does on a circle, Kp = 3 1/s, realistic arm. Less error, more shaking at rest. "
        "Means of ten seeds, with the standard deviation of one run.",
        f"The error falls with Kd while the jitter at rest grows: {rows}.",
    )


def reach() -> None:
    """The place where the arm comes to rest if its target is 75 cm forwards, out of reach."""
    model = lk.Model("left")
    T = model.pose(model.robot.ready)
    R, goal = T[:3, :3], T[:3, 3] + np.array((0.75, 0.0, 0.0))
    path = lk.PosePath(lk.Line(T[:3, 3], goal), R)
    target = lk.Chain([lk.Trajectory(path, lk.Quintic(5.0)), lk.Hold(lk.se3.pose(R, goal), 4.0)])
    shows("Send the hand 75 cm forwards", 75.0, 100.0 * path.path.length)
    ends = []
    for lever in (0.26, 1.0):
        law = WorkspaceVelocityPD(model, Kp=3.0, lever=lever)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", lk.errors.LabkitWarning)  # it warns of a singularity
            with lk.Arm("left", lk.BAXTER, SEED, q0=model.robot.ready) as arm:
                e = metrics.tip_error(lk.run(arm, target, law), model)[-1]
        ends += [1e3 * np.linalg.norm(e[:3]), np.degrees(np.linalg.norm(e[3:]))]
    number("reach_mm", ends[0], ".0f")
    number("reach_deg", ends[1], ".0f")
    number("reach_metre_mm", ends[2], ".0f")
    number("reach_metre_deg", ends[3], ".0f")
    holds(
        0.0 < ends[0] < 0.7 * ends[2] and ends[1] > 2.0 * ends[3] > 0.0,
        "the hand ends nearer to the goal, and more turned",
    )


def gains() -> HTML:
    """The gain that lag and delay allow: measured overshoot and the loop's phase margin."""
    kps = np.array((1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 14.0, 18.0, 24.0, 30.0))
    over = np.array([max(0.0, -_error(step_run(kp, 0.0, lk.BAXTER)).min() / OFFSET) for kp in kps])
    margin = np.array([phase_margin(kp) for kp in kps])
    _, (left, right) = plt.subplots(1, 2, figsize=(6.2, 2.9))
    left.plot(kps, 100.0 * over, "C0o-", markersize=4)
    left.set(xlabel="Kp [1/s]", ylabel="overshoot [%]")
    right.plot(kps, margin, "C1s--", markersize=4)
    right.axhline(ENOUGH, color="C5", linestyle=":")
    right.text(30.0, ENOUGH + 2.0, f"design value, {ENOUGH:g}°", ha="right", fontsize="small")
    allowed = brentq(lambda kp: phase_margin(kp) - ENOUGH, 1.0, 30.0)
    shows("a phase margin of 60° as a design value", 60.0, ENOUGH)
    number("kp_enough", allowed, ".2g")
    right.set(xlabel="Kp [1/s]", ylabel="phase margin [degrees]", ylim=(0, 95))
    first = float(kps[np.argmax(over > 0.05)])
    holds(
        0.0 <= over[kps < first].max() < 0.05 < over[kps == first][0] < 0.1
        and 0.2 < over[-1] < 0.3,
        "first exceeds 5 % there",
    )
    number("margin_5", phase_margin(5.0))
    return figure(
        "Overshoot of a 0.1 rad step, measured on the realistic arm, and phase margin, computed "
        "from lag and delay. The overshoot grows as the margin falls.",
        f"Left: overshoot stays near zero up to Kp = 8 and reaches {100 * over[-1]:.0f} % at "
        f"Kp = 30. Right: the phase margin falls from {margin[0]:.0f} to {margin[-1]:.0f} degrees; "
        f"the dotted line marks the design value of {ENOUGH:g} degrees.",
    )


def unstable() -> None:
    """The gain at which the loop rings: by the damping ratio, by its phase, and in runs."""
    lag, whole = lk.BAXTER.velocity_lag, lk.BAXTER.velocity_lag + DELAY
    zeta = [1.0 / (2.0 * np.sqrt(kp * whole)) for kp in (14.0, 30.0)]
    past = [100.0 * np.exp(-np.pi * z / np.sqrt(1.0 - z * z)) for z in zeta]
    shows("Put in a lag of 41.5 ms: the 30 ms of the motors and, roughly, another 11.5 ms",
          (41.5, 30.0, 11.5), 1e3 * np.array((whole, lag, DELAY)))  # fmt: skip
    shows("which is 6.0 1/s", 6.0, 1.0 / (4.0 * whole), 0.01)
    shows("At 14 1/s the damping ratio is 0.66 and a second-order system overshoots by 6.5 %, at "
          "30 1/s it is 0.45 and the overshoot 21 %", (0.66, 6.5, 0.45, 21.0),
          (zeta[0], past[0], zeta[1], past[1]), 0.02)  # fmt: skip
    w = brentq(lambda w: np.arctan(w * lag) + w * DELAY - 0.5 * np.pi, 1.0, 200.0)
    shows("With 30 ms and 11.5 ms that is at $\\omega = 50.6$ rad/s", 50.6, w, 2e-3)
    shows("is 56.6°, and $0.0115\\cdot50.6$ rad is 33.3°", (56.6, 33.3),
          np.degrees((np.arctan(w * lag), w * DELAY)), 3e-3)  # fmt: skip
    shows("which is 92 1/s", 92.0, w * np.hypot(1.0, w * lag), 2e-3)
    swings = []
    for kp, away in ((80.0, 0.005), (120.0, 0.005), (70.0, OFFSET)):
        q0 = lk.robot("left").ready
        with lk.Arm("left", lk.BAXTER, SEED, q0=q0) as arm:
            goal = q0 + away * np.eye(7)[0]
            e = _error(lk.run(arm, lk.Hold(goal, 3.0), JointVelocityPD(kp, 0.0)))
        swings.append(1e3 * float(np.ptp(e[-100:])))
    holds(
        0.0 <= max(swings[0], 0.01) < 0.5 and swings[1] > 50.0,
        "In a run that starts 5 mrad beside the target, the arm settles at 80 1/s and",
    )
    shows("at 70 1/s, by about 75 mrad from peak to peak", 75.0, swings[2], 0.05)
    robot = lk.robot("left")
    inertia = float(lk.Model("left", lk.BAXTER).mass_matrix(robot.ready)[0, 0])
    holds(
        2.0 * float(robot.speed[0]) / lag * inertia > 1.5 * robot.effort[0] > 0.0,
        "would take more torque than s0 has",
    )


def phase_margin(kp: float) -> float:
    """The phase margin of the loop Kp / s with the realistic arm's lag and delay, in [degrees]."""
    s = control.tf("s")
    loop = kp / (s * (lk.BAXTER.velocity_lag * s + 1.0))
    _, margin, _, crossing = control.margin(loop)
    return float(margin - np.degrees(crossing * DELAY))


def rotation_demo() -> HTML:
    """The live demo of orientation errors; on paper, the errors of its first view."""
    target, actual = (_from_rpy(angles) for angles in ((0.2, 1.3, 0.1), (-2.6, 1.4, -2.7)))
    errors = {
        "logarithm": lk.se3.orientation_error(target, actual),
        "Euler angles subtracted": _rpy(target) - _rpy(actual),
    }
    _, ax = plt.subplots(figsize=(5.0, 2.6))
    for k, (name, e) in enumerate(errors.items()):
        ax.bar(np.arange(3) + 0.4 * k, e, 0.38, label=f"{name}: length {np.linalg.norm(e):.3f}",
               hatch="/" * k, edgecolor="#ffffff")  # fmt: skip
    ax.set_xticks(np.arange(3) + 0.2, ["x, roll", "y, pitch", "z, yaw"])
    ax.set(ylabel="error [rad]")
    ax.legend(fontsize="small", loc="lower left", bbox_to_anchor=(0.0, 1.0))
    caption = "Two definitions of the error, live. Near a pitch of 90° they have little in common."
    return HTML(demo_html("rotation", caption=caption, poster=still()))


def euler() -> HTML:
    """Feedback of subtracted Euler angles, at the pose where the gripper points down."""
    model = lk.Model("left")
    q0 = model.robot.ready
    T_wd = model.pose(q0)
    turn = lk.se3.rotation(np.radians(5.0) * np.array((1.0, 0.0, 0.0)))
    start = model.inverse_kinematics(lk.se3.pose(turn @ T_wd[:3, :3], T_wd[:3, 3]), q0)
    good = WorkspaceVelocityPD(model, Kp=1.0)

    def subtracted(state: lk.State, target: lk.PoseSample) -> lk.JointVelocity:
        J, T = model.tip_jacobian(state.q), model.pose(state.q)
        e = np.concatenate(
            [target.pose[:3, 3] - T[:3, 3], _rpy(target.pose[:3, :3]) - _rpy(T[:3, :3])]
        )
        return lk.JointVelocity(np.linalg.pinv(J) @ (1.0 * e))

    angles = {}
    for name, law in (("logarithm", good), ("Euler angles subtracted", subtracted)):
        with lk.Arm("left", lk.IDEAL, q0=start) as arm:
            log = lk.run(arm, lk.Hold(T_wd, 3.0), law)
        angles[name] = np.degrees(np.linalg.norm(metrics.tip_error(log)[:, 3:], axis=1))
    _, ax = plt.subplots(figsize=(6.0, 3.0))
    for k, (name, angle) in enumerate(angles.items()):
        ax.plot(log.t, angle, **curve(k))
        ax.text(2.3, angle[230 * len(angle) // 300] + 5.0, name, ha="right")
    ax.set(xlabel="time [s]", ylabel="orientation error [degrees]", ylim=(0, None))
    right, wrong = (a[-1] for a in angles.values())
    holds(0.0 < right < 0.5 < 8.0 < wrong, "With the logarithm the error ends at")
    numbers({"log_end": right, "euler_end": wrong}, ".2g")
    return figure(
        "Orientation error of a hand that points down and starts 5° off about the world's x axis, "
        "gain 1 1/s, ideal arm. One law removes it, the other makes it grow.",
        f"Orientation error over three seconds: with the logarithm it falls from 5 to {right:.2g} "
        f"degrees; with subtracted Euler angles it ends at {wrong:.2g} degrees.",
    )


def _from_rpy(angles: Sequence[float]) -> np.ndarray:
    """The orientation with this roll, pitch and yaw."""
    x, y, z = (lk.se3.rotation(a * e) for a, e in zip(angles, np.eye(3), strict=True))
    return z @ y @ x


def _rpy(R: np.ndarray) -> np.ndarray:
    """Roll, pitch and yaw about fixed axes."""
    return np.array(
        [
            np.arctan2(R[2, 1], R[2, 2]),
            np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2])),
            np.arctan2(R[1, 0], R[0, 0]),
        ]
    )


@cache
def circle_task() -> tuple[lk.Trajectory, lk.Trajectory]:
    """A circle of radius 10 cm in 5 s, as poses and as joint angles."""
    model = lk.Model("left")
    T_wt = model.pose(model.robot.ready)
    start = T_wt[:3, 3]
    circle = lk.PosePath(lk.Circle(start, start + np.array((0.0, -0.1, 0.0))), T_wt[:3, :3])
    target = lk.Trajectory(circle, lk.Quintic(5.0))
    return target, model.joint_trajectory(target, model.robot.ready)


@cache
def circle_runs() -> dict[str, lk.Log]:
    """The circle by both velocity controllers, from the same seed."""
    poses, joints = circle_task()
    runs = {}
    model = lk.Model("left", lk.BAXTER)
    for name, target, law in (
        ("workspace", poses, WorkspaceVelocityPD(model, Kp=5.0)),
        ("joint", joints, JointVelocityPD(5.0)),
    ):
        with lk.Arm("left", lk.BAXTER, SEED, q0=lk.robot("left").ready) as arm:
            runs[name] = lk.run(arm, target, law)
    return runs


def circle_replay() -> HTML:
    """Both controllers on the circle, in 3-D."""
    runs = circle_runs()
    (poses, _), gain = circle_task(), WorkspaceVelocityPD(lk.Model("left"), Kp=5.0).Kp
    shows("follow a circle with a radius of 10 cm in five seconds", (10.0, 5.0),
          (100.0 * poses.path.path.radius, poses.duration))  # fmt: skip
    shows("on the realistic arm, with $K_p = 5$ 1/s and without", 5.0, np.max(gain))
    found = {name: metrics.summary(log).rms_mm for name, log in runs.items()}
    e = list(found.values())
    holds(
        all(0.0 < x < 6.0 for x in e) and abs(e[0] - e[1]) < 0.1 * e[0],
        "That they agree is not an accident",
    )
    numbers({f"circle_{name}": value for name, value in found.items()}, ".2g")
    return replay(
        runs["workspace"],
        "A circle by the workspace velocity PD",
        "A circle by the workspace velocity PD and, see-through, by the joint velocity PD, both "
        "with Kp = 5 1/s. The two arms and their errors cover each other.",
        label="workspace PD",
        ghosts={"joint PD": runs["joint"]},
    )


def circle_tracking() -> HTML:
    """The workspace controller's circle, as curves."""
    caption = "A circle by the workspace velocity PD. The error is largest where the hand is fast."
    return tracking(circle_runs()["workspace"], caption)


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            "With feed-forward and no disturbance a controller tracks perfectly. Someone has the "
            "sign of e wrong. When does it show?",
            [
                ("At once", "The error is zero, so its sign has no effect."),
                (
                    "As soon as anything pushes the arm off, and then the error grows",
                    "Test a controller from an offset and without feed-forward.",
                ),
                ("Never", "It does: the smallest error now feeds on itself."),
            ],
            1,
        ),
        Question(
            "Kp = 3 1/s and Kd = 2 on a joint that obeys its commanded speed at once, in "
            "continuous time. How fast does the error decay?",
            [
                ("3 per second", "That is Kd = 0."),
                ("1 per second", "The rate is Kp / (1 + Kd)."),
                ("9 per second", "This is Kp (1 + Kd), but Kd makes the decay slower."),
            ],
            1,
        ),
        Question(
            r"Why is \(I - J^T J\) not a projector onto the null space?",
            [
                ("It has the wrong size", "It is 7 by 7, as it should be."),
                (
                    r"\(J(I - J^T J) = (I - JJ^T)J\) is not zero",
                    r"With \(J^+\), \(J J^+ = I\) makes it zero.",
                ),
                ("It is one", r"Multiply by \(J\): zero only if the rows are orthonormal."),
            ],
            1,
        ),
    )
