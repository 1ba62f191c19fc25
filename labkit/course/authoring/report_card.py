"""The report card, which says how well the checks tell right from wrong, and by what margin.

Every answer, known mistake and right variant is marked with many draws of the hidden cases, and
`margins` measures how close they come to the tolerance.  A question whose distances do not vary has
no margin and is listed separately.  A question fails if a mistake earns too much or a right answer
too little, if only hidden cases reject a mistake, or if a margin is below `LEAST_MARGIN`.
"""

from __future__ import annotations

import json
import runpy
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ...errors import LabkitError, UnknownName
from ..calling import captured
from ..marking import mark
from ..question import Question
from ..reply import LocalFunction
from ..verdict import Outcome
from .layout import Course
from .margins import least_margin, share_runs
from .problem import Problem

Functions = Mapping[str, Sequence[Callable[..., Any]]]
"""Functions by the name of their question, or by "assignment/name" if two assignments ask it."""

DRAWS = 20
TIMEOUT = 600.0
"""Time after which one call of an answer is stopped, because it may be endless, in [s]."""
LEAST_MARGIN = 3.0
"""The smallest permitted margin between an answer and the tolerance, in sigmas."""
LARGEST_PART = 0.6
"""The largest share of the points that one right part of an answer may earn."""


@dataclass(frozen=True)
class Row:
    """The row of the card for one question.

    Attributes:
        assignment: The assignment that asks it.
        question: Its name.
        mistakes: Number of wrong answers that were tried.
        rejected: How many of these earned less than `rejected_below`.
        named: How many of the course's known mistakes were recognised by name.
        variants: Number of right answers that were tried, including the reference.
        accepted: How many of these earned full marks.
        seeds_agree: Number of draws of the hidden cases that give the same marks as the first.
        margin_sigma: Distance of the nearest answer from the tolerance, in sigmas; None if the
            distances do not vary.
        nearest: The nearest answer and its test.
        failures: What went wrong, in words.
    """

    assignment: str
    question: str
    mistakes: int
    rejected: int
    named: int
    variants: int
    accepted: int
    seeds_agree: int
    margin_sigma: float | None
    nearest: str
    failures: tuple[str, ...]


@dataclass(frozen=True)
class ReportCard:
    """The whole card.

    Attributes:
        seed: Seed of the first draw.
        seeds: Number of draws.
        rows: One row for each question.
    """

    seed: int
    seeds: int
    rows: tuple[Row, ...]

    @property
    def nearest(self) -> list[tuple[float, Row]]:
        """The margins, in sigmas, with their rows, in ascending order."""
        found = [(row.margin_sigma, row) for row in self.rows if row.margin_sigma is not None]
        return sorted(found, key=lambda pair: pair[0])

    def data(self) -> dict[str, Any]:
        """Totals and rows, as JSON data."""
        totals: dict[str, Any] = {
            key: sum(getattr(row, key) for row in self.rows)
            for key in ("mistakes", "rejected", "named", "variants", "accepted")
        }
        return {
            "seed": self.seed,
            "seeds": self.seeds,
            **totals,
            "seeds_agree": min((row.seeds_agree for row in self.rows), default=0),
            "min_margin_sigma": next((margin for margin, _ in self.nearest), None),
            "without_spread": [row.question for row in self.rows if row.margin_sigma is None],
            "questions": [asdict(row) for row in self.rows],
        }


def rejected_below(question: Question) -> float:
    """The points that a wrong answer must stay below.

    They are half of the points, or just more than a part that earns up to `LARGEST_PART` of them.
    """
    weights = [test.weight for test in question.tests]
    share = max(weights) / sum(weights)
    return (share + 1e-9 if 0.5 < share <= LARGEST_PART else 0.5) * question.points


def make(
    course: Course,
    names: Iterable[str],
    seed: int,
    mistakes: Functions | None = None,
    variants: Functions | None = None,
    progress: Callable[[Row], None] = lambda row: None,
    draws: int = DRAWS,
) -> ReportCard:
    """Mark all known answers and mistakes of some assignments.

    Args:
        course: The course.
        names: Names of the assignments; "assignment/question" selects one question.
        seed: Seed of the first draw of hidden cases; the next draws take the next seeds.
        mistakes: Further wrong answers, which cannot be recognised by name.
        variants: Further right answers.
        progress: Called with each row when it is complete.
        draws: Number of draws of the hidden cases.

    Raises:
        UnknownName: There is no such assignment, or no such question for an answer.
    """
    problems = [
        (assignment, problem)
        for assignment, _, only in (name.partition("/") for name in names)
        for problem in _asked(course, assignment, only)
    ]
    asked = [question for name, problem in problems for question in _names(name, problem)]
    for question in (*(mistakes or {}), *(variants or {})):
        if question not in asked:
            raise UnknownName("question", question, asked)
    rows = []
    for name, problem in problems:
        more = (
            [f for question in _names(name, problem) for f in (given or {}).get(question, ())]
            for given in (mistakes, variants)
        )
        rows.append(_row(name, problem, seed, draws, *more))
        progress(rows[-1])
    return ReportCard(seed, draws, tuple(rows))


def _asked(course: Course, assignment: str, only: str) -> Sequence[Problem]:
    """The problems of an assignment, or only the one that is named."""
    problems = {problem.name: problem for problem in course.problems(assignment)}
    if only and only not in problems:
        raise UnknownName("question", only, tuple(problems))
    return [problems[only]] if only else list(problems.values())


def _names(assignment: str, problem: Problem) -> tuple[str, str]:
    return problem.name, f"{assignment}/{problem.name}"


def _row(
    name: str,
    problem: Problem,
    seed: int,
    draws: int,
    mistakes: Sequence[Callable[..., Any]],
    variants: Sequence[Callable[..., Any]],
) -> Row:
    questions = share_runs([problem.question(seed + k) for k in range(draws)])
    own = {w.name: w.function for w in problem.wrong}
    wrong = own | _labelled("from outside: ", mistakes)
    right = {"the answer": problem.answer} | _labelled("", [*problem.variants, *variants])
    with captured():  # what answers print is not the card's
        verdicts = {
            label: [mark(question, function) for question in questions]
            for label, function in (wrong | right).items()
        }
        margin, nearest = least_margin(questions, problem, right, wrong)
    marks = {label: [verdict.earned for verdict in found] for label, found in verdicts.items()}
    failures = []
    limit = rejected_below(questions[0])
    rejected = named = accepted = 0
    for label in wrong:
        if max(marks[label]) < limit:
            rejected += 1
        else:
            failures.append(f"{label}: earned {max(marks[label]):g} of {problem.points:g}")
        known = verdicts[label][0].mistake
        if known is not None and known.name == label:
            named += 1
        elif label in own:
            failures.append(f"{label}: taken for {known.name if known else 'nothing known'}")
        if all(test.hidden or test.outcome is Outcome.RIGHT for test in verdicts[label][0].tests):
            failures.append(f"{label}: only hidden cases reject it; add a public case that does")
    for label in right:
        if all(verdict.outcome is Outcome.RIGHT for verdict in verdicts[label]):
            accepted += 1
        else:
            failures.append(f"{label}: a right answer earned only {min(marks[label]):g}")
    if margin is not None and margin < LEAST_MARGIN:
        needed = f"at least {LEAST_MARGIN:g} are needed"
        failures.append(f"{nearest}: {margin:.2f} sigma from the tolerance; {needed}")
    agree = sum(all(m[k] == m[0] for m in marks.values()) for k in range(draws))
    tried = len(wrong), rejected, named, len(right), accepted, agree
    return Row(name, problem.name, *tried, margin, nearest, tuple(failures))


def _labelled(whose: str, functions: Sequence[Callable[..., Any]]) -> dict[str, Callable[..., Any]]:
    """Functions by their names, which are called as students' functions are.

    Functions of the same name are numbered, so that none is left out.
    """
    names = [f"{whose}{getattr(f, '__name__', type(f).__name__)}" for f in functions]
    before = [names[:k].count(name) for k, name in enumerate(names)]
    labels = [f"{name} ({n + 1})" if n else name for name, n in zip(names, before, strict=True)]
    return {name: LocalFunction(f, TIMEOUT) for name, f in zip(labels, functions, strict=True)}


def functions_from(file: Path, table: str) -> Functions:
    """Further answers, from a dict in a Python file.

    Args:
        file: Contains a dict {question: [function, ...]}; a question is named as its stub.
        table: The dict's name, "MISTAKES" or "VARIANTS".

    Raises:
        LabkitError: The file is missing, does not run, or does not contain such a dict.
    """
    try:
        names = runpy.run_path(str(file))
    except (Exception, SystemExit) as error:
        raise LabkitError(f"{file} does not run: {type(error).__name__}: {error}") from error
    found: Functions | None = names.get(table)
    form = f"write {table} = {{question: [functions]}}"
    if not isinstance(found, dict):
        raise LabkitError(f"{file} has no dict {table}; {form}")
    for question, functions in found.items():
        if not isinstance(functions, list | tuple) or not all(map(callable, functions)):
            raise LabkitError(f"{table}[{question!r}] of {file} is not a list of functions; {form}")
    return found


def write(card: ReportCard, folder: Path) -> tuple[Path, Path]:
    """Write ``report_card.json`` and ``report_card.md`` into a folder; returns both paths."""
    folder.mkdir(parents=True, exist_ok=True)
    table, page = folder / "report_card.json", folder / "report_card.md"
    table.write_text(json.dumps(card.data(), indent=1, ensure_ascii=False) + "\n", "utf-8")
    page.write_text(markdown(card), "utf-8")
    return table, page


def markdown(card: ReportCard) -> str:
    """The card as a page."""
    data = card.data()
    nearest = [f"{margin:.2f} ({row.assignment}/{row.question})" for margin, row in card.nearest]
    lines = [
        "# Report card of the checks",
        "",
        f"Hidden cases drawn {card.seeds} times, from seed {card.seed} on.",
        "",
        f"- mistakes rejected: {data['rejected']} of {data['mistakes']}, named: {data['named']}",
        f"- right answers accepted: {data['accepted']} of {data['variants']}",
        f"- draws that agree: {data['seeds_agree']} of {card.seeds}",
        f"- least margins, in sigma: {', '.join(nearest[:3]) or 'none measured'}",
        "",
        "| assignment | question | rejected | named | accepted | draws | margin [σ] | nearest |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in card.rows:
        margin = "no spread" if row.margin_sigma is None else f"{row.margin_sigma:.1f}"
        lines.append(
            f"| {row.assignment} | {row.question} | {row.rejected}/{row.mistakes} | {row.named} "
            f"| {row.accepted}/{row.variants} | {row.seeds_agree}/{card.seeds} | {margin} "
            f"| {row.nearest} |"
        )
    failures = [f"- {row.question}: {words}" for row in card.rows for words in row.failures]
    return (
        "\n".join([*lines, *(["", "## What failed", "", *failures] if failures else [""])]) + "\n"
    )
