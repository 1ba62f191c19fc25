"""A mark as a value: a student's points for an assignment, line by line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..collect import Participant
from ..grading.results import Result
from ..roster import Student
from ..submission import is_name


@dataclass(frozen=True)
class MarkLine:
    """The points for one question, and where they come from.

    Attributes:
        name: The name of the question.
        points: Full marks.
        automatic: The points that the grader gave; None if a person marks the question.
        by_hand: The points that a person gave, which count instead; None if there are none.
        extra: Extra credit.
        comment: The comment that a person wrote.
        open: Whether a person still has to mark the question, or to look at it again.
    """

    name: str
    points: float
    automatic: float | None = None
    by_hand: float | None = None
    extra: float = 0.0
    comment: str = ""
    open: bool = False

    @property
    def score(self) -> float | None:
        """The points that count; None if the question is not marked yet."""
        given = self.automatic if self.by_hand is None else self.by_hand
        return None if given is None else round(given + self.extra, 4)

    @property
    def origin(self) -> str:
        """Where the score comes from, in words; empty if it is the grader's alone."""
        said = []
        if self.by_hand is not None:
            same = self.automatic in {None, self.by_hand}
            instead = "" if same else f", instead of {self.automatic:g}"
            said.append(f"{self.by_hand:g} by hand{instead}")
        if self.extra:
            said.append(f"{self.extra:g} extra credit")
        if self.open:
            said.append("not marked yet" if self.score is None else "to be looked at again")
        return "; ".join(said)


@dataclass(frozen=True)
class Mark:
    """One student's mark for an assignment.

    Attributes:
        person: The student, as described by the roster or, failing that, by the gradebook.
        listed: Whether the student is in the roster.
        when: When the work was handed in, as text.
        due: When the work was due, as text.
        lines: One for each question; none if no mark counts.
        raw: Points before deductions for lateness; None if no mark counts.
        penalty: Points deducted for lateness.
        points: Full marks; 0 if neither the gradebook nor the release says what they are.
        late: How late the work was, in words; empty if it was in time.
        moodle: The student as Moodle's download calls them, or None.
        result: The result of grading; None if there is no complete one.
        missing: Why no mark counts, and what to do; empty if one does, or nothing was handed in.
        remark: Anything else to know about the mark, such as that the file was rejected.
        author: Who handed in the team's report, if that was another member of the team.
    """

    person: Student
    listed: bool = False
    when: str = ""
    due: str = ""
    lines: tuple[MarkLine, ...] = ()
    raw: float | None = None
    penalty: float = 0.0
    points: float = 0.0
    late: str = ""
    moodle: Participant | None = None
    result: Result | None = None
    missing: str = ""
    remark: str = ""
    author: str = ""

    @property
    def student(self) -> str:
        """The name of the student's folder."""
        return self.person.id

    @property
    def absent(self) -> bool:
        """Whether the student handed in nothing."""
        return self.raw is None and not self.missing

    @property
    def open(self) -> tuple[str, ...]:
        """The questions that a person still has to mark."""
        return tuple(line.name for line in self.lines if line.open)

    @property
    def questions(self) -> Mapping[str, tuple[float, float]]:
        """The points of each question, with their maximum; none if no mark counts."""
        return {x.name: (x.score or 0.0, x.points) for x in self.lines if self.raw is not None}

    @property
    def score(self) -> float | str:
        """The points that count; an empty cell if no mark does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)

    @property
    def full(self) -> float | str:
        """Full marks; an empty cell if they are not known."""
        return self.points or ""

    @property
    def cells(self) -> tuple[float | str, float | str, float | str]:
        """Points before deductions, the deduction, and the score; or three empty cells."""
        return ("", "", "") if self.raw is None else (self.raw, self.penalty, self.score)

    @property
    def login(self) -> str:
        """The login; else the folder's name, unless the roster gave the folder."""
        made = self.listed or not is_name(self.student)
        return self.person.login or ("" if made else self.student)
