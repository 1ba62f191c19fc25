"""What the class understood: marks, success, misconceptions by name, the same texts."""

from __future__ import annotations

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import mean, median
from typing import Any, NamedTuple

from ...course.authoring.outcomes import OUTCOMES
from ...course.authoring.problem import Problem
from ...course.forms import Form
from ...course.messages import why_not_counted
from ...course.question import Question
from ...course.verdict import Outcome, Verdict
from ..clean import clean_line
from ..grading.batch import common_failures
from ..grading.results import Result
from ..marks.mark import Mark
from ..pages import render
from .alike import same_text

SLOW = 30.0
FEWEST = 5
"""A report without names tells no count of fewer students."""
COUNTED = (
    *(Outcome.RIGHT, Outcome.WRONG, Outcome.ERROR),
    *(Outcome.NOT_COUNTED, Outcome.NOT_ATTEMPTED),
)
"""Outcomes that have a column."""
_Row = dict[str, Any]
"""A row for the template, by the names that it uses."""


def report(
    assignment: str,
    marks: Sequence[Mark],
    problems: Mapping[str, Problem],
    called: Callable[[str], str],
    fewest: int = 1,
    asked: Sequence[Question] = (),
    truths: Mapping[str, Any] | None = None,
) -> str:
    """The report, in Markdown.

    Args:
        assignment: Which.
        marks: Of the class; the roster's students without one are left out.
        problems: By name, for what to say in the lecture.
        called: What a student is called in it: ``str``, or `pseudonyms`.
        fewest: No count of fewer students is said, from which somebody could tell who they are.
        asked: The assignment's questions, for their texts, the outcomes and the predictions.
        truths: By prediction, what would have been right.
    """
    marks = [mark for mark in marks if not mark.absent]
    counted = [mark for mark in marks if mark.result and (mark.lines or not mark.missing)]
    results = [mark.result for mark in counted if mark.result]
    who = {r.student: _as_text(called(r.student)) for r in results}
    graded = [r for r in results if not r.unanswered]
    rejected = [r for r in results if r.unanswered]
    times = sorted(((r.seconds.get("all", 0.0), who[r.student]) for r in graded), reverse=True)
    text = render(
        "class_report.md.j2",
        assignment=assignment,
        handed_in=len(marks),
        left_out=len(marks) - len(counted),
        open=sum(bool(mark.open) for mark in counted),
        rejected=[f"{who[r.student]}: {_as_text(r.unanswered)}" for r in rejected],
        graded=len(graded),
        scores=sorted(
            float(m.score) for m in counted if m.raw is not None and m.result not in rejected
        ),
        points=max((mark.points for mark in counted), default=0.0),
        mean=mean,
        median=median,
        changed=any(x.automatic not in (None, x.score) for mark in counted for x in mark.lines),
        questions=(questions := list(_questions(graded))),
        can=list(_can(questions, asked)),
        texts={q.name: _brief(q) for q in asked},
        believed=list(_believed(graded, asked, fewest, truths or {})),
        mistakes=list(_mistakes(graded, problems)),
        count=lambda n: f"<{fewest}" if 0 < n < fewest else n,
        tools=list(_tools(graded, who)),
        doubtful=list(common_failures(graded)),
        slow_limit=f"{SLOW:g}",
        slow=[f"{name}: {seconds:.0f} s" for seconds, name in times if seconds > SLOW],
        same_text=list(same_text(graded, who)),
    )
    return text.rstrip() + "\n"


def for_jplag(results: Sequence[Result], folder: Path, called: Callable[[str], str]) -> int:
    """Write the answers as JPlag wants them, a folder for each student; returns how many."""
    count = 0
    for result in results:
        for question in result.questions:
            if question.source and question.verdict.outcome is not Outcome.NOT_ATTEMPTED:
                path = folder / called(result.student) / f"{question.verdict.name}.py"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(question.source, encoding="utf-8", errors="replace")
                count += 1
    return count


class _QuestionRow(NamedTuple):
    name: str
    counts: list[int]
    share: float | None
    """Of the points, on average; None where the question has none."""


def _questions(graded: Sequence[Result]) -> Iterator[_QuestionRow]:
    verdicts: dict[str, list[Verdict]] = defaultdict(list)
    for result in graded:
        for question in result.questions:
            verdicts[question.verdict.name].append(question.verdict)
    for name, mine in verdicts.items():
        count = Counter(verdict.outcome for verdict in mine)
        shares = [verdict.earned / verdict.points for verdict in mine if verdict.points]
        yield _QuestionRow(name, [count[x] for x in COUNTED], mean(shares) if shares else None)


def _can(rows: Sequence[_QuestionRow], asked: Sequence[Question]) -> Iterator[_Row]:
    """For each outcome of the course, what the questions say that are evidence of it."""
    shares = {row.name: row.share for row in rows if row.share is not None}
    for outcome, says in OUTCOMES.items():
        names = [q.name for q in asked if outcome in q.outcomes and q.name in shares]
        if names:
            text = ", ".join(f"`{name}`" for name in names)
            share = mean(shares[name] for name in names)
            yield {"says": says, "questions": text, "share": share}


def _believed(
    graded: Sequence[Result], asked: Sequence[Question], fewest: int, truths: Mapping[str, Any]
) -> Iterator[_Row]:
    """For each prediction, what is true and what the class committed to, the commonest first."""
    sources = [{q.verdict.name: q.source for q in result.questions} for result in graded]
    for question in asked:
        form = question.judge
        if isinstance(form, Form):
            values = (_committed(source.get(question.name, "")) for source in sources)
            counts = Counter(form.words(x) for x in values if not form.problem(x))
            truth = form.words(truths[question.name]) if question.name in truths else ""
            common = [
                f"{n} x {_as_text(words)}{', which is true' * (words == truth)}"
                for words, n in counts.most_common()
                if n >= fewest
            ]
            rest = len(sources) - sum(n for n in counts.values() if n >= fewest)
            alike = f", fewer than {fewest} of them alike," if fewest > 1 else ""
            others = f"{rest} {'other' if rest == 1 else 'others'}{alike} or no answer"
            said = [*common, *[others] * bool(rest)]
            asks = " ".join(question.asks.split())
            yield {"name": question.name, "asks": asks, "truth": truth, "said": said}


def _committed(source: str) -> Any:
    """The value in ``name = predict("name", value)``; None if none is written down."""
    try:
        for node in ast.walk(ast.parse(source)):
            match node:
                case ast.Call(func=ast.Name("predict"), args=[_, value, *_]):
                    return ast.literal_eval(value)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        pass
    return None


def _mistakes(graded: Sequence[Result], problems: Mapping[str, Problem]) -> Iterator[_Row]:
    """How many made each known mistake, and what to say of it, the commonest first."""
    verdicts = (question.verdict for result in graded for question in result.questions)
    made = Counter((v.name, v.mistake.name) for v in verdicts if v.mistake)
    for (name, mistake), count in made.most_common():
        known = problems[name].wrong if name in problems else ()
        say = next((w.lecture or w.says for w in known if w.name == mistake), "")
        yield {"students": count, "question": name, "name": mistake, "say": say}


def _tools(graded: Sequence[Result], who: Mapping[str, str]) -> Iterator[str]:
    """What each student used that a question withholds, and what in a cell needs a look."""
    for result in graded:
        verdicts = [question.verdict for question in result.questions]
        used = [f"{v.name} {why_not_counted(v.withheld)}" for v in verdicts if v.withheld]
        if used:
            yield f"{who[result.student]}, not counted: {'; '.join(used)}"
        if result.tricks:
            yield f"{who[result.student]}, worth a look: {'; '.join(result.tricks[:20])}"


def _brief(question: Question) -> str:
    """What a question asks, in a cell of a table; predictions have a section of their own."""
    is_prediction = isinstance(question.judge, Form)
    return "see below" if is_prediction else " ".join(question.asks.split()).replace("|", r"\|")


def _as_text(text: str) -> str:
    """A line in which Markdown sees no markup."""
    return re.sub(r"([\\`*\[\]<>|&])", r"\\\1", clean_line(text))
