"""The report card, a table of how well the checks tell right from wrong.

Every answer, known mistake and right variant is marked with some draws of the hidden cases.  A
question fails if a mistake earns too much or has another's name, if a right answer earns too
little, or if only hidden cases reject a mistake.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ...errors import UnknownName
from ..calling import called, captured
from ..marking import mark
from ..question import Question
from ..verdict import Outcome, Verdict
from .layout import Course
from .problem import Problem

LARGEST_PART = 0.67
"""The largest share of the points that one right part of an answer may earn."""


@dataclass(frozen=True)
class Row:
    """The row of the card for one question.

    Attributes:
        question: The question, as assignment/name.
        mistakes: Number of known mistakes.
        rejected: How many of these earned less than `rejected_below`.
        named: How many of these were recognised by name.
        right: Number of right answers, the reference included.
        accepted: How many of these earned full marks.
        failures: What went wrong, in words.
    """

    question: str
    mistakes: int
    rejected: int
    named: int
    right: int
    accepted: int
    failures: tuple[str, ...]


def rejected_below(question: Question) -> float:
    """The points that a wrong answer must stay below.

    They are half of the points, or just more than a part that earns up to `LARGEST_PART` of them.
    """
    weights = [test.weight for test in question.tests]
    share = max(weights) / sum(weights)
    return (share + 1e-9 if 0.5 < share <= LARGEST_PART else 0.5) * question.points


def rows(course: Course, names: Iterable[str], seed: int, draws: int) -> Iterator[Row]:
    """Mark all known answers to some questions.

    Args:
        course: The course.
        names: Names of assignments; "assignment/question" selects one question.
        seed: Seed of the first draw of hidden cases; the next draws take the next seeds.
        draws: Number of draws.

    Raises:
        UnknownName: There is no such assignment or question.
    """
    for name in names:
        assignment, _, only = name.partition("/")
        problems = {problem.name: problem for problem in course.problems(assignment)}
        if only and only not in problems:
            raise UnknownName("question", only, tuple(problems))
        for problem in [problems[only]] if only else problems.values():
            yield row(assignment, problem, range(seed, seed + draws))


def row(assignment: str, problem: Problem, seeds: Iterable[int]) -> Row:
    """The row of one question, with a draw of the hidden cases for each seed."""
    questions = [problem.question(seed) for seed in seeds]
    limit = rejected_below(questions[0])
    failures = []
    rejected = named = accepted = 0
    with captured():  # what answers print is not the card's
        for wrong in problem.wrong:
            verdicts = [mark(question, called(wrong.function)) for question in questions]
            found = [*_faults(wrong.name, verdicts, limit)]
            rejected += max(verdict.earned for verdict in verdicts) < limit
            named += not any("taken for" in words for words in found)
            failures += [f"{wrong.name}: {words}" for words in found]
        for k, answer in enumerate((problem.answer, *problem.variants)):
            earned = min(mark(question, called(answer)).earned for question in questions)
            accepted += earned == problem.points
            if earned < problem.points:
                failures.append(f"right answer {k}: earned only {earned:g}")
    right = 1 + len(problem.variants)
    counts = len(problem.wrong), rejected, named, right, accepted
    return Row(f"{assignment}/{problem.name}", *counts, tuple(failures))


def _faults(name: str, verdicts: Sequence[Verdict], limit: float) -> Iterator[str]:
    """What is wrong with the verdicts on a known mistake, one for each draw."""
    most, known = max(verdict.earned for verdict in verdicts), verdicts[0].mistake
    if most >= limit:
        yield f"earned {most:g} of {verdicts[0].points:g}"
    if known is None or known.name != name:
        yield f"taken for {known.name if known else 'nothing known'}"
    if all(test.hidden or test.outcome is Outcome.RIGHT for test in verdicts[0].tests):
        yield "only hidden cases reject it; add a public case that does"


def table(card: Iterable[Row]) -> str:
    """The card as a table in Markdown, with its failures below it."""
    lines = ["| question | rejected | named | accepted |", "|---|---|---|---|"]
    failures = []
    for x in card:
        parts = f"{x.rejected}/{x.mistakes} | {x.named}/{x.mistakes} | {x.accepted}/{x.right}"
        lines.append(f"| {x.question} | {parts} |")
        failures += [f"- {x.question}: {words}" for words in x.failures]
    return "\n".join([*lines, *([""] if failures else []), *failures])
