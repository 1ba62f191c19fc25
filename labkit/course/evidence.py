"""The evidence: on which call an answer gave itself away, and the numbers side by side."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..shapes import Array
from .judges import numbers
from .marking import Verdict
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
        try:
            expected, given = numbers(call.expected), numbers(answer)
        except (TypeError, ValueError, OverflowError):
            continue
        same_form = expected.shape == given.shape and np.isfinite(given).all()
        if same_form and question.judge(answer, call.expected) is not None:
            return Evidence(call.shown(question.name), expected, given)
    return None
