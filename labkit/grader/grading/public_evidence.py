"""The evidence that students may see: runs of the arm and numbers, on public cases alone.

It goes into the result file, small, so that a page can be made from the result and nothing else.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from ...course.marking import PublicResult, PublicRun
from ...course.question import Question, Tuned
from ...log import Log
from ...replay import Motion, motion_of
from .results import Numbers, Run

LARGEST = 60_000
"""Bytes that one motion may take in a result."""
RATES = (25.0, 12.5, 6.25, 3.0)
"""Samples per second of a motion; the finest that fits is taken."""
FEWEST = 50
"""Samples that even a short motion gets."""
MOST = 400
"""Numbers of an answer that are kept at most, beside those expected."""


def runs(question: Question, tried: PublicResult) -> tuple[Run, ...]:
    """The public runs of a question as data: measures, their limits, and the motion.

    Args:
        question: What was asked.
        tried: What came of its public cases.

    Returns:
        One table for each run.  ``motion`` is what the viewer reads, as text, and empty where there
        is nothing to be seen; ``words`` describes it; a measure that is infinite is None.
    """
    return tuple(_run(question, ran) for ran in tried.runs(question))


def numbers(question: Question, tried: PublicResult) -> Numbers | None:
    """The numbers of the first public call whose answer differs; None if there are none.

    Returns:
        The ``call``; the first `MOST` numbers that were ``expected`` and that were ``given``; and
        ``of``, how many numbers the answer has.
    """
    found = tried.first_mismatch(question)
    if found is None or not len(found.given) or not np.isfinite(found.expected).all():
        return None
    return {
        "call": found.call,
        "expected": [float(f"{x:.6g}") for x in found.expected[:MOST]],
        "given": [float(f"{x:.6g}") for x in found.given[:MOST]],
        "of": len(found.given),
    }


def _run(question: Question, ran: PublicRun) -> Run:
    loop = ran.case.loop if isinstance(ran.case, Tuned) else ran.case
    says = ran.case.shown(question.name)
    shown = motion(ran.log, f"Your run: {ran.test}")
    measures = ran.case.measured(ran.log) if ran.complete else {}
    return {
        "test": ran.test,
        "says": says,
        "complete": ran.complete,
        "since": loop.settle,
        "measures": {key: _short(x) for key, x in measures.items()},
        "limits": {key: _short(x) for key, x in ran.case.expected.items()},
        "words": "" if shown is None else shown.description,
        "motion": "" if shown is None else fitting(shown),
    }


def motion(log: Log, title: str) -> Motion | None:
    """What the viewer shows of a run, as far as its numbers are numbers."""
    log = _finite(log)
    return motion_of(log, title, label="your arm") if len(log) > 1 else None


def _finite(log: Log) -> Log:
    """The rows of a log before the first that is not finite; an arm that runs away leaves some."""
    bad = np.flatnonzero(~np.isfinite(np.hstack([log.q, log.dq])).all(axis=1))
    rows = int(bad[0]) if bad.size else len(log)

    def cut(x: Any) -> Any:
        if isinstance(x, tuple):
            return type(x)(*(part[:rows] for part in x))
        return x[:rows] if isinstance(x, np.ndarray) else x

    return Log(**{f.name: cut(getattr(log, f.name)) for f in fields(log)})


def fitting(motion: Motion) -> str:
    """The motion as the viewer reads it, as fine as fits."""
    short = FEWEST / (motion.t[-1] - motion.t[0])
    texts = (motion.to_json(max(rate, short)) for rate in RATES)
    return next((text for text in texts if len(text.encode()) <= LARGEST), "")


def _short(x: Any) -> float | None:
    return float(f"{float(x):.6g}") if np.isfinite(x) else None
