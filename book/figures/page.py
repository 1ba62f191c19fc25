"""Tools for all chapters: figures with descriptions, replays, numbers, quizzes and claims."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML
from myst_nb import glue
from PIL import Image

from labkit import Log, metrics, plotting
from labkit.replay import Motion, motion_of
from labkit.replay.player import still as drawn

from .claims import holds
from .embed import motion_html
from .formulas import in_text

INKS = ("#b3001b", "#0a5aa6", "#a35200", "#1a7f4b", "#7b3fa0", "#57606a", "#00737d")
"""Line colours in light mode; `book.css` has those for dark mode, with a contrast above 4.5."""
TEXT, FRAME, FAINT = "#1f2328", "#57606a", "#999999"
_VARIABLES = {
    **{ink: f"var(--line-{k})" for k, ink in enumerate(INKS)},
    TEXT: "currentColor",
    "#000000": "currentColor",
    FRAME: "var(--frame)",
    FAINT: "var(--faint)",
    "#ffffff": "var(--paper)",
}

mpl.use("agg")
mpl.rcParams.update(
    {
        "svg.fonttype": "none",  # text stays text, for search, screen readers and scaling
        "font.size": 10.5,
        "figure.figsize": (6.0, 3.4),
        "figure.constrained_layout.use": True,
        "axes.prop_cycle": mpl.cycler(color=INKS),
        "axes.edgecolor": FRAME,
        "axes.labelcolor": TEXT,
        "axes.titlesize": "medium",
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": False,
        "text.color": TEXT,
        "xtick.color": FRAME,
        "ytick.color": FRAME,
        "xtick.labelcolor": TEXT,
        "ytick.labelcolor": TEXT,
        "legend.frameon": False,
        "lines.linewidth": 1.8,
        "savefig.transparent": True,
    }
)


def number(name: str, value: float, form: str = ".3g") -> None:
    """Define a number that the prose inserts with {glue:text}`name`."""
    glue(name, shown(value, form), display=False)


def shown(value: float, form: str = ".3g") -> str:
    """A number in the form of the prose: 2,400 and not 2.4e+03, with a minus sign, not a hyphen."""
    text = format(float(value), form)
    if "e+" in text:
        text = f"{float(text):,.0f}"
    return text.replace("-", "\N{MINUS SIGN}")


def numbers(values: Mapping[str, float], form: str = ".3g") -> None:
    """Define several numbers in the same form."""
    for name, value in values.items():
        number(name, value, form)


def figure(caption: str, alt: str, words: str = "", fig: Any = None) -> HTML:
    """The current figure as a drawing that follows the reader's theme.

    Args:
        caption: The text below the figure.
        alt: One or two sentences for readers who cannot see it, with the figure's own numbers.
        words: A longer description, which readers can open.
        fig: The figure; None means the current one.
    """
    fig = fig or plt.gcf()
    for ax in fig.axes:
        drawn = [x for x in ax.get_lines() if not str(x.get_label()).startswith("_")]
        looks = {(x.get_linestyle(), x.get_marker(), x.get_linewidth()) for x in drawn}
        holds(len(looks) == len(drawn), f"curves differ by more than colour: {caption}")
    with mpl.rc_context({"svg.hashsalt": caption}):
        text = io.StringIO()
        fig.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(fig)
    return HTML(framed(_drawing(text.getvalue(), caption, alt), caption, alt, words))


def _drawing(svg: str, caption: str, alt: str) -> str:
    """The SVG element with theme colours, unique ids and a name."""
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.S)
    mark = "f" + hashlib.sha256((caption + alt).encode()).hexdigest()[:8] + "-"
    svg = re.sub(r'id="([^"]+)"', rf'id="{mark}\1"', svg)
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{mark}", svg)
    svg = re.sub(r" font-family: [^;\"]*;?", "", svg)  # use the page's font
    for ink, variable in _VARIABLES.items():
        svg = svg.replace(ink, variable)
    box = re.search(r'viewBox="([^"]+)"', svg)[1]  # type: ignore[index]
    opening = (
        f'<svg class="lab-svg" role="img" aria-label="{escape(alt)}" viewBox="{box}" '
        'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'
    )
    return re.sub(r"<svg[^>]*>", opening, svg, count=1)


def framed(inside: str, caption: str, alt: str, words: str = "") -> str:
    """A drawing with its caption and its description in words."""
    more = words or alt
    return (
        f'<figure class="lab-figure">\n{inside}\n<figcaption>{escape(caption)}'
        f"<details><summary>Description in words</summary><p>{escape(more)}</p></details>"
        "</figcaption>\n</figure>"
    )


def replay(log: Log, title: str, caption: str = "", **options: Any) -> HTML:
    """A run as a 3-D replay in the page, or as a picture in browsers without WebGL."""
    motion = motion_of(log, title, reference=False, **options)
    return HTML(motion_html(motion, caption=caption, poster=poster(motion)))


def poster(motion: Motion) -> str:
    """The first view of a motion, with its paths and the things that it meets, as a data URL."""
    return _encoded(Image.open(io.BytesIO(drawn(motion))))


def still() -> str:
    """The current figure as a data URL, on white, because an image does not follow the theme."""
    data = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "still"}):
        plt.gcf().savefig(data, format="svg", facecolor="white", transparent=False,
                          metadata={"Date": None, "Creator": None})  # fmt: skip
    plt.close()
    return _address("svg+xml", data)


def address(picture: Any) -> str:
    """A picture as a data URL, so that the page contains it."""
    return _encoded(Image.fromarray(np.asarray(picture)))


def _encoded(picture: Image.Image) -> str:
    data = io.BytesIO()
    picture.save(data, "WEBP", quality=72, method=6)
    return _address("webp", data)


def _address(kind: str, data: io.BytesIO) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data.getvalue()).decode()}"


def tracking(log: Log, caption: str) -> HTML:
    """The tip and its target over time, with a description that has the run's own numbers."""
    _, axes = plt.subplots(2, 1, figsize=(6.2, 4.4), sharex=True)
    plotting.tracking(log, axes=axes)
    e = 1e3 * np.linalg.norm(metrics.tip_error(log)[:, :3], axis=1)
    words = (
        f"{plotting.describe(log)} The upper panel shows x, y and z of the tip over their targets, "
        f"the lower one the length of the error, which is largest at "
        f"t = {log.t[e.argmax()]:.2f} s and {e[-1]:.2g} mm at the end."
    )
    return figure(caption, plotting.describe(log), words)


@dataclass(frozen=True)
class Question:
    """One question of a quiz.

    Attributes:
        text: The question; mathematics between \\( and \\).
        answers: Answers in the order shown, each with the reply to a reader who chooses it.
        right: Which one is right, from 0.
    """

    text: str
    answers: Sequence[tuple[str, str]]
    right: int


def quiz(*questions: Question) -> HTML:
    """Questions in the page that answer at once; the answers are not sent to anyone."""
    parts = []
    for k, question in enumerate(questions):
        name = "quiz-" + hashlib.sha256(question.text.encode()).hexdigest()[:8]
        choices = "".join(
            f'<label class="lab-choice">'
            f'<input type="radio" name="{name}" value="{i}"{_spoken(answer)}> '
            f"<span>{in_text(answer)}</span></label>"
            for i, (answer, _) in enumerate(question.answers)
        )
        key = json.dumps([in_text(said) for _, said in question.answers], ensure_ascii=False)
        parts.append(
            f'<fieldset class="lab-question" data-right="{question.right}" '
            f'data-said="{escape(key)}"><legend>{k + 1}. {in_text(question.text)}</legend>{choices}'
            '<p class="lab-said" role="status"></p></fieldset>'
        )
    return HTML(f'<div class="lab-quiz">{"".join(parts)}</div>')


def _spoken(answer: str) -> str:
    """A name for an answer with a formula, which a screen reader's label may not contain."""
    if "\\(" not in answer:
        return ""
    return f' aria-label="{escape(re.sub("<[^>]+>", "", in_text(answer)))}"'


def table(head: Sequence[str], rows: Sequence[Sequence[Any]], caption: str) -> HTML:
    """A small table whose first column names its rows."""
    top = "".join(f'<th scope="col">{h}</th>' for h in head)
    body = "".join(
        f'<tr><th scope="row"{_wordy(row[0])}>{row[0]}</th>'
        + "".join(f"<td{_wordy(x)}>{x}</td>" for x in row[1:])
        + "</tr>"
        for row in rows
    )
    return HTML(
        '<div class="lab-scroll" role="group" tabindex="0" '
        f'aria-label="{escape(re.sub("<[^>]+>", "", caption))}"><table class="lab-table">'
        f"<caption>{caption}</caption><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _wordy(cell: Any) -> str:
    """Mark a cell with a sentence, which must be wide enough to read on a phone."""
    words = re.sub("<[^>]+>", "", str(cell))
    return ' class="lab-words"' if len(words) > 24 else ""
