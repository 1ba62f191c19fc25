"""The engine: what the lab asks of a physics engine.

Joints are numbered from the shoulder; vectors have one number per joint.  Angles are in [rad],
speeds in [rad/s], torques in [N m], forces in [N] and lengths in [m]; places and forces have the
world's axes, z upwards.
"""

from __future__ import annotations

from typing import Protocol

from ..plant import Plant
from ..robot import Robot
from ..shapes import Array

TIP_RADIUS = 0.01
"""Radius of the ball about the tip's origin, in [m]; contact begins this far from it."""

TIP_STIFFNESS = 10_000.0
"""Of the finger's rubber pad, in [N/m]."""

TIP_DAMPING = 20.0
"""Of the finger's rubber pad, in [N s/m]."""

FACE = 0.02
"""Thickness of a wall or a table top, in [m]."""


class Engine(Protocol):
    """A world of an engine, with gravity and a fixed step."""

    def add_arm(self, robot: Robot, plant: Plant) -> int:
        """Put an arm, with a ball for a fingertip, on its base; the number it goes by."""

    def add_box(
        self, T_wf: Array, size: Array, stiffness: float, damping: float, friction: float
    ) -> None:
        """Put a solid slab into the world.

        Args:
            T_wf: Pose of its upper face, z out of it, shape (4, 4).
            size: Of that face, shape (2,).
            stiffness: In [N/m], in series with the fingertip's.
            damping: In [N s/m], added to the fingertip's.
            friction: Coefficient of dry friction.
        """

    def place(self, arm: int, q: Array) -> None:
        """Put the joints at ``q``, at rest."""

    def state(self, arm: int) -> tuple[Array, Array, Array]:
        """Angles, speeds, and what the joints' motors gave in the last step, dry friction too."""

    def spin(self, arm: int, speeds: Array, effort: list[float]) -> None:
        """Hold the joints' speeds with torques up to ``effort``, from the next step on."""

    def drive(self, arm: int, tau: Array) -> None:
        """Drive the joints with torques in the next step, beside what `spin` asked for."""

    def push(self, arm: int, R_wt: Array, force: Array, moment: Array) -> None:
        """Push the tip in the next step.

        Args:
            arm: Whose.
            R_wt: How the tip is turned now, shape (3, 3).
            force: At the tip's origin, shape (3,).
            moment: Shape (3,) in [N m].
        """

    def step(self) -> None:
        """Advance by one step."""

    def close(self) -> None:
        """Free what it holds; nothing is asked of it afterwards."""
