"""Commands for graded work: feedback pages, a report on the class, tables, the concept test."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TextIO

import click

from ..course.cli import PATH, verb
from ..course.layout import DEFENCE, Course
from ..errors import LabkitError
from .cli_course import of_assignment, of_course
from .each import Failed, Failures

if TYPE_CHECKING:
    from .marks import Mark

QUIZZES = ("paper", "moodle-quiz", "canvas-quiz")
"""Layouts of the concept test."""
one_student = click.option("--student", metavar="S", help="Only this student.")
to_file = click.option(
    "--to", type=PATH, metavar="FILE", help="Write to FILE instead of the screen."
)


@verb("01_paths --student ada")
@of_assignment
@one_student
@click.option(
    "--moodle", type=PATH, metavar="ZIP", help="Also write a zip of feedback files for Moodle."
)
@click.option(
    "--unmarked", is_flag=True, help="Write the pages before all answers are marked by hand."
)
def feedback(
    course: Course, assignment: str, student: str | None, moodle: Path | None, unmarked: bool
) -> int:
    """Write a feedback page for each student.

    Some answers are marked by hand, in formgrader. No page is written until they are all marked;
    --unmarked writes the pages before.
    """
    from .exchange import for_exchange
    from .feedback import write_feedback
    from .marks import marks_of
    from .return_feedback import moodle_zip

    with Failures() as failures:
        everybody = [mark for mark in marks_of(course, assignment) if not mark.absent]
        if not unmarked:
            _wait_for_marks(everybody)
        marks = [mark for mark in everybody if student in {None, mark.student}]
        if not marks:
            raise _nobody(assignment, student)
        pages = write_feedback(course, assignment, marks)
        made = list(failures.sift(pages, "no page"))
        size = sum(path.stat().st_size for path in made) / 1e6
        print(f"pages in {course.root / 'feedback'}: {len(made)}, {size:.1f} MB")
        sent = for_exchange(course, assignment, made)
        if any(list(failures.sift(sent, "not for the exchange"))):
            print(f"back to the exchange: nbgrader release_feedback {assignment}")
        if moodle:
            count = moodle_zip(course, assignment, made, moodle)
            size = moodle.stat().st_size / 1e6
            print(f"for Moodle, {count} of {len(made)}, {size:.1f} MB: {moodle}")
    return failures.code


@verb("01_paths --to marks.csv")
@click.argument("assignment", required=False)
@of_course
@click.option(
    "--layout",
    type=click.Choice(["nbgrader", "questions", "canvas", "moodle", "moodle-worksheet", *QUIZZES]),
    default="questions",
    help="moodle: for Moodle's gradebook; moodle-worksheet: for the assignment's page in Moodle; "
    "paper, moodle-quiz, canvas-quiz: not marks, but the concept test.",
)
@click.option("--form", type=click.Choice(["a", "b"]), help="Which form of the concept test.")
@click.option(
    "--column", metavar="NAME", help="The platform's name of the assignment: 'Paths (4711)'."
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
    form: Literal["a", "b"] | None,
    column: str | None,
    absent_zero: bool,
    to: Path | None,
) -> int:
    """Write a table of marks, or the concept test.

    The table is of an assignment or, without ASSIGNMENT, of the term: every assignment that was
    graded, and the total with the weights of course.toml.
    """
    from . import concepts
    from .export import LAYOUTS, as_csv, of_term, remarks
    from .marks import marks_of
    from .rules import read_rules

    def read(name: str) -> list[Mark]:
        if name != DEFENCE:
            course.notebook_source(name)
        found = list(marks_of(course, name))
        if all(mark.absent for mark in found):
            return []
        return [replace(m, raw=0.0) if absent_zero and m.absent else m for m in found]

    if layout in QUIZZES:
        if to is None or form is None or assignment:
            raise LabkitError(f"type: labkit export --layout {layout} --form a --to FILE")
        to.write_bytes(concepts.LAYOUTS[layout](course, form))
        print(f"written: {to}")
        return 0
    if form:
        raise LabkitError(f"--form is of the concept test: --layout {', '.join(QUIZZES)}")
    if assignment is None:
        rules, names = read_rules(course), [x.stem for x in sorted(course.bundle.glob("*.json"))]
        names.append(DEFENCE)
        term = {name: marks for name in names if (marks := read(name))}
        if not term:
            raise LabkitError("nobody is graded in any assignment; type: labkit grade ASSIGNMENT")
        for name, marks in term.items():
            tell((f"{name}: {says}" for says in remarks("questions", marks)), sys.stderr)
        _write(as_csv(of_term(term, {name: rules.weight(name) for name in term})), to)
        return int(any(mark.missing for marks in term.values() for mark in marks))
    marks = read(assignment)
    if not marks:
        raise _nobody(assignment, None)
    tell(remarks(layout, marks), sys.stderr)
    _write(as_csv(LAYOUTS[layout](column or assignment, marks)), to)
    return int(any(mark.missing for mark in marks))


@verb("01_paths --names")
@of_assignment
@click.option("--names", is_flag=True, help="Show real names; for your eyes only.")
@to_file
@click.option("--jplag", type=PATH, metavar="DIR", help="Also write the answers to DIR, for JPlag.")
def class_report(
    course: Course, assignment: str, names: bool, to: Path | None, jplag: Path | None
) -> int:
    """Report what the class got right and wrong.

    The report counts mistakes by their names. Students have pseudonyms unless you add --names.
    """
    from ..course.bundle import Bundle
    from .class_report import FEWEST, for_jplag, report
    from .marks import marks_of
    from .pseudonyms import pseudonyms

    with Failures() as failures:
        marks = list(marks_of(course, assignment))
        if not any(mark.result for mark in marks):
            raise _nobody(assignment, None)
        out = [mark for mark in marks if mark.missing and not mark.lines]
        failures.add("left out", [Failed(mark.student, mark.missing) for mark in out])
        problems = {p.name: p for p in course.problems(assignment)}
        pseudonym = pseudonyms(course)
        called, fewest = str if names else pseudonym, 1 if names else FEWEST
        asked = Bundle.of(course, assignment).questions
        _write(report(assignment, marks, problems, called, fewest, asked), to)
        if jplag:
            written = for_jplag([m.result for m in marks if m.result], jplag, pseudonym)
            print(f"{written} answers in {jplag}", file=sys.stderr)
    return failures.code


def _wait_for_marks(marks: Iterable[Mark]) -> None:
    """Raise a LabkitError if a person still has something to mark."""
    waiting = [f"{mark.student} ({', '.join(mark.open)})" for mark in marks if mark.open]
    if waiting:
        some = ", ".join(waiting[:5]) + (", ..." if len(waiting) > 5 else "")
        raise LabkitError(
            f"{len(waiting)} are not marked by hand in full: {some}; mark them in formgrader, or "
            "add --unmarked to write the pages without these marks"
        )


def _nobody(assignment: str, student: str | None) -> LabkitError:
    """The error for an assignment in which nothing is graded yet."""
    who = f"{student} is not" if student else "nobody is"
    return LabkitError(f"{who} graded in {assignment}; type: labkit grade {assignment}")


def tell(sentences: Iterable[str], where: TextIO) -> None:
    """Print sentences as they come."""
    for sentence in sentences:
        print(sentence, file=where, flush=True)


def _write(text: str, where: Path | None) -> None:
    if where is None:
        sys.stdout.write(text)
    else:
        where.write_text(text, encoding="utf-8")
        print(f"written: {where}")


COMMANDS = (feedback, export, class_report)
