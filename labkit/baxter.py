"""Baxter's two arms.  Their numbers come from Rethink's URDF, see ``data/LICENSE-baxter``."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files

import numpy as np

from .errors import UnknownName
from .robot import Robot
from .shapes import locked


@cache
def robot(side: str) -> Robot:
    """The data of one arm.

    Args:
        side: "left" or "right".

    Raises:
        UnknownName: Baxter has no such arm.
    """
    if side not in ("left", "right"):
        raise UnknownName("arm", side, ("left", "right"))
    data = json.loads((files("labkit") / "data" / "baxter.json").read_text())[side]
    bodies = data.pop("bodies")  # the rest is named as here
    for limit in ("lower", "upper", "speed", "effort"):
        data[limit] = [body[limit] for body in bodies]
    return Robot(
        side=side,  # type: ignore[arg-type]
        joint_names=tuple(body["joint"] for body in bodies),
        bodies=tuple(bodies),
        **{name: locked(np.array(numbers)) for name, numbers in data.items()},
    )
