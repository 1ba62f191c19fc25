"""The engine: the interface of a physics engine, which integrates the motion of one arm.

Motors, friction, stops and contacts of the tip reach the engine as joint torques.  labkit computes
them itself (`joints`, `scene`), so they are the same with every engine.
"""

from __future__ import annotations

from typing import Protocol

from ..shapes import Array


class Engine(Protocol):
    r"""An arm of n joints on its fixed base, under gravity along -z of the world.

    It is made from a `Robot`, a `Plant` and a step in [s], and uses the payload and the rotors A of
    the plant.  A step of :math:`\Delta t` takes the speeds :math:`\dot q` and the angles q to

    .. math:: \dot q^+ = \dot q + \Delta t\,(M(q) + A)^{-1} (\tau - C(q, \dot q)\,\dot q - g(q)),
        \qquad q^+ = q + \Delta t\,\dot q^+

    without any stops, damping or motors of the engine's own.
    """

    def place(self, q: Array, dq: Array) -> None:
        """Put the joints at ``q`` [rad], turning at ``dq`` [rad/s], both of shape (n,)."""

    def state(self) -> tuple[Array, Array]:
        """Joint angles in [rad] and speeds in [rad/s], two new arrays of shape (n,)."""

    def step(self, tau: Array, ddq: Array | None = None) -> None:
        """Take a step under the given joint torques; `state` must be called before each step.

        Args:
            tau: Joint torques, shape (n,) in [N m].
            ddq: The accelerations that they cause, shape (n,) in [rad/s^2], if the caller has them
                already; this saves 7 µs with an engine that has no rotors.
        """

    def close(self) -> None:
        """Free the engine's resources; no other method is called afterwards."""
