"""Chapter "Impedance": its drawings and its calculations by hand."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from scipy.optimize import fsolve

import labkit as lk
from labkit.scene import contact_stiffness
from solutions.study import experiments
from solutions.study.gains import TIP_SPRING

from .claims import holds, shows
from .page import figure, number, numbers, table

JOINT_SPRINGS = np.array((200.0, 200.0, 100.0, 100.0, 10.0, 10.0, 2.0))
"""Stiffness of the joint impedance controller on the ideal arm, in [N m/rad]."""
PUSH = 10.0


def planar() -> None:
    """The two-joint arm of the calculations by hand."""
    link, bend, rotors = 0.5, math.radians(90.0), (1.0, 0.25)
    shows("Two links of 0.5 m are in a plane, the first along $x$, the second bent upwards by 90°",
          (0.5, 90.0), (link, math.degrees(bend)))  # fmt: skip
    shows("the two motors have 1 and 0.25 kg m²", (1.0, 0.25), rotors)
    x, y = link * math.cos(bend), link * math.sin(bend)
    J, M = np.array(((-y, -y), (link + x, x))), np.diag(rotors)
    mobility = J @ np.linalg.solve(M, J.T)
    push, spring = 1.0, 100.0
    shows("Push this tip along $y$ with 1 N", (1.0, -0.25, 0.25), (push, *push * mobility[:, 1]))
    shows("Give this tip a spring of 100 N/m in both directions", 100.0, spring)
    L = np.linalg.inv(mobility)
    holds(
        np.allclose([mobility[0, 0], mobility[1, 1], mobility[0, 1]], (1.25, 0.25, -0.25)),
        "1.25 and 0.25 on the diagonal and −0.25 off it",
    )
    holds(
        np.allclose([L[0, 0], L[1, 1], L[0, 1]], (1.0, 5.0, 1.0)),
        "1 kg along $x$, 5 kg along $y$ and 1 kg off the diagonal",
    )
    holds(
        math.isclose(1.0 / mobility[1, 1], 4.0) and math.isclose(L[1, 1], 5.0),
        "feels 4 kg along $y$ if it may slip sideways, and 5 kg if a rail keeps it on",
    )
    values, axes = np.linalg.eigh(L)
    D = 2.0 * math.sqrt(spring) * (axes * np.sqrt(values)) @ axes.T
    numbers({"planar_dx": D[0, 0], "planar_dy": D[1, 1], "planar_dxy": D[0, 1]}, ".3g")
    poles = [_poles(L, spring, x) for x in (np.diag(np.diag(D)), D)]
    holds(
        np.allclose([float(np.min(-x.real / np.abs(x))) for x in poles], (0.9, 1.0), rtol=0.005),
        "one pair of poles would be complex, with a damping ratio of 0.90; with it",
    )


def _poles(L: np.ndarray, spring: float, D: np.ndarray) -> np.ndarray:
    """The poles of a mass matrix on equal springs with a damping matrix."""
    zero, one = np.zeros_like(L), np.eye(len(L))
    A = np.block([[zero, one], [-spring * np.linalg.inv(L), -np.linalg.solve(L, D)]])
    return np.linalg.eigvals(A)


def one_mass_by_hand() -> None:
    """The peak of the swinging mass, by the formula for the overshoot."""
    z = 0.2
    k, m, push = 200.0, 2.0, 10.0
    holds(
        math.isclose(math.sqrt(k / m), 10.0) and math.isclose(2.0 * math.sqrt(k * m), 40.0),
        "rad/s, and $\\zeta = 1$ needs",
    )
    shows("For 2 kg on 200 N/m", (2.0, 200.0), (m, k))
    shows("Pushed with 10 N it rests 50 mm away", (10.0, 50.0), (push, 1e3 * push / k))
    peak = 1e3 * push / k * (1.0 + math.exp(-math.pi * z / math.sqrt(1.0 - z**2)))
    number("peak_02", peak, ".2g")
    holds(math.isclose(peak / 50.0 - 1.0, 0.527, rel_tol=0.01), "overshoots by 53 %")


def admittance() -> None:
    """The stiffest wall on which an admittance with a lag is stable, by Routh and by the roots."""
    m, k, lag, contact = 2.0, 200.0, 0.03, contact_stiffness(experiments.the_wall())

    def stable(b: float, k_w: float, lag: float = lag) -> bool:
        parts = (m * lag, m + b * lag, b + k * lag, k + k_w)
        return bool(np.roots(parts).real.max() < 0.0)

    most = max(x for x in np.arange(1000.0, 4000.0) if stable(40.0, x))
    least = min(b for b in np.arange(20.0, 80.0) if stable(b, contact))
    shows("With 2 kg, 200 N/m and 40 N s/m, critically damped in free air, and a lag of 30 ms, "
          "that is 2,250 N/m: the contact of this chapter, with 3,333 N/m, is too stiff",
          (2.0, 200.0, 40.0, 30.0, 2250.0, 3333.0),
          (m, k, 2.0 * math.sqrt(k * m), 1e3 * lag, most, contact), 2e-3)  # fmt: skip
    slowest = max(ms for ms in np.arange(5.0, 30.0) if stable(40.0, contact, 1e-3 * ms))
    shows("A damper of 54 N s/m makes this contact stable", 54.0, least)
    holds(0.45 < slowest / (1e3 * lag) < 0.55, "so does a position loop with about half the lag")


def felt_inertia() -> HTML:
    """The inertia at Baxter's tip in the vertical plane, for a free hand and for a guided one."""
    model = lk.Model("left", lk.IDEAL)
    q = np.array(model.robot.ready)
    L = np.array(model.operational_inertia(q))
    mobility = np.linalg.inv(L)
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    u = np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=1)
    free = 1.0 / np.einsum("ki,ij,kj->k", u, mobility[:3, :3], u)
    guided = np.einsum("ki,ij,kj->k", u, L[:3, :3], u)
    _, ax = plt.subplots(figsize=(6.0, 3.6))
    ax.plot(*(guided[:, None] * u)[:, [0, 2]].T, "C1--", label="all other directions held")
    ax.plot(*(free[:, None] * u)[:, [0, 2]].T, "C0-", label="free to give way")
    ax.set_aspect("equal")
    ax.set(xlabel="inertia felt along x [kg]", ylabel="along z, upwards [kg]")
    ax.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    numbers({"lambda_x": L[0, 0], "lambda_z": L[2, 2], "lambda_xz": L[0, 2]}, ".2g")
    numbers({"felt_x": 1.0 / mobility[0, 0], "felt_z": 1.0 / mobility[2, 2]}, ".2g")
    holds(
        0.0 < 1.0 / mobility[0, 0] < 0.1 * (1.0 / mobility[2, 2]),
        "one push meets less than a tenth of the inertia that another meets",
    )
    holds(
        18.0 < L[0, 0] / (1.0 / mobility[0, 0]) < 22.0 and 1.0 / mobility[0, 0] > 0.0,
        "twenty times as much",
    )
    return figure(
        "The inertia that a push feels at the ready arm's tip, by direction in the vertical plane. "
        "It is the distance of a curve from the middle, in kg.",
        f"Two closed curves. Free, the tip feels like {1 / mobility[0, 0]:.2g} kg "
        f"along x and {1 / mobility[2, 2]:.2g} kg along z. With all others held, "
        f"{L[0, 0]:.2g} and {L[2, 2]:.2g} kg.",
    )


def wall_by_hand() -> None:
    """The force on the wall, from springs in series."""
    model = lk.Model("left", lk.IDEAL)
    mobility = np.linalg.inv(model.operational_inertia(model.robot.ready))
    stiffness = 400.0 / float(mobility[0, 0])
    contact = contact_stiffness(experiments.the_wall())
    number("stiff_torque", stiffness, ".3g")
    depth, gain = 0.03, 400.0
    shows("the target is 3 cm behind the surface", 3.0, 100.0 * depth)
    shows("a rigid arm, 3 cm too far", 3.0, 100.0 * depth)
    shows("compressed by 3 cm", 3.0, 100.0 * depth)
    shows("which is 400 1/s² times", gain, stiffness * float(mobility[0, 0]))
    force = depth / (1.0 / stiffness + 1.0 / contact)
    number("hand_torque", force, ".2g")
    found = experiments.wall(names=("joint torque",))[0]
    holds(
        0.0 < force < -found.force_at_rest[0] < 1.1 * force, "within a tenth of what the run shows"
    )
    hold = depth / (1.0 / TIP_SPRING[0] + 1.0 / contact)
    holds(math.isclose(hold, 8.26, rel_tol=0.001), "8.26 N by the calculator")


def joint_springs() -> HTML:
    """The displacement of the pushed tip if each joint has its own spring."""
    model = lk.Model("left", lk.IDEAL)
    J = model.tip_jacobian(model.robot.ready)
    moved = 1e3 * PUSH * (J / JOINT_SPRINGS) @ J.T  # mm
    rows = [
        (f"10 N along {axis}", *(f"{moved[i, k]:.0f}" for i in range(3)))
        for k, axis in enumerate("xyz")
    ]
    q, start = np.array(model.robot.ready), np.array(model.robot.ready)
    shows("A push of 10 N upwards", 10.0, PUSH)
    shows(
        "= (200, 200, 100, 100, 10, 10, 2) N m/rad",
        (200.0, 200.0, 100.0, 100.0, 10.0, 10.0, 2.0),
        JOINT_SPRINGS,
    )
    for force in np.linspace(1.0, PUSH, 10):
        push = force * np.eye(6)[2]
        q = fsolve(lambda q, f=push: JOINT_SPRINGS * (start - q) + model.tip_jacobian(q).T @ f, q)
    rest = 1e3 * (model.pose(q) - model.pose(start))[:3, 3]
    met = experiments.push((0.0, 0.0, PUSH), names=("joint impedance",))[0]
    found = 1e3 * met.at_rest
    numbers({"side_x": moved[0, 2], "side_z": moved[2, 2]}, ".2g")
    numbers({"side_run_x": found[0], "side_run_z": found[2]}, ".2g")
    holds(found[0] > found[2] > 0.0, "further to the side than up")
    holds(np.allclose(rest[::2], found[::2], rtol=0.0, atol=0.1), "to a tenth of a millimetre")
    return table(
        ("Push", "along x [mm]", "along y [mm]", "along z [mm]"),
        rows,
        "Displacement of the tip under springs at the joints, by "
        "C<sub>x</sub> = J K<sub>q</sub>⁻¹ Jᵀ",
    )
