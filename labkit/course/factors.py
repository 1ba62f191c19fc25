"""Factors: what it means that all numbers of an answer are wrong by the same one."""

from __future__ import annotations

import math

from .verdict import Difference

_FACTORS = {
    -1.0: "the same with the other sign",
    math.degrees(1.0): "these look like degrees; use radians",
    math.radians(1.0): "these look like degrees taken for radians",
    1e3: "a thousand times too large: millimetres for metres?",
    1e-3: "a thousand times too small",
    2.0: "twice what is expected",
    0.5: "half of what is expected",
}
"""The likely cause if all numbers are wrong by the same factor."""


def likely_cause(d: Difference) -> str:
    """The likely cause of a factor; a single number may be twice or half of another by chance."""
    if d.times is None:
        return ""
    single = isinstance(d.expected, float) and not d.at
    for factor, means in _FACTORS.items():
        if math.isclose(d.times, factor, rel_tol=1e-6) and not (single and factor in (2.0, 0.5)):
            return means
    return ""
