"""Margins: how many sigmas lie between an answer and the tolerance, and answers kept for reuse.

Distances from what is expected are measured in tolerances: right answers lie below 1, a mistake
lies above it wherever it is found out.  Over draws of the hidden cases, disturbed inputs, starts
and seeds of the noise these distances spread; the margin is how many of their standard deviations
lie between their mean and the tolerance.  Logarithms are compared, since distances spread over
decades.  Where nothing spreads there is no sigma.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..check import Call, Choice, Loop, Question, Tuned
from ..check.cases import Case
from ..check.codec import encode
from ..check.judge import AtMost
from .problem import Problem

ROUNDING = 1e-3
"""Distances below this, in tolerances, are rounding, and count as this much."""
HUGE = 1e12
"""Distances above this count as this much."""

Memory = dict[Any, dict[str, float]]


@dataclass(frozen=True, eq=False)
class _Remembered(Loop):
    """A run that is made once for each function and each start, however often it is asked for."""

    memory: Memory = field(default_factory=dict)

    def ask(self, function: Callable[..., Any]) -> Any:
        """The measures of the run, for a log takes room; runs that raise are made again."""
        key = (function, _run_key(self))
        if key not in self.memory:
            self.memory[key] = super().measured(super().ask(function))
        return self.memory[key]

    def measured(self, answer: Any) -> dict[str, float]:
        """What `ask` gave."""
        measures: dict[str, float] = answer
        return measures


@dataclass(frozen=True, eq=False)
class _RememberedGains(Tuned):
    """The same for a run with chosen gains."""

    memory: Memory = field(default_factory=dict)

    def ask(self, function: Callable[..., Any]) -> Any:
        """The measures of the run, for a log takes room; runs that raise are made again."""
        key = (function, json.dumps(encode(self.args)), _run_key(self.loop))
        if key not in self.memory:
            self.memory[key] = super().measured(super().ask(function))
        return self.memory[key]

    def measured(self, answer: Any) -> dict[str, float]:
        """What `ask` gave."""
        measures: dict[str, float] = answer
        return measures


def _run_key(loop: Loop) -> str:
    return json.dumps({key: encode(x) for key, x in vars(loop).items() if key != "memory"})


def remembering(questions: Sequence[Question]) -> list[Question]:
    """The same questions, whose runs are made once for each function, however often asked for."""
    memory: Memory = {}

    def case(x: Case) -> Case:
        if isinstance(x, Call | Choice):
            return x
        kind: Any = _Remembered if isinstance(x, Loop) else _RememberedGains
        remembered: Case = kind(**vars(x), memory=memory)
        return remembered

    return [
        replace(q, tests=tuple(replace(t, cases=tuple(map(case, t.cases))) for t in q.tests))
        for q in questions
    ]


def least(
    questions: Sequence[Question],
    problem: Problem,
    right: Mapping[str, Callable[..., Any]],
    wrong: Mapping[str, Callable[..., Any]],
) -> tuple[float | None, str]:
    """The least distance from a tolerance in sigmas, and whose it is."""
    found: list[tuple[float, str]] = []
    for k, test in enumerate(questions[0].tests):
        for label, function in right.items():
            apart: dict[type, list[float]] = {}  # runs and calls have tolerances of different kinds
            for q, case in _cases(questions, k):
                spread = apart.setdefault(_kind(case), [])
                spread.append(_distance(q, case, function))
                spread.append(_disturbed(q, case, function, problem))
            for spread in apart.values():
                found += _sigmas(spread, -1.0, f"{label}: {test.name}")
        for label, function in wrong.items():
            distances = [
                max(_distance(q, case, function) for case in q.tests[k].cases) for q in questions
            ]
            if min(distances) > 1.0:
                found += _sigmas(distances, 1.0, f"{label}: {test.name}")
    return min(found, default=(None, ""))


def _cases(questions: Sequence[Question], k: int) -> list[tuple[Question, Case]]:
    """All cases of the k-th test over all draws, public ones once."""
    hidden = [(q, case) for q in questions for case in q.tests[k].cases if case.hidden]
    return [(questions[0], c) for c in questions[0].tests[k].cases if not c.hidden] + hidden


def _kind(case: Case) -> type:
    """What sort of case it is, remembered or not."""
    return next(kind for kind in (Call, Loop, Choice, Tuned) if isinstance(case, kind))


def _sigmas(distances: Sequence[float], sign: float, whose: str) -> list[tuple[float, str]]:
    """How many standard deviations the mean lies beyond the tolerance, on the side ``sign``."""
    logs = np.log10(np.clip([d for d in distances if np.isfinite(d)], ROUNDING, HUGE))
    if len(logs) < 2 or float(np.std(logs)) < 1e-9:
        return []
    return [(sign * float(np.mean(logs)) / float(np.std(logs, ddof=1)), whose)]


def _distance(question: Question, case: Case, function: Callable[..., Any]) -> float:
    """How far an answer is off, in tolerances; infinite where none came."""
    try:
        answer: Any = case.ask(function)
        if isinstance(case, Call):
            return question.judge.distance(answer, case.expected)
        return AtMost().distance(case.measured(answer), case.expected)
    except Exception:
        return float("inf")


def _disturbed(
    question: Question, case: Case, function: Callable[..., Any], problem: Problem
) -> float:
    """The same with the input disturbed: rounded numbers, or another seed of the arm's noise."""
    if isinstance(case, Loop):
        return _distance(question, _another_noise(case), function)
    if isinstance(case, Tuned):
        return _distance(question, replace(case, loop=_another_noise(case.loop)), function)
    if isinstance(case, Choice):
        return _distance(question, case, function)
    again = replace(case, args=tuple(map(_rounded, case.args)))
    again = replace(again, expected=again.ask(problem.expected or problem.answer))
    return _distance(question, again, function)


def _another_noise(loop: Loop) -> Loop:
    noisy = any(loop.plant.velocity_noise) or loop.plant.lost_ticks > 0.0
    return replace(loop, seed=loop.seed + 1) if noisy else loop


def _rounded(x: Any) -> Any:
    """Numbers and arrays to seven digits; anything else as it is."""
    if isinstance(x, float):
        return float(f"{x:.7g}")
    if isinstance(x, np.ndarray):
        return np.round(x, 7)
    return x
