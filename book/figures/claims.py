"""The evidence for the book's conclusions and typed numbers: the build stops if the runs differ.

The words name a sentence for whoever reads the message.  A page may say it differently, but it
must have the numbers of `shows` (`tests/book/test_claims.py`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np


class ConclusionFails(AssertionError):
    """Raised to stop the build if the runs no longer show what the prose says."""


def holds(fact: Any, conclusion: str) -> None:
    """Stop the build if the runs do not support a conclusion of the prose."""
    if not bool(fact):
        raise ConclusionFails(f"the text says: {conclusion}; the runs say otherwise")


def shows(sentence: str, values: Any, actual: Any, near: float = 0.01) -> None:
    """Stop the build if numbers typed in the prose are not those of the code.

    Args:
        sentence: Words of the page, with the numbers.
        values: The number or numbers that they show.
        actual: The same numbers, computed by the code.
        near: The relative difference that rounding may cause.

    Raises:
        ConclusionFails: The numbers differ.
    """
    found = np.ravel([*actual] if isinstance(actual, Iterable) else actual).tolist()
    same = [
        math.isclose(a, b, rel_tol=near, abs_tol=1e-12)
        for a, b in zip(np.ravel(values).tolist(), found, strict=True)
    ]
    holds(all(same), f"{sentence} (here {found})")
