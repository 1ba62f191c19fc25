"""The report card: how well the checks tell right from wrong, and by what margin.

Every answer, known mistake and right variant is marked with many draws of the hidden cases.  Their
distances from what is expected are measured in tolerances: right answers lie below 1, a mistake
lies above it wherever it is found out.  Over draws, disturbed inputs, starts and seeds of the noise
these distances spread; the margin is how many of their standard deviations lie between their mean
and the tolerance.  Logarithms are compared, since distances spread over decades.  Where nothing
spreads there is no sigma, and the question is listed apart.
"""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..check import Call, Choice, Loop, Outcome, Question, Tuned, mark
from ..check.codec import encode
from ..check.judge import AtMost
from ..check.question import Case
from ..errors import LabkitError, UnknownName
from .course import Course
from .problem import Problem

Functions = Mapping[str, Sequence[Callable[..., Any]]]
"""Functions by the name of their question."""

DRAWS = 20
ROUNDING = 1e-3
"""Distances below this, in tolerances, are rounding, and count as this much."""
HUGE = 1e12
"""Distances above this count as this much."""


@dataclass(frozen=True)
class Row:
    """What the card says of one question.

    Attributes:
        assignment: Where it is asked.
        question: Its name.
        mistakes: Wrong answers tried.
        rejected: Of these, how many earned less than half.
        named: Of the course's own, how many were called by their name.
        variants: Right answers tried, the reference included.
        accepted: Of these, how many earned full marks.
        seeds_agree: Draws of the hidden cases after which every mark is that of the first draw.
        margin_sigma: Distance of the nearest answer from the tolerance, in sigmas; None where
            nothing spreads.
        nearest: Which answer that is.
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
class Card:
    """The whole card.

    Attributes:
        seed: Of the first draw.
        seeds: How many draws.
        rows: One for each question.
    """

    seed: int
    seeds: int
    rows: tuple[Row, ...]

    def data(self) -> dict[str, Any]:
        """Totals and rows, as JSON data."""
        totals: dict[str, Any] = {
            key: sum(getattr(row, key) for row in self.rows)
            for key in ("mistakes", "rejected", "named", "variants", "accepted")
        }
        margins = [row.margin_sigma for row in self.rows if row.margin_sigma is not None]
        return {
            "seed": self.seed,
            "seeds": self.seeds,
            **totals,
            "seeds_agree": min((row.seeds_agree for row in self.rows), default=0),
            "min_margin_sigma": min(margins, default=None),
            "without_spread": [row.question for row in self.rows if row.margin_sigma is None],
            "questions": [asdict(row) for row in self.rows],
        }


def make(
    course: Course,
    names: Iterable[str],
    seed: int,
    mistakes: Functions | None = None,
    variants: Functions | None = None,
    progress: Callable[[Row], None] = lambda row: None,
) -> Card:
    """Mark everything that is known of some assignments.

    Args:
        course: The course.
        names: Of the assignments.
        seed: Of the first draw of hidden cases; the others follow it.
        mistakes: More wrong answers, from outside; these have no name to be called by.
        variants: More right answers, from outside.
        progress: Told each row when it is done.

    Raises:
        UnknownName: No such assignment, or an answer to a question that nobody asks.
    """
    problems = [(name, problem) for name in names for problem in course.problems(name)]
    asked = [problem.name for _, problem in problems]
    for question in (*(mistakes or {}), *(variants or {})):
        if question not in asked:
            raise UnknownName("question", question, asked)
    rows = []
    for name, problem in problems:
        more = (tuple((given or {}).get(problem.name, ())) for given in (mistakes, variants))
        rows.append(_row(name, problem, seed, *more))
        progress(rows[-1])
    return Card(seed, DRAWS, tuple(rows))


def _row(
    name: str,
    problem: Problem,
    seed: int,
    mistakes: Sequence[Callable[..., Any]],
    variants: Sequence[Callable[..., Any]],
) -> Row:
    questions = _remembering([problem.question(seed + k) for k in range(DRAWS)])
    wrong = {w.name: w.function for w in problem.wrong}
    wrong |= {f"from outside: {_name(f)}": f for f in mistakes}
    right = {"the answer": problem.answer}
    right |= {_name(f): f for f in (*problem.variants, *variants)}
    failures, marks = [], {}
    rejected = named = accepted = 0
    for label, function in wrong.items():
        verdicts = [mark(question, function) for question in questions]
        marks[label] = [verdict.earned for verdict in verdicts]
        if max(marks[label]) < 0.5 * problem.points:
            rejected += 1
        else:
            failures.append(f"{label}: earned {max(marks[label]):g} of {problem.points:g}")
        known = verdicts[0].mistake
        if known is not None and known.name == label:
            named += 1
        elif label in {w.name for w in problem.wrong}:
            failures.append(f"{label}: taken for {known.name if known else 'nothing known'}")
    for label, function in right.items():
        verdicts = [mark(question, function) for question in questions]
        marks[label] = [verdict.earned for verdict in verdicts]
        if all(verdict.outcome is Outcome.RIGHT for verdict in verdicts):
            accepted += 1
        else:
            failures.append(f"{label}: a right answer earned only {min(marks[label]):g}")
    agree = sum(all(m[k] == m[0] for m in marks.values()) for k in range(DRAWS))
    margin, nearest = _margin(questions, problem, right, wrong)
    return Row(
        name,
        problem.name,
        len(wrong),
        rejected,
        named,
        len(right),
        accepted,
        agree,
        margin,
        nearest,
        tuple(failures),
    )


Memory = dict[Any, dict[str, float]]


@dataclass(frozen=True, eq=False)
class _Remembered(Loop):
    """A run that is made once for each function and each start, however often it is asked for."""

    memory: Memory = field(default_factory=dict)

    def ask(self, function: Callable[..., Any]) -> Any:
        """The measures of the run, for a log takes room; runs that raise are made again."""
        key = (function, _run_key(self))
        if key not in self.memory:
            self.memory[key] = super().measured(super().ask(function))
        return self.memory[key]

    def measured(self, answer: Any) -> dict[str, float]:
        """What `ask` gave."""
        measures: dict[str, float] = answer
        return measures


@dataclass(frozen=True, eq=False)
class _RememberedGains(Tuned):
    """The same for a run with chosen gains."""

    memory: Memory = field(default_factory=dict)

    def ask(self, function: Callable[..., Any]) -> Any:
        """The measures of the run, for a log takes room; runs that raise are made again."""
        key = (function, json.dumps(encode(self.args)), _run_key(self.loop))
        if key not in self.memory:
            self.memory[key] = super().measured(super().ask(function))
        return self.memory[key]

    def measured(self, answer: Any) -> dict[str, float]:
        """What `ask` gave."""
        measures: dict[str, float] = answer
        return measures


def _run_key(loop: Loop) -> str:
    return json.dumps({key: encode(x) for key, x in vars(loop).items() if key != "memory"})


def _remembering(questions: Sequence[Question]) -> list[Question]:
    memory: Memory = {}

    def case(x: Case) -> Case:
        if isinstance(x, Call | Choice):
            return x
        kind: Any = _Remembered if isinstance(x, Loop) else _RememberedGains
        remembered: Case = kind(**vars(x), memory=memory)
        return remembered

    return [
        replace(q, tests=tuple(replace(t, cases=tuple(map(case, t.cases))) for t in q.tests))
        for q in questions
    ]


def _margin(
    questions: Sequence[Question],
    problem: Problem,
    right: Mapping[str, Callable[..., Any]],
    wrong: Mapping[str, Callable[..., Any]],
) -> tuple[float | None, str]:
    """The least distance from a tolerance in sigmas, and whose it is."""
    found: list[tuple[float, str]] = []
    for k, test in enumerate(questions[0].tests):
        for label, function in right.items():
            apart: dict[type, list[float]] = {}  # runs and calls have tolerances of different kinds
            for q, case in _cases(questions, k):
                spread = apart.setdefault(_kind(case), [])
                spread.append(_distance(q, case, function))
                spread.append(_disturbed(q, case, function, problem))
            for spread in apart.values():
                found += _sigmas(spread, -1.0, f"{label}: {test.name}")
        for label, function in wrong.items():
            distances = [
                max(_distance(q, case, function) for case in q.tests[k].cases) for q in questions
            ]
            if min(distances) > 1.0:
                found += _sigmas(distances, 1.0, f"{label}: {test.name}")
    return min(found, default=(None, ""))


def _cases(questions: Sequence[Question], k: int) -> list[tuple[Question, Case]]:
    """All cases of the k-th test over all draws, public ones once."""
    hidden = [(q, case) for q in questions for case in q.tests[k].cases if case.hidden]
    return [(questions[0], c) for c in questions[0].tests[k].cases if not c.hidden] + hidden


def _kind(case: Case) -> type:
    """What sort of case it is, remembered or not."""
    return next(kind for kind in (Call, Loop, Choice, Tuned) if isinstance(case, kind))


def _sigmas(distances: Sequence[float], sign: float, whose: str) -> list[tuple[float, str]]:
    """How many standard deviations the mean lies beyond the tolerance, on the side ``sign``."""
    logs = np.log10(np.clip([d for d in distances if np.isfinite(d)], ROUNDING, HUGE))
    if len(logs) < 2 or float(np.std(logs)) < 1e-9:
        return []
    return [(sign * float(np.mean(logs)) / float(np.std(logs, ddof=1)), whose)]


def _distance(question: Question, case: Case, function: Callable[..., Any]) -> float:
    """How far an answer is off, in tolerances; infinite where none came."""
    try:
        answer: Any = case.ask(function)
        if isinstance(case, Call):
            return question.judge.distance(answer, case.expected)
        return AtMost().distance(case.measured(answer), case.expected)
    except Exception:
        return float("inf")


def _disturbed(
    question: Question, case: Case, function: Callable[..., Any], problem: Problem
) -> float:
    """The same with the input disturbed: rounded numbers, or another seed of the arm's noise."""
    if isinstance(case, Loop):
        return _distance(question, _another_noise(case), function)
    if isinstance(case, Tuned):
        return _distance(question, replace(case, loop=_another_noise(case.loop)), function)
    if isinstance(case, Choice):
        return _distance(question, case, function)
    again = replace(case, args=tuple(map(_rounded, case.args)))
    again = replace(again, expected=again.ask(problem.expected or problem.answer))
    return _distance(question, again, function)


def _another_noise(loop: Loop) -> Loop:
    noisy = any(loop.plant.velocity_noise) or loop.plant.lost_ticks > 0.0
    return replace(loop, seed=loop.seed + 1) if noisy else loop


def _rounded(x: Any) -> Any:
    """Numbers and arrays to seven digits; anything else as it is."""
    if isinstance(x, float):
        return float(f"{x:.7g}")
    if isinstance(x, np.ndarray):
        return np.round(x, 7)
    return x


def functions_from(file: Path, table: str) -> Functions:
    """Answers from outside: a dict of a Python file.

    Args:
        file: Holds a dict {question: [function, ...]}; a question is named as its stub.
        table: The dict's name, "MISTAKES" or "VARIANTS".

    Raises:
        LabkitError: There is no such file, or no such dict in it.
    """
    spec = importlib.util.spec_from_file_location("answers_from_outside", file)
    if spec is None or spec.loader is None or not file.exists():
        raise LabkitError(f"{file} is no Python file; give one with a dict {table}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found: Functions | None = getattr(module, table, None)
    if not isinstance(found, dict):
        raise LabkitError(f"{file} has no dict {table}; write {table} = {{question: [functions]}}")
    return found


def write(card: Card, folder: Path) -> tuple[Path, Path]:
    """Write ``report_card.json`` and ``report_card.md`` into a folder; returns both paths."""
    folder.mkdir(parents=True, exist_ok=True)
    table, page = folder / "report_card.json", folder / "report_card.md"
    table.write_text(json.dumps(card.data(), indent=1, ensure_ascii=False) + "\n", "utf-8")
    page.write_text(markdown(card), "utf-8")
    return table, page


def markdown(card: Card) -> str:
    """The card as a page."""
    data = card.data()
    least = data["min_margin_sigma"]
    lines = [
        "# Report card of the checks",
        "",
        f"Hidden cases drawn {card.seeds} times, from seed {card.seed} on.",
        "",
        f"- mistakes rejected: {data['rejected']} of {data['mistakes']}, named: {data['named']}",
        f"- right answers accepted: {data['accepted']} of {data['variants']}",
        f"- draws that agree: {data['seeds_agree']} of {card.seeds}",
        f"- least margin: {'none measured' if least is None else f'{least:.1f} sigma'}",
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


def _name(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", type(function).__name__)
