"""Questions as data: what is asked, how it is tried and judged, what goes wrong.

A question holds no code of its own answer, so it may travel to a student; its hidden cases travel
apart.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from .cases import Call, Case, Choice
from .judges import Judge


@dataclass(frozen=True, eq=False)
class Test:
    """Cases that stand or fall together.

    Attributes:
        name: What it looks at, as the student reads it.
        cases: Public ones first.
        weight: Share of the points; 0 is a gate, without which no other test counts.
        also: The classes of hidden case it will meet, in words; never the numbers.
    """

    __test__ = False  # pytest, this is not for you

    name: str
    cases: tuple[Case, ...]
    weight: float = 1.0
    also: str = ""


@dataclass(frozen=True)
class Raised:
    """An answer that never came: the function raised.

    Attributes:
        kind: The exception's type.
    """

    kind: str


@dataclass(frozen=True, eq=False)
class Mistake:
    """A wrong answer that people really give, known by its fingerprint.

    Attributes:
        name: In a few words.
        says: What to tell who made it.
        answers: What it gives on each public call, in order; `Raised` where it raises.
    """

    name: str
    says: str
    answers: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Question:
    """One thing to write, and how it is marked.

    Attributes:
        name: The function's name.
        points: What it is worth.
        asks: What it should do, in one sentence.
        judge: Compares answers.
        tests: In the order in which they are tried.
        withheld: Names that would answer it, such as "labkit.Circle".
        hints: From the idea to nearly there.
        mistakes: Known wrong answers.
    """

    name: str
    points: float
    asks: str
    judge: Judge
    tests: tuple[Test, ...]
    withheld: tuple[str, ...] = ()
    hints: tuple[str, ...] = ()
    mistakes: tuple[Mistake, ...] = ()

    @property
    def calls(self) -> tuple[Call | Choice, ...]:
        """The public calls, on which fingerprints are taken."""
        cases = (case for test in self.tests for case in test.cases)
        return tuple(case for case in cases if isinstance(case, Call | Choice) and not case.hidden)

    @property
    def complete(self) -> bool:
        """Whether all its cases are here; a student's copy lacks the hidden ones."""
        if any(case.hidden for test in self.tests for case in test.cases):
            return True
        return all(test.cases and not test.also for test in self.tests)

    def public(self) -> Question:
        """The same question without its hidden cases."""
        return replace(
            self,
            tests=tuple(
                replace(test, cases=tuple(case for case in test.cases if not case.hidden))
                for test in self.tests
            ),
        )
