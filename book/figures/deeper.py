"""Pages "Going deeper": friction, passivity, servoing by the image, and the seventh joint."""

from __future__ import annotations

from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit.plotting import curve
from solutions.study import identification, image_servoing, passivity, redundancy, tasks
from solutions.study.gains import TIP_SPRING
from solutions.study.workspace_velocity import WorkspaceVelocityPD

from .claims import holds, shows
from .page import figure, number, numbers, shown, table

SEEDS = range(10)
"""A single run says little about viscous friction; see the spread in `friction`."""


@cache
def _runs() -> list[lk.Log]:
    return [identification.excite(seed=seed) for seed in SEEDS]


@cache
def _found(between: bool = True) -> list[identification.Friction]:
    """The friction found in each of the runs."""
    model = lk.Model("left", lk.BAXTER)
    return [identification.fit(log, model, between) for log in _runs()]


def friction() -> HTML:
    """The torque that the motion does not explain, against speed, and the line fitted to it."""
    names, true_dry = [x[5:] for x in lk.robot("left").joint_names], lk.BAXTER.each("stiction", 7)
    true, first = float(lk.BAXTER.viscous[0]), _found()[0]
    dry, viscous = (
        np.array([getattr(found, name) for found in _found()]) for name in ("dry", "viscous")
    )
    newer = np.array([found.viscous for found in _found(False)])
    error = viscous.std(axis=0, ddof=1) / np.sqrt(len(viscous))
    holds(np.abs(dry / true_dry - 1.0).max() < 0.05, "each run finds the dry friction")
    holds(np.all(np.abs(viscous.mean(axis=0) - true) < 3.0 * error), "the mean has no bias")
    holds(np.all(viscous[:, :2].std(axis=0) > 0.03), "a single run is not to be trusted")
    holds(np.all(newer.mean(axis=0)[:2] < true - 3.0 * error[:2]), "the newer command is biased")
    shows("Instants below 0.05 rad/s are left out", 0.05, identification.MOVING)
    shows("late and at 100 Hz", 100.0, lk.BAXTER.state_rate)
    fastest = float(np.median([np.abs(speed).max() for speed in first.speed[:4]]))
    share = true * fastest / (true * fastest + true_dry[1])
    shows(
        "fastest swing there, 0.3 rad/s, makes it a sixth", (0.3, 1.0 / 6.0), (fastest, share), 0.08
    )
    shows("a cubic fitted to 11 angles, 0.1 s", (11.0, 0.1),
          (identification.WINDOW, (identification.WINDOW - 1) / lk.BAXTER.state_rate))  # fmt: skip
    _, axes = plt.subplots(1, 2, figsize=(6.4, 3.0))
    for ax, joint in zip(axes, (1, 5), strict=True):
        x = np.linspace(0.05, np.abs(first.speed[joint]).max(), 2)
        ax.plot(first.speed[joint], first.torque[joint], ".", color="#999999", markersize=3)
        for sign in (-1.0, 1.0):
            ax.plot(sign * x, sign * (first.viscous[joint] * x + first.dry[joint]), "C0-")
        ax.set(xlabel="speed [rad/s]", ylabel="torque left over [N m]", title=names[joint])
    numbers({"viscous_s1": viscous[:, 1].mean(), "viscous_newer": newer[:, 1].mean()}, ".2f")
    numbers({"viscous_s0_sd": viscous[:, 0].std(ddof=1), "viscous_s1_error": error[1]}, ".1g")
    rows = [
        (name, f"{one:g}", *(f"{x.mean():.3f} ± {x.std(ddof=1):.3f}" for x in found))
        for name, one, *found in zip(names, true_dry, dry.T, viscous.T, strict=True)
    ]
    drawn = figure(
        "The torque that the motion does not explain, at two joints in the first run. Red lines "
        "are the fitted friction; the two scales differ.",
        "Two clouds of points, each in two halves joined by a jump at zero speed.",
    )
    listed = table(
        ("Joint", "dry, given [N m]", "dry, found", f"viscous, found (given {true:g} N m s/rad)"),
        rows, "Friction found in ten runs: mean ± standard deviation of a run",
    )  # fmt: skip
    return HTML(drawn.data + listed.data)


def compensation() -> HTML:
    """Joint impedance along the line, without and with feed-forward of the friction."""
    line = tasks.line()
    pairs = [
        identification.compared(line, found, seed=seed)
        for seed, found in zip(SEEDS, _found(), strict=True)
    ]
    off = {
        name: np.array([identification.error(logs[name]) for logs in pairs]) for name in pairs[0]
    }
    holds(off["compensated"].max() < 0.7 * off["plain"].min(), "the error falls in every run")
    numbers({"uncompensated": off["plain"].mean(), "compensated": off["compensated"].mean()}, ".2g")
    numbers({"compensated_sd": off["compensated"].std(ddof=1)}, ".1g")
    shows("with $\\epsilon = 0.01$ rad/s", 0.01, identification.SOFT)
    _, ax = plt.subplots(figsize=(6.0, 3.0))
    for k, (name, log) in enumerate(pairs[0].items()):
        ax.plot(log.t, _off(log), **curve(k))
        ax.text(3.0, _off(log)[-1] + 0.7, name, ha="right")
    ax.set(xlabel="time [s]", ylabel="error of the tip [mm]", ylim=(0, None))
    last = [_off(logs["compensated"]) for logs in pairs]
    numbers({"left_at_rest": np.mean([e[-1] for e in last]),
             "left_moving": np.mean([e.max() for e in last])}, ".2g")  # fmt: skip
    for logs in pairs:
        _ahead(logs["compensated"])
    return figure(
        "Joint impedance along the line on the realistic arm, without and with the friction found "
        "in the first run. The same spring now tracks, and comes to rest near its target.",
        f"Error over time. RMS without compensation {off['plain'][0]:.2g} mm, with it "
        f"{off['compensated'][0]:.2g} mm.",
    )


def _off(log: lk.Log) -> np.ndarray:
    """The length of the tip's error at each tick, in [mm]."""
    return 1e3 * np.linalg.norm(lk.metrics.tip_error(log)[:, :3], axis=1)


def _ahead(log: lk.Log) -> None:
    """Check that the compensated arm's largest error is ahead of its target, by speed times age."""
    e = lk.metrics.tip_error(log)[:, :3]
    tip = np.array([pose[:3, 3] for pose in lk.metrics.tip_poses(log)])
    k = int(np.linalg.norm(e, axis=1).argmax())
    speed = np.gradient(tip, log.t, axis=0)
    fastest = float(np.linalg.norm(speed, axis=1).max())
    forward = speed[k] / np.linalg.norm(speed[k])
    age = lk.BAXTER.state_delay + 0.5 / lk.BAXTER.state_rate
    holds(
        0.0 < 0.7 * (1000.0 * np.linalg.norm(e[k])) < -(1000.0 * e[k] @ forward),
        "ahead of its target",
    )
    shows("The reports are 9 ms old on average", 9.0, 1e3 * age)
    shows(
        "At 0.2 m/s, 9 ms are 1.8 mm",
        (0.2, 9.0, 1.8),
        (fastest, 1e3 * age, 1e3 * fastest * age),
        0.1,
    )


MASS, SAMPLING, DAMPER = 8.0, 0.005, 60.0


def passive() -> HTML:
    """Stiffness against physical damping, with the limits of passivity and of stability."""
    damping = np.unique([*np.linspace(1.0, 7.0, 13), *np.linspace(1.0, 30.0, 16)])
    limit = 2.0 * damping / SAMPLING
    alone = [passivity.stiffest(MASS, b, 0.0, SAMPLING) for b in damping]
    damped = [passivity.stiffest(MASS, b, DAMPER, SAMPLING) for b in damping]
    wall = [passivity.stiffest(MASS, b, DAMPER, SAMPLING, wall=5e5) for b in damping]
    exact = [passivity.least_damping(K, B, SAMPLING) - K * SAMPLING / 2 - abs(B)
             for K, B in ((300.0, 0.0), (300.0, 50.0), (2000.0, -20.0))]  # fmt: skip
    holds(np.abs(exact).max() < 1e-3, "the general condition is b > KT/2 + |B| here")
    ratio = np.array(alone) / limit
    holds(ratio.min() >= 1.0 and ratio.max() < 1.005, "the two limits agree within half a per cent")
    number("light_ratio", passivity.stiffest(0.1, 50.0, 0.0, SAMPLING) * SAMPLING / 100.0, ".1f")
    holds(
        0.0 < max([damping[0], damping[-1]]) < DAMPER == 60.0 and min(damped) > 300.0,
        "With a damper of 60 N s/m the condition never holds in this figure, for $b$",
    )
    at_wall = passivity.loop(MASS, 5.0, 300.0, 60.0, SAMPLING, 5e5)
    holds(passivity.is_stable(at_wall), "the lab's spring is stable at a wall of 500 kN/m")
    holds(
        0.0 < 10.0 * 300.0 < min([float(np.interp(5.0, damping, x)) for x in (damped, wall)]),
        "The lab's own spring, 300 N/m, is far below both",
    )
    own = TIP_SPRING[0]
    need = [passivity.least_damping(own, B, SAMPLING) for B in (0.0, DAMPER)]
    shows(
        "For the lab's spring of 300 N/m at 200 Hz the first term",
        (300.0, 200.0),
        (own, 1.0 / SAMPLING),
    )
    shows("a damper of 60 N s/m asks for 60 more", 60.0, need[1] - need[0], 1e-3)
    numbers({"need_300": own * SAMPLING / 2}, ".2g")
    numbers({"stable_5": round(np.interp(5.0, damping, damped), -3),
             "stable_wall_5": round(np.interp(5.0, damping, wall), -2)}, ",.0f")  # fmt: skip
    _, ax = plt.subplots(figsize=(6.0, 3.4))
    ax.semilogy(damping, alone, "C0-", label="no damper; also the passive limit 2b/T")
    ax.semilogy(damping, damped, "C1--", label="damper of 60 N s/m")
    ax.semilogy(damping, wall, "C2-.", label="the same, at a wall of 500 kN/m")
    ax.axhline(300.0, color="#999999", linestyle=":")
    ax.text(30.0, 330.0, "the lab's spring", ha="right", fontsize="small")
    ax.set(xlabel="physical damping b [N s/m]", ylabel="largest stiffness [N/m]", ylim=(200, 3e5))
    ax.legend(fontsize="small")
    return figure(
        "The largest stiffness at which a computer's spring is stable, with 8 kg and samples 5 ms "
        "apart. With the damper it is nowhere passive here.",
        f"Largest stable stiffness over physical damping. At 5 N s/m it is "
        f"{shown(np.interp(5.0, damping, alone), '.2g')} N/m without a damper, "
        f"{shown(np.interp(5.0, damping, damped), '.2g')} N/m with one of 60 N s/m and "
        f"{shown(np.interp(5.0, damping, wall), '.2g')} N/m with it against a wall.",
    )


def servoing() -> HTML:
    """Which methods reach the goal if the believed focal length is wrong by a fifth."""
    off, rows = 0.2, []
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    ends = {}
    for k, method in enumerate(image_servoing.METHODS):
        right, wrong = (image_servoing.approach(method, e) for e in (0.0, off))
        ends[method] = 1e3 * wrong.distance[-1]
        rows.append([method, f"{1e3 * right.distance[-1]:.2f}", f"{ends[method]:.2g}"])
        t = image_servoing.DT * np.arange(len(wrong.distance))
        name = method.replace("measured", "in metres")
        ax.semilogy(t, 1e3 * wrong.distance, **curve(k), label=name)
    holds(
        0.0 < ends["image"] < 0.5
        and ends["pose, goal measured"] > 20.0
        and (0.0 < ends["pose, goal shown"] < 0.5),
        "With a focal length that is believed 20 % too long",
    )
    numbers({"servo_image": ends["image"], "servo_pose": ends["pose, goal measured"]}, ".2g")
    ax.set(xlabel="time [s]", ylabel="distance from the goal [mm]", ylim=(1e-3, 300))
    ax.legend(fontsize="small")
    told = "; ".join(
        f"{method.replace('measured', 'in metres')}: {end:.2g} mm" for method, end in ends.items()
    )
    return figure(
        "Distance of the hand's camera from its goal, with a focal length believed 20 % too long. "
        "Only the goal in metres is missed.",
        f"Three falling curves on a logarithmic scale. At the end {told}.",
    )


def posture() -> HTML:
    """The drift of the elbow over laps of the tip, with and without a posture term."""
    model = lk.Model("left")
    q0 = model.robot.ready
    _, ax = plt.subplots(figsize=(6.0, 2.8))
    ends = {}
    for k, (pull, name) in enumerate(((0.0, "no posture"), (2.0, "posture, k = 2 1/s"))):
        q = redundancy.laps(model, q0, count=5, pull=pull)
        away = np.degrees(np.abs(q - q0).max(axis=1))
        ends[name] = away[-1]
        ax.plot(away, **curve(k) | {"marker": "o", "markevery": 1})
        ax.text(4.6, 0.92 * away[-1] + 0.6, name, ha="right")
    free, held = ends.values()
    holds(free > 5.0 * held > 0.0, "After five laps")
    numbers({"drift_free": free, "drift_held": held}, ".2g")
    ax.set(xlabel="lap", ylabel="farthest joint [°]")
    return figure(
        "How far the farthest joint is from its start after each lap of the tip round a circle. "
        "Without a posture the joints drift on.",
        f"After five laps a joint is {free:.2g} degrees off without a posture and {held:.2g} with.",
    )


def along_the_paths() -> HTML:
    """Manipulability along the four paths."""
    model = lk.Model("left")
    _, ax = plt.subplots(figsize=(6.0, 3.0))
    least = {}
    for k, task in enumerate((tasks.line(), tasks.circle(), tasks.square(), _tag())):
        t, w = redundancy.manipulability(model, task.joints)
        ax.plot(t / t[-1], w, **curve(k), label=task.name)
        least[task.name] = w.min()
    holds(min(least.values()) > 0.02, "none of the four paths comes near a singularity")
    numbers({"least_w": min(least.values())}, ".2g")
    ax.set(xlabel="share of the time", ylabel="manipulability", ylim=(0, None))
    ax.legend(ncols=2)
    told = ", ".join(f"{name} {w:.2g}" for name, w in least.items())
    return figure(
        "Manipulability along the four paths. The circle has the least.",
        f"Four smooth curves; the least values are: {told}.",
    )


def _tag() -> tasks.Task:
    T = tasks.ready_pose()
    round_once = lk.Circle(T[:3, 3], T[:3, 3] - (0.0, 0.06, 0.0))
    target = lk.Trajectory(lk.PosePath(round_once, T[:3, :3]), lk.Quintic(6.5))
    return tasks.Task("tag", target, lk.robot("left").ready)


def robust() -> HTML:
    """The costs and benefits of a damped inverse near a singularity."""
    model = lk.Model("left")
    angles = np.linspace(0.02, 0.8, 79)
    _, (above, below) = plt.subplots(2, 1, figsize=(6.0, 4.2), sharex=True)
    peak, miss = {}, {}
    for k, damping in enumerate((0.0, 1e-3, 4e-3)):
        fast, missed = redundancy.stretched(model, angles, damping)
        above.semilogy(angles, fast, **curve(k), label=f"λ² = {damping:g} m²")
        below.plot(angles, 1e3 * missed, **curve(k))
        peak[damping], miss[damping] = fast.max(), 1e3 * missed.max()
    holds(
        peak[0.0] > 1000.0
        and peak[0.0] > 5.0 * peak[4e-3] > 0.0
        and (0.0 <= round(miss[0.0], 3) < 1.0 < miss[4e-3]),
        "the fastest joint would have to reach more than 1,000 rad/s",
    )
    shows("of the 100 mm/s that are wanted", 100.0, 1e3 * redundancy.OUTWARDS)
    shows("$\\lambda^2 = 0.004$ m², the value of this lab", 4e-3, WorkspaceVelocityPD.damping)
    numbers({"peak_2": peak[4e-3], "miss_2": miss[4e-3]}, ".2g")
    above.axhline(1.5, color="#999999", linestyle=":", label="limit, 1.5 rad/s")
    above.set_ylabel("fastest joint [rad/s]")
    above.legend(fontsize="small")
    below.set(xlabel="elbow angle e1 [rad]", ylabel="tip misses [mm/s]")
    return figure(
        "Pulling the tip outwards at 100 mm/s near the stretched elbow. The tip pays for damping.",
        f"Above, the fastest joint: {shown(peak[0.0], '.2g')} rad/s at most without damping, "
        f"{peak[4e-3]:.2g} with the strongest. Below, what the tip misses: 0 and "
        f"{miss[4e-3]:.2g} mm/s at most.",
    )


def methods() -> HTML:
    """A table of what each method of visual servoing needs and tolerates."""
    return table(
        ("Method", "wrong focal length", "needs"),
        [
            ("by the image", "arrives", "a picture at the goal, a rough depth"),
            (
                "by the pose, goal in metres",
                "stops beside it",
                "a calibrated camera, the tag's size",
            ),
            ("by the pose, goal shown", "arrives", "a picture at the goal"),
        ],
        "Three methods of bringing a camera to a place",
    )
