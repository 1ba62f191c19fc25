"""The landing page."""

from __future__ import annotations

import inspect
import re
from html import escape
from pathlib import Path

import numpy as np
from IPython.display import HTML

from labkit.course.authoring.layout import Course
from labkit.course.marking import mark
from labkit.course.messages import message
from labkit.course.student import Desk
from solutions.study import campaign
from solutions.study.grid import pick
from solutions.velocity_control import mistakes

from . import comparison
from .claims import holds
from .page import table

COURSE = Course(Path(__file__).parents[2])
NOTEBOOKS = {
    "00_warmup": "vectors, rotations and orientation errors in numpy",
    "01_paths": "lines, circles and polylines, and the timing along them",
    "02_model": "the Jacobian, the mass matrix, gravity and Coriolis torques",
    "03_velocity_control": "joint and workspace velocity control",
    "04_torque_control": "torques from a model; gains; sampling",
    "05_impedance": "an arm that behaves like a spring, and what it touches",
    "06_tags": "from a picture to a pose; following a tag that moves",
    "07_comparison": "margins, tuning, and a comparison that means something",
}
"""The content of each notebook."""
_TIME = re.compile(r"\*\*Time\*\* \|\D*([\d.]+)(?: hours.* all (?:about )?([\d.]+))?")


def picked() -> HTML:
    """The tracking error of each method on each task, on the realistic arm."""
    names = {campaign.BASELINE: "baseline (the built-in method)"}
    rows = [
        (names.get(controller, controller), *(_error(controller, task) for task in campaign.TASKS))
        for controller in (*campaign.FIVE, campaign.INTEGRAL, campaign.BASELINE)
    ]
    return table(
        ("Method", *campaign.TASKS),
        rows,
        "RMS error of the tip in mm after the first second, mean over the seeds, on the arm with "
        "friction, lag and noise. The baseline plans for a goal at rest: it cannot follow the tag. "
        "In the column tag the error is counted from the target that the controllers received, "
        "not from the tag itself.",
    )


def _error(controller: str, task: str) -> str:
    if (controller, task) == (campaign.BASELINE, "tag"):
        return "\N{EN DASH}"
    rows = pick(comparison.found()["rows"], controller=controller, task=task, plant="baxter")
    return f"{np.mean([row['late_rms_mm'] for row in rows]):.2g}"


def a_mistake() -> HTML:
    """A wrong answer of a student, without type hints, and the message of the check."""
    wrong = mistakes.no_feedforward
    folder = COURSE.root / "assignments" / "03_velocity_control"
    question = Desk.beside(folder).question("joint_velocity_pd")
    verdict = mark(question, wrong)
    holds(verdict.mistake is not None, "the check knows this mistake")
    code = inspect.getsource(wrong).replace(wrong.__name__, question.name)
    code = code.replace(f'    """{wrong.__doc__}"""\n', "")
    code = re.sub(r": [\w.]+(?=[,)])|(?<=\)) -> [\w.]+(?=:\n)", "", code, count=5)
    return HTML(
        _typed(code, "A student's answer") + _typed(str(message(question, verdict)), "The check's")
    )


def _typed(text: str, label: str) -> str:
    return (
        f'<div class="highlight lab-typed" role="group" tabindex="0" aria-label="{label}">'
        f"<pre>{escape(text)}</pre></div>"
    )


def hours(name: str) -> tuple[float, float]:
    """The hours for a notebook's core and for all of it, as stated in its first cell."""
    (source,) = COURSE.root.glob(f"solutions/*/{name}.py")
    core, whole = _TIME.search(source.read_text()).groups()
    return float(core), float(whole or core)


def notebooks() -> HTML:
    """The topic of each notebook, its hours, and the points for its functions."""
    rows = []
    for name, about in NOTEBOOKS.items():
        problems = COURSE.problems(name)
        points = sum(problem.points for problem in problems)
        core, whole = hours(name)
        rows.append((name, about, f"{core:g}", f"{whole:g}", len(problems), f"{points:g}"))
    core, whole, points = (sum(float(row[k]) for row in rows) for k in (2, 3, 5))
    return table(
        ("Notebook", "Students write", "Hours, core", "Hours, all", "Functions",
         "Points for functions"),
        rows,
        f"{len(rows)} notebooks: {core:g} hours for the core and {whole:g} for everything; "
        f"{points:g} points for functions",
    )  # fmt: skip
