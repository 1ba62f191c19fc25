"""The hand of a page: it holds on for as long as something is heard of it."""

from __future__ import annotations

import time
from typing import Any

from ..arm import Arm
from ..hand import Hand

FRESH, SLOW_PAGE = 0.2, 1.0
"""A pointer of which nothing was heard for this long, in [s], lets go; where a page says that it is
slow, after three times its slowest turn of late, but at most after the second of these."""

STEADY = 5.0
"""A push by a button goes on for this long, in [s], after the last word of it."""


class Grip(Hand):
    """A hand that a page moves.

    Attributes:
        move: The page's number of the last move, with which the picture answers.
        patience: How long it holds on after the last word, in [s].
    """

    def __init__(self, arm: Arm) -> None:
        """A hand that holds nothing yet."""
        super().__init__(arm)
        self.move, self.patience, self.heard = 0, FRESH, 0.0

    def follow(self, message: dict[str, Any]) -> None:
        """Do what the page says: pull a point to a place, push it, or let go."""
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
        """Let go if nothing was heard for too long."""
        if time.monotonic() - self.heard > self.patience:
            self.let_go()
