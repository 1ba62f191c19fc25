r"""A hand that can hold the arm anywhere, moved by the pointer and the keys of the live view.

It is a spring and a damper between a point of a link and a place in the world, as strong as a
person's arm at most,

.. math:: f = k\,(x - p) - d\,\dot p, \qquad |f| \le f_{max}, \qquad \tau = J_p^T f ,

or a constant force at that point.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ..arm import Arm
from ..shapes import Array, as_array
from ..world import World

STIFFNESS = 400.0
"""Stiffness of the spring, in [N/m]."""

DAMPING = 12.0
"""Damping of the damper, in [N s/m]."""

STRONGEST = 60.0
"""Largest force of the hand, in [N]."""

FRESH, SLOW_PAGE = 0.2, 1.0
"""Times without a message about the pointer after which a pull ends, in [s].

The first is the usual one.  For a page that reports itself as slow, the time is three of its
longest recent update periods, but at most the second."""

STEADY = 5.0
"""Time for which a push by a button continues after the last message about it, in [s]."""


class Hand:
    """A hand beside an arm; it pulls from `take` or `push` until `let_go`.

    Attributes:
        at: Point at which it holds the arm, world axes, shape (3,) in [m]; None while it holds
            nothing.
        force: Its force in the last physics step, or the constant one, world axes, shape (3,) in
            [N].
        move: The page's number of the last move, which the next picture returns.
        heard: Time of the page's last message, by `time.monotonic`, in [s].
        patience: How long it keeps hold after the last message of a page, in [s].
    """

    at: Array | None
    force: Array
    _point: tuple[int, Array] | None
    _to: Array | None

    def __init__(self, arm: Arm) -> None:
        """Make a hand that holds nothing yet; ``arm.world.put(hand)`` puts it beside the arm."""
        self._arm, self.move, self.patience, self.heard = arm, 0, FRESH, 0.0
        self.let_go()

    def take(self, body: int, point: Any, to: Any) -> None:
        """Pull a point towards a place.

        Args:
            body: The body to hold, by the number of its joint; n is the tip's frame.
            point: Point of the body, in the body's frame, shape (3,) in [m].
            to: Place to pull the point to, world axes, shape (3,) in [m].
        """
        self._point, self._to = (body, as_array(point, (3,), "point")), as_array(to, (3,), "to")

    def push(self, body: int, point: Any, force: Any) -> None:
        """Push at a point with a constant force.

        Args:
            body: As for `take`.
            point: As for `take`.
            force: Force, world axes, shape (3,) in [N].
        """
        self._point, self._to = (body, as_array(point, (3,), "point")), None
        self.force = _bounded(as_array(force, (3,), "force"))

    def let_go(self) -> None:
        """Let go of the arm."""
        self._point, self._to, self.at = None, None, None
        self.force = np.zeros(3)

    def follow(self, message: dict[str, Any]) -> None:
        """Carry out a message of the page: pull a point to a place, push it, or let go."""
        slow = min(SLOW_PAGE, max(FRESH, 3.0 * message.get("every", 0.0)))
        self.heard, self.patience = message["heard"], STEADY if "force" in message else slow
        self.move = message.get("move", self.move)
        point = message["link"], message["local"]
        if "force" in message:
            self.push(*point, message["force"])
        elif "to" in message:
            self.take(*point, message["to"])
        else:
            self.let_go()

    def tire(self) -> None:
        """Let go if the last message is too old."""
        if time.monotonic() - self.heard > self.patience:
            self.let_go()

    def seen(self) -> dict[str, Any]:
        """The hand's action as plain numbers, for the page to draw."""
        if self.at is None or self._point is None:
            return {"at": None, "force": None, "link": None}
        at, force = self.at.round(4).tolist(), self.force.round(3).tolist()
        return {"at": at, "force": force, "link": self._point[0]}

    def act(self, world: World) -> None:
        """Pull during the next physics step."""
        if self._point is None:
            return
        _, q, dq, _ = self._arm.truth()
        self.at, J = self._arm.model.point_on(q, *self._point)
        if self._to is not None:
            self.force = _bounded(STIFFNESS * (self._to - self.at) - DAMPING * (J @ dq))
        self._arm.pull(J.T @ self.force)


def _bounded(force: Array) -> Array:
    size = float(np.linalg.norm(force))
    return force if size <= STRONGEST else force * (STRONGEST / size)
