"""The evidence that students may see: runs of the arm and numbers, from public cases only.

A result file holds a compact form of the evidence, so the file alone is enough to make a page.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..course.marking import PublicResult, PublicRun
from ..course.question import Question, Tuned
from ..replay import Motion, motion_of
from .results import Numbers, Run

MAX_BYTES = 60_000
"""The largest size of one motion in a result, in bytes."""
RATES = (25.0, 12.5, 6.25, 3.0)
"""Samples per second of a motion; the first rate with which it fits is used."""
MIN_SAMPLES = 50
"""The least number of samples of a motion, however short."""
MAX_NUMBERS = 400
"""The most numbers of an answer that are kept, each with the expected one."""


def runs(question: Question, tried: PublicResult) -> tuple[Run, ...]:
    """The public runs of a question as data: measures, their limits, and the motion.

    Args:
        question: The question.
        tried: The outcome of its public cases.

    Returns:
        One table for each run.  ``motion`` is the text that the viewer reads, empty if there is
        nothing to show, and ``words`` describes the motion.  An infinite measure is None.
    """
    return tuple(_run(question, ran) for ran in tried.runs(question))


def numbers(question: Question, tried: PublicResult) -> Numbers | None:
    """The numbers of the first public call whose answer is wrong; None if there are none.

    Returns:
        The ``call``; the first `MAX_NUMBERS` numbers ``expected`` and ``given``, in which those far
        below the tolerance are 0; and ``of``, how many numbers the answer has.
    """
    noise = 1e-4 * getattr(question.judge, "atol", 0.0)
    found = tried.first_mismatch(question)
    if found is None or not len(found.given) or not np.isfinite(found.expected).all():
        return None
    return {
        "call": found.call,
        "expected": [_short(x, noise) for x in found.expected[:MAX_NUMBERS]],
        "given": [_short(x, noise) for x in found.given[:MAX_NUMBERS]],
        "of": len(found.given),
    }


def _run(question: Question, ran: PublicRun) -> Run:
    loop = ran.case.loop if isinstance(ran.case, Tuned) else ran.case
    says = ran.case.shown(question.name)
    title = f"Your run: {ran.test}"
    shown = motion_of(ran.log, title, label="your arm") if len(ran.log) > 1 else None
    measures = ran.case.measured(ran.log) if ran.complete else {}
    return {
        "test": ran.test,
        "says": says,
        "complete": ran.complete,
        "since": loop.settle,
        "measures": {key: _rounded(x) for key, x in measures.items()},
        "limits": {key: _rounded(x) for key, x in ran.case.expected.items()},
        "words": "" if shown is None else shown.alt,
        "motion": "" if shown is None else encode_to_fit(shown),
    }


def encode_to_fit(motion: Motion) -> str:
    """The motion as the text that the viewer reads, at the highest rate that fits."""
    short = MIN_SAMPLES / (motion.t[-1] - motion.t[0])
    texts = (motion.to_json(max(rate, short)) for rate in RATES)
    return next((text for text in texts if len(text.encode()) <= MAX_BYTES), "")


def _short(x: float, noise: float) -> float:
    return float(f"{x:.6g}") if abs(x) > noise else 0.0


def _rounded(x: Any) -> float | None:
    return float(f"{float(x):.6g}") if np.isfinite(x) else None
