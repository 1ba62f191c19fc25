"""The direction in which a live controller pulls the tip, and what a wrong direction indicates."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

from ..arm import Arm
from ..control import JointTorque
from ..model import Model
from ..shapes import Array

FAR = 0.05
"""Distance of the tip from the target up to which a controller is not judged, in [m]."""

LOOKS = 10
"""Number of consecutive checks, made 30 times a second, that are judged together."""

WEAK = 2.0
"""A pull smaller than this, in [N], has no usable direction."""

_SAYS = {
    1: "pulls the arm away from its target; check the signs of its spring and its damper",
    2: "pulls along the error as the tool's axes have it; are the error and the Jacobian in the "
    "same axes?",
    3: "pulls towards its target, but the arm's weight pulls it elsewhere; does it add gravity?",
}
_RIGHT, _CLEAR = 0.7, 0.85  # cosines


class Pull:
    """Checks the direction of a controller's pull repeatedly."""

    def __init__(self, arm: Arm) -> None:
        """Prepare to check the controller that drives ``arm``."""
        self._arm = arm
        self.begin()

    def begin(self) -> None:
        """Start again, for another controller or another run."""
        self._looks: deque[list[float]] = deque(maxlen=LOOKS)
        self._said = ""

    def look(self, asked: Any, T_wd: Array | None, alone: bool) -> str:
        """Say what is wrong with the controller once that is clear, otherwise nothing.

        Args:
            asked: The controller's latest command; only torques have a pull.
            T_wd: Desired pose of the tip, shape (4, 4), if it is known.
            alone: Whether no hand is pulling as well.
        """
        if T_wd is None or not alone or not isinstance(asked, JointTorque):
            self._looks.clear()
            return self._said
        arm, q, tau = self._arm, self._arm.truth().q, asked.value
        way = T_wd[:3, 3] - arm.tip()[0]
        if np.linalg.norm(way) < FAR:
            self.begin()
            return ""
        g = arm.model.gravity(q)
        felt = tip_force(arm.model, q, tau if arm.plant.gravity_compensation else tau - g)
        in_tool = arm.model.pose(q)[:3, :3].T @ way
        ways = [(felt, way), (felt, -way), (felt, in_tool), (tip_force(arm.model, q, tau), way)]
        self._looks.append([_cosine(force, along) for force, along in ways])
        likely = np.mean(self._looks, axis=0)
        best = int(likely[1:].argmax()) + 1
        if len(self._looks) == LOOKS and likely[0] < _RIGHT and likely[best] > _CLEAR:
            self._said = self._said or _SAYS[best]
        return self._said


def tip_force(model: Model, q: Array, torque: Array) -> Array:
    """The force at the tip that is equivalent to joint torques, world axes, shape (3,) in [N]."""
    return np.asarray(np.linalg.lstsq(model.tip_jacobian(q).T, torque, rcond=1e-3)[0][:3])


def _cosine(force: Array, way: Array) -> float:
    size = float(np.linalg.norm(force))
    return 0.0 if size < WEAK else float(force @ way) / (size * float(np.linalg.norm(way)))
