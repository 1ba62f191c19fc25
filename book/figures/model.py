"""Chapter "The model"."""

from __future__ import annotations

from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit.replay import Motion
from labkit.shapes import Array

from .claims import holds, shows
from .embed import demo_html
from .page import Question, figure, number, numbers, poster, quiz, shown, table

SEED = 2
STEP = 1e-6
LIMIT = 1.5
"""Speed limit of Baxter's shoulder and elbow joints, in [rad/s]."""


def jacobian_demo() -> HTML:
    """The live demo of the Jacobian."""
    caption = "The tip Jacobian, live. Turn the joints, and watch a column become two arrows."
    left = lk.robot("left")
    held = Motion(left, np.array((0.0, 1.0)), np.tile(left.ready, (2, 1)))
    return HTML(demo_html("jacobian", caption=caption, poster=poster(held)))


def checks() -> HTML:
    """Check the properties of the formulas on random states."""
    model, random = lk.Model("left", lk.BAXTER), np.random.default_rng(SEED)
    worst = dict.fromkeys(("J", "symmetry", "skew", "gravity", "power", "turn"), 0.0)
    smallest = np.inf
    for _ in range(100):
        q = random.uniform(model.robot.lower, model.robot.upper)
        dq = random.uniform(-1.0, 1.0, 7)
        J, M, C = model.tip_jacobian(q), model.mass_matrix(q), model.coriolis(q, dq)
        slope = np.column_stack(
            [
                (model.pose(q + h)[:3, 3] - model.pose(q - h)[:3, 3]) / (2.0 * STEP)
                for h in STEP * np.eye(7)
            ]
        )
        rate = (model.mass_matrix(q + STEP * dq) - model.mass_matrix(q - STEP * dq)) / (2.0 * STEP)
        skew = rate - 2.0 * C
        hill = [
            (model.potential_energy(q + h) - model.potential_energy(q - h)) / (2.0 * STEP)
            for h in STEP * np.eye(7)
        ]
        for name, off in (
            ("J", slope - J[:3]),
            ("symmetry", M - M.T),
            ("skew", skew + skew.T),
            ("gravity", np.array(hill) - model.gravity(q)),
            ("power", np.array(dq @ skew @ dq)),
            ("turn", model.mass_matrix(q * np.array((0.0, *np.ones(6)))) - M),
        ):
            worst[name] = max(worst[name], float(np.abs(off).max()))
        smallest = min(smallest, float(np.linalg.eigvalsh(M)[0]))
    holds(max(worst.values()) < 1e-6, "the laws of the model hold")
    holds(smallest > 0.0, "the mass matrix is positive definite")
    rows = [
        ("Linear rows of J are the slope of the pose", f"{_small(worst['J'])} m/rad"),
        ("M is symmetric", f"{_small(worst['symmetry'])} kg m²"),
        ("Ṁ − 2C is skew", f"{_small(worst['skew'])} kg m²/s"),
        ("g is the slope of the potential energy", f"{_small(worst['gravity'])} N m"),
        ("q̇ᵀ(Ṁ − 2C)q̇ vanishes", f"{_small(worst['power'])} W"),
        ("M does not change when s0 turns", f"{_small(worst['turn'])} kg m²"),
        ("M is positive definite", f"none: its smallest eigenvalue is {smallest:.2g} kg m²"),
    ]
    return table(("Law", "Largest miss"), rows, "100 random states within the joint limits")


def _small(miss: float) -> str:
    """A small error in the notation of the text: 2.4·10⁻¹⁰, or 0."""
    digits, _, power = f"{miss:.1e}".partition("e")
    raised = str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{digits}·10{raised}" if miss else "0"


def singular() -> HTML:
    """The joint speeds that pull the tip towards the shoulder through a singularity."""
    model = lk.Model("left")
    angles = np.linspace(0.02, 1.2, 1181)
    sigma, speed = [], []
    for e1 in angles:
        q = np.array(model.robot.neutral)
        q[3] = e1
        J = model.tip_jacobian(q)
        radial = model.pose(q)[:3, 3] - np.array(model.links(q)[1].T_wl[:3, 3])
        pull = np.append(-0.2 * radial / np.linalg.norm(radial), np.zeros(3))
        sigma.append(np.linalg.svd(J, compute_uv=False)[-1])
        speed.append(np.abs(np.linalg.pinv(J) @ pull).max())
    at, top = float(angles[int(np.argmin(sigma))]), float(np.max(speed))
    at_e1 = (1.0, 0.3, 0.02)
    fast = [float(np.interp(x, angles, speed)) for x in at_e1]
    _, (left, right) = plt.subplots(1, 2, figsize=(6.4, 3.0))
    left.plot(angles, sigma, "C1-")
    left.axvline(at, color="C5", linestyle=":")
    left.set(xlabel="elbow e1 [rad]", ylabel="smallest singular value", ylim=(0, None))
    right.semilogy(angles, speed, "C0-")
    right.axhline(LIMIT, color="C5", linestyle="--")
    right.axvline(at, color="C5", linestyle=":")
    right.text(0.3, 0.5 * LIMIT, "limit of s0 to e1", fontsize="small")
    right.set(xlabel="elbow e1 [rad]", ylabel="largest joint speed [rad/s]", ylim=(0.2, 3.0 * top))
    holds(
        abs(at - 0.16) < 0.01 and 0.0 < np.min(sigma) < 0.002,
        "it vanishes at a bent elbow, not at a straight one",
    )
    holds(
        top > 10.0 * fast[1] > 10.0 * fast[0] > 0.0 and top > 10.0 * fast[2] > 0.0,
        "on both sides of it the joint speeds fall again",
    )
    number("singular_at", at, ".2f")
    shows("With the elbow bent to 1 rad", 1.0, at_e1[0])
    shows("at e1 = 0.02 rad", 0.02, at_e1[2])
    shows("against a limit of 1.5 rad/s", 1.5, LIMIT)
    numbers({"bent": fast[0], "straight": fast[2], "singular_peak": top}, ".2g")
    return figure(
        "The smallest singular value of the tip Jacobian, and joint speed of a pull towards the "
        "shoulder at 0.2 m/s. Where the one vanishes, dotted, the other grows without bound.",
        f"Left: the smallest singular value of the tip Jacobian over the elbow's angle; it falls "
        f"to zero at e1 = {at:.2f} rad and rises again towards the straight elbow. Right, on a "
        f"logarithmic scale: the largest joint speed, {fast[0]:.2g} rad/s at e1 = 1, a peak of "
        f"{shown(top, '.2g')} rad/s at the singularity, {fast[2]:.2g} rad/s at e1 = 0.02; the "
        f"limit is {LIMIT:g} rad/s.",
    )


def gravity() -> HTML:
    """The holding torque of each joint while the shoulder moves through its range."""
    model = lk.Model("left")
    angles = np.linspace(model.robot.lower[1], model.robot.upper[1], 200)
    torque = []
    for s1 in angles:
        q = np.array(model.robot.neutral)
        q[1] = s1
        torque.append(model.gravity(q))
    rows = np.array(torque)
    _, ax = plt.subplots(figsize=(6.0, 3.0))
    for k, name, style in ((1, "s1", "-"), (3, "e1", "--"), (5, "w1", "-.")):
        ax.plot(angles, rows[:, k], f"C{k}{style}")
        ax.text(angles[110], rows[110, k] + 1.5, name, ha="right")
    ax.set(xlabel="shoulder s1 [rad]", ylabel="g(q) [N m]")
    most = rows[np.abs(rows[:, 1]).argmax(), 1]
    neutral = model.gravity(model.robot.neutral)[1]
    numbers({"g_neutral": abs(neutral), "g_most": abs(most)}, ".3g")
    holds(abs(most) > 50.0, "more than the 50 N m that its motor gives")
    return figure(
        "The torques that hold the arm as s1 alone turns. By far the largest is that of s1 itself.",
        f"Three curves over the range of s1. The shoulder's own torque is the largest, "
        f"{most:.3g} N m at its extreme and {neutral:.3g} N m at the neutral pose; the elbow e1 "
        f"carries up to {np.abs(rows[:, 3]).max():.3g} N m, the wrist w1 up to "
        f"{np.abs(rows[:, 5]).max():.2g} N m.",
    )


def weigh() -> HTML:
    """The part of each body in the holding torque of the shoulder s1, at the neutral pose."""
    model = lk.Model("left")
    q = np.array(model.robot.neutral)
    _, *bodies = model.links(q)
    about, axis = bodies[0].T_wl[:3, 3], bodies[0].T_wl[:3, 2]
    levers = [float(np.cross(axis, body.com - about)[2]) for body in bodies]
    torques = [9.81 * body.mass * lever for body, lever in zip(bodies, levers, strict=True)]
    masses = [float(body.mass) for body in bodies]
    shows("Add the last column: the sum is the holding torque", sum(torques), model.gravity(q)[1])
    shows("their product with 9.81 m/s²", 9.81, model.gravity(q)[1] / np.dot(masses, levers))
    holds(
        abs(sum(masses[3:]) / sum(masses) - 1 / 3) < 0.02
        and 0.5 < np.abs(torques)[3:].sum() / np.abs(torques).sum() < 0.7,
        "a third of the mass and cause more than half of the torque",
    )
    rows = [
        (name.removeprefix("left_"), f"{m:.2f}", f"{abs(lever):.3f}", f"{abs(t):.2f}")
        for name, m, lever, t in zip(
            model.robot.joint_names[1:], masses, levers, torques, strict=True
        )
    ]
    head = ("Body after joint", "mass [kg]", "distance [m]", "torque [N m]")
    return table(head, rows, "The holding torque of s1 at the neutral pose, body by body")


@cache
def _swing() -> lk.Log:
    """A swing of the ideal arm under computed torque at 1 kHz."""
    model = lk.Model("left")
    q0 = model.robot.ready
    swing = lk.Trajectory(
        lk.Line(q0, q0 + np.array((0.3, -0.4, 0.2, 0.5, 0.0, -0.4, 0.0))), lk.Quintic(2.0)
    )

    def feedforward(state: lk.State, target: lk.Sample) -> lk.JointTorque:
        q, dq = state.q, state.dq
        wanted = target.acceleration + 100.0 * (target.position - q)
        wanted = wanted + 20.0 * (target.velocity - dq)
        return lk.JointTorque(model.mass_matrix(q) @ wanted + model.bias(q, dq))

    with lk.Arm("left", lk.IDEAL, q0=q0) as arm:
        return lk.run(arm, swing, feedforward, rate=1000)


def wrong_axes() -> None:
    """A mistake that the power balance misses: inertias left in the bodies' own axes."""
    model, log = lk.Model("left"), _swing()

    def extra(q: Array) -> Array:
        """The error of the mass matrix due to the mistake."""
        turns = [(x.com_jacobian[3:], x.inertia, x.T_wl[:3, :3]) for x in model.links(q)]
        return sum(W.T @ (I - R @ I @ R.T) @ W for W, I, R in turns)

    more = [0.5 * dq @ extra(q) @ dq for q, dq in zip(log.q, log.dq, strict=True)]
    missed = float(np.abs(np.gradient(np.array(more), log.t)).max())
    q = np.array(model.robot.ready)
    turned = q + 0.5 * np.pi * np.eye(7)[0]
    entry = [float((model.mass_matrix(x) + extra(x))[1, 1]) for x in (q, turned)]
    right = float(np.abs(model.mass_matrix(turned) - model.mass_matrix(q)).max())
    number("axes_w", missed, ".2g")
    numbers({"axes_before": entry[0], "axes_after": entry[1]}, ".3f")
    holds(
        round(right, 9) < 1e-09 and 0.015 < entry[0] - entry[1] < 0.03,
        "so $M$ must not change when s0 turns",
    )


def power() -> HTML:
    """The power of the motors is the rate of the arm's energy."""
    model, log = lk.Model("left"), _swing()
    rows = zip(log.q, log.dq, strict=True)
    energy = [model.kinetic_energy(q, dq) + model.potential_energy(q) for q, dq in rows]
    gained = np.gradient(np.array(energy), log.t)
    given = np.einsum("ij,ij->i", log.tau, log.dq)
    _, ax = plt.subplots(figsize=(6.0, 2.9))
    ax.plot(log.t, given, color="#999999", linewidth=5, label="τᵀq̇, given by the motors")
    ax.plot(log.t, gained, "C0--", label="gained by the arm, kinetic and potential")
    ax.set(xlabel="time [s]", ylabel="power [W]")
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize="small")
    off = float(np.abs(gained - given)[2:-2].max())
    peak = float(np.abs(given).max())
    holds(0.0 < off < 0.01 * peak, "the two curves differ by at most")
    numbers({"power_peak": peak, "power_off": off}, ".2g")
    return figure(
        "Power during a swing of the ideal arm, 1 kHz control. The two curves cover each other.",
        f"Two curves over two seconds lie on each other: the power of the motors and the rate of "
        f"the arm's energy. The peak is {peak:.2g} W, the largest difference {off:.2g} W.",
    )


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            "The gripper points down and turns about the vertical, its tip at rest and not above "
            "the world's origin. Which Jacobian gives a twist whose linear part is not zero?",
            [
                ("The tip Jacobian", "Its linear rows are the velocity of the tip, which is zero."),
                ("The body Jacobian", "It gives the same velocity in other axes: still zero."),
                (
                    "The spatial Jacobian",
                    "It gives the velocity of the point of the turning body that passes "
                    "through the world's origin.",
                ),
            ],
            2,
        ),
        Question(
            r"Someone computes \(C\) as \(\dot M / 2\) and shows that \(\dot M - 2C\) is skew. "
            "What has been proved?",
            [
                ("That C is right", "The zero matrix is skew, so this test passes for free."),
                (
                    "Nothing about C q̇",
                    "Skewness must come together with the right torque C q̇.",
                ),
            ],
            1,
        ),
        Question(
            "Which of these has the unit of a torque?",
            [
                (
                    r"\(M J^T a\), with a an acceleration",
                    "kg m² times m times m/s²: kg m⁴/s². Not a torque.",
                ),
                (r"\(\sum_i m_i J_i^T a\), with \(J_i\) of each link's centre", "The unit is N m."),
                (r"\(J^T a\)", "m²/s²: a force is missing its mass."),
            ],
            1,
        ),
    )
