r"""Identify friction: move the arm, fit friction to the torques, and feed it forward.

On an arm that carries its own weight, the commanded torque of each joint is

.. math:: \tau_i - (M \ddot q + C \dot q)_i = b_i\,\dot q_i + f_i\,\operatorname{sgn} \dot q_i

which is linear in the two unknowns, so least squares finds them (Siciliano, section 7.3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from labkit import BAXTER, Arm, JointTorque, Log, Model, Plant, Sample, State, metrics, run
from labkit.control import Command, Controller
from labkit.shapes import Array

from .gains import course_controllers
from .tasks import Task

MOVING = 0.05
"""Below this speed, in [rad/s], a joint may stick, and its torque does not show its friction."""
WINDOW = 11
"""The number of neighbouring reports to which one cubic is fitted."""
SOFT = 0.01
"""The speed in [rad/s] over which the sign of the target's speed is smoothed."""


@dataclass(frozen=True)
class Swing:
    """A motion that excites every joint with two sines, slow enough not to reach a limit.

    Attributes:
        q0: The joint angles around which the arm swings, shape (n,) in [rad].
        amplitude: The amplitude of each sine, in [rad].
        duration: The duration in [s].
    """

    q0: Array
    amplitude: float = 0.12
    duration: float = 12.0

    def __call__(self, t: float) -> Sample:
        """The joint angles at time ``t`` [s], which grow from rest within two seconds."""
        k = np.arange(len(self.q0))
        rates = 2.0 * np.pi * np.array([0.11 + 0.02 * k, 0.29 - 0.015 * k])
        x, grown = min(t / 2.0, 1.0), np.zeros(3)
        grown[:] = (
            x**3 * (10 - 15 * x + 6 * x**2),
            15 * x**2 * (1 - x) ** 2,
            15 * x * (1 - x) * (1 - 2 * x),
        )
        s, c = np.sin(rates * t), np.cos(rates * t)
        wave, slope, bend = s.sum(axis=0), (rates * c).sum(axis=0), -(rates**2 * s).sum(axis=0)
        return Sample(
            self.q0 + self.amplitude * grown[0] * wave,
            self.amplitude * (grown[1] * wave + grown[0] * slope),
            self.amplitude * (grown[2] * wave + 2.0 * grown[1] * slope + grown[0] * bend),
        )


@dataclass(frozen=True, eq=False)
class Friction:
    """The friction found by least squares.

    Attributes:
        viscous: b, shape (n,) in [N m s/rad].
        dry: f, shape (n,) in [N m].
        speed: The speeds used in the fit, for each joint, in [rad/s].
        torque: The torques that the motion does not explain, for each joint, in [N m].
    """

    viscous: Array
    dry: Array
    speed: tuple[Array, ...]
    torque: tuple[Array, ...]


def excite(plant: Plant = BAXTER, seed: int = 0) -> Log:
    """Let the arm swing under computed torque."""
    model = Model("left", plant)
    law, swing = course_controllers(model, plant)["joint torque"], Swing(model.robot.ready)
    with Arm("left", plant, seed, q0=model.robot.ready) as arm:
        return run(arm, swing, law.controller, rate=law.rate, duration=swing.duration)


def fit(log: Log, model: Model, between: bool = True) -> Friction:
    """Fit the friction to the reports and the commands of the arm, without other knowledge.

    Args:
        log: A run in torque mode of an arm that carries its own weight.
        model: The model of the arm; it must have the arm's rotors.
        between: Whether the torque at a report is the mean of the two commands before and after it.
            A command acts until the next one, so the newer one alone gives a biased fit.
    """
    t, at = np.unique(log.measured.t.round(6), return_index=True)
    step = float(np.median(np.diff(t)))
    even = np.arange(t[0], t[-1], step)
    q = np.column_stack([np.interp(even, t, x) for x in log.measured.q[at].T])
    dq, ddq = (savgol_filter(q, WINDOW, 3, deriv=k, delta=step, axis=0) for k in (1, 2))
    per_report = step / float(np.median(np.diff(log.t)))
    wide = 2 * round(WINDOW // 2 * per_report) + 1  # the same time, as a number of commands
    acted = np.vstack([log.command[:1], 0.5 * (log.command[1:] + log.command[:-1])])
    sent = savgol_filter(acted if between else log.command, wide, 3, axis=0)
    command = np.column_stack([np.interp(even, log.t, x) for x in sent.T])
    moved = np.array(
        [
            model.inverse_dynamics(*row) - model.gravity(row[0])
            for row in zip(q, dq, ddq, strict=True)
        ]
    )
    rest = command - moved
    found, speeds, torques = [], [], []
    for speed, torque in zip(dq.T, rest.T, strict=True):
        use = np.abs(speed) > MOVING
        A = np.column_stack([speed, np.sign(speed)])[use]
        found.append(np.linalg.lstsq(A, torque[use], rcond=None)[0])
        speeds.append(speed[use])
        torques.append(torque[use])
    viscous, dry = np.array(found).T
    return Friction(viscous, dry, tuple(speeds), tuple(torques))


@dataclass(frozen=True, eq=False)
class Compensated:
    """A torque controller with feed-forward of the friction along the target's motion.

    The target's speed is used, not the measured one: it has no noise, and at rest it is zero, so
    that the compensation can never drive the arm by itself.

    Attributes:
        law: A controller that follows joint angles.
        friction: The friction to compensate.
    """

    law: Controller
    friction: Friction

    def __call__(self, state: State, target: Sample) -> Command:
        """The command at this tick."""
        dq = target.velocity
        extra = self.friction.viscous * dq + self.friction.dry * np.tanh(dq / SOFT)
        return JointTorque(self.law(state, target).value + extra)


def compared(
    task: Task, friction: Friction, plant: Plant = BAXTER, seed: int = 0
) -> dict[str, Log]:
    """Run joint impedance along a task, without and with the compensation."""
    law = course_controllers(Model("left", plant), plant)["joint impedance"]
    logs = {}
    for name, one in (
        ("plain", law.controller),
        ("compensated", Compensated(law.controller, friction)),
    ):
        with Arm("left", plant, seed, q0=task.q0) as arm:
            logs[name] = run(arm, task.joints, one, rate=law.rate)
    return logs


def error(log: Log) -> float:
    """RMS position error of the tip, in [mm]."""
    return 1e3 * metrics.rms(metrics.tip_error(log)[:, :3])
