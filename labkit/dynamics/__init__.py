"""Who computes the equations of motion: Pinocchio where it is installed, MuJoCo elsewhere.

Both do so from the same bodies, and their numbers are the same to rounding.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Protocol

from ..errors import UnknownName
from ..plant import Plant
from ..robot import Robot
from ..shapes import Array

BACKENDS = {"pinocchio": "Pinocchio", "mujoco": "MuJoCo"}
"""The modules and their classes; the first one installed is taken."""


class Dynamics(Protocol):
    """The equations of motion of one arm, made of a `Robot` and of a plant's rotors and payload.

    No argument is checked; q, dq, ddq and tau are float vectors of shape (n,).  `Model` says what
    each method returns; each result is the caller's own.
    """

    def frames(self, q: Array) -> Array:
        """Poses of the n bodies in the world, shape (n, 4, 4)."""

    def pose(self, q: Array) -> Array: ...
    def tip_jacobian(self, q: Array) -> Array: ...
    def tip_jacobian_rate(self, q: Array, dq: Array) -> Array: ...
    def mass_matrix(self, q: Array) -> Array: ...
    def coriolis(self, q: Array, dq: Array) -> Array: ...
    def gravity(self, q: Array) -> Array: ...
    def bias(self, q: Array, dq: Array) -> Array: ...
    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array) -> Array: ...

    def acceleration(self, q: Array, dq: Array, tau: Array) -> Array:
        """The accelerations that torques cause, shape (n,) in [rad/s^2]."""

    def free_motion(self, q: Array, dq: Array, tau: Array) -> tuple[Array, Array]:
        """The same, and the inverse of M(q)."""


class PerThread(threading.local):
    """Working memory, of which each thread, such as that of `live`, has its own."""

    def __init__(self, make: Callable[[], Any]) -> None:
        """Let each thread ``make`` its `data` when it first asks."""
        self.data = make()


def chosen() -> str:
    """The backend of LABKIT_MODEL, or else the first one installed.

    Raises:
        UnknownName: There is no such backend.
    """
    name = os.environ.get("LABKIT_MODEL") or next(filter(find_spec, BACKENDS))
    if name not in BACKENDS:
        raise UnknownName("backend of the model", name, BACKENDS)
    return name


def dynamics_of(robot: Robot, plant: Plant) -> Dynamics:
    """The equations of motion of an arm."""
    name = chosen()
    made: Dynamics = getattr(import_module(f".{name}", __name__), BACKENDS[name])(robot, plant)
    return made
