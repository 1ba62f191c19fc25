"""Problems, which are questions as their authors write them, with code that students must not see.

Evaluating the answer, the mistakes and the hidden cases turns one into a `labkit.course.Question`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any

import numpy as np

from ..judges import Close, Judge
from ..marking import fingerprint
from ..question import Call, Case, Mistake, Question, Term, Test

CLOSE = Close()


def call(*args: Any, **kwargs: Any) -> Call:
    """One call of the student's function; the expected result is computed by the answer."""
    return Call(args, kwargs)


def _none(random: np.random.Generator) -> Iterable[Case]:
    return ()


@dataclass(frozen=True, eq=False)
class Trial:
    """Cases that pass or fail together; see `labkit.course.Test`.

    Attributes:
        name: What it tests.
        public: Cases that students see.
        hidden: Makes the cases that students do not see, from a random generator.
        also: The class of the hidden cases, in words.
        weight: Share of the points; 0 is a gate.
        part: The part of the answer that it tests; empty for all parts.
    """

    name: str
    public: tuple[Case, ...]
    hidden: Callable[[np.random.Generator], Iterable[Case]] = _none
    also: str = ""
    weight: float = 1.0
    part: str = ""


@dataclass(frozen=True, eq=False)
class Wrong:
    """A wrong answer that students really give.

    Attributes:
        name: Its name in a few words, as students read it.
        says: The cause: what is wrong, without the corrected expression.
        function: The wrong answer.
        lecture: What to say in the next lecture, for the class report.
        cure: What to do, which a student reads at the second try of the same cause.
    """

    name: str
    says: str
    function: Callable[..., Any]
    lecture: str = ""
    cure: str = ""


@dataclass(frozen=True, eq=False)
class Problem:
    """A question with its answer and its known mistakes.

    Attributes:
        name: The function's name.
        points: Full marks.
        asks: What the function should do, in one sentence.
        answer: The reference.
        trials: The trials, gates first.
        judge: Compares answers with the expected ones.
        withheld: Tools that the answer may not use.
        hints: Three hints, from the idea to almost the answer.
        wrong: Known mistakes.
        variants: Right answers in another form; every one must pass.
        expected: Returns what to compare with, if that is not the answer's own result.
        core: Whether it belongs to the core path; else it is an extension.
        outcomes: Learning outcomes of which it is evidence, names of `layout.OUTCOMES`.
        terms: For a law that is a sum of terms: given the arguments of a call, the terms by their
            formulas, and those that are taken for them.  They name what `wrong` need not list.
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
    terms: Callable[..., tuple[Mapping[str, Any], Mapping[str, Any]]] | None = None

    def question(self, seed: int) -> Question:
        """The question, with hidden cases drawn from a seed and the mistakes as fingerprints."""
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
        mistakes = (
            Mistake(w.name, w.says, w.cure, fingerprint(plain, w.function)) for w in self.wrong
        )
        names = tuple(signature(self.answer).parameters) if callable(self.answer) else ()
        return replace(
            plain, mistakes=tuple(mistakes), arguments=names, terms=tuple(self._terms(plain))
        )

    def _terms(self, question: Question) -> Iterator[Term]:
        calls = [case for case in question.calls if isinstance(case, Call)]
        told = [case.ask(self.terms) for case in calls] if self.terms else []
        for factor, at in zip((1.0, 0.0), zip(*told, strict=True), strict=False):
            for name in at[0]:
                yield Term(name, factor, tuple(np.asarray(x[name], dtype=float) for x in at))

    def _test(self, trial: Trial, random: np.random.Generator) -> Test:
        public = (self._with_expected(case, hidden=False) for case in trial.public)
        hidden = (self._with_expected(case, hidden=True) for case in trial.hidden(random))
        return Test(trial.name, (*public, *hidden), trial.weight, trial.also, trial.part)

    def _with_expected(self, case: Case, *, hidden: bool) -> Case:
        if isinstance(case, Call) and case.expected is None:
            return replace(case, expected=case.ask(self.expected or self.answer), hidden=hidden)
        return replace(case, hidden=hidden)  # a run carries its limits
