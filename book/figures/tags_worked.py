"""Chapter "Tags and cameras": two drawings, calculations by hand, and the point to aim at."""

from __future__ import annotations

import inspect
import math

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit.tags.detection import pose_covariance, tag_pose
from labkit.tags.drawing import Intrinsics
from labkit.tags.stream import Estimate, TagStream, first_estimate, update
from solutions.study.tag_task import LAP, OFFSET, RADIUS
from solutions.tags.following import TagFollower, blend, carry_forward, turn_on

from .claims import holds, shows
from .page import figure, numbers
from .tags import (
    AGE,
    FOCAL,
    LOST,
    NOISE,
    PERIOD,
    SIZE,
    ambiguity_gap,
    corners_seen,
    swaying,
)

LENS = Intrinsics(width=640, height=480, fx=FOCAL, fy=FOCAL)
SPEED = 0.1
AHEAD = TagFollower.horizon + AGE
PUSHES = {2: 0.03, 3: 0.0035}
"""Assumed unsteadiness of a tag's velocity [m²/s³] or of its acceleration [m²/s⁵]."""
BELIEFS = {
    "it stays": (1, False),
    "it goes straight on": (2, False),
    "it goes on bending": (3, False),
    "it goes on turning": (3, True),
}
"""Number of states (position, velocity, acceleration) of a belief, and if the last one turns."""


def frames() -> HTML:
    """The frames of a camera beside the table, and the chain through them."""
    _, ax = plt.subplots(figsize=(6.4, 2.8))
    at = {"w": (0.0, 0.0), "c": (6.5, 2.5), "m": (4.9, 0.25), "t": (4.9, 1.6)}
    turn = {"w": 0.0, "c": -2.19, "m": 0.0, "t": math.pi}
    for name, (x, y) in at.items():
        for axis in (0.0, math.pi / 2):
            a = turn[name] + axis
            ax.annotate(
                "", (x + 0.42 * math.cos(a), y + 0.42 * math.sin(a)), (x, y),
                arrowprops={"arrowstyle": "->", "color": "#57606a"},
            )  # fmt: skip
    ax.plot([4.5, 5.3], [0.25, 0.25], color="#1f2328", linewidth=5, solid_capstyle="butt")
    arm = ((0, 0.9, 2.3, 4.1, 4.9, 4.9), (0, 1.3, 1.75, 2.3, 2.2, 1.6))
    ax.plot(*arm, color="#999999", linewidth=7)
    for corner in (4.5, 5.3):
        ax.plot([at["c"][0], corner], [at["c"][1], 0.25], color="#999999", linewidth=0.9)
    links = (("w", "c", "C0", "$T_{wc}$", (2.3, 1.05)), ("c", "m", "C1", "$T_{cm}$", (5.95, 1.2)),
             ("w", "m", "C3", "$T_{wm} = T_{wc}\\,T_{cm}$", (1.9, -0.2)))  # fmt: skip
    for start, end, ink, text, place in links:
        arrow = {"arrowstyle": "-|>", "color": ink, "lw": 1.8}
        ax.annotate("", at[end], at[start], arrowprops=arrow)
        ax.text(*place, text, color=ink)
    ax.annotate("", at["t"], at["m"], arrowprops={"arrowstyle": "<->", "color": "C2", "lw": 1.5})
    ax.text(3.05, 0.75, "20 cm, to be kept", color="C2", fontsize="small")
    names = {"w": (-0.35, -0.3, "w world"), "c": (6.65, 2.6, "c camera"), "m": (5.4, 0.15, "m tag"),
             "t": (4.05, 1.75, "t tip")}  # fmt: skip
    for x, y, text in names.values():
        ax.text(x, y, text)
    ax.set(xlim=(-0.5, 8.2), ylim=(-0.5, 3.1), aspect="equal")
    ax.axis("off")
    return figure(
        "The frames of the world, the camera, the tag and the tip. The camera measures the tag in "
        "its own frame; the arm needs it in the world's.",
        "A side view. An arm reaches from the world frame w on the left to its tip t on the right, "
        "above the tag m on a board. A camera c looks down at the tag. Arrows lead from w "
        "to c, from c to m and from w to m; the third is the product of the first two.",
    )


def timeline() -> HTML:
    """The times at which pictures are taken and arrive, and the knowledge in between."""
    _, ax = plt.subplots(figsize=(6.4, 2.7))
    for k, ink in enumerate(("C0", "C2", "C3", "C4")):
        taken, arrived = 100.0 * k, 100.0 * k + 100.0
        arrow = {"arrowstyle": "->", "color": ink}
        ax.plot(taken, 1.0, "o", color=ink)
        ax.annotate("", (arrived, 0.0), (taken, 1.0), arrowprops=arrow)
        ax.plot([arrived, arrived + 100.0], [0.0, 0.0], color=ink, linewidth=5,
                solid_capstyle="butt")  # fmt: skip
        ax.text(arrived + 50.0, -0.17, f"picture {k}", ha="center", va="top",
                fontsize="small")  # fmt: skip
    bracket = {"arrowstyle": "|-|", "color": "C1"}
    ax.annotate("", (360.0, 1.25), (200.0, 1.25), arrowprops=bracket)
    ax.text(280.0, 1.42, "age of picture 2 now: 160 ms", ha="center", color="C1", fontsize="small")
    ax.plot([200.0, 200.0], [1.05, 1.25], color="C1", linestyle=":")
    ax.plot([360.0, 360.0], [-0.1, 1.25], color="C1", linestyle=":")
    ax.text(366.0, 1.2, "now", color="C1")
    ax.set_yticks([1.0, 0.0], ["taken", "arrived"])
    ax.set(xlabel="time [ms]", xlim=(-15.0, 512.0), ylim=(-0.42, 1.7))
    ax.spines["left"].set_visible(False)
    ax.tick_params(left=False)
    return figure(
        "Ten pictures a second, each 100 ms on its way. The newest one ages from 100 to 200 ms "
        "before the next arrives.",
        "Four pictures are taken at 0, 100, 200 and 300 ms and arrive 100 ms later each. Between "
        "two arrivals the newest picture ages from 100 to 200 ms. At 360 ms it is that of 200 ms, "
        "160 ms old.",
    )


def geometry() -> None:
    """Numbers of the sections on pictures, each computed by hand and by the code."""
    at = np.array((0.0, 0.0, 1.0))
    shows("$f$ = 600 pixels and a tag of 80 mm at a distance of 1 m", (600.0, 80.0, 1.0),
          (FOCAL, 1e3 * SIZE, at[2]))  # fmt: skip
    flat = lk.se3.rotation((math.pi, 0.0, 0.0))
    square = pose_covariance(lk.se3.pose(flat, at), LENS, SIZE, 0.1)
    askew = flat @ lk.se3.rotation((0.0, 0.6, 0.0))
    tilted = pose_covariance(lk.se3.pose(askew, at), LENS, SIZE, 0.1)
    seen = corners_seen(0.5, at[2]) + (LENS.cx, LENS.cy)
    believed = [tag_pose(seen, LENS, a)[2, 3] for a in (SIZE, 1.25 * SIZE)]
    shows("a tag taken for 25 % larger appears 25 % farther away", (1.0, 1.25), believed, 0.001)
    sigma = 0.1  # of the corners, in pixels
    shows("= 0.00147 m", 0.00147, sigma / (math.sqrt(2.0) * FOCAL * SIZE))
    away = at[2] + SIZE / 2.0 * math.sin(math.radians(24.6)) * np.array((-1.0, 1.0))
    shows(
        "and the calculations by hand below assume 0.1 pixel",
        0.1,
        math.sqrt(2.0) * FOCAL * SIZE * 0.00147,
    )
    shows("48.8 pixels tall, the right side 47.2", (48.8, 47.2), FOCAL * SIZE / away, 0.002)
    shows(
        "so the two are at 0.984 m and 1.017 m",
        (0.984, 1.017),
        FOCAL * SIZE / np.array((48.8, 47.2)),
        0.001,
    )
    right = FOCAL * SIZE / np.array((48.8, 47.2, 47.7))
    shows("so the two are at 0.984 m and 1.017 m", (0.984, 1.017), right[:2], 0.001)
    shows("is 80 mm wide and its right side is 33.3 mm farther away", (80.0, 33.3),
          (1e3 * SIZE, 1e3 * (right[1] - right[0])), 0.01)  # fmt: skip
    shows("the right side is at 1.006 m, the difference is 22.7 mm", (1.006, 22.7),
          (right[2], 1e3 * (right[2] - right[0])), 0.01)  # fmt: skip
    turning, way = 0.5, 0.4
    shows("turns at 0.5 rad/s while a picture is 100 ms under way has turned by 0.05 rad, "
          "and a tag at "
          "a distance of 0.4 m then appears $0.05\\cdot0.4$ = 20 mm", (0.5, 100.0, 0.05, 0.4, 20.0),
          (turning, 1e3 * AGE, turning * AGE, way, 1e3 * turning * AGE * way))  # fmt: skip
    shows("errors are twice as large as they are claimed to be", 2.0, math.sqrt(12.0 / 3.0))
    shows("is uncertain by 1.47 mm", 1.47, 1e3 * math.sqrt(square[2, 2]))
    sideways = math.sqrt(tilted[0, 0])
    shows("Sideways it is 0.083 mm, since $0.1\\cdot1/(2\\cdot600)$ = 0.000083 m",
          (0.083, 0.000083), (1e3 * sideways, 0.1 * at[2] / (2.0 * FOCAL)), 0.01)  # fmt: skip
    shows("an unknown tilt makes it 0.118 mm", 0.118, 1e3 * math.sqrt(square[0, 0]))
    shows("make the tilt uncertain by 3.0°", 3.0, math.degrees(math.sqrt(square[3, 3])))
    shows("the tilt is uncertain by 0.27° only", 0.27, math.degrees(math.sqrt(tilted[4, 4])), 0.03)
    for words, value, heights in (
        ("is tilted by 24.6°", 24.6, (48.8, 47.2)),
        ("the answer becomes 16.5°", 16.5, (48.8, 47.7)),
    ):
        shows(words, value, _tilt_read(*heights))
    shows("3.8 pixels for each radian", 3.84, FOCAL * SIZE**2)
    lean = 0.6
    shows("at 0.6 rad (34°) it changes by $48\\sin\\theta$, 27 pixels", (0.6, 34.4, 27.1),
          (lean, math.degrees(lean), FOCAL * SIZE * math.sin(lean)), 0.01)  # fmt: skip
    angle, afar = 30.0, 2.5
    shows("At 2.5 m and 30°", (2.5, 30.0), (afar, angle))
    gap = ambiguity_gap(math.radians(angle), afar)
    shows("comes to 0.154 pixels", 0.154, gap, 0.05)


def _tilt_read(left: float, right: float) -> float:
    """The tilt in degrees that the detector reads from two upright sides, heights in pixels."""
    depth = FOCAL * SIZE / np.array((left, right))
    sine = float(np.diff(depth)[0]) / SIZE
    x = 0.5 * SIZE * math.sqrt(1.0 - sine**2) * np.array((-1.0, 1.0))
    corners = np.array([(FOCAL * x[k] / depth[k], s * FOCAL * SIZE / 2.0 / depth[k])
                        for k, s in ((0, -1.0), (1, -1.0), (1, 1.0), (0, 1.0))])  # fmt: skip
    T_cm = tag_pose(corners + (LENS.cx, LENS.cy), LENS, SIZE)
    return math.degrees(math.acos(abs(T_cm[2, 2])))


def one_blend() -> None:
    """The blend that the text computes by hand."""
    now, goal = (np.array([x]) for x in (0.1, 0.0)), np.array([0.12])
    position, still = now
    reference = lk.Sample(position, np.array([0.1]), still)
    lasts = 1.0
    half = blend(0.5 * lasts, reference, lk.Sample(goal, still, still), lasts)
    speed = reference.velocity[0]
    shows("is at 0.1 m and moves at 0.1 m/s", (100.0, 0.1), (1e3 * position[0], speed))
    shows("The goal is 0.12 m, at rest, in 1 s", (0.12, 1.0), (goal[0], lasts))
    shows("by 80 mm and be 0.1 m/s too fast", (80.0, 0.1),
          (1e3 * (position[0] + speed * lasts - goal[0]), speed))  # fmt: skip
    shows("is at 0.1256 m", 0.1256, half.position[0], 1e-3)
    shows("moving back at 0.006 m/s", 0.006, -half.velocity[0], 0.05)


def two_pictures() -> None:
    """The filter's first steps, which the text computes by hand."""
    noise, q, z = 1e-6 * np.eye(3), 0.0025, 0.012
    shows("A first picture says 0 mm, with $R = 1$ mm²", 1.0, 1e6 * noise[0, 0])
    shows("The second picture, 0.1 s later, says 12 mm", (0.1, 12.0), (PERIOD, 1e3 * z))
    sure = 1e3 * math.sqrt(noise[0, 0])
    shows("Two readings with 1 mm of noise each, 0.1 s apart, give $\\sqrt2/0.1 = 14$ mm/s",
          (1.0, 0.1, 14.0), (sure, PERIOD, math.sqrt(2.0) * sure / PERIOD), 0.02)  # fmt: skip
    shows("Take in 12 mm", 12.0, 1e3 * z)
    fastest = 0.2
    shows("anything up to some 200 mm/s, so $P = \\mathrm{diag}(1, 40\\,000)$", (200.0, 4e4),
          (1e3 * fastest, 1e6 * fastest**2))  # fmt: skip
    first = first_estimate(0.0, np.zeros(3), noise, fastest)
    then = Estimate(PERIOD, *carry_forward(first.mean, first.covariance, PERIOD, q))
    P = 1e6 * then.covariance[np.ix_((0, 3), (0, 3))]
    holds(
        np.allclose([P[0, 0], P[0, 1], P[1, 1]], (401.83, 4012.5, 40250.0), rtol=0.0001),
        "The entries are then 401.8 mm², 4,012.5 mm²/s and 40,250 mm²/s²",
    )
    shows("changed the velocity by about 50 mm/s", 50.0, 1e3 * math.sqrt(q))
    shows("In metres this is 0.0025 m²/s³", 0.0025, q)
    turn = RADIUS / SPEED
    shows("of radius $r$ = 60 mm at $v$ = 0.1 m/s", (60.0, 0.1), (1e3 * RADIUS, SPEED))
    shows("in $r/v$ = 0.6 s", 0.6, turn)
    shows("$\\sigma_a^2 \\approx 0.1^2/0.6 = 0.017$ m²/s³", 0.017, SPEED**2 / turn, 0.03)
    shows("the straight belief of the next figure takes 0.03 m²/s³", 0.03, PUSHES[2])
    shows("the place is uncertain by 20 mm", 20.0, math.sqrt(P[0, 0]))
    shows("4012.5/402.8 = 9.96$ 1/s", 9.96, P[0, 1] / (P[0, 0] + 1.0))
    after = update(then, (z, 0.0, 0.0), noise)
    holds(
        np.allclose(
            [1000.0 * after.mean[0], 1000.0 * after.mean[3], 1000.0 * z, PERIOD],
            (11.97, 119.53, 12.0, 0.1),
            rtol=0.001,
        ),
        "The belief is now 11.97 mm and 119.5 mm/s: nearly the difference quotient 12",
    )
    P = 1e6 * after.covariance[np.ix_((0, 3), (0, 3))]
    shows("known to 16.8 mm/s", 16.8, math.sqrt(P[1, 1]))
    mean, covariance = carry_forward(after.mean, after.covariance, AGE, q)
    shows("The present is 0.1 s later than the picture, because this reading was 100 ms under way",
          (0.1, 100.0),
          (AGE, 1e3 * AGE))  # fmt: skip
    shows("the filter expects the target at 23.9 mm", 23.9, 1e3 * mean[0])
    spread = 1e3 * math.sqrt(covariance[0, 0])
    shows("with a standard deviation of 2.6 mm", 2.58, spread)
    shows("said 12 mm, and would have been sure of it to 1 mm", (12.0, 1.0),
          (1e3 * z, sure))  # fmt: skip
    shows("an error of 12 mm and pays with 2.6 mm of noise", (12.0, 2.6),
          (1e3 * (mean[0] - z), spread), 0.02)  # fmt: skip
    random, more = np.random.default_rng(0), []
    for believed, read in random.uniform(0.1, 10.0, (50, 2)):
        k = believed / (believed + read)
        more.append(min(believed, read) - (1.0 - k) * believed)
    holds(min(more) > 0.0, "smaller than either of the two")
    for _ in range(200):
        before = Estimate(0.0, *carry_forward(after.mean, after.covariance, 0.1, q))
        after = update(before, np.zeros(3), noise)
    gain = before.covariance[(0, 3), 0] / (before.covariance[0, 0] + 1e-6)
    holds(
        np.allclose(list(map(float, gain)), (0.83, 6.5), rtol=0.01),
        "After a few seconds they settle at 0.83 and 6.5 1/s",
    )


def old_pictures() -> None:
    """The error due to age alone for a swaying target, by hand and from the run."""
    sway = swaying()
    age = math.sqrt(0.15**2 + 0.1**2 / 12.0)
    speed = float(np.sqrt(np.mean(np.gradient(sway.truth, sway.t)[sway.t > 1.5] ** 2)))
    shows("By hand that makes 13.0 mm", 13.0, sway.rms(sway.last), 0.02)
    shows("at 0.1 m/s and 100 ms, 10 mm", 10.0, 1e3 * SPEED * AGE)
    shows("The readings had 1 mm of noise", 1.0, 1e3 * NOISE)
    shows("its RMS speed is $0.1\\cdot1.2/\\sqrt2$ = 0.085 m/s", 0.085, speed, 0.05)
    shows("its root is $\\sqrt{0.15^2 + 0.1^2/12}$ = 0.153 s", 0.153, age)
    shows("With pictures at 10 Hz that are 100 ms old", (10.0, 100.0), (1.0 / PERIOD, 1e3 * AGE))


def steering() -> None:
    """The gain that an old picture allows, and the distance of the hand behind a moving goal."""
    delay = 0.1
    gain = 1.0 / (math.e * delay)
    shows("with an age of 100 ms it is 3.7 1/s", 3.7, gain)
    shows("is unstable beyond 15.7 1/s", 15.7, math.pi / 2.0 / delay)
    shows("at 0.1 m/s the hand stays 27 mm behind", (0.1, 27.0),
          (SPEED, 1e3 * (1.0 - _steered(gain, SPEED)[-1])), 0.02)  # fmt: skip
    most = [float(_steered(k).max()) for k in (gain, 2.0 * gain, 16.5)]
    holds(
        abs(most[0]) < 0.001 and 0.02 < most[1] < 1.0 < most[2],
        "Beyond that gain the hand overshoots",
    )


def _steered(gain: float, speed: float = 0.0) -> np.ndarray:
    """Positions, relative to its goal, of a hand that starts 1 m behind it and sees it 0.1 s late.

    If the goal has a speed, in [m/s], the hand starts at the goal, and 1 is added to the positions.
    """
    dt, lag = 0.001, 100
    gap = [0.0 if speed else 1.0] * (lag + 1)
    for _ in range(12000):
        gap.append(gap[-1] + dt * (speed - gain * gap[-1 - lag]))
    return (1.0 if speed else 0.0) - np.array(gap)


def _aimed(order: int, turns: bool, noise: float) -> float:
    """The RMS distance in mm between the point aimed at and the circling tag."""
    random, w = np.random.default_rng(1), SPEED / RADIUS

    def at(t: float) -> np.ndarray:
        return RADIUS * np.array((math.cos(w * t), math.sin(w * t), 0.0))

    R, q = noise**2 * np.eye(3), PUSHES.get(order, 0.0)
    believed, off = None, []
    for k in range(300):
        t = k * PERIOD
        z = at(t) + noise * np.append(random.standard_normal(2), 0.0)
        if order == 1:
            aim = z
        elif believed is None:
            believed, aim = first_estimate(t, z, R, *(SPEED, 0.2)[: order - 1]), z
        else:
            then = carry_forward(believed.mean, believed.covariance, PERIOD, q)
            believed = update(Estimate(t, *then), z, R)
            straight = carry_forward(believed.mean, believed.covariance, AHEAD, q)[0]
            aim = (turn_on(believed.mean, AHEAD) if turns else straight)[:3]
        off.append(aim - at(t + AHEAD))
    return 1e3 * lk.metrics.rms(np.array(off[30:]))


def aims() -> HTML:
    """The error of aiming ahead by each belief, against the noise of the readings."""
    noises = np.geomspace(0.02e-3, 3e-3, 10)
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    curves = {}
    for k, (belief, (order, turns)) in enumerate(BELIEFS.items()):
        curves[belief] = [_aimed(order, turns, s) for s in noises]
        ax.semilogx(1e3 * noises, curves[belief], f"C{k}" + ("-", "--", "-.", ":")[k], label=belief)
    stays, straight, bends, turning = (curves[b] for b in BELIEFS)
    holds(
        all(0.0 < x < 0.75 * y for x, y in zip(bends[:4], straight[:4], strict=True)),
        "the belief with acceleration errs less than the one with constant velocity",
    )  # up to 0.1 mm
    holds(
        turning[-1] > 1.05 * straight[-1] > 0.0,
        "at 3 mm even the belief that turns errs more than the one with constant",
    )
    numbers({"aim_stays": stays[0], "aim_straight": straight[0], "aim_bends": bends[0],
             "aim_turns": turning[0]}, ".2g")  # fmt: skip
    numbers({"aim_turns_noisy": turning[-1], "aim_straight_noisy": straight[-1]}, ".2g")
    shows(
        "which is 25 mm at 0.1 m/s and 60 mm", 25.0, 1e3 * SPEED**2 * AHEAD**2 / (2 * RADIUS), 0.02
    )
    shows(
        "With the same numbers this is 7.7 mm, less than a third",
        7.7,
        1e3 * SPEED**3 * AHEAD**3 / (6 * RADIUS**2),
    )
    shows("A blend of $T = 0.45$ s that starts when a picture is 0.1 s old", (0.45, 0.1),
          (TagFollower.horizon, AGE))  # fmt: skip
    ax.set(xlabel="noise of a reading, each coordinate [mm]", ylabel="error of the aim [mm]",
           ylim=(0.0, None))  # fmt: skip
    ax.legend(fontsize="small")
    return figure(
        f"How far the aim is from a tag that goes round at 0.1 m/s, {AHEAD:g} s after the picture. "
        "The more a belief contains, the more the noise of the readings costs it.",
        f"Four curves over the noise of a reading, which rises from 0.02 to 3 mm. A belief that "
        f"the tag stays errs by {stays[0]:.2g} to {stays[-1]:.2g} mm, one that it goes straight on "
        f"by {straight[0]:.2g} to {straight[-1]:.2g} mm, one that it goes on bending by "
        f"{bends[0]:.2g} to {bends[-1]:.2g} mm, and one that it goes on turning by "
        f"{turning[0]:.2g} to {turning[-1]:.2g} mm.",
    )


def question() -> None:
    """The speed of the tag in the task: the peak of a quintic is 15/8 of its mean."""
    shows("a circle 12 cm across", 0.12, 2.0 * RADIUS)
    shows("The hand is to stay 20 cm above the tag", 0.2, OFFSET[2])
    shows("With 30 % of the readings lost at random", 0.3, LOST)
    dials = inspect.signature(TagStream).parameters
    pictures, late = dials["rate"].default, dials["delay"].default
    shows("takes ten pictures a second, and it takes 100 ms", (10.0, 100.0), (pictures, 1e3 * late))
    shows("at up to 0.11 m/s", 0.11, 15.0 / 8.0 * 2.0 * math.pi * RADIUS / LAP, 0.02)
