"""Feedback: one page for each student, verdicts in words, nothing that should stay hidden.

It is made from the result alone, so no hidden case and no reference value of one can be in it;
whatever a student's code said is shown as text.  A page with a replay brings the viewer and the
robot along, 1.7 MB; its policy names each script by its hash, and nothing is loaded from anywhere.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Mapping
from functools import cache, partial
from hashlib import sha256
from html import escape
from pathlib import Path
from typing import Any

from ..course import Outcome
from ..course.layout import Course
from ..course.messages import GATE, HEADS, why
from ..replay import viewer_scripts
from .each import Failed, for_student
from .own_work import has_replay, own_work
from .results import Answer, Result, write

PAGE = Path(__file__).parents[1] / "data" / "feedback"
_HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<main>
"""


def page(result: Result, comments: Mapping[str, str] | None = None) -> str:
    """The page of one student.

    Args:
        result: What came of the submission.
        comments: What the teacher wrote by hand, by question.

    Returns:
        HTML in one piece, readable without its scripts.
    """
    title = escape(f"{result.assignment}: feedback for {result.student}")
    style, scripts = _style(), _scripts() if has_replay(result) else ()
    lines = [
        _HEAD.format(title=title, style=style, policy=_policy(style, scripts)),
        f"<h1>{title}</h1>",
    ]
    if result.rejected:
        lines.append(
            f'<p class="total"><strong>0 of {result.points:g} points:</strong> '
            f"it could not be graded; {escape(result.rejected)}.</p>"
            "<p>Mend this and hand it in again, or talk to your teacher.</p>"
        )
    else:
        right = sum(question.verdict.right for question in result.questions)
        lines.append(
            f'<p class="total"><strong>{result.score:g} of {result.points:g} points.</strong> '
            f"{right} of {len(result.questions)} questions are right.</p>"
        )
    lines += [f"<p>Note: {escape(note)}.</p>" for note in result.notes]
    for question in result.questions:
        lines += _question(question, (comments or {}).get(question.verdict.name, ""))
    if result.cells:
        lines.append("<h2>Cells that did not run</h2><ul>")
        for cell in result.cells:
            what = f"{cell['kind']}: {cell['error']}" if cell["kind"] != "died" else cell["error"]
            lines.append(f"<li>Cell {cell['cell'] + 1}: {escape(what)}</li>")
        lines.append("</ul>")
    lines += ["</main>", *(f"<script>{script}</script>" for script in scripts)]
    return "\n".join([*lines, "</body>", "</html>", ""])


def write_feedback(
    course: Course, assignment: str, results: Iterable[Result], comments: Mapping[str, Any]
) -> list[Path | Failed]:
    """Write the pages where ``nbgrader release_feedback`` looks for them.

    Args:
        course: The course.
        assignment: Which.
        results: Of its students.
        comments: Written by hand: by student, then by question.

    Returns:
        The files; and for whom no page could be made.
    """

    def make(result: Result) -> Path:
        path = course.root / "feedback" / result.student / assignment / f"{assignment}.html"
        write(path, page(result, comments.get(result.student)))
        return path

    return [for_student(result.student, partial(make, result)) for result in results]


@cache
def _style() -> str:
    return (PAGE / "page.css").read_text(encoding="utf-8")


@cache
def _scripts() -> tuple[str, ...]:
    return (*viewer_scripts(), (PAGE / "page.js").read_text(encoding="utf-8"))


@cache
def _policy(style: str, scripts: tuple[str, ...]) -> str:
    """The content security policy: this style, these scripts, nothing else."""
    rules = ["default-src 'none'", f"style-src {_hash(style)}"]
    rules += [f"script-src {' '.join(map(_hash, scripts))}"] if scripts else []
    return "; ".join([*rules, "base-uri 'none'", "form-action 'none'"])


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _question(answer: Answer, comment: str) -> Iterable[str]:
    verdict = answer.verdict
    name, mark = escape(verdict.name), "yes" if verdict.right else "no"
    yield f'<section aria-labelledby="{name}"><h2 id="{name}"><code>{name}</code></h2>'
    yield (
        f'<p><strong class="{mark}">{HEADS[verdict.outcome].capitalize()}.</strong> '
        f"{verdict.earned:g} of {verdict.points:g} points.</p>"
    )
    if verdict.outcome in {Outcome.WRONG, Outcome.ERROR}:
        yield "<ul>"
        for test in verdict.tests:
            right = test.outcome is Outcome.RIGHT
            gate, says = "" if test.weight else GATE, escape(why(test))
            word = '<span class="yes">passed</span>' if right else '<span class="no">failed</span>'
            yield f"<li>{word}: {escape(test.name)}{gate}{says and f': {says}'}</li>"
        yield "</ul>"
    yield from own_work(answer)
    if verdict.mistake:
        yield (
            f'<p class="tip"><strong>A well-known one: {escape(verdict.mistake.name)}.'
            f"</strong> {escape(verdict.mistake.says)}</p>"
        )
    yield from (f"<p>Note: {escape(note)}.</p>" for note in answer.notes)
    if comment:
        yield f'<p class="tip"><strong>Your teacher:</strong> {escape(comment)}</p>'
    if answer.source and verdict.outcome is not Outcome.NOT_ATTEMPTED:
        source = escape(answer.source)
        yield f'<details><summary>Your answer</summary><pre tabindex="0">{source}</pre></details>'
    yield "</section>"
