"""What a result file holds: its fields, their types and their ranges; more than that is kept."""

from __future__ import annotations

from typing import Annotated, Literal, NotRequired, TypedDict

from msgspec import Meta

Points = Annotated[float, Meta(ge=0.0, le=1e6)]
Name = Annotated[str, Meta(pattern=r"^\w+$")]
"""The name of a function, of which names of files are made."""
OutcomeName = Literal["not attempted", "not tried", "not counted", "error", "wrong", "right"]


class TestData(TypedDict):
    """What came of one test; a weight of 0 is a gate."""

    name: str
    weight: Points
    outcome: OutcomeName
    says: str
    hidden: bool


class MistakeData(TypedDict):
    """A known mistake that gives the same answers."""

    name: str
    says: str


class RunData(TypedDict):
    """A run of the arm on a public case; see `seen.runs`."""

    test: str
    says: str
    complete: bool
    since: float
    measures: dict[str, float | None]
    limits: dict[str, float | None]
    words: str
    motion: str


class NumbersData(TypedDict):
    """The numbers of an answer beside those expected; see `seen.numbers`."""

    call: str
    expected: list[float]
    given: list[float]
    of: int


class QuestionData(TypedDict):
    """What came of one question."""

    name: Name
    outcome: OutcomeName
    earned: Points
    points: Points
    tests: list[TestData]
    mistake: MistakeData | None
    notes: list[str]
    source: str
    runs: NotRequired[list[RunData]]
    numbers: NotRequired[NumbersData | None]


class CellData(TypedDict):
    """A cell that failed or was stopped; `cell` counts from 0."""

    cell: int
    kind: str
    error: str
    output: str
    seconds: float


class OwnCell(TypedDict):
    """A cell of the student's own, and the cell of the release that it follows."""

    type: str
    source: str
    after: str


class Hashes(TypedDict):
    """What a result is known by."""

    submission: str
    bundle: str
    engine: str


class ResultData(TypedDict):
    """All of it; see `results.Result`."""

    assignment: str
    student: str
    score: Points
    points: Points
    rejected: str
    questions: list[QuestionData]
    notes: list[str]
    cells: list[CellData]
    own: list[OwnCell]
    tricks: list[str]
    isolation: str
    versions: dict[str, str]
    hashes: Hashes
    seed: int
    seconds: dict[str, float]
