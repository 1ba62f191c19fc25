"""Verdicts, which are the results of questions as data, from the check to the gradebook.

The only sentences in them are what authors say about known mistakes; `messages` writes all others,
with `differences`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from msgspec import Meta

Points = Annotated[float, Meta(ge=0.0, le=1e6)]
Name = Annotated[str, Meta(pattern=r"^\w+$")]
"""The name of a function, which is also used in names of files."""
Value = float | str | None | tuple[float | tuple[float, ...], ...]
"""A number, a vector or a matrix; anything else as its shortened `repr`."""


class Outcome(StrEnum):
    """The outcome of a question, or of one of its tests."""

    NOT_ATTEMPTED = "not attempted"
    NOT_TRIED = "not tried"  # a test without a case
    NOT_COUNTED = "not counted"
    ERROR = "error"
    WRONG = "wrong"
    RIGHT = "right"


class Kind(StrEnum):
    """The kinds of difference between an answer and the expected one."""

    NUMBERS = "numbers"  # different numbers
    RESPONSE = "response"  # a different magnitude or phase at a frequency
    MEASURE = "measure"  # a measure of a run is above its limit
    TYPE = "type"  # a different type; "" stands for plain numbers
    VALUE = "value"  # a different text, truth value or None
    KEY = "key"  # a key of a dict is missing
    PARTS = "parts"  # a different number of parts
    REFUSED = "refused"  # a judge refuses it; `found` is the sentence
    NOTHING = "nothing"  # the function returned None
    CHANGED = "changed"  # the function changed its argument; `found` is the sentence
    RAISED = "raised"  # an exception; `found` is its description
    OTHER = "other"  # the answer cannot be compared


@dataclass(frozen=True)
class Difference:
    """How an answer differs from the expected one.

    Attributes:
        kind: The kind of the difference.
        part: The part of the answer, the key, or the measure of a run; "" is the whole answer.
        at: The index of the worst number, or the frequency in [rad/s].
        expected: The expected value; for a response, magnitude and phase in [degrees].
        found: The value in the answer.
        times: The factor by which all numbers are wrong, if there is one.
        several: Whether answers other than the expected one would also be right.
        parts: Names of the expected parts.
        error: The type of the exception.
    """

    kind: Kind
    part: str = ""
    at: tuple[float, ...] = ()
    expected: Value = None
    found: Value = None
    times: float | None = None
    several: bool = False
    parts: tuple[str, ...] = ()
    error: str = ""


@dataclass(frozen=True)
class TestResult:
    """The result of one test.

    Attributes:
        name: What it tests.
        weight: Its share of the points; 0 is a gate.
        outcome: Its outcome; a test is never partly right.
        hidden: Whether a hidden case failed; the outcome is then wrong, and ``call`` and
            ``difference`` are empty.
        call: The case that failed, as the student would type it.
        also: The classes of its hidden cases, in words.
        difference: Why the answer is not right.
    """

    __test__ = False  # pytest must not collect this class

    name: str
    weight: Points
    outcome: Outcome
    hidden: bool = False
    call: str = ""
    also: str = ""
    difference: Difference | None = None


@dataclass(frozen=True)
class Misconception:
    """A known mistake.

    Attributes:
        name: Its name, in a few words.
        says: The cause: what is wrong, without the corrected expression.
        cure: What to do, which a student reads at the second try of the same cause.
    """

    name: str
    says: str
    cure: str = ""


@dataclass(frozen=True)
class Verdict:
    """The result of a question.

    Attributes:
        name: The question's name.
        outcome: Right only if every test that was tried is right.
        earned: Points earned.
        points: Full marks.
        tests: The result of each test.
        withheld: The withheld tools that the answer used.
        complete: Whether the question came with all its cases, so that the verdict is final.
        mistake: The known mistake that gives the same answers, if there is one.
    """

    name: Name
    outcome: Outcome
    earned: Points
    points: Points
    tests: tuple[TestResult, ...] = ()
    withheld: tuple[str, ...] = ()
    complete: bool = True
    mistake: Misconception | None = None

    @property
    def right(self) -> bool:
        """Whether the outcome is right."""
        return self.outcome is Outcome.RIGHT
