"""What one student has for an assignment, line by line: a value, as every page shows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..grading.results import Result
from ..students.class_list import Student
from ..students.platforms import LmsUser
from ..submission import is_name


@dataclass(frozen=True)
class MarkLine:
    """What one question brings, and where that comes from.

    Attributes:
        name: The question.
        points: Full marks.
        automatic: What the machine gave; None where a person marks.
        by_hand: What a person gave, which counts instead.
        extra: Extra credit.
        comment: What a person wrote.
        open: Whether a person has to mark it still, or once more.
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
        """What counts; None where nobody marked it."""
        given = self.automatic if self.by_hand is None else self.by_hand
        return None if given is None else round(given + self.extra, 4)

    @property
    def origin(self) -> str:
        """Where the score comes from, in words; empty if it is the machine's alone."""
        said = []
        if self.by_hand is not None:
            instead = "" if self.automatic is None else f", instead of {self.automatic:g}"
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
        person: The student, as the roster knows them, or else the gradebook.
        listed: Whether they are in the roster.
        when: When it came in, as text.
        due: When it was due, as text.
        lines: One for each question; none where no mark counts.
        raw: Points before late rules; None where no mark counts.
        penalty: What late rules take.
        points: What full marks would be; 0 where neither gradebook nor release says so.
        late: How late it came, in words; empty if it came in time.
        user: How the platform knows the student from which the work was collected, or None.
        result: What the grader found; None where there is no whole result.
        missing: Why no mark counts, and what to do; empty where one does, or nothing came.
        remark: What else should be known of the mark, such as that the file was rejected.
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
    user: LmsUser | None = None
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
        """Whether the student is in the roster, and nothing came."""
        return self.raw is None and not self.missing

    @property
    def open(self) -> tuple[str, ...]:
        """Questions that a person has to mark still."""
        return tuple(line.name for line in self.lines if line.open)

    @property
    def questions(self) -> Mapping[str, tuple[float, float]]:
        """Points of each question, with their maximum; none where no mark counts."""
        return {x.name: (x.score or 0.0, x.points) for x in self.lines if self.raw is not None}

    @property
    def score(self) -> float | str:
        """What counts; an empty cell where nothing does."""
        return "" if self.raw is None else round(max(0.0, self.raw - self.penalty), 4)

    @property
    def full(self) -> float | str:
        """What full marks would be; an empty cell where nobody knows."""
        return self.points or ""

    @property
    def cells(self) -> tuple[float | str, float | str, float | str]:
        """Points before late rules, what these take, and what counts; or three empty cells."""
        return ("", "", "") if self.raw is None else (self.raw, self.penalty, self.score)

    @property
    def login(self) -> str:
        """Their login: the name of the folder, unless that was made from a download or is unfit."""
        made = self.user or self.listed or not is_name(self.student)
        return self.person.login or (self.number("exchange") if made else self.student)

    @property
    def canvas(self) -> str:
        """Their number in Canvas, empty if it is not known."""
        return self.number("canvas") or self.person.lms_user_id

    def number(self, system: str) -> str:
        """Their number in a platform, empty if it is not known."""
        return self.user.number if self.user and self.user.system == system else ""
