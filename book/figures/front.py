"""The landing page."""

from __future__ import annotations

import inspect
import re
from html import escape
from pathlib import Path

import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics
from labkit.course.layout import Course
from labkit.course.marking import mark
from labkit.course.messages import message
from labkit.course.student import Desk
from solutions.study import campaign
from solutions.study.grid import pick
from solutions.study.joint_velocity import JointVelocityPD
from solutions.velocity_control import mistakes

from . import comparison
from .page import holds, numbers, replay, table

SEED = 1
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
"""What a student writes in each notebook."""
_TIME = re.compile(r"\*\*Time\*\* \| (?:core )?about ([\d.]+)(?: hours, all about ([\d.]+))?")


def welcome() -> HTML:
    """A line, then a circle, by the joint velocity PD on the realistic arm."""
    model = lk.Model("left")
    q0 = model.robot.ready
    T_wt = model.pose(q0)
    start, R = T_wt[:3, 3], T_wt[:3, :3]
    corner = start + np.array((0.05, -0.12, 0.12))
    circle = lk.Circle(corner, corner + np.array((0.0, -0.09, 0.0)))
    target = lk.Chain(
        [
            lk.Trajectory(lk.PosePath(lk.Line(start, corner), R), lk.Quintic(2.5)),
            lk.Trajectory(lk.PosePath(circle, R), lk.Quintic(5.0)),
        ]
    )
    with lk.Arm("left", lk.BAXTER, SEED, q0=q0) as arm:
        log = lk.run(arm, model.joint_trajectory(target, q0), JointVelocityPD(5.0))
    found = metrics.summary(log)
    holds(found.max_mm < 10.0, "the tip stays within a centimetre of its target")
    numbers({"rms": found.rms_mm, "worst": found.max_mm}, ".2g")
    return replay(
        log,
        "Baxter's left arm draws a line and a circle",
        "A recorded run on the realistic arm, with the error of the tip.",
        label="joint velocity PD",
    )


def picked() -> HTML:
    """The tracking error of each method on each task, on the realistic arm."""
    names = {campaign.BASELINE: "baseline (the built-in method)"}
    rows = [
        (names.get(way, way), *(_error(way, task) for task in campaign.TASKS))
        for way in (*campaign.FIVE, campaign.BASELINE)
    ]
    return table(
        ("Method", *campaign.TASKS),
        rows,
        "RMS error of the tip in mm after the first second, mean over the seeds, on the arm with "
        "friction, lag and noise. The baseline plans for a goal at rest: it cannot follow the tag.",
    )


def _error(way: str, task: str) -> str:
    if (way, task) == (campaign.BASELINE, "tag"):
        return "\N{EN DASH}"
    rows = pick(comparison.found()["rows"], way=way, task=task, plant="baxter")
    return f"{np.mean([row['late_rms_mm'] for row in rows]):.2g}"


def a_mistake() -> HTML:
    """A wrong answer of a student, without its types, and what the check says to it."""
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
    """Hours of a notebook's core and of all of it, as its first cell tells the students."""
    (source,) = COURSE.root.glob(f"solutions/*/{name}.py")
    core, whole = _TIME.search(source.read_text()).groups()
    return float(core), float(whole or core)


def notebooks() -> HTML:
    """What each notebook is about, how long it takes and what its functions earn."""
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
