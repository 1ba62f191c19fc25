"""Baxter's two arms.  Their numbers come from Rethink's URDF; see ``data/LICENSE-baxter``."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

from .errors import UnknownName
from .robot import SIDES, Robot


@cache
def robot(side: str) -> Robot:
    """One of Baxter's arms.

    Args:
        side: "left" or "right".

    Raises:
        UnknownName: Baxter has no such arm.
    """
    if side not in SIDES:
        raise UnknownName("arm", side, SIDES)
    data = json.loads((files("labkit") / "data" / "baxter.json").read_text())[side]
    return Robot(name=side, **data)


def as_robot(arm: Robot | str) -> Robot:
    """Return a `Robot` unchanged, and Baxter's arm for a name.

    Raises:
        UnknownName: Baxter has no such arm.
    """
    return arm if isinstance(arm, Robot) else robot(arm)
