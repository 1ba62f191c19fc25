"""Experiments on impedance: push the arm, let it run into a wall, tie it to a spring.

Each experiment makes the same contenders do the same and returns frozen results for figures.  The
contenders are a stiff position controller, computed torque, and the two impedance controllers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import (
    IDEAL,
    Arm,
    Hold,
    JointPosition,
    Line,
    Log,
    Model,
    Plant,
    PosePath,
    Push,
    Quintic,
    Sample,
    Spring,
    State,
    Trajectory,
    Wall,
    World,
    metrics,
    run,
)
from labkit.scene import TIP_RADIUS, contact_stiffness
from labkit.shapes import Array, locked
from labkit.world import Thing

from .gains import Candidate, course_controllers

CONTENDERS = ("position", "joint torque", "joint impedance", "workspace impedance")


@dataclass(frozen=True, eq=False)
class Encounter:
    """The run of one contender in an experiment.

    Attributes:
        name: The name of the controller.
        t: Time, shape (N,) in [s].
        displacement: Actual minus target position of the tip, world axes, shape (N, 3) in [m].
        turn: Actual minus target orientation, world axes, shape (N, 3) in [rad].
        wrench: The wrench on the arm by its torque sensors, world axes, shape (N, 6) in [N], [N m].
        log: The run.
    """

    name: str
    t: Array
    displacement: Array
    turn: Array
    wrench: Array
    log: Log

    @property
    def at_rest(self) -> Array:
        """Mean displacement over the last tenth of the run, shape (3,) in [m]."""
        return np.asarray(self.displacement[-max(1, len(self.t) // 10) :].mean(axis=0))

    @property
    def force_at_rest(self) -> Array:
        """Mean force over the last tenth of the run, shape (3,) in [N]."""
        return np.asarray(self.wrench[-max(1, len(self.t) // 10) :, :3].mean(axis=0))


def push(
    force: Any = (0.0, 10.0, 0.0),
    *,
    moment: Any = (0.0, 0.0, 0.0),
    duration: float = 3.0,
    rest: float = 0.0,
    plant: Plant = IDEAL,
    seed: int = 0,
    names: tuple[str, ...] = CONTENDERS,
) -> tuple[Encounter, ...]:
    """Push the arm while its target is to stay where it is.

    Args:
        force: The force on the tip, world axes, shape (3,) in [N].
        moment: The moment on the tip, world axes, shape (3,) in [N m].
        duration: The duration of the push, in [s].
        rest: How long the run continues after the push, in [s].
        plant: The plant to drive.
        seed: The seed of the noise.
        names: The contenders to compare.
    """
    things = (Push(force, moment, duration=duration),)
    return _meet(things, lambda T: Hold(T, duration + rest), plant, seed, names)


def wall(
    *,
    gap: float = 0.05,
    beyond: float = 0.03,
    stiffness: float = 5_000.0,
    plant: Plant = IDEAL,
    seed: int = 0,
    names: tuple[str, ...] = CONTENDERS,
) -> tuple[Encounter, ...]:
    """Send the tip along x to a place behind a wall, in 2 s, and wait there for 2 s.

    Args:
        gap: The distance from the tip's ball to the wall, in [m].
        beyond: How far beyond the point of contact the target ends, in [m].
        stiffness: The stiffness of the wall alone, in [N/m].
        plant: The plant to drive.
        seed: The seed of the noise.
        names: The contenders to compare.
    """
    face = the_wall(gap, stiffness)
    way = (gap + beyond) * np.eye(3)[0]
    return _meet((face,), lambda T: _there(T, way), plant, seed, names)


def the_wall(gap: float = 0.05, stiffness: float = 5_000.0) -> Wall:
    """The wall of the experiment, facing the ready arm's tip."""
    p = Model().pose(Model().robot.ready)[:3, 3]
    point = p + (gap + TIP_RADIUS) * np.eye(3)[0]
    return Wall(point, (-1.0, 0.0, 0.0), size=(0.3, 0.3), stiffness=stiffness)


def predicted_wall_force(face: Wall, K: float, beyond: float) -> float:
    """The force in [N] of a tip with stiffness ``K`` [N/m]: tip and wall are springs in series."""
    return beyond / (1.0 / K + 1.0 / contact_stiffness(face))


def spring(
    *,
    stiffness: float = 200.0,
    way: float = 0.1,
    plant: Plant = IDEAL,
    seed: int = 0,
    names: tuple[str, ...] = CONTENDERS,
) -> tuple[Encounter, ...]:
    """Tie the tip to where it starts and send it away along y, in 2 s, then wait for 2 s.

    Args:
        stiffness: The stiffness of the spring, in [N/m].
        way: The length of the motion, in [m].
        plant: The plant to drive.
        seed: The seed of the noise.
        names: The contenders to compare.
    """
    anchor = Model().pose(Model().robot.ready)[:3, 3]
    return _meet(
        (Spring(anchor, stiffness),),
        lambda T: _there(T, way * np.eye(3)[1]),
        plant,
        seed,
        names,
    )


def position(state: State, target: Sample) -> JointPosition:
    """Baxter's position mode, which is as stiff as the motors are strong."""
    return JointPosition(target.position)


def _contender(name: str, model: Model) -> Candidate:
    if name == "position":
        return Candidate(position, 200.0, True)
    return course_controllers(model)[name]


def _there(T_wt: Array, way: Array) -> Trajectory:
    line = Line(T_wt[:3, 3], T_wt[:3, 3] + way)
    return Trajectory(PosePath(line, T_wt[:3, :3]), Quintic(2.0))


def _meet(
    things: tuple[Thing, ...], make_target: Any, plant: Plant, seed: int, names: tuple[str, ...]
) -> tuple[Encounter, ...]:
    model = Model("left", plant)
    ready = model.robot.ready
    target = make_target(model.pose(ready))
    wait = 2.0 if isinstance(target, Trajectory) else 0.0
    out = []
    for name in names:
        tuned = _contender(name, model)
        goal = tuned.target(model, target, ready)
        with Arm("left", plant, seed, q0=ready, world=World(things=things)) as arm:
            log = run(arm, goal, tuned.controller, tuned.rate, target.duration + wait)
        off = -metrics.tip_error(log, model)
        wrench = locked(metrics.felt_wrench(log, model))
        out.append(Encounter(name, log.t, locked(off[:, :3]), locked(off[:, 3:]), wrench, log))
    return tuple(out)
