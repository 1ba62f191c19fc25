"""Commands for graded work: feedback pages and a report on the class."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click

from ...course.authoring.layout import Course
from ...course.cli import PATH, verb
from ...errors import LabkitError
from ..clean import few, how_many
from ..each import Failure, Failures
from .course import MARKED_BY, of_assignment

if TYPE_CHECKING:
    from ..marks import Mark

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
    course: Course,
    assignment: str,
    student: str | None,
    moodle: Path | None,
    unmarked: bool,
) -> int:
    """Write a feedback page for each student.

    Some answers are marked by hand, in formgrader. No page is written until they are all marked;
    the page of one --student waits for the answers of that student alone. With --unmarked no page
    waits.
    """
    from ..collect import for_exchange
    from ..feedback import moodle_zip, write_feedback
    from ..marks import marks_of

    with Failures() as failures:
        everybody = [mark for mark in marks_of(course, assignment) if not mark.absent]
        marks = [mark for mark in everybody if student in {None, mark.student}]
        if not marks:
            raise nobody(assignment, student)
        if not unmarked:
            _wait_for_marks(marks)
        pages = write_feedback(course, assignment, marks)
        made = list(failures.sift(pages, "no page"))
        print(f"pages in {course.root / 'feedback'}: {len(made)}")
        sent = for_exchange(course, assignment, made)
        if any(list(failures.sift(sent, "not for the exchange"))):
            print(f"back to the exchange: nbgrader release_feedback {assignment}")
        if moodle and not made:
            print("no zip for Moodle was written, because there are no pages for it")
        elif moodle:
            count = moodle_zip(course, assignment, made, moodle)
            size = moodle.stat().st_size / 1e6
            print(f"for Moodle, {count} of {len(made)}, {size:.1f} MB: {moodle}")
    return failures.code


@verb("01_paths --names")
@of_assignment
@click.option("--names", is_flag=True, help="Show real names; for your eyes only.")
@to_file
def class_report(course: Course, assignment: str, names: bool, to: Path | None) -> int:
    """Report what the class got right and wrong.

    The report counts mistakes by their names. Students have pseudonyms unless you add --names.
    """
    from ...course.authoring.bundle import Bundle
    from ..class_report import FEWEST, report
    from ..marks import marks_of
    from ..seeds import pseudonyms

    with Failures() as failures:
        marks = [mark for mark in marks_of(course, assignment) if not mark.author]
        if not any(mark.result for mark in marks):
            raise nobody(assignment, None, next((m.missing for m in marks if m.missing), ""))
        out = [mark for mark in marks if mark.missing and not mark.lines]
        failures.add("left out", [Failure(mark.student, mark.missing) for mark in out])
        problems = {p.name: p for p in course.problems(assignment)}
        called, fewest = (str, 1) if names else (pseudonyms(course), FEWEST)
        asked = Bundle.of(course, assignment).questions
        truths = {p.name: p.truth for p in course.predictions(assignment)}
        write(report(assignment, marks, problems, called, fewest, asked, truths), to)
    return failures.code


def _wait_for_marks(marks: Iterable[Mark]) -> None:
    """Raise a LabkitError if a person still has something to mark."""
    open_ones = {mark.author or mark.student: ", ".join(mark.open) for mark in marks if mark.open}
    if waiting := [f"{student} ({names})" for student, names in open_ones.items()]:
        raise LabkitError(
            f"{few(waiting)}: answers of {how_many(len(waiting), 'student')} still wait for a mark "
            "by hand; mark them in formgrader, or add --unmarked to write the pages without these "
            "marks"
        )


def nobody(assignment: str, student: str | None, why: str = "") -> LabkitError:
    """The error if nothing is graded yet; ``why`` says why no result can be read."""
    who = f"{student} is not" if student else "nobody is"
    why = why or f"type: {MARKED_BY.get(assignment, f'labkit grade {assignment}')}"
    return LabkitError(f"{who} graded in {assignment}; {why}")


def tell(sentences: Iterable[str], where: TextIO) -> None:
    """Print sentences as they come."""
    for sentence in sentences:
        print(sentence, file=where, flush=True)


def write(text: str, where: Path | None) -> None:
    """Write a text to a file or, without one, to the screen."""
    if where is None:
        sys.stdout.write(text)
    else:
        where.write_text(text, encoding="utf-8")
        print(f"written: {where}")


COMMANDS = (feedback, class_report)
