"""Verdicts: what came of a question, as data from the check to the gradebook.

They hold no sentences; `messages` makes words of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

from msgspec import Meta

Points = Annotated[float, Meta(ge=0.0, le=1e6)]
Name = Annotated[str, Meta(pattern=r"^\w+$")]
"""The name of a function, of which names of files are made."""
Value = float | str | None | tuple[float | tuple[float, ...], ...]
"""A number, a vector or a matrix; anything else as Python writes it, shortened."""


class Outcome(StrEnum):
    """What came of a question, or of one of its tests."""

    NOT_ATTEMPTED = "not attempted"
    NOT_TRIED = "not tried"  # of a test without a case
    NOT_COUNTED = "not counted"
    ERROR = "error"
    WRONG = "wrong"
    RIGHT = "right"


class Kind(StrEnum):
    """In what an answer differs from what is expected."""

    NUMBERS = "numbers"  # other numbers
    RESPONSE = "response"  # another magnitude and phase at a frequency
    MEASURE = "measure"  # a measure of a run is above its limit
    TYPE = "type"  # another type; "" stands for plain numbers
    VALUE = "value"  # another text, truth value or None
    KEY = "key"  # a key of a dict is missing
    PARTS = "parts"  # another number of parts
    REFUSED = "refused"  # labkit cannot read it; `found` is its sentence
    NOTHING = "nothing"  # a function without a return
    CHANGED = "changed"  # the function wrote to its argument; `found` is the sentence
    RAISED = "raised"  # an exception; `found` is what it says
    OTHER = "other"  # it cannot be compared


@dataclass(frozen=True)
class Difference:
    """How an answer differs from what is expected.

    Attributes:
        kind: In what.
        part: Which part of the answer, which key, or which measure of a run; "" is the whole.
        at: The index of the worst number, or the frequency in [rad/s].
        expected: What it should be; of a response, magnitude and phase in [degrees].
        found: What it is.
        times: The one factor by which all numbers are off, where there is one.
        several: Whether other answers than the expected one would be right too.
        parts: What the parts should be.
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
    """What came of one test.

    Attributes:
        name: What it looked at.
        weight: Its share of the points; 0 is a gate.
        outcome: Never partly right.
        hidden: Whether a hidden case decided; then it is wrong or not counted, and there is no
            ``call`` and no ``difference``.
        call: The case that decided, as the student would type it.
        also: The classes of hidden case that the test has, in words.
        difference: Why it is not right.
        tool: The withheld tool that was used, if that decided.
    """

    __test__ = False  # pytest, this is not for you

    name: str
    weight: Points
    outcome: Outcome
    hidden: bool = False
    call: str = ""
    also: str = ""
    difference: Difference | None = None
    tool: str = ""


@dataclass(frozen=True)
class Misconception:
    """A known mistake.

    Attributes:
        name: In a few words.
        says: What to tell who made it.
    """

    name: str
    says: str


@dataclass(frozen=True)
class Verdict:
    """What came of a question.

    Attributes:
        name: The question's.
        outcome: Right only if every test is that was tried.
        earned: Points.
        points: What full marks would be.
        tests: One result each.
        withheld: The tools that it used and that the question asks to write.
        complete: Whether no hidden case is left that could change it.
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
        """Whether it is right."""
        return self.outcome is Outcome.RIGHT
