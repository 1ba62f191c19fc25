"""Version numbers of file formats and of the simulated physics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .errors import LabkitError

FORMAT = 2
"""Version of checks.json, bundles and results."""
PHYSICS = 2
"""Version of the plant and its engines; the same run gives a different log in another version."""


def stamp() -> dict[str, int]:
    """The version numbers to store in a file: its ``format`` and its ``physics``."""
    return {"format": FORMAT, "physics": PHYSICS}


def check_stamp(data: Mapping[str, Any], what: str, remedy: str) -> None:
    """Refuse a file that another version of labkit wrote.

    Args:
        data: The contents of the file.
        what: The name of the file for the message, such as "checks.json".
        remedy: What to do, in the imperative.

    Raises:
        LabkitError: The file's format or physics differs from that of this labkit.
    """
    for name, mine in stamp().items():
        if data.get(name) != mine:
            raise LabkitError(
                f"{what} has {name} {data.get(name)!r}, but this labkit reads {mine}; {remedy}"
            )
