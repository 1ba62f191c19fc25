"""The engine: what the lab asks of a physics engine, which is to integrate the motion of one arm.

Motors, friction, stops and whatever touches the tip come to it as torques on the joints: they are
the lab's own (`joints`, `scene`), and so the same on every engine.
"""

from __future__ import annotations

from typing import Protocol

from ..shapes import Array


class Engine(Protocol):
    r"""An arm of n joints on its fixed base, under gravity along -z of the world.

    It is made from a `Robot`, a `Plant` and a step in [s], and takes from the plant the payload and
    the rotors A.  In a step of :math:`\Delta t` it goes from speeds :math:`\dot q` and angles q to

    .. math:: \dot q^+ = \dot q + \Delta t\,(M(q) + A)^{-1} (\tau - C(q, \dot q)\,\dot q - g(q)),
        \qquad q^+ = q + \Delta t\,\dot q^+

    and has neither stops nor damping nor motors of its own.
    """

    def place(self, q: Array, dq: Array) -> None:
        """Put the joints at ``q`` [rad], turning at ``dq`` [rad/s], both of shape (n,)."""

    def state(self) -> tuple[Array, Array]:
        """Joint angles in [rad] and speeds in [rad/s], two new arrays of shape (n,)."""

    def step(self, tau: Array, ddq: Array | None = None) -> None:
        """Take a step under all torques on the joints, once `state` was asked where it begins.

        Args:
            tau: Shape (n,) in [N m].
            ddq: The accelerations that they make, shape (n,) in [rad/s^2], where somebody knows
                them already: 7 µs less where the engine has no rotors.
        """

    def close(self) -> None:
        """Free what it holds; nothing is asked of it afterwards."""
