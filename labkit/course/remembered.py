"""Runs made once: the same function on the same run need not move the arm again."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from . import Call, Choice, Loop, Question, Tuned
from .cases import Case
from .question_codec import KINDS
from .serialize import encode

Memory = dict[Any, dict[str, float]]
"""Measures of a run, by the function and the run."""


@dataclass(frozen=True, eq=False)
class Remembered:
    """A case whose run is made once for each function, however often it is asked for.

    Attributes:
        run: The case.
        memory: What came of runs so far.
    """

    run: Loop | Tuned
    memory: Memory

    @property
    def expected(self) -> Any:
        """The run's."""
        return self.run.expected

    @property
    def hidden(self) -> bool:
        """The run's."""
        return self.run.hidden

    def ask(self, function: Callable[..., Any]) -> dict[str, float]:
        """The measures of the run, for a log takes room; runs that raise are made again."""
        key = (function, json.dumps(encode(self.run, KINDS)))
        if key not in self.memory:
            self.memory[key] = self.run.measured(self.run.ask(function))
        return self.memory[key]

    def measured(self, answer: dict[str, float]) -> dict[str, float]:
        """What `ask` gave."""
        return answer

    def shown(self, name: str) -> str:
        """The run in words."""
        return self.run.shown(name)


def remembering(questions: Sequence[Question]) -> list[Question]:
    """The same questions, with one memory for the runs of all of them."""
    memory: Memory = {}

    def case(x: Case) -> Any:
        return x if isinstance(x, Call | Choice) else Remembered(x, memory)

    return [
        replace(q, tests=tuple(replace(t, cases=tuple(map(case, t.cases))) for t in q.tests))
        for q in questions
    ]
