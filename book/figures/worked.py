"""Calculations by hand in the chapters, each compared with the code or with another formula.

These are the chapters on paths, on the model and on velocity control.
"""

from __future__ import annotations

from functools import cache
from math import atan, atan2, degrees, exp, hypot, pi, sqrt

import numpy as np
from scipy.optimize import lsq_linear

import labkit as lk
from solutions.study.singular import damped_inverse
from solutions.study.workspace_velocity import WorkspaceVelocityPD

from .claims import holds, shows
from .paths import DURATION, KP, WAY, line_task
from .velocity import DELAY

ROD, ELBOW_MASS, HAND_MASS = 0.4, 4.0, 2.0
"""The arm of two rods: length in [m], masses in [kg]."""
POSE = (0.0, pi / 2.0)


def paths() -> None:
    """Numbers of the chapter on paths."""
    line = lk.Line(np.zeros(3), np.array(WAY))
    D, tick = line.length, 0.005
    sample = lk.Trajectory(line, lk.Quintic(DURATION))(1.0)
    speed, pace = np.linalg.norm(sample.velocity), lk.Quintic(DURATION)(1.0)
    shows("which is 0.269 m", 0.269, D, 1e-3)
    shows("the tip is 27.9 mm along", 27.9, 1e3 * np.linalg.norm(sample.position), 2e-3)
    shows("= 0.2637$ per second", 0.2637, pace[1], 1e-3)
    shows("(0.0264, -0.0527, 0.0396)$ m/s", (0.0264, -0.0527, 0.0396), sample.velocity, 2e-3)
    shows("Its length is 0.0710 m/s", 0.0710, speed, 1e-3)
    shows("accelerates along the line by 0.0947 m/s²", 0.0947, pace[2] * D, 1e-3)
    peak = np.abs([lk.Quintic(DURATION)(t)[1:] for t in np.linspace(0.0, DURATION, 4001)]).max(0)
    shows("which is 0.126 m/s, and the acceleration", (0.126, 0.0972), peak * D, 3e-3)
    shows("which is 0.0972 m/s²", 0.0972, peak[1] * D, 1e-3)
    _durations(D)
    _bends(tick)
    _, joints = line_task()
    fastest = np.abs([joints(t)[1:] for t in np.linspace(0.0, DURATION, 801)]).max((0, 2))
    shows("step of 5 ms that is 1.6 rad/s², while the fastest joint of this chapter's line truly "
          "accelerates by 0.23 rad/s²", (5.0, 1.6, 0.23),
          (1e3 * tick, 4e-5 / tick**2, fastest[1]), 0.01)  # fmt: skip
    shows("turns at 0.227 rad/s, far below its limit of 1.5 rad/s", (0.227, 1.5),
          (fastest[0], lk.robot("left").speed[0]), 3e-3)  # fmt: skip
    shows("It falls to 37 % in", 0.37, exp(-1.0), 0.01)
    apart = 0.05
    shows("If they differ by 5 cm, a controller with $K_p = 5$ 1/s asks for 0.25 m/s",
          (5.0, 5.0, 0.25), (100.0 * apart, KP, KP * apart))  # fmt: skip
    shows("angles are up to 14 ms old", 14.0, 1e3 * (lk.BAXTER.state_delay + 0.01))


def _durations(D: float) -> None:
    """The duration of the line, and of a centimetre of it."""
    v, a = 0.25, 0.5
    quintic, bang = lk.Quintic.within(D, v, a).duration, lk.BangBang.within(D, v, a).duration
    trapezoid = lk.Trapezoid(D, v, a).duration
    pull = sqrt(lk.Quintic.PEAK_ACCELERATION * D / a)
    shows("2.02 s and the acceleration for 1.76 s, so it takes 2.02 s", (2.02, 1.76),
          (quintic, pull), 3e-3)  # fmt: skip
    shows("The bang-bang schedule needs 2.15 s", 2.15, bang, 3e-3)
    shows("it needs 1.58 s", 1.58, trapezoid, 3e-3)
    holds(
        1.0 < trapezoid < quintic < bang < 2.2,
        "the tip may move at 0.25 m/s and accelerate at 0.5 m/s²",
    )
    short = lk.Quintic.within(0.01, v, a).duration
    shows(
        "0.075 s and the acceleration for 0.340 s", (0.075, 0.340), (1.875 * 0.01 / v, short), 1e-3
    )
    scaled = lk.Quintic(DURATION * 0.01 / D)
    shows("= 0.131$ m", 0.131, lk.Quintic.PEAK_ACCELERATION * 0.04 / (1.875**2 * 0.5), 4e-3)
    shows("= 0.760$ s; for 50 cm", 0.760, lk.Quintic.within(0.05, 0.2, 0.5).duration, 1e-3)
    shows("= 4.69$ s", 4.69, lk.Quintic.within(0.5, 0.2, 0.5).duration, 1e-3)
    shows(
        "it takes $2\\sqrt{0.05/0.5} = 0.632$ s", 0.632, lk.Trapezoid(0.05, 0.2, 0.5).duration, 1e-3
    )
    shows("= 2.9$ s", 2.9, lk.Trapezoid(0.5, 0.2, 0.5).duration, 1e-6)
    asked = 0.01 * lk.Quintic.PEAK_ACCELERATION / scaled.duration**2
    shows("to 0.149 s for one centimetre", 0.149, scaled.duration, 4e-3)
    quick, slow = (np.array(lk.Quintic(T)(T / 4.0)[1:]) for T in (2.0, 4.0))
    shows("In half the time the speed doubles and the acceleration is four times as large",
          (2.0, 4.0), quick / slow)  # fmt: skip
    shows("asks the arm for 2.62 m/s², five times", (2.62, 5.0), (asked, asked / a), 0.05)


def _bends(tick: float) -> None:
    """The accelerations on a circle and at a corner."""
    circle = lk.Circle(np.array((0.1, 0.0, 0.0)), np.zeros(3))
    middle = lk.Trajectory(circle, lk.Quintic(5.0))(2.5)
    v, a = np.linalg.norm(middle.velocity), np.linalg.norm(middle.acceleration)
    shows("radius 0.10 m in five seconds, the quintic's pace peaks at 0.375 per second",
          (0.10, 0.375), (circle.radius, lk.Quintic(5.0)(2.5)[1]))  # fmt: skip
    shows("which is 0.236 m/s, and the acceleration towards the centre is $v^2/r$, "
          "which is 0.555 m/s²",
          (0.236, 0.555), (v, a), 2e-3)  # fmt: skip
    holds(0.5 < a < 0.6, "above the limit of 0.5")
    corner = lk.Polyline([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0]])
    jump = 0.5 * np.linalg.norm(corner(0.5).velocity - corner(0.4999).velocity)
    shows("passed at 0.1 m/s, the velocity jumps by 0.141 m/s", 0.141, jump, 4e-3)
    shows("period of 5 ms that is an acceleration of 28 m/s²", 28.0, jump / tick, 0.02)


@cache
def two_rods() -> lk.Model:
    """The arm of two rods without mass, in a vertical plane, x forwards and y up on paper."""
    upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    along = (ROD, 0.0, 0.0)
    free = {"inertia": 1e-12 * np.eye(3), "lower": -3.2, "upper": 3.2, "speed": 9.0, "effort": 99.0}
    bodies = (
        {"joint": "shoulder", "T_parent": lk.se3.pose(upright, np.zeros(3)), "mass": ELBOW_MASS,
         "com": along, **free},
        {"joint": "elbow", "T_parent": lk.se3.pose(np.eye(3), np.array(along)), "mass": HAND_MASS,
         "com": along, **free},
    )  # fmt: skip
    tip = lk.se3.pose(np.eye(3), np.array(along))
    return lk.Model(lk.Robot("two rods", bodies, tip, np.array(POSE), np.array(POSE)))


def model() -> None:
    """Numbers of the chapter on the model."""
    arm = two_rods()
    J = arm.tip_jacobian(POSE)[[0, 2]]
    M, g, dq = arm.mass_matrix(POSE), arm.gravity(POSE), np.array((1.0, 2.0))
    C = arm.coriolis(POSE, dq)
    inertia = np.linalg.inv(J @ np.linalg.inv(M) @ J.T)
    shows("At 1 rad/s of the shoulder alone the hand moves at 0.57 m/s", (1.0, 0.57),
          (dq[0], np.linalg.norm(J[:, 0] * dq[0])), 0.01)  # fmt: skip
    shows("presses the hand down with 10 N", (4.0, 0.0), J.T @ (0.0, 10.0))
    shows("the hand must press up with 10 N", (4.0, 0.0), J.T @ (0.0, 10.0))
    shows("The shoulder gives 4 N m and the elbow nothing", (4.0, 0.0), J.T @ (0.0, 10.0))
    shows("is 0.4 m from the shoulder, and the hand's mass moves with the tip, whose Jacobian is "
          "$J$", (1.28, 0.32, 0.32, 0.32), M.ravel(), 1e-6)  # fmt: skip
    far = arm.mass_matrix(np.zeros(2))[0, 0]
    shows("the hand is 0.8 m away", 0.8, arm.pose(np.zeros(2))[0, 3])
    shows("1.28 kg m² to 1.92 kg m²", (1.28, 1.92), (M[0, 0], far), 1e-6)
    shows("That is a factor of 1.5", 1.5, far / M[0, 0], 1e-6)
    shows("which is 23.5 N m", 23.5, g[0], 3e-3)
    holds(g[0] > 20.0 and abs(g[1]) < 1e-06, "so $g_2 = 0$")
    shows("is $(-2.56,\\ 0.32)$ N m", (-2.56, 0.32), C @ dq, 1e-6)
    rate = (arm.mass_matrix(POSE + 1e-6 * dq) - arm.mass_matrix(POSE - 1e-6 * dq)) / 2e-6
    skew = rate - 2.0 * C
    shows("zeros on its diagonal and 1.28 and −1.28", (1.28, -1.28), (skew[0, 1], skew[1, 0]), 1e-4)
    shows("moves the hand alone and feels 2 kg", 2.0, inertia[0, 0], 1e-6)
    shows("has to lift the elbow too, and feels 6 kg", 6.0, inertia[1, 1], 1e-6)
    shows("three times heavier in one direction", 3.0, inertia[1, 1] / inertia[0, 0], 1e-6)
    _rods(J)
    _newton()
    _elbow()


def _rods(J: np.ndarray) -> None:
    """The data of the arm of two rods, and its exercises."""
    rods = (ROD, ELBOW_MASS, HAND_MASS)
    shows("two rods of 0.4 m without mass, a mass $m_1$ of 4 kg at the elbow and a mass "
          "$m_2$ of 2 kg",
          (0.4, 4.0, 2.0), rods)  # fmt: skip
    shows("Both masses have the horizontal distance 0.4 m", (0.4, 23.5),
          (ROD, 9.81 * sum(rods[1:]) * ROD), 3e-3)  # fmt: skip
    shows("0.4189 and 0.0611", (0.4189, 0.0611), np.linalg.eigvalsh(J @ J.T)[::-1], 1e-3)
    more = two_rods().mass_matrix(POSE) + J.T @ J
    shows("$\\ddot q = (-3.5, 3.5)$ rad/s²", (-3.5, 3.5),
          np.linalg.solve(more, (-9.81 * ROD, 0.0)), 4e-3)  # fmt: skip


def _newton() -> None:
    """Two steps of inverse kinematics of the arm of two rods."""
    arm, goal, q, left = two_rods(), np.array((0.36, 0.44)), np.array(POSE), []
    shows("is at $(0.4, 0.4)$ m in the drawing and should go to $(0.36, 0.44)$ m",
          (0.4, 0.4, 0.36, 0.44), (*arm.pose(q)[[0, 2], 3], *goal), 1e-6)  # fmt: skip
    for _ in range(2):
        e = goal - arm.pose(q)[[0, 2], 3]
        step = np.linalg.solve(arm.tip_jacobian(q)[[0, 2]], e)
        left.append((1e3 * np.linalg.norm(e), step))
        q = q + step
    shows("which is 57 mm away", 57.0, left[0][0], 0.01)
    shows("$\\Delta q = (0.1, 0)$ rad", (0.1, 0.0), left[0][1], 1e-6)
    shows("After this step the hand is 2.8 mm from its goal", 2.8, left[1][0], 0.02)
    last = 1e3 * np.linalg.norm(goal - arm.pose(q)[[0, 2], 3])
    holds(last < 0.02, "after another one less than 0.02 mm")


def _elbow() -> None:
    """The elbow angle at which Baxter's arm is straight, from its dimensions."""
    arm = lk.Model("left")
    s1, e1, w1 = (arm.links(np.zeros(7))[k].T_wl[:3, 3] for k in (1, 3, 5))
    (upper, drop), (fore, sink) = (
        (1e3 * hypot(*(b - a)[:2]), 1e3 * (a - b)[2]) for a, b in ((s1, e1), (e1, w1))
    )
    shows("is 364.4 mm in front of the shoulder's and 69 mm below it, and the wrist's axis is "
          "374.3 mm in front of the elbow's and 10 mm below it", (364.4, 69.0, 374.3, 10.0),
          (upper, drop, fore, sink), 1e-4)  # fmt: skip
    shows("elbow axis is set off from the upper arm's by 69 mm", 69.0, drop, 1e-3)
    slopes = atan(drop / upper), atan(sink / fore)
    shows("\\arctan(69/364.4) = 0.1871$ rad", 0.1871, slopes[0], 3e-4)
    shows("\\arctan(10/374.3) = 0.0267$ rad", 0.0267, slopes[1], 1e-3)
    sigma = {x: _smallest(arm, x) for x in np.linspace(0.155, 0.165, 21)}
    shows("which is 0.1604 rad", 0.1604, slopes[0] - slopes[1], 3e-4)
    shows("The three axes are in one line", 0.1604, min(sigma, key=lambda x: sigma[x]), 4e-3)


def _smallest(arm: lk.Model, elbow: float) -> float:
    """The smallest singular value of the tip Jacobian at an elbow angle, others neutral."""
    q = np.array(arm.robot.neutral)
    q[3] = elbow
    return float(np.linalg.svd(arm.tip_jacobian(q), compute_uv=False)[-1])


def velocity() -> None:
    """Numbers of the chapter on velocity control."""
    left = {kd: 0.1 * exp(-3.0 / (1.0 + kd)) for kd in (0.0, 0.6)}
    shows("and the joint starts 0.1 rad away", (0.0050, 0.0153), left.values(), 0.01)
    shows("which is 0.0050 rad", 0.0050, left[0.0], 0.01)
    shows("0.0153 rad is left: three times as much", (0.0153, 3.0),
          (left[0.6], left[0.6] / left[0.0]), 0.03)  # fmt: skip
    _swing()
    crossing, lag = 4.95, lk.BAXTER.velocity_lag
    shows("loop gain is one at $\\omega_c = 4.95$ rad/s", 5.0,
          crossing * hypot(1.0, lag * crossing), 2e-3)  # fmt: skip
    phase = degrees(atan(lag * crossing)), degrees(crossing * DELAY)
    shows("which is 8.4°, the delay takes", 8.4, phase[0], 0.01)
    shows("which is 3.3°, and $90 - 8.4 - 3.3$ leaves 78.3°", (3.3, 78.3),
          (phase[1], 90.0 - sum(phase)), 0.02)  # fmt: skip
    J = np.array([[2.0, 1.0]])
    shows("with the length $\\sqrt{0.2} = 0.447$", (0.4, 0.2), np.linalg.pinv(J)[:, 0])
    free = np.eye(2) - np.linalg.pinv(J) @ J
    shows("joint to turn at 1 rad/s, $z = (1, 0)$", (0.2, -0.4), free[:, 0], 1e-6)
    _limited(J)
    _turned()
    _integral()
    _finite()
    _wanted()
    cut, even = np.minimum((3.0, 0.9), 1.5), 0.5 * np.array((3.0, 0.9))
    shows(
        "asked for 3.0 and 0.9 rad/s, and the limit is 1.5 rad/s",
        (1.5, 0.9, 1.5, 0.45),
        (*cut, *even),
    )
    shows("points 31° away from the x axis and the second 16.7°", (31.0, 16.7),
          [degrees(atan(y / x)) for x, y in (cut, even)], 4e-3)  # fmt: skip
    shows("published at 100 Hz, is another 5 ms old on average; a command is held for 5 ms",
          (100.0, 5.0, 2.5),
          (lk.BAXTER.state_rate, 0.5e3 / lk.BAXTER.state_rate, 0.5e3 / 200.0))  # fmt: skip


def _limited(J: np.ndarray) -> None:
    """The two joints with a limit on the first, cut off or by the quadratic program."""
    cut = np.minimum(np.linalg.pinv(J)[:, 0], (0.3, np.inf))
    price = 1e-4 * np.eye(2)
    best = lsq_linear(np.vstack((J, price)), (1.0, 0.0, 0.0), ([-0.3, -9.0], [0.3, 9.0]), "bvls").x
    shows("limited to 0.3 rad/s, a motor that cuts makes $(0.3, 0.2)$, and the tip moves at 0.8 in "
          "place of 1", (0.3, 0.2, 0.8), (*cut, *(J @ cut)), 1e-6)  # fmt: skip
    shows("answers $(0.3, 0.4)$ rad/s", (0.3, 0.4, 1.0), (*best, *(J @ best)), 1e-6)


def _turned() -> None:
    """The yaw of the ready pose, and how fast an error of orientation decays under the law."""
    R = lk.Model("left").pose(lk.robot("left").ready)[:3, :3]
    shows("ready pose $\\psi$ is −164°", -164.0, degrees(atan2(R[1, 0], R[0, 0])), 5e-3)
    left, kp, h = [], 3.0, 1e-3
    for kd in (0.0, 0.6):
        for turning in (0.0, 1.0):
            R, R_d = lk.se3.rotation(np.array((0.8, -0.5, 0.9))), np.eye(3)
            for t in np.arange(0.0, 1.0, h):
                w_d = turning * np.array((0.9 * np.sin(3.0 * t), 0.7, 1.2))
                w = w_d + kp / (1.0 + kd) * lk.se3.rotation_log(R_d @ R.T)
                R, R_d = lk.se3.rotation(h * w) @ R, lk.se3.rotation(h * w_d) @ R_d
            left.append(float(np.linalg.norm(lk.se3.rotation_log(R_d @ R.T))) / sqrt(1.7))
    holds(
        np.allclose(left, [exp(-3.0)] * 2 + [exp(-3.0 / 1.6)] * 2, rtol=0.01),
        "The angle of the orientation's error decays at this rate too, with $K_d$ and",
    )


def _integral() -> None:
    """The exercise on the integral: the slower of two exponentials, over all K_i."""
    rates = {ki: -max(np.roots((1.0, 4.0, ki)).real) for ki in (1.0, 3.0, 4.0, 8.0)}
    shows("at half the rate of $K_p$ alone", (4.0, 2.0), (4.0, max(rates.values())), 1e-6)
    shows("leaves the rate at 2 1/s", 2.0, rates[8.0], 1e-6)


def _wanted() -> None:
    """The exercise on damping: the lambda that keeps a limit, and its cost elsewhere."""
    least = 0.2 / (2.0 * 1.5)
    ratios = np.geomspace(1e-3, 1.0, 999)
    slow = max(0.2 * damped_inverse(np.array([[x]]), least**2)[0, 0] for x in ratios)
    kept = 0.3 * damped_inverse(np.array([[0.3]]), least**2)[0, 0]
    shows("gives $\\lambda \\ge 0.0667$", (0.0667, 1.5), (least, slow), 1e-3)
    shows("= 4.7$ % is lost", 0.047, 1.0 - kept, 4e-3)


def _swing() -> None:
    """The error of a swinging joint with a lag, by the formula and by integration."""
    lag, kp, w, size = lk.BAXTER.velocity_lag, 3.0, 2.5, 0.3
    amplitude, run = [], []
    for kd in (0.0, 0.6):
        amplitude.append(lag * w * w * size / hypot(kp - lag * w * w, (1.0 + kd) * w))
        h, e, de, seen = 1e-4, 0.0, 0.0, 0.0
        for k in range(100_000):
            pull = -lag * w * w * size * np.sin(w * h * k)
            de += h * (pull - (1.0 + kd) * de - kp * e) / lag
            e += h * de
            seen = max(seen, abs(e)) if k > 60_000 else 0.0
        run.append(seen)
    shows("behind a lag of 30 ms", (0.3, 2.5, 0.03), (size, w, lag))
    shows("the error swings by 0.0149 rad", (0.0149, 0.0115), amplitude, 5e-3)
    shows("the error is 0.0115 rad, smaller by 23 %", (0.0149, 0.0115, 0.23),
          (*run, 1.0 - run[1] / run[0]), 0.01)  # fmt: skip


def _finite() -> None:
    """The effect of a damped inverse in one direction."""
    damping = WorkspaceVelocityPD.damping
    factor = float(damped_inverse(np.array([[0.05]]), damping)[0, 0])
    shows("with $\\sigma = 0.05$ m/rad the tip should move at 0.1 m/s", 2.0, 0.1 / 0.05)
    shows("or 2 rad/s, too much for a shoulder with a limit of 1.5 rad/s", (2.0, 1.5),
          (0.1 / 0.05, lk.robot("left").speed[0]))  # fmt: skip
    shows("With $\\lambda^2 = 0.004$, as in this lab", 0.004, damping)
    shows("so the joints turn at 0.769 rad/s", (7.69, 0.769), (factor, 0.1 * factor), 1e-3)
    shows("or 0.0385 m/s: the share", 0.0385, 0.005 * factor, 2e-3)
    shows("is lost, which is 62 %", 0.62, 1.0 - 0.05 * factor, 0.01)
