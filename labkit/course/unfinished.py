"""The names that a cell should define, even if Python cannot read it."""

from __future__ import annotations

import re

from .source import analyse

_DEFINES = re.compile(r"^(?:def|class)\s+(\w+)|^(\w+)\s*=", re.MULTILINE)


def defined_in(source: str) -> set[str]:
    """The names that a cell should define, even if Python cannot read the cell."""
    found = analyse(source)
    if not found["broken"]:
        return set(found["binds"])
    return {function or value for function, value in _DEFINES.findall(source)}
