"""Numbers that say which labkit can read a file, and with which physics it was made."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .errors import LabkitError

FORMAT = 2
"""Of checks.json, bundles, results and logs; files of version 0.1 have no number and count as 1."""
PHYSICS = 2
"""Of the plant and its engines; under another number the same run gives another log."""


def stamp() -> dict[str, int]:
    """What a file says about itself: its ``format`` and its ``physics``."""
    return {"format": FORMAT, "physics": PHYSICS}


def check_stamp(data: Mapping[str, Any], what: str, remedy: str) -> None:
    """Refuse a file that another version of labkit wrote.

    Args:
        data: What the file holds.
        what: What it is called, such as "checks.json".
        remedy: What to do about an older one, an imperative.

    Raises:
        LabkitError: Its format or its physics has another number than this labkit's.
    """
    for name, mine in stamp().items():
        found = data.get(name, 1)
        if found != mine:
            newer = isinstance(found, int) and found > mine
            todo = "install the labkit that it came with" if newer else remedy
            raise LabkitError(f"{what} has {name} {found!r}, this labkit reads {mine}; {todo}")
