"""A problem: a question as its author writes it, with the code that a student must not see.

Evaluating the answer, the mistakes and the hidden cases turns it into a `labkit.course.Question`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any

import numpy as np

from ..equivalence import Judge
from ..judges import Close
from ..marking import fingerprint
from ..probes import make_probes
from ..question import Call, Case, Mistake, Question, Test

CLOSE = Close()


def call(*args: Any, **kwargs: Any) -> Call:
    """One call of the student's function; what is expected comes from the answer."""
    return Call(args, kwargs)


def _none(random: np.random.Generator) -> Iterable[Case]:
    return ()


@dataclass(frozen=True, eq=False)
class Trial:
    """Cases that stand or fall together; see `labkit.course.Test`.

    Attributes:
        name: What it looks at.
        public: Cases that the student sees.
        hidden: Makes the cases that the student does not see, from a generator.
        also: The class of the hidden cases, in words.
        weight: Share of the points; 0 is a gate.
        part: Of an answer of several parts, the one that it looks at; empty for all of them.
    """

    name: str
    public: tuple[Case, ...]
    hidden: Callable[[np.random.Generator], Iterable[Case]] = _none
    also: str = ""
    weight: float = 1.0
    part: str = ""


@dataclass(frozen=True, eq=False)
class Wrong:
    """A wrong answer that people really give.

    Attributes:
        name: In a few words, as the student reads it.
        says: What to tell who made it.
        function: The wrong answer.
        lecture: What to say in the next lecture, for the class report.
    """

    name: str
    says: str
    function: Callable[..., Any]
    lecture: str = ""


@dataclass(frozen=True, eq=False)
class Problem:
    """A question, its answer, and what people write instead.

    Attributes:
        name: The function's name.
        points: What it is worth.
        asks: What it should do, in one sentence.
        answer: The reference.
        trials: How it is tried; gates first.
        judge: Compares answers.
        withheld: Names that would answer it.
        hints: From the idea to nearly there, three of them.
        wrong: Known mistakes.
        variants: Right answers in another form; every one must pass.
        expected: What to compare with, where that is not the answer's own output.
        core: Whether it belongs to the core path; else it is an extension.
        outcomes: What it is evidence of, names of `outcomes.OUTCOMES`.
    """

    name: str
    points: float
    asks: str
    answer: Callable[..., Any]
    trials: tuple[Trial, ...]
    judge: Judge = CLOSE
    withheld: tuple[str, ...] = ()
    hints: tuple[str, ...] = ()
    wrong: tuple[Wrong, ...] = ()
    variants: tuple[Callable[..., Any], ...] = ()
    expected: Callable[..., Any] | None = None
    core: bool = True
    outcomes: tuple[str, ...] = ()

    def question(self, seed: int) -> Question:
        """The question with hidden cases drawn from a seed; the mistakes as fingerprints."""
        tests = tuple(
            self._test(trial, np.random.default_rng([seed, k, *self.name.encode()]))
            for k, trial in enumerate(self.trials)
        )
        plain = Question(
            self.name,
            self.points,
            self.asks,
            self.judge,
            tests,
            withheld=self.withheld,
            hints=self.hints,
            core=self.core,
            outcomes=self.outcomes,
        )
        mistakes = (Mistake(w.name, w.says, fingerprint(plain, w.function)) for w in self.wrong)
        probes = make_probes(plain, self.answer, self.expected or self.answer)
        names = tuple(signature(self.answer).parameters) if callable(self.answer) else ()
        return replace(plain, mistakes=tuple(mistakes), arguments=names, probes=probes)

    def _test(self, trial: Trial, random: np.random.Generator) -> Test:
        public = (self._with_expected(case, hidden=False) for case in trial.public)
        hidden = (self._with_expected(case, hidden=True) for case in trial.hidden(random))
        return Test(trial.name, (*public, *hidden), trial.weight, trial.also, trial.part)

    def _with_expected(self, case: Case, *, hidden: bool) -> Case:
        if isinstance(case, Call):
            return replace(case, expected=case.ask(self.expected or self.answer), hidden=hidden)
        return replace(case, hidden=hidden)  # a run carries its limits
