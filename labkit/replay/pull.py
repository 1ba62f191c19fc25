"""Where a live law pulls the tip while nobody else does, and what a wrong direction says of it."""

from __future__ import annotations

from collections import deque

import numpy as np

from ..model import Model
from ..shapes import Array

FAR = 0.05
"""A law that keeps its tip nearer to the target than this, in [m], is not judged."""

LOOKS = 10
"""So many looks in a row, of which there are 30 a second, are judged together."""

WEAK = 2.0
"""A pull smaller than this, in [N], has no direction."""

_SAYS = {
    1: "pulls the arm away from its target; check the sign of the error",
    2: "pulls along the error as the tool's axes have it; are the error and the Jacobian in the "
    "same axes?",
    3: "pulls towards its target, but the arm's weight pulls it elsewhere; does it add gravity?",
}
_RIGHT, _CLEAR = 0.7, 0.85  # cosines


class Pull:
    """The direction of a law's pull, look after look."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._looks: deque[Array] = deque(maxlen=LOOKS)
        self._said = ""

    def interrupt(self) -> None:
        """Somebody else pulls too; what was said stays."""
        self._looks.clear()

    def begin(self) -> None:
        """Another law, or another start."""
        self._looks.clear()
        self._said = ""

    def look(self, model: Model, q: Array, torque: Array, weight: Array, way: Array) -> str:
        """What is wrong with the law, once that is clear; else nothing.

        Args:
            model: The arm's equations.
            q: Joint angles, shape (n,) in [rad].
            torque: What the law asks for, shape (n,) in [N m].
            weight: What it has to carry, shape (n,) in [N m]; zeros if the arm carries itself.
            way: From the tip to its target, world axes, shape (3,) in [m].
        """
        if np.linalg.norm(way) < FAR:
            self.begin()
            return ""
        felt = tip_force(model, q, torque - weight)
        in_tool = model.pose(q)[:3, :3].T @ way
        self._looks.append(np.array([_cosine(felt, way), _cosine(felt, -way),
                                     _cosine(felt, in_tool),
                                     _cosine(tip_force(model, q, torque), way)]))  # fmt: skip
        likely = np.mean(self._looks, axis=0)
        best = int(likely[1:].argmax()) + 1
        if len(self._looks) == LOOKS and likely[0] < _RIGHT and likely[best] > _CLEAR:
            self._said = self._said or _SAYS[best]
        return self._said


def tip_force(model: Model, q: Array, torque: Array) -> Array:
    """The force at the tip that joint torques amount to, world axes, shape (3,) in [N]."""
    return np.asarray(np.linalg.lstsq(model.tip_jacobian(q).T, torque, rcond=1e-3)[0][:3])


def _cosine(force: Array, way: Array) -> float:
    size = float(np.linalg.norm(force))
    return 0.0 if size < WEAK else float(force @ way) / (size * float(np.linalg.norm(way)))
