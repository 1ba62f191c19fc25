"""Instructor's guide: the hours and points of each notebook, and the cost of marking."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
from IPython.display import HTML

from labkit.course.authoring.layout import OUTCOMES, Course
from labkit.grader.doctor import elsewhere

from .claims import holds
from .front import NOTEBOOKS, hours
from .page import number, table

COURSE = Course(Path(__file__).parents[2])
REPORT = "08_report"
NEEDS = {
    "00_warmup": "numpy",
    "01_paths": "00",
    "02_model": "00, calculus of several variables",
    "03_velocity_control": "00, the idea of the Jacobian",
    "04_torque_control": "00, the equation of motion",
    "05_impedance": "04 or its introduction",
    "06_tags": "01 and 03, or their introductions",
    "07_comparison": "any two of 03, 04, 05",
    REPORT: "07; an arm of one's own from 03",
}
"""What a student should have done before each notebook."""
HOURS = {name: hours(name) for name in (*NOTEBOOKS, REPORT)}
"""Hours for the core and for everything; for the report, the hours of each team member."""
_CHAPTER = re.compile(r"\*\*Time\*\* (\d+) minutes, and about \d+ hours for notebook (\d\d)")
READING = {
    number: float(minutes) / 60.0
    for path in sorted((COURSE.root / "book/chapters").glob("*.md"))
    for minutes, number in _CHAPTER.findall(path.read_text())
}
"""Hours for the chapter of each notebook, as the chapter says."""
ON_THE_MODEL = ("04", "05")
"""Notebooks whose chapters use the equations of the chapter on the model."""
CLASS, TEAM = 200, 3
"""Number of students, and size of the teams that write a report, in the example for marking."""
WORDS_A_MINUTE = 238.0
"""Words per minute of silent reading: Brysbaert, J. Memory and Language 109 (2019) 104047."""
WHY = 80.0 / WORDS_A_MINUTE + 0.25
"""Minutes for the longest allowed why, of which 15 s are for the points and the next page."""
REPORT_WORDS = 720.0
"""The largest number of words that the six parts of notebook 08 allow."""
REPORT_MINUTES = REPORT_WORDS / WORDS_A_MINUTE + 0.5 + 6 * 0.4 + 1.5
"""Minutes for a report: its words, its figure, six rows of the rubric at 24 s each, a comment."""
MINUTES = {
    "four short 'why' answers of each student, of at most 80 words": 4 * WHY,
    "a report of four pages, at most 720 words, with its rubric": REPORT_MINUTES / TEAM,
    "a defence": 8.0,
    "contested marks, with labkit explain": 0.3,
}
"""The work of a person, in minutes for each student.

The time for reading follows from the longest texts allowed; the other times are estimates.
"""
TRACKS = {
    "2 weeks": ("00", "01", "03"),
    "6 weeks": ("00", "01", "03", "04", "05"),
    "12 weeks": tuple(name[:2] for name in HOURS),
}
WEEKS = {
    "00": (1, 1, 1),
    "01": (2, 2, 1),
    "02": (3, "3, its chapter alone", None),
    "03": (4, 3, 2),
    "04": (5, 4, None),
    "05": (6, 5, None),
    "06": (7, None, None),
    "07": (8, None, None),
    "08": ("9 and 10", None, None),
}
"""The week of each notebook in a term of 12, of 6 and of 2 weeks; it is due when the week ends."""


def planning() -> HTML:
    """A table of each notebook's hours and prerequisites, and of its points by who marks them."""
    rows: list[tuple[str, ...]] = []
    for name, (core, whole) in HOURS.items():
        machine, hand = _points(name)
        row = (f"{x:g}" for x in (core, whole, machine, hand))
        rows.append((name, *row, NEEDS[name]))
    totals = [sum(float(row[k]) for row in rows) for k in (1, 2, 3, 4)]
    rows.append(("total", *(f"{x:g}" for x in totals), ""))
    return table(
        ("Notebook", "Hours, core", "Hours, all", "Points by machine",
         "Points that a person may give", "Prerequisites"),
        rows,
        "Hours are the authors' estimate for a student who has basic numpy and has read the "
        "chapter. A person marks a short text in each of four notebooks, which answers a “why” "
        "question.",
    )  # fmt: skip


def _points(name: str) -> tuple[float, float]:
    """Points that the grader gives, and points that a person gives."""
    path = COURSE.root / "assignments" / name / f"{name}.ipynb"
    cells = [c.metadata.get("nbgrader", {}) for c in nbformat.read(path, as_version=4).cells]
    graded = [c for c in cells if c.get("grade")]
    hand = sum(c["points"] for c in graded if c["solution"])
    return sum(c["points"] for c in graded) - hand, hand


def syllabi() -> HTML:
    """A table of the notebooks and chapters that fit into a term."""
    rows = []
    for weeks, numbers in TRACKS.items():
        taken = [both for name, both in HOURS.items() if name[:2] in numbers]
        core, whole = (sum(x) for x in zip(*taken, strict=True))
        chapters = {*numbers, *("02" for number in numbers if number in ON_THE_MODEL)}
        read = sum(READING.get(number, 0.0) for number in chapters)
        each = (whole + read) / float(weeks.split()[0])
        what = "all, and the report" if len(numbers) == len(HOURS) else ", ".join(numbers)
        rows.append((weeks, what, f"{core:g}", f"{whole:g}", f"{read:.2g}", f"{each:.2g}"))
    return table(
        ("You have", "Notebooks", "Hours, core", "Hours, all", "Hours for the chapters",
         "Hours per week, all and chapters"), rows,
        "Three syllabi, in hours that the authors estimate. The chapters are those of the "
        "notebooks, and the one on the model where 04 or 05 needs it; discussions in class are not "
        "counted.",
    )  # fmt: skip


def plan() -> HTML:
    """A table for each week: what students read and write, when it is due, and what is marked."""
    for column, track in enumerate(reversed(TRACKS)):
        taken = {name for name, weeks in WEEKS.items() if isinstance(weeks[column], int | str)}
        extra = {"02"} if set(ON_THE_MODEL) <= taken else set()
        holds(taken == {*TRACKS[track], *extra}, f"the plan of {track} has its notebooks")
    rows: list[tuple[str, ...]] = []
    asked = [name for name in NOTEBOOKS if _points(name)[1]]
    holds(len(asked) == 4, "four notebooks have a why")
    for name, (core, whole) in HOURS.items():
        read = READING.get(name[:2], 0.0)
        by_hand = f"{CLASS} whys, {CLASS * WHY / 60.0:.1f} h" if name in asked else ""
        if name == REPORT:
            by_hand = f"{CLASS / TEAM:.0f} reports, {CLASS * REPORT_MINUTES / TEAM / 60.0:.0f} h"
        what = name.replace("_", " ")
        what = what if rows else f"practice hand-in, then {what}"
        spent = " to ".join(dict.fromkeys(f"{x + read:.2g}" for x in (core, whole)))
        rows.append((what, spent, *map(_week, WEEKS[name[:2]]), by_hand))
    defences = f"{CLASS} defences, {CLASS * MINUTES['a defence'] / 60.0:.0f} h"
    rows.append(("defence", "", "12", "6", "2, at its end", defences))
    return table(
        ("What is due", "Hours, core to all", "Week of 12", "Week of 6", "Week of 2",
         f"Then by hand, for {CLASS} students"), rows,
        "A plan by weeks. Each notebook is due at the end of the week that is named, the practice "
        "hand-in in the first days. Hours are the authors' estimates, with the chapter and without "
        "the practice hand-in; what is marked by hand is that of a term of 12 weeks.",
    )  # fmt: skip


def _week(which: int | str | None) -> str:
    return "\N{EN DASH}" if which is None else str(which)


def numbers_told() -> None:
    """Numbers of the prose: points by kind, and hours of reading."""
    problems = [p for name in NOTEBOOKS for p in COURSE.problems(name)]
    own_arm = sum(p.points for p in problems if "experiment" in p.outcomes)
    everything = sum(sum(_points(name)) for name in NOTEBOOKS)
    functions = sum(p.points for p in problems)
    number("points_functions", functions - own_arm, "g")
    number("points_core", sum(p.points for p in problems if p.core), "g")
    number("points_arm", own_arm, "g")
    number("points_whys", everything - functions, "g")
    number("reading_hours", sum(READING.values()), ".0f")


def outcomes() -> HTML:
    """A table of the skills of a student after the course, with the evidence for each."""
    evidence: dict[str, list[str]] = {name: [] for name in OUTCOMES}
    for notebook in NOTEBOOKS:
        for outcome in {name for one in COURSE.problems(notebook) for name in one.outcomes}:
            evidence[outcome].append(notebook[:2])
    holds(all(evidence.values()), "every outcome has its evidence")
    rows = [(sentence, ", ".join(evidence[name])) for name, sentence in OUTCOMES.items()]
    return table(("A student can then", "Notebooks"), rows, "Eight outcomes, and their evidence")


def marking() -> HTML:
    """A table of the work of people, in minutes for a student and in hours for a class."""
    rows = [(what, f"{m:.1f}", f"{m * CLASS / 60:.0f}") for what, m in MINUTES.items()]
    whole = sum(MINUTES.values())
    rows.append(("total", f"{whole:.1f}", f"{whole * CLASS / 60:.0f}"))
    holds(12.5 < whole < 13.5, "thirteen minutes for each student")
    return table(
        ("By hand", "Minutes per student", f"Hours for {CLASS} students"),
        rows,
        f"A whole term, reports by teams of {TEAM}. All minutes are the authors' estimates; those "
        "for reading follow from the longest texts allowed.",
    )


def isolation() -> None:
    """What a sandbox needs in the places where people grade, in the words of `labkit doctor`."""
    print(elsewhere())
