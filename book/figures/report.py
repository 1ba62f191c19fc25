"""Page "A 2019 report re-examined": computes the evidence for each verdict."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import labkit as lk
from labkit import metrics
from solutions.study.tuning import tune
from solutions.study.workspace_impedance import WorkspaceImpedance

from .claims import holds, shows
from .page import number, numbers

SEED = 6


def paths() -> None:
    """Equations 1 to 15."""
    far, near, v, a = 0.1, 0.01, 0.4, 1.0
    shows("m/s² at 10 cm", 10.0, 100.0 * far)
    shows("m/s² at 1 cm", 1.0, 100.0 * near)
    shows("With 0.4 m/s and 1 m/s² a move of 1 cm", (0.4, 1.0, 1.0), (v, a, 100.0 * near))
    numbers({"a_10": 4.0 * far / (5.0 * far) ** 2, "a_1": 4.0 * near / (5.0 * near) ** 2})
    duration = lk.BangBang.within(near, v, a).duration
    holds(abs(4.0 * near / duration**2) < 1.0 + 1e-9, "with both limits the acceleration is kept")
    number("t_1", duration, ".2g")

    # Equation 4 at t = 0, for a start at x = 0.6 m, 0.2 m to go in 1 s
    x, a = 0.6, 4.0 * 0.2 / 1.0**2
    shows("A start at 0.60 m with $a = 0.8$ m/s²", (0.60, 0.8), (x, a))
    number("p_printed", a * x, ".2f")

    # Equation 8 at half time, theta_0 = 0.7 rad, radius 0.2 m
    theta_0, r, tau = 0.7, 0.2, 4.0
    shows("With $\\theta_0 = 0.7$ rad the angle jumps by", 0.7, theta_0)
    shows("on a radius of 0.2 m", 0.2, r)
    shows("A second into a circle of 0.2 m in 4 s", (0.2, 4.0), (r, tau))

    def alpha(t: float) -> float:
        return 8.0 * np.pi / tau**2 * (1.0 if t <= tau / 2 else -1.0)

    def theta_printed(t: float) -> float:
        if t <= tau / 2:
            return 0.5 * alpha(t) * t**2 + theta_0
        late = t - tau / 2
        omega = alpha(0.0) * tau / 2
        half = theta_printed(tau / 2)
        return half + 0.5 * alpha(t) * late**2 + omega * late + theta_0

    jump = theta_printed(tau / 2 + 1e-9) - theta_printed(tau / 2)
    holds(abs(jump - theta_0) < 1e-6, "the printed angle jumps by theta_0")
    numbers({"jump_rad": jump, "jump_m": 2.0 * r * np.sin(theta_0 / 2.0)})

    # Equation 10 against the slope of equation 11
    def velocity(t: float) -> np.ndarray:
        theta, omega = 0.5 * alpha(t) * t**2, alpha(t) * t
        return r * omega * np.array((-np.sin(theta), np.cos(theta)))

    t, h = 1.0, 1e-6
    slope = (velocity(t + h) - velocity(t - h)) / (2.0 * h)
    theta, omega, a = 0.5 * alpha(t) * t**2, alpha(t) * t, alpha(t)
    bracket = np.array(
        (
            -a * np.sin(theta) - omega**2 * np.cos(theta),
            a * np.cos(theta) - omega**2 * np.sin(theta),
        )
    )
    right, printed = r * bracket, -r * omega**2 * bracket
    holds(np.abs(right - slope).max() < 1e-6, "the repaired equation 10 is the slope of v")
    holds(np.abs(printed - slope).max() > 0.5, "the printed equation 10 is not")
    numbers({"a10_right": np.linalg.norm(right), "a10_printed": np.linalg.norm(printed)})

    # Equations 14 and 15: four segments of 1 s, half a second into the first
    holds(0.5 - sum([1.0]) < 0.0, "the printed time on the segment is negative")


def recursion() -> None:
    """Equation 17 on the ideal arm: add the correction to the measured speed."""
    q0 = lk.robot("left").ready
    beside = 0.02  # small enough to stay below the speed limit
    shows("a joint 0.02 rad off rings", 0.02, beside)
    goal = q0 + beside * np.eye(7)[0]

    def printed(state: lk.State, target: lk.Sample) -> lk.JointVelocity:
        e, de = target.position - state.q, target.velocity - state.dq
        return lk.JointVelocity(state.dq + 3.0 * e + 1e-4 * de)

    with lk.Arm("left", lk.IDEAL, q0=q0) as arm:
        log = lk.run(arm, lk.Hold(goal, 5.0), printed)
    e = np.abs(metrics.joint_error(log)[:, 0])
    left = e[log.t > 4.5].max() / 0.02
    crossings = np.flatnonzero(np.diff(np.sign(metrics.joint_error(log)[:, 0])))
    early = crossings[log.t[crossings] < 1.0]
    omega = np.pi * (len(early) - 1) / (log.t[early[-1]] - log.t[early[0]])
    holds(left > 1.0, "the ringing of the printed recursion grows in five seconds")
    holds(abs(omega - np.sqrt(600.0)) < 1.5, "and rings near sqrt(600) rad/s")
    numbers({"ring_left": 100.0 * left, "ring_omega": omega})


def gravity() -> None:
    """Compare the formula G = M J^T (0, 0, 0.981, 0, 0, 0) with the torque that holds the arm."""
    model = lk.Model("left")
    random = np.random.default_rng(SEED)
    ready = np.array(model.robot.ready)
    shares = []
    for _ in range(50):
        q = np.clip(ready + random.uniform(-0.3, 0.3, 7), model.robot.lower, model.robot.upper)
        guess = model.mass_matrix(q) @ model.tip_jacobian(q).T[:, 2] * 0.981
        g = model.gravity(q)
        shares.append(float(np.linalg.norm(guess) / np.linalg.norm(g)))
    holds(max(shares) < 0.1, "its length is less than a tenth of that of $g(q)$")


def impedance() -> None:
    """Equations 19 and 21, and whether impedance needs a force sensor."""
    # Equation 19 in one dimension, 2 kg, M_d = M, at rest on the target, pushed by 5 N
    mass, push = 2.0, 5.0
    shows("One dimension, 2 kg, at rest on the target, pushed with 5 N", (2.0, 5.0), (mass, push))
    desired = push / mass
    law = push + mass * push  # the two terms with F_ext; all others vanish here
    printed = (law + push) / mass  # the push is on the arm
    turned = (law - push) / mass  # F_ext is the force of the arm on the world
    shows("Read as the push on the arm, +5 N", 5.0, push)
    shows("the arm is pushed with −5 N", -5.0, -push)
    shows("where −2.5 m/s² is wanted", -2.5, -desired)
    holds(
        abs(printed - desired) > 1.0 and abs(turned + desired) > 1.0 and (printed > 0.0),
        "Neither is what it should be",
    )
    numbers({"a19_right": desired, "a19_printed": printed, "a19_turned": turned})

    plant = replace(lk.IDEAL, name="ideal with rotors", armature=lk.BAXTER.armature)
    model = lk.Model("left", plant)
    q0 = model.robot.ready
    T_wd = model.pose(q0)
    beside, lasts, gone_at = 0.002, 2.0, 0.1
    shows("From 2 mm beside the target", 2.0, 1e3 * beside)
    shows("mm within 2 s with", 2.0, lasts)
    shows("it is 10 cm away after", 10.0, 100.0 * gone_at)
    T_off = lk.se3.pose(T_wd[:3, :3], T_wd[:3, 3] + np.array((beside, 0.0, 0.0)))
    start = model.inverse_kinematics(T_off, q0)
    K = np.array((300.0, 300.0, 300.0, 20.0, 20.0, 20.0))
    D = np.array((60.0, 60.0, 60.0, 4.0, 4.0, 4.0))
    gone = {}
    for sign in (1.0, -1.0):

        def law(state: lk.State, target: lk.PoseSample, sign: float = sign) -> lk.JointTorque:
            J = model.tip_jacobian(state.q)
            e = model.pose_error(target.pose, state.q)
            F = sign * K * e - D * (J @ state.dq)
            return lk.JointTorque(J.T @ F + model.bias(state.q, state.dq))

        with lk.Arm("left", plant, q0=start) as arm:
            try:
                log = lk.run(arm, lk.Hold(T_wd, lasts), law, rate=1000)
            except lk.errors.Diverged as error:
                log = error.log
        off = np.linalg.norm(metrics.tip_error(log)[:, :3], axis=1)
        gone[sign] = (
            1e3 * off[-1],
            log.t[np.argmax(off > gone_at)] if off.max() > gone_at else np.inf,
        )
    holds(gone[1.0][0] < 1.0, "with the right sign of stiffness the tip comes back")
    holds(gone[-1.0][1] < 2.0, "with the printed sign the tip is driven away")
    numbers({"k_back": gone[1.0][0], "k_away": gone[-1.0][1]}, ".2g")

    # A push, measured by no one: M_d = Lambda
    force = np.array((0.0, 10.0, 0.0))
    shows("pushed with 10 N it moved", 10.0, force[1])
    world = lk.World(things=[lk.Push(force=force)])
    with lk.Arm("left", plant, q0=q0, world=world) as arm:
        law_2 = WorkspaceImpedance(model, K=K)
        log = lk.run(arm, lk.Hold(T_wd, 3.0), law_2, rate=1000)
    moved = -metrics.tip_error(log)[-1, :3]
    stiffness = float(force[1] / moved[1])
    holds(abs(stiffness / 300.0 - 1.0) < 0.02, "the arm is as stiff as commanded, sensor or not")
    procedure = tune(0, lk.BAXTER)
    number("procedure_rigid", procedure.Kp, ".2g")
    (half,) = (step.decay for step in procedure.steps if step.why == "half of that")
    number("left_rigid", half, ".1g")
    holds(half > 0.4, "the rule's quarter is not found")
    numbers({"felt": stiffness, "moved_mm": 1e3 * moved[1]})
