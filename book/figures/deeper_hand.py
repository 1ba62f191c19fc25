"""Pages "Going deeper": calculations that a student can check by hand, and their drawings."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from solutions.study import image_servoing
from solutions.study.gains import TIP_SPRING

from .claims import holds, shows
from .page import figure, number, numbers, table

STIFFNESS, SLOW, SPEED, DEPTH = 300.0, 0.1, 0.1, 0.05
"""In the drawing: spring [N/m], very slow sampling [s], speed [m/s] and depth [m] of a hand."""


def trip() -> HTML:
    """A hand presses a sampled spring at constant speed and releases it at the same speed."""
    count = round(DEPTH / (SPEED * SLOW))
    step = SPEED * SLOW
    inwards = [(step * k, STIFFNESS * step * k) for k in range(count)]
    outwards = [(DEPTH - step * k, STIFFNESS * (DEPTH - step * k)) for k in range(count)]
    spent = sum(force * step for _, force in inwards)
    returned = sum(force * step for _, force in outwards)
    holds(
        0.0 < spent < returned
        and math.isclose(returned - spent, STIFFNESS * SPEED * SLOW * DEPTH, rel_tol=1e-06),
        "returns more than it received",
    )
    k, rate, deep, v = TIP_SPRING[0], 200.0, 0.05, 0.2
    shows("The lab's spring of 300 N/m at 200 Hz, pressed by 5 cm at 0.2 m/s",
          (300.0, 200.0, 5.0, 0.2), (k, rate, 100.0 * deep, v))  # fmt: skip
    lab = k * v * deep / rate
    numbers({"trip_mj": 1e3 * lab, "trip_stored": 1e3 * 0.5 * k * deep**2}, ".3g")
    number("trip_need", lab / (2.0 * v * deep), ".2g")
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    for k, (name, parts, way) in enumerate((("in", inwards, 1.0), ("out", outwards, -1.0))):
        x = np.array([(a, a + way * step) for a, _ in parts]).ravel()
        f = np.array([(force, force) for _, force in parts]).ravel()
        ax.plot(1e3 * x, f, f"C{k}{'-' if k == 0 else '--'}", label=f"on the way {name}")
    x = np.array((0.0, DEPTH))
    ax.plot(1e3 * x, STIFFNESS * x, color="#999999", linestyle=":", label="a real spring")
    ax.set(xlabel="compression [mm]", ylabel="force [N]", ylim=(0, None))
    ax.legend()
    return figure(
        "A spring of 300 N/m from samples 0.1 s apart, pressed by 50 mm at 0.1 m/s and let out. "
        "The steps on the way out are above those on the way in.",
        "Two staircases around the straight line of a real spring: the one on the way in is below "
        f"it, the one on the way out above. Work in {1e3 * spent:.3g} mJ, work out "
        f"{1e3 * returned:.3g} mJ.",
    )


def viscous_tip() -> None:
    """The damping at the tip that viscous friction in the joints causes."""
    model = lk.Model("left")
    J = model.tip_jacobian(model.robot.ready)
    b = lk.BAXTER.viscous[0]
    shows("With Baxter's 0.7 N m s/rad", 0.7, b)
    tip = [b / float(J[k] @ J[k]) for k in range(3)]
    numbers({"tip_viscous_x": tip[0], "tip_viscous_z": tip[2]}, ".2g")
    holds(
        all(0.75 < x < 60.0 for x in tip),
        "enough for the spring alone and not for a damper beside it",
    )


def projections() -> HTML:
    """The effect on the tip of a torque at e0, after each of two projections."""
    rows, most = [], []
    for name, plant in (("without rotors", lk.IDEAL), ("with rotors", lk.BAXTER)):
        model = lk.Model("left", plant)
        q = model.robot.ready
        J, M = model.tip_jacobian(q), model.mass_matrix(q)
        Jbar = np.linalg.solve(M, J.T) @ np.array(model.operational_inertia(q))
        tau = np.eye(7)[2]
        shows("A torque of 1 N m at e0", 1.0, tau[2])
        found = [
            float(np.linalg.norm((J @ np.linalg.solve(M, tau - J.T @ (G.T @ tau)))[:3]))
            for G in (np.linalg.pinv(J), Jbar)
        ]
        left = float(np.linalg.solve(M, tau - J.T @ (Jbar.T @ tau))[2])
        rows.append((name, f"{found[0]:.2g}", "&lt; 10⁻⁹", f"{left:.2g}"))
        most.append(found)
        key = name.split()[0]
        numbers({f"pinv_{key}": found[0], f"elbow_{key}": left}, ".2g")
    holds(
        min([x[0] for x in most]) > 0.1 and max(map(abs, [x[1] for x in most])) < 1e-09,
        "The pseudo-inverse of the Jacobian is the wrong one here",
    )
    return table(
        ("Arm", "tip, with J⁺ [m/s²]", "tip, with J̄ [m/s²]", "e0, with J̄ [rad/s²]"),
        rows,
        "Acceleration due to a torque of 1 N m at e0, after the projection",
    )


def freedom() -> None:
    """The direction of the seventh freedom at the ready pose, and its manipulability."""
    model = lk.Model("left")
    J = model.tip_jacobian(model.robot.ready)
    _, sigma, axes = np.linalg.svd(J)
    n = axes[6] / axes[6][2]
    shows("For 1 rad/s of e0", 1.0, n[2])
    numbers({"free_s0": n[0], "free_w0": n[4], "free_w2": n[6]}, ".2f")
    holds(max(abs(n[1:6:2])) < 1e-6 < 0.5 < min(abs(n[::4])), "s1, e1 and w1 do not take part")
    numbers({f"row_{joint}": J[5, k] for k, joint in ((0, "s0"), (2, "e0"), (4, "w0"), (6, "w2"))},
            ".2f")  # fmt: skip
    row = [float(J[5, k]) for k in (0, 2, 4, 6)]
    holds(
        abs(np.dot(row, n[::2])) < 1e-09 and row[0] > 0.9 and (row[3] < -0.9),
        "Multiply the two numbers of each row and add the four products: the sum is",
    )
    numbers({"sigma_least": sigma[-1], "sigma_most": sigma[0]}, ".2g")
    number("w_ready", float(np.prod(sigma)), ".2g")


def two_speeds() -> None:
    """Friction from two instants: two equations with two unknowns."""
    y = {v: 0.7 * v + 1.0 for v in (0.1, 0.3)}
    viscous = (y[0.3] - y[0.1]) / 0.2
    holds(
        np.allclose([*y.values()], (1.07, 1.21)), "1.07 N m at 0.1 rad/s and 1.21 N m at 0.3 rad/s"
    )
    holds(
        math.isclose(viscous, lk.BAXTER.viscous[0]) and math.isclose(y[0.1] - 0.1 * viscous, 1.0),
        "the slope is 0.7 N m s/rad and what is left at zero speed is 1 N m",
    )


def half_turn() -> None:
    """The command of the image-based law if the camera must turn by 180° about its axis."""
    s = 0.2 * np.array(((1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)))
    turned = s @ np.array(((math.cos(math.pi), -math.sin(math.pi)),
                           (math.sin(math.pi), math.cos(math.pi))))  # fmt: skip
    V = np.linalg.pinv(image_servoing.interaction(s, depth=0.25)) @ (turned - s).ravel()
    holds(
        V[2] < -0.1 and abs(np.delete(V, 2)).max() < 1e-09,
        "the camera must turn by 180° about its optical axis",
    )


def lens_by_hand() -> None:
    """Where the camera stops if its depth is wrong by a fifth, and what a wrong depth costs."""
    away = math.hypot(0.12, 0.22)
    number("lens_away", 1e3 * away, ".3g")
    number("lens_short", 1e3 * (away - away / 1.2), ".2g")
    ends = 1e3 * image_servoing.approach("pose, goal measured", 0.2).distance[-1]
    by_hand = 1000.0 * (away - away / 1.2)
    holds(
        0.0 < 1.14 * by_hand < ends < 1.2 * by_hand,
        "ends about a sixth further off than this calculation says",
    )
    rate = {}
    for share in (0.5, 1.0, 2.0):
        d = image_servoing.approach("image", depth=0.25 * share).distance
        rate[share] = float(-math.log(d[60] / d[20]) / (40 * image_servoing.DT))
    numbers({"rate_half": rate[0.5], "rate_true": rate[1.0], "rate_double": rate[2.0]}, ".2g")
    shows("The law asks for $\\lambda = 2$ 1/s", 2.0, image_servoing.GAIN)
    holds(
        min(rate.values()) > 1.0 and max(rate.values()) < 4.0,
        "The camera arrives in all three cases",
    )
