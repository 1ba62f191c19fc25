"""Identifications, in which students measure a number on an arm of their own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from .judges import OWN_ARM, Found, Measured
from .notebook import heading
from .own_arm import DEMO, OwnArm, public_arm
from .question import Call, Question, Test
from .verdict import Difference, Kind, Outcome, Verdict


@dataclass(frozen=True)
class Identification:
    """Something that students find out about their own arm, as its author writes it.

    Attributes:
        name: Name of the value that the student writes down.
        asks: What to find out.
        judge: Knows the right answer and its tolerance.
        truth: The right answer for the demonstration's arm.
        form: What to write down, such as "one number, in kg".
        points: Points for an answer within the tolerance.
        hints: Hints, from the idea to almost the answer.
        core: Whether it belongs to the core path.
        outcomes: The learning outcomes of which it is evidence.
    """

    name: str
    asks: str
    judge: Measured | Found
    truth: Any
    form: str
    points: float
    hints: tuple[str, ...] = ()
    core: bool = True
    outcomes: tuple[str, ...] = ("experiment",)

    def question(self) -> Question:
        """The question, with a public gate and a hidden case with the right answer for an arm."""
        tests = (
            Test(self.form, (Call(()),), 0.0),
            Test(
                OWN_ARM,
                (Call((), expected=self.truth, hidden=True),),
                also="whether it is right for your own arm",
            ),
        )
        return Question(
            self.name,
            self.points,
            self.asks,
            self.judge,
            tests,
            hints=self.hints,
            core=self.core,
            outcomes=self.outcomes,
        )

    def brief(self) -> str:
        """The text above the place for the answer."""
        near = ""
        if isinstance(self.judge, Measured):
            near = f" It counts if it is off by at most {self.judge.tolerance:g} {self.judge.unit}."
        form = (
            f"- Write {self.form}.{near} Type values; do not calculate them from your runs, which "
            "are not repeated when the notebook is marked."
        )
        head = heading("Find out", self.name, self.points, self.core)
        return "\n".join([head, "", self.asks, "", form])

    def cell(self) -> str:
        """The cell that the student fills in."""
        return f"{self.name} = None"

    def solved(self) -> str:
        """The cell with the right answer for the demonstration's arm."""
        return f"{self.name} = {self.truth!r}"


def personalised(question: Question, arm: OwnArm) -> Question:
    """The question with the right answer for a student's arm; other questions are unchanged."""
    if not isinstance(question.judge, Measured | Found):
        return question
    expected = question.judge.expected(arm)
    return question.with_cases(lambda c: replace(c, expected=expected) if c.hidden else c)


def on_the_public_arm(question: Question, verdict: Verdict, answer: Any) -> tuple[Verdict, str]:
    """The verdict on a plausible answer about the public arm, and a remark if it is right."""
    judge: Any = question.judge
    if judge(answer, judge.expected(public_arm())) is None:
        return verdict, f"Your answer is right for the public arm, {DEMO!r}."
    found = f"it is not right for the public arm, {DEMO!r}"
    if isinstance(judge, Measured):
        off = answer - judge.expected(public_arm())
        more = "more" if off > 0.0 else "less"
        found += f": it is {abs(off):.2g} {judge.unit} {more} than there"
        if judge.of == "payload":
            found += "; did its tip touch the wall in your run?"
    why = Difference(Kind.REFUSED, found=found)
    call = f"{question.name}()"
    wrong = replace(verdict.tests[-1], outcome=Outcome.WRONG, call=call, difference=why)
    tests = (*verdict.tests[:-1], wrong)
    return replace(verdict, outcome=Outcome.WRONG, earned=0.0, tests=tests), ""
