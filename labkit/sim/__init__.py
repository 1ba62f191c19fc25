"""Physics engines behind one protocol; only the module of an engine imports that engine.

Motors, friction, stops and contacts of the tip reach the engine as joint torques.  labkit computes
them itself (`joints`, `scene`), so they are the same with every engine.
"""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec
from typing import Protocol

from ..errors import UnknownName
from ..plant import Plant
from ..robot import Robot
from ..shapes import Array

ENGINES = {"pybullet": "PyBullet", "mujoco": "MuJoCo"}
"""The engines' modules and classes; the first one installed is the default."""


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

    def step(self, tau: Array, ddq: Array | None) -> tuple[Array, Array]:
        """Take a step under the given joint torques.

        Args:
            tau: Joint torques, shape (n,) in [N m].
            ddq: The accelerations that they cause, shape (n,) in [rad/s^2], if the caller has them
                already, for an engine that has no rotors.

        Returns:
            Joint angles in [rad] and speeds in [rad/s] after it, two new arrays of shape (n,).
        """

    def close(self) -> None:
        """Free the engine's resources; no other method is called afterwards."""


def chosen(name: str | None = None) -> str:
    """Check the name of an engine; None means that of LABKIT_ENGINE, or the first installed.

    Raises:
        UnknownName: There is no such engine.
    """
    name = name or os.environ.get("LABKIT_ENGINE") or next(filter(find_spec, ENGINES))
    if name not in ENGINES:
        raise UnknownName("engine", name, ENGINES)
    return name


def new_arm(name: str, robot: Robot, plant: Plant, dt: float) -> Engine:
    """Make an arm in the engine ``name``, with steps of ``dt`` [s]."""
    made: Engine = getattr(import_module(f".{name}", __name__), ENGINES[name])(robot, plant, dt)
    return made
