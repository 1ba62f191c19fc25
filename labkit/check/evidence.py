"""The evidence: on which call an answer gave itself away, and the numbers side by side."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..commands import COMMANDS
from .mark import Verdict
from .question import Question


class Evidence(NamedTuple):
    """What was expected and what came, on one call.

    Attributes:
        call: The call as the student would type it.
        expected: All numbers of the expected answer, shape (n,).
        given: The same of the student's answer, shape (n,).
    """

    call: str
    expected: Array
    given: Array


def evidence(question: Question, verdict: Verdict) -> Evidence | None:
    """The first public call whose answer differs, where both are numbers of one form."""
    for call, answer in zip(question.calls, verdict.answers, strict=True):
        expected, given = _numbers(call.expected), _numbers(answer)
        if expected is None or given is None or expected.shape != given.shape:
            continue
        if np.isfinite(given).all() and question.judge(answer, call.expected) is not None:
            return Evidence(call.shown(question.name), expected, given)
    return None


def _numbers(value: Any) -> Array | None:
    if isinstance(value, COMMANDS):
        value = value.value
    parts = value if isinstance(value, list | tuple) else [value]
    try:
        return np.concatenate([np.asarray(part, dtype=float).ravel() for part in parts])
    except (TypeError, ValueError):
        return None
