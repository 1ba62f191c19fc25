"""Two checks of the simulated arm that can fail: MuJoCo's own friction, and half the step.

labkit computes friction, rotors and motors itself, and an engine integrates what they do to the
links.  So two engines that agree say nothing about friction.  Here MuJoCo computes all of it.
"""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from labkit import BAXTER, Arm, Log, Model, State, World, metrics, run

from . import tasks
from .gains import course_controllers

CALM = replace(BAXTER, state_rate=0.0, state_delay=0.0, velocity_noise=0.0, lost_ticks=0.0)
"""Baxter's arm with exact and fresh states, so that chance has no part in a run."""
SOLREF, SOLIMP = (2e-3, 1.0), (0.95, 0.99, 1e-4, 0.5, 2.0)
"""How hard MuJoCo's dry friction is, which it makes a soft constraint; the default creeps."""


def lab(controller: str, dt: float = 1e-3) -> Log:
    """The line of the campaign, seed 0, on the lab's arm, with physics steps of ``dt`` [s]."""
    task, tuned = tasks.line(), course_controllers(Model("left", BAXTER))[controller]
    with Arm("left", CALM, q0=task.start(0), world=World(dt)) as arm:
        return run(arm, task.joints, tuned.controller, rate=tuned.rate)


def mujoco_alone(controller: str, dt: float = 1e-3) -> Log:
    """The same run where MuJoCo computes rotors, friction and the arm's gravity compensation.

    Args:
        controller: A controller of joint torques that follows joint angles.
        dt: The physics step, in [s].

    Returns:
        The log of `lab` with these joint angles.
    """
    log, target = lab(controller, dt), tasks.line().joints
    law, robot = course_controllers(Model("left", BAXTER))[controller].controller, log.robot
    arm = _arm(dt)
    data, steps, angles = mujoco.MjData(arm), round((log.t[1] - log.t[0]) / dt), []
    data.qpos[:] = log.q[0]
    for t in log.t:
        angles.append(data.qpos.copy())
        tau = law(State(t, angles[-1], data.qvel.copy()), target(t)).value
        data.qfrc_applied[:] = np.clip(tau, -robot.effort, robot.effort)
        mujoco.mj_step(arm, data, steps)
    return replace(log, q=np.array(angles))


def _arm(dt: float) -> mujoco.MjModel:
    """Baxter's arm; friction and rotors must be given before the model is compiled."""
    robot = Model("left").robot
    spec = mujoco.MjSpec.from_string(robot.urdf(CALM))
    spec.option.timestep = dt
    rotor, viscous, dry = (CALM.each(x, robot.n) for x in ("armature", "viscous", "stiction"))
    for k, joint in enumerate(spec.joints):
        joint.armature, joint.damping[0], joint.frictionloss = rotor[k], viscous[k], dry[k]
        joint.solref_friction, joint.solimp_friction = SOLREF, SOLIMP
    for body in spec.bodies[1:]:
        body.gravcomp = 1.0
    return spec.compile()


def rms(log: Log) -> float:
    """The RMS position error of the tip, in [mm]."""
    return 1e3 * metrics.rms(metrics.tip_error(log)[:, :3])
