"""The motors: what they do for each type of command, in each physics step."""

from __future__ import annotations

from operator import le

import numpy as np

from .control import Command, JointPosition, JointTorque, JointVelocity
from .joints import Drive
from .model import Model
from .plant import Plant
from .shapes import Array

BRAKING = 0.5
"""Share of the torque left after gravity with which the position mode plans to brake."""


class Motors:
    """The motors of one arm, with limits of speed and torque.

    Attributes:
        kind: Type of the current command, which is the mode of the motors.
        saturated: Whether a limit has cut the current command at any time.
    """

    kind: type = type(None)
    saturated = False

    def __init__(self, dt: float, plant: Plant, own: Model) -> None:
        """Make the motors of an arm.

        Args:
            dt: The physics step, in [s].
            plant: Lag, dry friction and gravity compensation.
            own: The arm's model of itself, which includes its own weight but not its payload.
        """
        self._dt, self._plant, self._own = dt, plant, own
        self._effort, self._speed = own.robot.effort.tolist(), own.robot.speed.tolist()
        self._nothing = own.robot.zeros
        self._stiction = plant.each("stiction", own.robot.n)
        self._sticks = bool(self._stiction.any())

    def follow(self, command: Command) -> None:
        """Follow a command, clipped to the limits, from the next physics step on."""
        self._wanted, self.saturated = command.value, False
        if type(command) is JointTorque:
            self._wanted, self.saturated = _cut(command.value, self._effort)
        elif type(command) is JointVelocity:
            self._wanted, self.saturated = _cut(command.value, self._speed)
        if type(command) is not self.kind:
            self.kind = type(command)
            self._lagged: Array | None = None
        self._fresh = True

    def drive(self, q: Array, dq: Array) -> Drive:
        """What the motors do in the next physics step.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
        """
        if self.kind is JointTorque:
            total = self._wanted
            if self._plant.gravity_compensation:  # the arm carries its own weight
                total, cut = _cut(total + self._own.gravity(q), self._effort)
                self.saturated |= cut
            return Drive(total, self._nothing, self._stiction, self._sticks)
        if self.kind is JointPosition:
            speed = self._approach(q)
        elif self._plant.velocity_lag:
            share = min(1.0, self._dt / self._plant.velocity_lag)
            before = dq if self._lagged is None else self._lagged
            self._lagged = speed = before + (self._wanted - before) * share
        else:
            speed = self._wanted
        self._fresh = False
        return Drive(self._nothing, speed, self._own.robot.effort)

    def _approach(self, q: Array) -> Array:
        """Speeds towards the commanded angles from which the motors can still brake in time.

        Braking evenly from v takes v^2 / 2a (Lynch & Park, section 9.2.2).
        """
        if self._fresh:
            M, g = self._own.mass_matrix(q), self._own.gravity(q)
            spare = np.maximum(self._own.robot.effort - np.abs(g), 0.0)  # too weak: zero
            self._braking = BRAKING * spare / M.diagonal()
        gain = min(self._plant.position_gain or np.inf, 1.0 / self._dt)
        gap = self._wanted - q
        stops = np.sqrt(2.0 * self._braking * np.abs(gap))
        allowed, cut = _cut(np.clip(gain * gap, -stops, stops), self._speed)
        self.saturated |= cut
        return allowed


def _cut(x: Array, limit: list[float]) -> tuple[Array, bool]:
    """``x`` within ±limit, and whether that changed it."""
    if all(map(le, map(abs, x.tolist()), limit)):  # five times as fast as NumPy for 7 joints
        return x, False
    return np.clip(x, np.negative(limit), limit), True
