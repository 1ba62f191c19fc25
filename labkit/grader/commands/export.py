"""The command that writes tables of marks, and files for other platforms."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...course.authoring.layout import DEFENCE, Course
from ...course.cli import verb
from ...errors import LabkitError
from ..each import Failure, Failures
from .course import of_course
from .pages import nobody, tell, to_file, write

if TYPE_CHECKING:
    from ..marks import Mark

TABLES = ("nbgrader", "questions", "canvas", "moodle", "moodle-worksheet")
"""Layouts of marks."""
NAMED = ("canvas", "moodle")
"""Layouts with a column whose name a platform must know."""


@verb("01_paths --to marks.csv")
@click.argument("assignment", required=False)
@of_course
@click.option(
    "--layout",
    type=click.Choice([*TABLES, "gradescope"]),
    default="questions",
    help="moodle: for Moodle's gradebook; moodle-worksheet: for the assignment's page in Moodle; "
    "gradescope: the zip with which Gradescope grades ASSIGNMENT itself.",
)
@click.option(
    "--column",
    metavar="NAME",
    help="canvas, moodle: the platform's name of the assignment: 'Paths (4711)'.",
)
@click.option(
    "--absent-zero",
    is_flag=True,
    help="Write 0, not an empty cell, for a student who handed in nothing.",
)
@to_file
def export(
    course: Course,
    assignment: str | None,
    layout: str,
    column: str | None,
    absent_zero: bool,
    to: Path | None,
) -> int:
    """Write marks.

    The marks are those of an assignment or, without ASSIGNMENT, of the term: every assignment that
    was graded, and the total with the weights of course.toml.
    """
    from ..export import LAYOUTS, as_csv, of_term, remarks, unmatched
    from ..marks import marks_of
    from ..roster import idle_extensions
    from ..rules import read_rules

    if column and layout not in NAMED:
        raise LabkitError(
            f"--layout {layout} has no column that a platform knows by its name; --column is for "
            f"--layout {' or '.join(NAMED)}"
        )
    if layout == "gradescope":
        return _autograder(course, assignment, to)

    doubts = list(idle_extensions(course))

    def read(name: str) -> list[Mark]:
        if name != DEFENCE:
            course.notebook_source(name)
        found = list(marks_of(course, name))
        return [] if all(mark.absent for mark in found) else found

    def filled(marks: list[Mark]) -> list[Mark]:
        """The marks, with a 0 for each absent student if that is asked for."""
        return [replace(m, raw=0.0) if m.absent and absent_zero else m for m in marks]

    if assignment is None:
        if layout != "questions":
            raise LabkitError(
                "--layout is for one assignment: type labkit export ASSIGNMENT "
                f"--layout {layout}; without them, labkit export writes the table of the term"
            )
        rules, names = read_rules(course), [x.stem for x in sorted(course.bundle.glob("*.json"))]
        names += [DEFENCE]
        term = {name: marks for name in names if (marks := read(name))}
        if not term:
            raise LabkitError("nobody is graded in any assignment; type: labkit grade ASSIGNMENT")
        for name, marks in term.items():
            tell((f"{name}: {says}" for says in remarks("questions", marks, name)), sys.stderr)
        whole = {name: filled(marks) for name, marks in term.items()}
        write(as_csv(of_term(whole, {name: rules.weight(name) for name in term})), to)
        tell(doubts, sys.stderr)
        return int(any(m.missing for marks in term.values() for m in marks) or bool(doubts))
    marks = read(assignment)
    if not marks:
        raise nobody(assignment, None)
    tell(remarks(layout, marks, assignment), sys.stderr)
    write(as_csv(LAYOUTS[layout](column or assignment, filled(marks))), to)
    tell(doubts, sys.stderr)
    lost, count = unmatched(layout, marks)
    return int(any(m.missing for m in marks) or 0 < count == len(lost) or bool(doubts))


def _autograder(course: Course, assignment: str | None, to: Path | None) -> int:
    """Write the zip for Gradescope; name the students whose own arm it cannot find."""
    from ..gradescope import autograder

    if assignment is None or to is None:
        raise LabkitError("name ASSIGNMENT, and the zip to write: --to FILE")
    with Failures() as failures:
        unknown = autograder(course, assignment, to)
        why = "the roster has no e-mail address, by which Gradescope tells whose arm it is"
        failures.add("not known to Gradescope", [Failure(x, why) for x in unknown])
        print(f"written: {to}; it holds the hidden cases, so give it to Gradescope alone")
    return failures.code


COMMANDS = (export,)
