"""The motors: what each kind of command makes them do, physics step by physics step."""

from __future__ import annotations

from operator import le
from typing import Any

import numpy as np

from .control import NOTHING, Command, JointPosition, JointTorque, JointVelocity
from .model import Model
from .plant import Plant
from .quiet import quiet
from .robot import DOF
from .sensors import angles, motor_torques, speeds
from .shapes import Array
from .world import World

with quiet():
    import pybullet as bullet

JOINTS = tuple(range(DOF))
"""PyBullet's numbers of the arm's joints."""

BRAKING = 0.5
"""Share of the torque left by gravity that the position mode plans to brake with."""


class Motors:
    """The motors of one arm, with limits of speed and torque.

    Attributes:
        kind: Type of the command that they follow: their mode.
        saturated: Whether a limit cut the command, at any time since it came.
        needs_rows: Whether `drive` must know the joints' states in this mode.
    """

    kind: type = type(None)
    saturated = False
    needs_rows = False

    def __init__(self, world: World, body: int, plant: Plant, own: Model) -> None:
        """Take over the motors of a body.

        Args:
            world: Where it is.
            body: PyBullet's number of the arm.
            plant: Lag, dry friction and gravity compensation.
            own: What the arm knows of itself: its own weight, not what it carries.
        """
        self._world, self._body, self._plant, self._own = world, body, plant, own
        self._effort, self._speed = own.robot.effort.tolist(), own.robot.speed.tolist()
        self._total = NOTHING

    def follow(self, command: Command) -> None:
        """Follow a command from the next physics step on, cut to the limits."""
        self._wanted, self.saturated = command.value, False
        if type(command) is JointTorque:
            self._wanted, self.saturated = _cut(command.value, self._effort)
        elif type(command) is JointVelocity:
            self._wanted, self.saturated = _cut(command.value, self._speed)
        if type(command) is not self.kind:
            self.kind = type(command)
            self._total = NOTHING
            compensated = self.kind is JointTorque and self._plant.gravity_compensation
            self.needs_rows = compensated or self.kind is JointPosition
            if self.kind is JointTorque:  # PyBullet's motors have one duty left: to be dry friction
                stiction = list(self._plant.stiction)
                self._set(bullet.VELOCITY_CONTROL, targetVelocities=[0.0] * DOF, forces=stiction)
            else:
                rows = bullet.getJointStates(self._body, JOINTS, self._world.client)
                self._lagged = speeds(rows)
        self._fresh = True

    def drive(self, rows: Any) -> None:
        """Set speeds or torques for the next physics step.

        Args:
            rows: The joints' states, if they are needed.
        """
        if self.kind is JointTorque:
            if self._plant.gravity_compensation:  # it carries its own weight
                wanted = self._wanted + self._own.gravity(angles(rows))
                self._total, cut = _cut(wanted, self._effort)
                self.saturated |= cut
            elif self._fresh:
                self._total = self._wanted
            self._set(bullet.TORQUE_CONTROL, forces=self._total.tolist())
        elif self.kind is JointPosition:
            self._spin(self._approach(angles(rows)))
        elif self._plant.velocity_lag:
            share = min(1.0, self._world.dt / self._plant.velocity_lag)
            self._lagged += (self._wanted - self._lagged) * share
            self._spin(self._lagged)
        elif self._fresh:  # PyBullet's motors keep their target
            self._spin(self._wanted)
        self._fresh = False

    def torque(self, rows: Any) -> Array:
        """What the motors gave in the last physics step, shape (7,) in [N m]."""
        return self._total if self.kind is JointTorque else motor_torques(rows)

    @property
    def driven(self) -> Array:
        """Torque that drives the joints beside PyBullet's motors, shape (7,) in [N m]."""
        return self._total if self.kind is JointTorque else NOTHING

    def _approach(self, q: Array) -> Array:
        """Speeds towards the wanted angles, from which the motors can still brake before them.

        Braking evenly from v takes v^2 / 2a (Lynch & Park, section 9.2.2).
        """
        if self._fresh:
            M, g = self._own.mass_matrix(q), self._own.gravity(q)
            self._braking = BRAKING * (self._own.robot.effort - np.abs(g)) / M.diagonal()
        gain = min(self._plant.position_gain or np.inf, 1.0 / self._world.dt)
        gap = self._wanted - q
        stops = np.sqrt(2.0 * self._braking * np.abs(gap))
        allowed, cut = _cut(np.clip(gain * gap, -stops, stops), self._speed)
        self.saturated |= cut
        return allowed

    def _spin(self, speeds: Array) -> None:
        """Hold these speeds with whatever torque it takes, up to the limits."""
        self._set(bullet.VELOCITY_CONTROL, targetVelocities=speeds.tolist(), forces=self._effort)

    def _set(self, mode: int, **targets: list[float]) -> None:
        bullet.setJointMotorControlArray(
            self._body, JOINTS, mode, physicsClientId=self._world.client, **targets
        )


def _cut(x: Array, limit: list[float]) -> tuple[Array, bool]:
    """``x`` within ±limit, and whether that changed it."""
    if all(map(le, map(abs, x.tolist()), limit)):  # a fifth of the time that NumPy takes for seven
        return x, False
    return np.clip(x, np.negative(limit), limit), True
