"""Report what a class understood: marks, success rates, misconceptions."""

from __future__ import annotations

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from statistics import mean, median
from typing import Any

from ..course.authoring.problem import Problem
from ..course.judges import Form
from ..course.messages import why_not_counted
from ..course.question import Question
from ..course.verdict import Outcome, Verdict
from .batch import common_failures
from .clean import clean_line
from .each import for_student
from .marks import Mark
from .pages import render
from .results import Result

COUNTED = (Outcome.RIGHT, Outcome.WRONG, Outcome.ERROR, Outcome.NOT_COUNTED, Outcome.NOT_ATTEMPTED)
"""Outcomes that have a column of the table."""
_Row = dict[str, Any]
"""A row for the template, whose keys are the names that the template uses."""


def report(
    assignment: str,
    marks: Sequence[Mark],
    problems: Mapping[str, Problem],
    asked: Sequence[Question] = (),
    truths: Mapping[str, Any] | None = None,
) -> str:
    """The class report, in Markdown; it names nobody.

    Args:
        assignment: The name of the assignment.
        marks: The marks of the class; students who did not hand in are left out.
        problems: The problems by name, for what to say in the lecture.
        asked: The questions of the assignment, for their texts and predictions.
        truths: The right value of each prediction, by name.
    """
    marks = [mark for mark in marks if not mark.absent]
    counted = [mark for mark in marks if mark.result and (mark.lines or not mark.missing)]
    results = [mark.result for mark in counted if mark.result]
    graded = [r for r in results if not r.rejected]
    full = [m for m in counted if m.raw is not None and m.result in graded]
    verdicts: dict[str, list[Verdict]] = defaultdict(list)
    for verdict in (answer.verdict for result in graded for answer in result.questions):
        verdicts[verdict.name].append(verdict)
    tests = [test for found in verdicts.values() for verdict in found for test in verdict.tests]
    shares = {
        name: mean(v.earned / v.points for v in found)
        for name, found in verdicts.items()
        if all(v.points for v in found)
    }
    text = render(
        "class_report.md.j2",
        assignment=assignment,
        handed_in=len(marks),
        left_out=len(marks) - len(counted),
        open=sum(bool(mark.open) for mark in counted),
        rejected=len(results) - len(graded),
        graded=len(graded),
        scores=sorted(float(m.score) for m in full),
        points=max((mark.points for mark in counted), default=0.0),
        mean=mean,
        median=median,
        counts={k: Counter(v.outcome for v in found) for k, found in verdicts.items()},
        columns=COUNTED,
        shares=shares,
        tests=len(tests),
        hidden=sum(test.hidden for test in tests),
        texts={q.name: _short_question(q) for q in asked},
        predictions=list(_prediction_rows(graded, asked, truths or {})),
        mistakes=list(_mistake_rows(verdicts, problems)),
        tools=Counter(
            f"{v.name} {why_not_counted(v.withheld)}"
            for found in verdicts.values()
            for v in found
            if v.withheld
        ),
        doubtful=list(common_failures(graded)),
    )
    return text.rstrip() + "\n"


def _prediction_rows(
    graded: Sequence[Result], asked: Sequence[Question], truths: Mapping[str, Any]
) -> Iterator[_Row]:
    """For each prediction, the truth and what at least two committed to, most common first."""
    sources = [(x.student, {q.verdict.name: q.source for q in x.questions}) for x in graded]
    for question in asked:
        form = question.judge
        if isinstance(form, Form):
            told = [for_student(who, _said, form, x.get(question.name, "")) for who, x in sources]
            counts = Counter(x for x in told if isinstance(x, str))
            truth = _escape(form.words(truths[question.name])) if question.name in truths else ""
            said = [(n, _escape(words)) for words, n in counts.most_common() if n > 1]
            rest = len(sources) - sum(n for n, _ in said)
            asks = " ".join(question.asks.split())
            yield {"name": question.name, "asks": asks, "truth": truth, "said": said, "rest": rest}


def _said(form: Form, source: str) -> str | None:
    """What a student predicted, in words; None if it is no answer."""
    value = _committed(source)
    return None if form.problem(value) else form.words(value)


def _committed(source: str) -> Any:
    """The value in ``name = predict("name", value)``; None if there is none."""
    try:
        for node in ast.walk(ast.parse(source)):
            match node:
                case ast.Call(func=ast.Name("predict"), args=[_, value, *_]):
                    return ast.literal_eval(value)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        pass
    return None


def _mistake_rows(
    verdicts: Mapping[str, Sequence[Verdict]], problems: Mapping[str, Problem]
) -> Iterator[_Row]:
    """How many made each known mistake, and what to say about it, most common first."""
    made = Counter((v.name, v.mistake.name) for x in verdicts.values() for v in x if v.mistake)
    for (name, mistake), count in made.most_common():
        known = problems[name].wrong if name in problems else ()
        say = next((w.lecture or w.says for w in known if w.name == mistake), "")
        yield {"students": count, "question": name, "name": mistake, "say": say}


def _short_question(question: Question) -> str:
    """The text of a question for a cell of a table; predictions have a section of their own."""
    is_prediction = isinstance(question.judge, Form)
    return "see below" if is_prediction else " ".join(question.asks.split()).replace("|", r"\|")


def _escape(text: str) -> str:
    """A text as one line in which all Markdown markup is escaped."""
    return re.sub(r"([\\`*\[\]<>|&])", r"\\\1", clean_line(text))
