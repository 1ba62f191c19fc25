"""Write feedback: a page for each student, with verdicts in words and nothing hidden.

A page is made from the result only, so it cannot show a hidden case or the value expected in one.
What a student's code printed or raised is shown as text.  A page with a replay contains the viewer
and the robot, 1.7 MB.  Its content policy names each script by its hash, and it loads nothing.

Moodle accepts pages as a zip, and recognises a participant by the number in the name of a folder,
``NAME_PARTICIPANT_assignfeedback_file`` (github.com/moodle/moodle,
``mod/assign/feedback/file/importziplib.php``).
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

import bleach
import numpy as np
from jinja2 import pass_context
from markupsafe import Markup
from nbconvert import HTMLExporter

from ..course import messages
from ..course.authoring.layout import Course
from ..course.messages import is_prediction
from ..errors import LabkitError
from ..metrics import SETTLED
from ..replay.motion import unpack
from .collect import participants
from .each import Failure, for_student
from .files import write
from .marks import Mark, mark_of
from .pages import render_page
from .results import Result
from .rules import read_rules

MEASURES = {
    "rms_mm": ("position error of the tip, RMS", "mm", 1.0),
    "max_mm": ("position error of the tip, largest", "mm", 1.0),
    "rms_deg": ("orientation error of the tip, RMS", "degrees", 1.0),
    "max_deg": ("orientation error of the tip, largest", "degrees", 1.0),
    "rms_velocity_mm_s": ("velocity error of the tip, RMS", "mm/s", 1.0),
    "settling": (f"until it stays within {1e3 * SETTLED:g} mm", "s", 1.0),
    "effort": ("motor torque, RMS", "N m", 1.0),
    "saturated": ("commands that a limit cut", "%", 100.0),
    "duration": ("duration", "s", 1.0),
}
"""The name of each field of `metrics.Summary`, its unit, and the factor to that unit."""


class Measure(NamedTuple):
    """A row in the table of a run: value and limit, each with its unit, and whether it is over."""

    words: str
    value: str
    limit: str
    over: bool


def page(result: Result, mark: Mark | None = None, course: str = "") -> str:
    """The feedback page of one student.

    Args:
        result: The result of the submission.
        mark: The mark in the gradebook; by default that of the result.
        course: The name of the course.

    Returns:
        HTML in one file, which can be read without its scripts.
    """
    mark = mark or mark_of(result)
    asked = {line.name: line for line in mark_of(result).lines}
    replays = any(run["motion"] for q in result.questions for run in q.runs)
    return render_page(
        "feedback.html.j2",
        replays=replays,
        result=result,
        mark=mark,
        course=course,
        lines=asked | {line.name: line for line in mark.lines},
        by_hand=[line for line in mark.lines if line.name not in asked],
        answers=[q.verdict for q in result.questions if not is_prediction(q.verdict)],
        predictions=[q.verdict for q in result.questions if is_prediction(q.verdict)],
        say=messages,
        error_over_time=error_over_time,
        measures=measures,
        farthest=farthest,
        markdown=lambda text: Markup(markdown({}, text)),
    )


def write_feedback(course: Course, assignment: str, marks: Iterable[Mark]) -> list[Path | Failure]:
    """Write the pages where ``nbgrader release_feedback`` looks for them.

    Args:
        course: The course.
        assignment: The name of the assignment.
        marks: The marks of its students.

    Returns:
        For each student the file, or why no page could be made.
    """
    name = read_rules(course).name

    def make(mark: Mark) -> Path:
        if mark.result is None or (mark.missing and not mark.lines):
            raise LabkitError(mark.missing or "there is no result of theirs; grade again")
        path = course.root / "feedback" / mark.student / assignment / f"{assignment}.html"
        write(path, page(mark.result, mark, name))
        return path

    return [for_student(mark.student, make, mark) for mark in marks]


def error_over_time(run: Mapping[str, Any], motion: Mapping[str, Any]) -> tuple[Markup, str]:
    """The position error of the tip in a run, with the largest allowed: a figure, its words."""
    error = 1e3 * np.abs(unpack(motion["error"])[:, 0])
    t = motion["start"] + motion["period"] * np.arange(len(error))
    peak, limit = int(error.argmax()), run["limits"].get("max_mm")
    words = (
        f"Position error of the tip over {t[-1]:.3g} s: {_plain(error[0])} mm at the start, "
        f"largest at {t[peak]:.3g} s with {_plain(error[peak])} mm, {_plain(error[-1])} mm at the "
        "end."
    )
    top = max(error[peak], limit or 0.0) or 1.0
    x, y = 400 * (t - t[0]) / (t[-1] - t[0]), 150 - 130 * error / top
    shapes = [
        f'<path class="axes" d="M0 20V150H400"/><text y="12">{_plain(top)} mm</text>',
        f'<text x="400" y="166" text-anchor="end">{t[-1]:.3g} s</text>',
        f'<polyline points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))}"/>',
    ]
    if limit is not None:
        shapes.append(f'<path class="limit" d="M0 {150 - 130 * limit / top:.1f}H400"/>')
        since = f" from {run['since']:g} s on" if run["since"] else ""
        words += f" The dashed line is the largest that is allowed{since}, {limit:g} mm."
    figure = f'<svg viewBox="0 0 400 170" role="img" aria-label="{escape(words)}">'
    return Markup(f"{figure}{''.join(shapes)}</svg>"), words


def farthest(found: Mapping[str, Any]) -> str:
    """Which number of an answer is farthest from the expected one, in words."""
    expected, given = found["expected"], found["given"]
    worst = max(range(len(given)), key=lambda k: abs(expected[k] - given[k]))
    first = f"Of {found['of']} numbers, number {worst + 1} is farthest off: expected"
    return f"{first} {expected[worst]:.4g}, returned {given[worst]:.4g}."


def measures(run: Mapping[str, Any]) -> Iterator[Measure]:
    """The measures of a run and their limits."""
    for name, value in run["measures"].items():
        words, unit, factor = MEASURES.get(name, (name, "", 1.0))
        limit = run["limits"].get(name)
        said = ["never" if x is None else f"{_plain(factor * x)} {unit}" for x in (value, limit)]
        over = limit is not None and (value is None or value > limit)
        yield Measure(words, said[0], "" if limit is None else said[1], over)


def _plain(x: float) -> str:
    """A number with at least three digits, and without an exponent up to a billion."""
    return f"{x:.0f}" if 1e3 <= abs(x) < 1e9 else f"{x:.3g}"


def moodle_zip(course: Course, assignment: str, pages: Iterable[Path], to: Path) -> int:
    """Write the zip that Moodle accepts under *Upload multiple feedback files in a zip*.

    Args:
        course: The course.
        assignment: The name of the assignment.
        pages: Files such as ``feedback/STUDENT/ASSIGNMENT/NAME.html``.
        to: The file to write.

    Returns:
        The number of pages in the zip.

    Raises:
        LabkitError: None of the pages is for a student named in Moodle's download.
    """
    people = participants(course).get(assignment, {})
    mine = [
        (people[student], page) for page in pages if (student := page.parents[1].name) in people
    ]
    if not mine:
        raise LabkitError(
            f"none of these students' {assignment} was collected from Moodle, and the zip needs "
            f"Moodle's numbers of them; first type: labkit collect {assignment} MOODLE.zip"
        )
    to.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(to, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, page in mine:  # Moodle reads the number between the first two underscores
            name = page.parents[1].name.replace("_", " ")
            archive.write(page, f"{name}_{number}_assignfeedback_file/{page.name}")
    return len(mine)


_TAGS = (
    {"a", "abbr", "b", "blockquote", "br", "code", "del", "div", "em", "hr", "i", "kbd", "p", "pre"}
    | {"s", "small", "span", "strong", "sub", "sup", "details", "summary"}
    | {"h1", "h2", "h3", "h4", "h5", "h6", "dd", "dl", "dt", "li", "ol", "ul"}
    | {"table", "tbody", "td", "tfoot", "th", "thead", "tr"}
)
_LINKS = ("http://", "https://", "mailto:", "#")
"""Others could lead to a page that was handed in."""
_exporter = HTMLExporter(exclude_anchor_links=True)


@pass_context
def markdown(context: Any, source: str) -> str:
    """Markdown as HTML of known elements; as it was typed, where it cannot be read."""
    try:
        html = str(_exporter.markdown2html(context, source))
    except Exception:  # such as a picture that was not handed in
        html = f"<pre>{escape(source)}</pre>"
    return clean(html)


def clean(html: str | bytes) -> str:
    """HTML with known elements and links alone; anything else is shown as text."""
    text = html.decode(errors="replace") if isinstance(html, bytes) else html
    return str(bleach.clean(text, tags=_TAGS, attributes=_is_link))


def _is_link(tag: str, name: str, value: str) -> bool:
    return (tag, name) == ("a", "href") and value.lower().startswith(_LINKS)
