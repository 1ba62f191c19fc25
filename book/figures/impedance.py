"""Chapter "Impedance"."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from scipy.integrate import solve_ivp
from scipy.linalg import expm, sqrtm

import labkit as lk
from labkit import metrics
from labkit.plotting import curve
from labkit.scene import contact_stiffness
from solutions.study import experiments
from solutions.study.gains import TIP_SPRING
from solutions.study.workspace_impedance import WorkspaceImpedance

from .claims import holds, shows
from .page import Question, figure, number, numbers, quiz, replay

SEED = 7
PUSH, BEGINS = 10.0, 0.5
ROTORS = replace(lk.IDEAL, name="ideal with rotors", armature=lk.BAXTER.armature)
TURN = 20.0
"""Rotational stiffness of the hand, in N m/rad."""


def one_mass() -> HTML:
    """A mass on a spring that is pushed for a while, with three dampings."""
    m, k, push = 2.0, 200.0, 10.0
    t = np.linspace(0.0, 3.0, 1201)
    _, ax = plt.subplots(figsize=(6.0, 3.0))
    told = []
    for j, zeta in enumerate((0.2, 1.0, 3.0)):
        b = 2.0 * zeta * np.sqrt(k * m)

        def slope(s: float, y: np.ndarray, b: float = b) -> list[float]:
            return [y[1], (push * (s < 1.5) - b * y[1] - k * y[0]) / m]

        x = solve_ivp(slope, (0.0, 3.0), [0.0, 0.0], t_eval=t, max_step=0.005).y[0]
        ax.plot(t, 1e3 * x, **curve(j), label=f"ζ = {zeta:g}")
        told.append(f"{zeta:g}: {1e3 * x.max():.0f} mm at most")
    ax.axhline(1e3 * push / k, color="C5", linestyle=":")
    ax.text(2.7, 1e3 * push / k + 2, "F / k", fontsize="small")
    ax.set(xlabel="time [s]", ylabel="displacement [mm]", ylim=(None, 115))
    ax.legend(ncols=3)
    return figure(
        "2 kg on a spring of 200 N/m, pushed with 10 N until 1.5 s. If damped little, it swings.",
        f"Displacement: pushed, it tends to 50 mm, released, to zero. Peaks: {'; '.join(told)}.",
    )


@cache
def push_run(
    stiffness: float, plant: lk.Plant = ROTORS, force: float = PUSH, seed: int = SEED
) -> lk.Log:
    """A hand pushes the tip sideways from 0.5 s to 2 s."""
    model = lk.Model("left", plant)
    q0 = model.robot.ready
    K = np.array((stiffness,) * 3 + (TURN,) * 3)
    law = WorkspaceImpedance(model, K=K, gravity=not plant.gravity_compensation)
    world = lk.World(things=[lk.Push(force=(0.0, force, 0.0), start=BEGINS, duration=1.5)])
    rate = 200.0 if plant.state_rate else 1000.0
    with lk.Arm("left", plant, seed, q0=q0, world=world) as arm:
        return lk.run(arm, lk.Hold(model.pose(q0), 3.5), law, rate=rate)


def _sideways(log: lk.Log) -> np.ndarray:
    return -1e3 * metrics.tip_error(log)[:, 1]


def _linear(stiffness: float, seconds: float) -> float:
    """The apparent stiffness [N/m] by the law's linear equation, some time after a push began."""
    model = lk.Model("left", ROTORS)
    L = np.array(model.operational_inertia(model.robot.ready))
    K = np.diag((stiffness,) * 3 + (TURN,) * 3)
    cross = np.real(sqrtm(L)) @ np.sqrt(K)
    inverse = np.linalg.inv(L)
    A = np.block([[np.zeros((6, 6)), np.eye(6)], [-inverse @ K, -inverse @ (cross + cross.T)]])
    pushed = np.append(np.zeros(6), inverse[:, 1] * PUSH)
    state = np.linalg.solve(A, (expm(A * seconds) - np.eye(12)) @ pushed)
    return PUSH / float(state[1])


def push() -> HTML:
    """The arm yields to a push like the commanded spring."""
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    told, found = [], []
    told_to_be, read_at = (150.0, 300.0, 600.0), 1.95
    shows("a spring of 150, 300 and 600 N/m", (150.0, 300.0, 600.0), told_to_be)
    shows("read 1.45 s into the push", 1.45, read_at - BEGINS)
    for k, stiffness in enumerate(told_to_be):
        log = push_run(stiffness)
        y = _sideways(log)
        felt = 1e3 * PUSH / float(np.interp(read_at, log.t, y))
        found.append(felt)
        ax.plot(log.t, y, **curve(k), label=f"{stiffness:g} N/m")
        told.append(f"commanded {stiffness:g} N/m, felt {felt:.4g} N/m")
        number(f"felt_{stiffness:.0f}", felt, ".4g")
        number(f"linear_{stiffness:.0f}", _linear(stiffness, read_at - BEGINS), ".4g")
    shows("Look at the curve for 600 N/m", 600.0, told_to_be[-1])
    creeps = np.interp((0.7, 0.85, read_at), log.t, y)  # of the stiffest
    first, then, last = creeps
    holds(then < 0.99 * first < first < 0.9 * last, "it rises, falls back and creeps")
    above = max(x / k for x, k in zip(found, told_to_be, strict=True)) - 1.0
    shows("They are up to 2.2 % above what was asked", 2.2, 100.0 * above, 0.02)
    holds(
        all(0.95 < x / k < 1.05 for x, k in zip(found, told_to_be, strict=True)),
        "an arm without friction shows",
    )
    real = push_run(300.0, lk.BAXTER)
    y = _sideways(real)
    ax.plot(real.t, y, "C4:", label="300 N/m, realistic arm")
    felt = 1e3 * PUSH / float(np.interp(read_at, real.t, y))
    ends = [abs(_sideways(push_run(300.0, lk.BAXTER, PUSH, seed))[-1]) for seed in range(10)]
    left = float(np.mean(ends))
    holds(felt > 330.0 and left > 0.5, "holds against small forces")
    numbers({"left_real": left, "left_real_sd": np.std(ends, ddof=1)}, ".1f")
    ax.set(xlabel="time [s]", ylabel="displacement [mm]")
    ax.legend(fontsize="small")
    return figure(
        "A push of 10 N sideways on the tip, from 0.5 s to 2 s, which no sensor measures. Friction "
        "(dotted) lets the hand move less than its 300 N/m would (dashed).",
        f"Displacement over time: {'; '.join(told)}. The realistic arm, told 300 N/m, moves less, "
        f"as if {felt:.3g} N/m, and stays {left:.2g} mm off when released.",
    )


def two_pushes() -> None:
    """The realistic arm, pushed with 10 N and with 20 N: results of each push and of both."""
    forces, asked, read_at = (PUSH, 2.0 * PUSH), 300.0, 1.95
    ten = [[push_run(asked, lk.BAXTER, force, seed) for force in forces] for seed in range(10)]
    far = np.array([[np.interp(read_at, x.t, _sideways(x)) for x in logs] for logs in ten])
    shows("10 N and 20 N", (10.0, 20.0), forces)
    stiffness = 1e3 * np.array(
        [*(np.array(forces) / far).T, (forces[1] - forces[0]) / np.ptp(far, 1)]
    )
    names = ("alone_first", "alone_second", "two_slope")
    for name, values in zip(("two_first", "two_second"), far.T, strict=True):
        numbers({name: values.mean(), f"{name}_sd": values.std(ddof=1)}, ".1f")
    for name, values in zip(names, stiffness, strict=True):
        numbers({name: values.mean(), f"{name}_sd": values.std(ddof=1)}, ".0f")
    first, second, both = stiffness.mean(axis=1)
    holds(asked < both < second < first, "which is nearer to the 300 N/m that were asked for")
    logs = [log for both_logs in ten for log in both_logs]
    moved = [float(np.abs(np.ptp(log.q[:, 1]))) for log in logs]
    turned = [float(np.abs(np.ptp(log.q[:, 2]))) for log in logs]
    holds(
        all(0.0 <= a < 0.05 * b for a, b in zip(moved, turned, strict=True)),
        "here s1 in both pushes",
    )


def push_replay() -> HTML:
    """A 3-D replay of the soft and of the stiff arm."""
    return replay(
        push_run(150.0),
        "A push of 10 N on a soft and a stiff arm",
        "A push at 150 N/m and, see-through, at 600 N/m. The soft hand moves four times as far.",
        label="150 N/m",
        ghosts={"600 N/m": push_run(600.0)},
        force=True,
    )


def wall_replay() -> HTML:
    """A 3-D replay of a run into a wall: the impedance and, see-through, the position mode."""
    soft, stiff = experiments.wall(names=("workspace impedance", "position"))
    return replay(
        soft.log,
        "Into a wall",
        "Workspace impedance and, see-through, the position mode, sent 3 cm into the wall.",
        label="impedance",
        ghosts={stiff.name: stiff.log},
        force=True,
        things=[experiments.the_wall()],
    )


def wall() -> HTML:
    """The force of each controller on a wall."""
    met = experiments.wall()
    wrist = float(abs(met[0].log.tau[-1, 5]))  # of the position mode
    stiff = contact_stiffness(experiments.the_wall())
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    ends = {}
    for k, one in enumerate(met):
        force = -one.wrench[:, 0]
        ax.plot(one.t, force, **curve(k), label=one.name)
        ends[one.name] = float(-one.force_at_rest[0])
    ax.set(xlabel="time [s]", ylabel="force on the wall [N]")
    ax.legend(fontsize="small")
    soft, hard = ends["workspace impedance"], ends["position"]
    expected = experiments.predicted_wall_force(experiments.the_wall(), TIP_SPRING[0], 0.03)
    holds(abs(soft / expected - 1.0) < 0.05, "Two springs in series, the arm's and the contact's")
    holds(
        abs(wrist - 15.0) < 0.01 and 0.0 < hard < 0.5 * (0.03 * stiff),
        "its wrist w1 has reached its limit of torque, 15 N m",
    )
    holds(0.0 < ends["joint torque"] < soft, "Computed torque is soft as well")
    numbers({"contact": stiff, "wall_rigid": 0.03 * stiff}, ".4g")
    numbers(
        {"wall_soft": soft, "wall_expected": expected, "wall_hard": hard,
         "wall_torque": ends["joint torque"]},
        ".2g",
    )  # fmt: skip
    told = ", ".join(f"{name} {force:.3g} N" for name, force in ends.items())
    return figure(
        "The force of four controllers that send the ideal arm 3 cm into a stiff wall. Only the "
        "position mode presses with all that its motors have.",
        f"Force on the wall, by the arm's own torque sensors, over four seconds. At rest: {told}.",
    )


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            "You push with 6 N against an arm of 300 N/m and 40 N s/m and wait. How far does it "
            "go?",
            [
                ("20 mm", "At rest only the spring counts, F / K."),
                ("15 mm", "The damper gives no force at rest."),
                ("It depends on the inertia", "On the way there, yes; not at rest."),
            ],
            0,
        ),
        Question(
            "Which impedance is possible without measuring a force?",
            [
                ("Any", "An inertia other than the arm's own requires the force."),
                (
                    "Any stiffness and damping, with the arm's own inertia",
                    "The law needs only angles and speeds.",
                ),
                ("None", "The push moves the arm, and the spring answers the motion."),
            ],
            1,
        ),
        Question(
            "The spring has the wrong sign: F = −K e, with e = target − actual. What happens?",
            [
                ("The arm is softer", "It is not a spring at all: it pushes away."),
                ("The arm leaves", "The further it goes, the harder it pushes."),
            ],
            1,
        ),
    )
