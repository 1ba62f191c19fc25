r"""Series elasticity, with the motor at one end of a spring and the joint at the other.

A rotor of inertia a, at the angle :math:`\theta`, moves under motor and friction
:math:`\tau_m` and under its spring,

.. math:: a\,\ddot\theta = \tau_m - \tau_s, \qquad
   \tau_s = k\,(\theta - q) + d\,(\dot\theta - \dot q)

and only :math:`\tau_s` acts on the joint (Spong 1987; Siciliano, section 9.1 on elastic joints,
does the same).  k and d are `Plant.joint_stiffness` and `Plant.joint_damping`.
"""

from __future__ import annotations

import numpy as np

from .joints import Drive
from .plant import Plant
from .shapes import Array


class Springs:
    """The rotors and springs of one arm, physics step by physics step."""

    def __init__(self, plant: Plant, n: int, dt: float) -> None:
        """Make the rotors and springs of ``n`` joints, with steps of ``dt`` [s]."""
        self._k, self._d, self._a, self._viscous = (
            plant.each(name, n)
            for name in ("joint_stiffness", "joint_damping", "armature", "viscous")
        )
        self._inertia = self._a + dt * (self._viscous + self._d) + dt * dt * self._k
        self._dt = dt

    def reset(self, q: Array, tau: Array) -> None:
        """Rest at ``q`` (n,) [rad], with the springs loaded by ``tau`` (n,) [N m]."""
        self._theta, self._speed = q + tau / self._k, np.zeros(len(q))

    def pull(self, q: Array, dq: Array, drive: Drive) -> tuple[Array, Drive]:
        """Advance the rotors by a step that is implicit in the springs, hence stable.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            drive: The motors' action on the rotors.

        Returns:
            The torque of the motors, shape (n,) in [N m], and the springs' action on the joints.
        """
        dt = self._dt
        push = drive.tau - self._k * (self._theta - q) + self._d * dq
        free = (self._a * self._speed + dt * push) / self._inertia
        held = np.clip((drive.speed - free) * self._inertia / dt, -drive.bound, drive.bound)
        self._speed = free + dt / self._inertia * held
        self._theta = self._theta + dt * self._speed
        spring = self._k * (self._theta - q) + self._d * (self._speed - dq)
        nothing = np.zeros(len(q))
        return drive.tau + held, Drive(spring, nothing, nothing, holds=False)
