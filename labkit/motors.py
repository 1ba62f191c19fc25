"""The motors: what each kind of command makes them do, physics step by physics step."""

from __future__ import annotations

from operator import le

import numpy as np

from .control import NOTHING, Command, JointPosition, JointTorque, JointVelocity
from .model import Model
from .plant import Plant
from .shapes import Array
from .sim import Engine

BRAKING = 0.5
"""Share of the torque left by gravity that the position mode plans to brake with."""


class Motors:
    """The motors of one arm, with limits of speed and torque.

    Attributes:
        kind: Type of the command that they follow: their mode.
        saturated: Whether a limit cut the command, at any time since it came.
        needs_angles: Whether `drive` must know the joints' angles in this mode.
    """

    kind: type = type(None)
    saturated = False
    needs_angles = False

    def __init__(self, engine: Engine, arm: int, dt: float, plant: Plant, own: Model) -> None:
        """Take over the motors of an arm.

        Args:
            engine: What moves it.
            arm: Its number there.
            dt: The physics step, in [s].
            plant: Lag, dry friction and gravity compensation.
            own: What the arm knows of itself: its own weight, not what it carries.
        """
        self._engine, self._arm, self._dt, self._plant, self._own = engine, arm, dt, plant, own
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
            self.needs_angles = compensated or self.kind is JointPosition
            if self.kind is JointTorque:  # the engine's motors have one duty left: dry friction
                self._engine.spin(self._arm, NOTHING, list(self._plant.stiction))
            else:
                self._lagged = self._engine.state(self._arm)[1]
        self._fresh = True

    def drive(self, q: Array) -> None:
        """Set speeds or torques for the next physics step.

        Args:
            q: The joints' angles, if they are needed, shape (7,) in [rad].
        """
        if self.kind is JointTorque:
            if self._plant.gravity_compensation:  # it carries its own weight
                wanted = self._wanted + self._own.gravity(q)
                self._total, cut = _cut(wanted, self._effort)
                self.saturated |= cut
            elif self._fresh:
                self._total = self._wanted
            self._engine.drive(self._arm, self._total)
        elif self.kind is JointPosition:
            self._spin(self._approach(q))
        elif self._plant.velocity_lag:
            share = min(1.0, self._dt / self._plant.velocity_lag)
            self._lagged += (self._wanted - self._lagged) * share
            self._spin(self._lagged)
        elif self._fresh:  # the engine's motors keep their target
            self._spin(self._wanted)
        self._fresh = False

    def torque(self, given: Array) -> Array:
        """What the motors gave in the last physics step, shape (7,) in [N m].

        Args:
            given: What the engine's motors gave, which in torque mode are dry friction.
        """
        return self._total if self.kind is JointTorque else given

    @property
    def driven(self) -> Array:
        """Torque that drives the joints beside the engine's motors, shape (7,) in [N m]."""
        return self._total if self.kind is JointTorque else NOTHING

    def _approach(self, q: Array) -> Array:
        """Speeds towards the wanted angles, from which the motors can still brake before them.

        Braking evenly from v takes v^2 / 2a (Lynch & Park, section 9.2.2).
        """
        if self._fresh:
            M, g = self._own.mass_matrix(q), self._own.gravity(q)
            self._braking = BRAKING * (self._own.robot.effort - np.abs(g)) / M.diagonal()
        gain = min(self._plant.position_gain or np.inf, 1.0 / self._dt)
        gap = self._wanted - q
        stops = np.sqrt(2.0 * self._braking * np.abs(gap))
        allowed, cut = _cut(np.clip(gain * gap, -stops, stops), self._speed)
        self.saturated |= cut
        return allowed

    def _spin(self, speeds: Array) -> None:
        """Hold these speeds with whatever torque it takes, up to the limits."""
        self._engine.spin(self._arm, speeds, self._effort)


def _cut(x: Array, limit: list[float]) -> tuple[Array, bool]:
    """``x`` within ±limit, and whether that changed it."""
    if all(map(le, map(abs, x.tolist()), limit)):  # a fifth of the time that NumPy takes for seven
        return x, False
    return np.clip(x, np.negative(limit), limit), True
