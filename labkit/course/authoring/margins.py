"""Margins, which are the distances in sigmas between answers and the tolerance.

The distance of an answer from the expected one is measured in tolerances: it is below 1 for a right
answer, and above 1 for a mistake in each case that reveals the mistake.  These distances vary with
the draws of the hidden cases, disturbed inputs, starts and seeds of the noise.  The margin is the
number of standard deviations between their mean and the tolerance.  Logarithms are compared,
because distances range over decades.  If the distances do not vary, there is no margin.

A run of the arm is made only once for each function, and all draws share it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..judges import AtMost
from ..question import Call, Case, Choice, Loop, Question, Tuned
from ..serialize import encode
from .problem import Problem

ROUNDING = 1e-3
"""Distances below this, in tolerances, are rounding errors, and count as this much."""
HUGE = 1e12
"""Distances above this count as this much."""


def least_margin(
    questions: Sequence[Question],
    problem: Problem,
    right: Mapping[str, Callable[..., Any]],
    wrong: Mapping[str, Callable[..., Any]],
) -> tuple[float | None, str]:
    """The least margin, in sigmas, and the answer and test that have it."""
    found: list[tuple[float, str]] = []
    for k, test in enumerate(questions[0].tests):
        for label, function in right.items():
            apart: dict[type, list[float]] = {}  # runs and calls have different tolerances
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
    """All cases of the k-th test in all draws; the public ones are included once."""
    hidden = [(q, case) for q in questions for case in q.tests[k].cases if case.hidden]
    return [(questions[0], c) for c in questions[0].tests[k].cases if not c.hidden] + hidden


def _kind(case: Case | Remembered) -> type:
    """The type of a case, whether it is remembered or not."""
    return type(case.run if isinstance(case, Remembered) else case)


def _sigmas(distances: Sequence[float], sign: float, whose: str) -> list[tuple[float, str]]:
    """The number of standard deviations from the tolerance to the mean, on the side ``sign``."""
    logs = np.log10(np.clip([d for d in distances if np.isfinite(d)], ROUNDING, HUGE))
    if len(logs) < 2 or float(np.std(logs)) < 1e-9:
        return []
    return [(sign * float(np.mean(logs)) / float(np.std(logs, ddof=1)), whose)]


def _distance(question: Question, case: Case | Remembered, function: Callable[..., Any]) -> float:
    """The distance of an answer, in tolerances; infinite if the function raises."""
    try:
        answer: Any = case.ask(function)
        if isinstance(case, Call):
            return question.judge.distance(answer, case.expected)
        return AtMost().distance(case.measured(answer), case.expected)
    except Exception:
        return float("inf")


def _disturbed(
    question: Question, case: Case | Remembered, function: Callable[..., Any], problem: Problem
) -> float:
    """The distance with a disturbed input: rounded numbers, or another seed of the noise."""
    if isinstance(case, Remembered):
        return _distance(question, replace(case, run=_another_noise(case.run)), function)
    if isinstance(case, Call):
        case = replace(case, args=tuple(map(_rounded, case.args)))
        case = replace(case, expected=case.ask(problem.expected or problem.answer))
    return _distance(question, case, function)


def _another_noise(run: Loop | Tuned) -> Loop | Tuned:
    loop = run.loop if isinstance(run, Tuned) else run
    if any(loop.plant.velocity_noise) or loop.plant.lost_ticks > 0.0:
        loop = replace(loop, seed=loop.seed + 1)
    return replace(run, loop=loop) if isinstance(run, Tuned) else loop


def _rounded(x: Any) -> Any:
    """Numbers and arrays, rounded to seven digits; anything else unchanged."""
    if isinstance(x, float):
        return float(f"{x:.7g}")
    if isinstance(x, np.ndarray):
        return np.round(x, 7)
    return x


Memory = dict[Any, dict[str, float]]
"""Measures of a run, by the function and the run."""


@dataclass(frozen=True, eq=False)
class Remembered:
    """A case whose run is made only once for each function.

    Attributes:
        run: The case.
        memory: The measures of earlier runs.
    """

    run: Loop | Tuned
    memory: Memory

    def __getattr__(self, name: str) -> Any:
        """Take all other attributes of a case from `run`."""
        return getattr(self.run, name)

    def ask(self, function: Callable[..., Any]) -> dict[str, float]:
        """The measures of the run, whose log is too large to keep; runs that raise are repeated."""
        key = (function, json.dumps(encode(self.run)))
        if key not in self.memory:
            self.memory[key] = self.run.measured(self.run.ask(function))
        return self.memory[key]

    def measured(self, answer: dict[str, float]) -> dict[str, float]:
        """The measures that `ask` returned."""
        return answer


def share_runs(questions: Sequence[Question]) -> list[Question]:
    """The same questions, which share one memory for their runs."""
    memory: Memory = {}

    def case(x: Case) -> Any:
        return x if isinstance(x, Call | Choice) else Remembered(x, memory)

    return [question.with_cases(case) for question in questions]
