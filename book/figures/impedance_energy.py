"""Chapter "Impedance": the freedom of the elbow, and the conditions of passivity."""

from __future__ import annotations

import math
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from scipy.linalg import eigh

import labkit as lk
from labkit import metrics, se3
from labkit.plotting import curve
from labkit.shapes import Array
from solutions.study import tasks
from solutions.study.gains import TIP_SPRING
from solutions.study.workspace_impedance import WorkspaceImpedance

from .claims import holds, shows
from .impedance import ROTORS
from .page import figure, number, numbers


@dataclass(frozen=True, eq=False)
class Undamped:
    """The impedance law without the damper of its posture term."""

    law: WorkspaceImpedance

    def __call__(self, state: lk.State, target: lk.PoseSample) -> lk.JointTorque:
        """The command, with the damper's torque taken out of it again."""
        model = self.law.model
        J, M = model.tip_jacobian(state.q), model.mass_matrix(state.q)
        damper = -2.0 * np.sqrt(self.law.pull) * state.dq
        L = np.linalg.inv(J @ np.linalg.solve(M, J.T))
        out = M @ damper - J.T @ (L @ (J @ damper))
        return lk.JointTorque(self.law(state, target).value - out)


def elbow() -> HTML:
    """The elbow starts away from its posture: with a damper it returns, without one it swings."""
    model = lk.Model("left", ROTORS)
    ready = np.array(model.robot.ready)
    start = np.array(ready)
    for _ in range(40):  # turn the elbow while the hand stays
        J = model.tip_jacobian(start)
        turn = np.eye(7)[2] - np.linalg.pinv(J) @ J[:, 2]
        start += 0.005 * turn / turn[2] + np.linalg.pinv(J) @ model.pose_error(
            model.pose(ready), start
        )
    law = WorkspaceImpedance(model, K=TIP_SPRING)
    _, ax = plt.subplots(figsize=(6.0, 2.9))
    late, moved = [], []
    for k, (one, name) in enumerate(((law, "posture and damper"), (Undamped(law), "no damper"))):
        with lk.Arm("left", ROTORS, q0=start) as arm:
            log = lk.run(arm, lk.Hold(model.pose(ready), 6.0), one, rate=1000.0)
        off = log.q[:, 2] - ready[2]
        ax.plot(log.t, off, **curve(k), label=name)
        late.append(float(np.abs(off[log.t > 4.0]).max()))
        moved.append(1e3 * float(np.linalg.norm(metrics.tip_error(log)[:, :3], axis=1).max()))
    holds(
        late[1] > 0.15 and 0.0 <= late[0] < 0.01 * late[1], "Without the damper the elbow swings on"
    )
    holds(
        math.isclose(law.pull, 4.5**2, rel_tol=0.02),
        "asks for an acceleration of 20 rad/s² for each radian from the posture, so an",
    )
    numbers({"elbow_late": late[1]}, ".2g")
    number("elbow_tip", moved[1], ".1g")
    ax.set(xlabel="time [s]", ylabel="e0 from its posture [rad]", ylim=(-0.24, 0.32))
    ax.legend(ncols=2, loc="upper right")
    return figure(
        "The elbow, released 0.2 rad from its posture while the hand stays. Without friction or a "
        "damper it swings on.",
        f"With a damper in the null space e0 returns within a second; without one it still swings "
        f"by {late[1]:.2g} rad after four. The hand moves by {moved[1]:.1g} mm at most.",
    )


def margins() -> None:
    """The part of the damper that the changing inertia can cancel on three paths, and mu."""
    model = lk.Model("left", lk.BAXTER)
    law = WorkspaceImpedance(model, K=TIP_SPRING)
    share, least, fastest = {}, math.inf, 0.0
    for task in (tasks.line(), tasks.circle(), tasks.square()):
        found = []
        for t in np.linspace(0.01, task.joints.duration - 0.01, 60):
            s = task.joints(float(t))
            D = law._damper(np.array(model.operational_inertia(s.position)))
            least = min(least, float(np.linalg.eigvalsh(D)[0]))
            rate = _rate(model.operational_inertia, s.position, s.velocity)
            tip = (model.tip_jacobian(s.position) @ s.velocity)[:3]
            fastest = max(fastest, float(np.linalg.norm(tip)))
            found.append(float(eigh(0.5 * rate, D, eigvals_only=True)[-1]))
        share[task.name] = max(found)
    numbers({"eaten_circle": 100 * share["circle"], "eaten_square": 100 * share["square"]}, ".2g")
    holds(
        0.0 < max(share.values()) < 0.5 and least > 0.3 and (0.1 < fastest < 0.205),
        "At 0.2 m/s and less this holds everywhere on the line, the circle and the",
    )
    holds(1.0 < 4.0 * share["square"] < 4.0, "four times as fast has lost the guarantee")
    random, worst, without = np.random.default_rng(1), 0.0, 0.0
    for _ in range(10):
        q = np.array(model.robot.ready) + random.uniform(-0.4, 0.4, 7)
        dq = random.uniform(-1.0, 1.0, 7)
        J, M = model.tip_jacobian(q), model.mass_matrix(q)
        L = np.array(model.operational_inertia(q))
        Jbar = np.linalg.solve(M, J.T) @ L
        turning = L @ _rate(model.tip_jacobian, q, dq) @ Jbar
        S = _rate(model.operational_inertia, q, dq) - 2.0 * Jbar.T @ model.coriolis(q, dq) @ Jbar
        without = max(without, float(np.abs(S + S.T).max()))  # mu for a constant J
        S += 2.0 * turning
        worst = max(worst, float(np.abs(S + S.T).max()))
    holds(
        round(worst, 5) == 0.0 and 20.0 < without < 60.0,
        "is skew for this $\\mu$, as a check on ten random states confirms",
    )


def _rate(of: object, q: Array, dq: Array, h: float = 1e-6) -> Array:
    """The time derivative of a matrix that depends on q, along dq."""
    return (np.array(of(q + h * dq)) - np.array(of(q - h * dq))) / (2.0 * h)  # type: ignore[operator]


def loops() -> None:
    """The work around a closed loop of orientations, with unequal rotational stiffness."""
    unequal, equal = np.diag((10.0, 20.0, 30.0)), 20.0 * np.eye(3)
    shows("say 10, 20 and 30 N m/rad", (10.0, 20.0, 30.0), np.diag(unequal))

    def log_law(R: Array, K: Array) -> Array:
        return np.asarray(K @ se3.rotation_log(R.T))

    def vector_law(R: Array, K: Array) -> Array:
        e = se3.rotation_log(R.T)
        half = 0.5 * float(np.linalg.norm(e))
        eps = e / (2.0 * half) * math.sin(half)
        return np.asarray(2.0 * (math.cos(half) * np.eye(3) - se3.hat(eps)) @ K @ eps)

    def work(law: object, K: Array, count: int = 1500) -> float:
        s = 2.0 * np.pi * np.arange(2 * count + 1) / (2 * count)
        R = [se3.rotation(np.array((0.5 * np.cos(x), 0.5 * np.sin(x), 0.6))) for x in s]
        return -sum(
            float(law(R[k + 1], K) @ se3.rotation_log(R[k + 2] @ R[k].T))  # type: ignore[operator]
            for k in range(0, 2 * count, 2)
        )

    gained = work(log_law, unequal)
    number("loop_work", gained, ".2g")
    holds(
        gained > 5.0
        and max(abs(work(log_law, equal)), abs(work(vector_law, unequal))) < 0.001 * gained,
        "and with the vector part of the quaternion it is zero",
    )
