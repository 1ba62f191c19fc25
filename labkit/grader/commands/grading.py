"""Commands that run students' code: grade it, explain a mark."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from ...course.authoring.layout import Course
from ...course.cli import verb
from ...errors import LabkitError
from ..clean import how_many
from ..each import Failure, Failures
from .course import of_assignment, of_course
from .pages import one_student, tell

if TYPE_CHECKING:
    from ..results import Result

jobs = click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    default=lambda: len(os.sched_getaffinity(0)),
    help="Number of workers; one for each core by default.",
)


@verb("01_paths --student ada")
@of_assignment
@one_student
@jobs
@click.option("--again", is_flag=True, help="Also grade what is already graded.")
@click.option("--diff", is_flag=True, help="Change no mark; list the marks that would change.")
@click.option(
    "--lower", is_flag=True, help="After a test has changed, also record marks that become lower."
)
@click.option(
    "--dask", metavar="ADDRESS", help="Address of a Dask scheduler whose workers share this folder."
)
@click.option(
    "--unsafe-no-isolation",
    "isolated",
    flag_value=False,
    default=True,
    help="Without a sandbox: students' code can then read and delete your files.",
)
def grade(course: Course, assignment: str, student: str | None, diff: bool, **how: Any) -> int:
    """Grade every submission that is not graded yet.

    Each submission is graded in a sandbox of its own. After you have changed a test and released
    the assignment, all submissions are graded again. No mark is lowered unless you add --lower; if
    a question has other points since, its share of them is compared.
    A notebook of another assignment that was handed in is named at the end, with exit code 1.
    """
    from ..batch import GradeOptions, changes, common_failures, grade_class
    from ..gradebook import record
    from ..results import Results
    from ..roster import idle_extensions

    options = GradeOptions(**how, tell=partial(print, file=sys.stderr, flush=True))
    with Failures() as failures:
        failures.add("ATTENTION", idle_extensions(course))  # an error in the rules stops here
        who = _handed_in(course, assignment, student, failures)
        done = failures.sift(
            grade_class(course, assignment, who, options, change=not diff), "not graded"
        )
        if diff:
            tell(changes(list(done)), sys.stdout)
            return failures.code
        graded: list[Result] = []
        for number, one in enumerate(done, start=1):
            graded.append(one.result)
            says = f" ({one.says})" if one.says else ""
            print(f"[{number}/{len(who)}] {one.result}{says}", flush=True)
        written = record(course, assignment, graded)
        tell(failures.sift(written, "not in the gradebook"), sys.stdout)
        everybody = graded if student else list(Results(course, assignment))
        tell((f"ATTENTION: {says}" for says in common_failures(everybody)), sys.stdout)
        failures.add("ATTENTION", _other_notebooks(graded))
        if graded:
            tell(_on_top(course, assignment), sys.stdout)
            print(f"isolation: {graded[-1].isolation}\nresults: {course.results / assignment}")
    return failures.code


def _other_notebooks(results: Iterable[Result]) -> Iterator[Failure]:
    """A failure for each student who handed in the notebook of another assignment."""
    for result in results:
        if result.unanswered and not result.rejected:
            yield Failure(result.student, f"{result.unanswered}; ask for the right one")


def _on_top(course: Course, assignment: str) -> Iterator[str]:
    """The points by hand, which the printed marks do not include, and who still waits for them."""
    from ...course.authoring.bundle import Bundle
    from ..gradebook import open_gradebook

    if by_hand := Bundle.of(course, assignment).by_hand:
        with open_gradebook(course) as book:
            found = book.assignment_submissions(assignment)
            waiting = sum(x.needs_manual_grade for x in found)
        left = f"{how_many(waiting, 'student')} still to be marked"
        yield f"not included: {how_many(by_hand, 'point')} by hand; {left}"


@verb("ada bang_bang")
@click.argument("student")
@click.argument("question")
@click.option(
    "--assignment",
    metavar="NAME",
    help="Needed if several assignments have a QUESTION of that name.",
)
@of_course
def explain(course: Course, student: str, question: str, assignment: str | None) -> int:
    """Explain the mark of an answer, with its numbers.

    The answer runs once more in the sandbox. You see what the student may be shown, and then,
    for you alone, the hidden case that decided the mark. Numbers and runs are written to a page.
    """
    from ..explain import explain

    print(explain(course, student, question, assignment))
    return 0


def _points(ctx: click.Context, option: click.Parameter, text: str | None) -> list[int] | None:
    if text is None:
        return None
    words = text.split(",")
    if not all(word.strip().isdecimal() for word in words):
        raise click.BadParameter(f"{text} is not a mark; write whole numbers, such as 2,3,1")
    return [int(word) for word in words]


@verb("ada --mark 2,3,1")
@click.argument("student")
@click.option(
    "--mark",
    metavar="A,B,C",
    callback=_points,
    help="After the defence: the points of each question, from 0 to 3.",
)
@of_course
def defence(course: Course, student: str, mark: list[int] | None) -> int:
    """Print the page of a student's oral examination.

    It asks about three functions of theirs that were accepted, each with a mistake put into it, or
    as many as there are; for the rest you choose work of theirs to ask about.
    The second side has the answers. Which functions and mistakes follows from a key of the term.
    """
    from ..defence import ASKED, draw, give_mark, write_page
    from ..seeds import public_warning

    if mark is not None:
        give_mark(course, student, mark)
        print(f"{student}: {how_many(sum(mark), 'point')} for the defence")
        return 0
    asked = draw(course, student)
    path = write_page(course, student, asked)
    print(f"{', '.join(one.of.question.name for one in asked) or 'no function'}: {path}")
    if len(asked) < ASKED:
        print(
            f"{student} has {how_many(len(asked), 'accepted answer')} that a mistake can be put "
            f"into, and {ASKED} are needed; for the rest ask about work of theirs that you choose, "
            f"and give {ASKED} numbers all the same: labkit defence {student} --mark A,B,C"
        )
    if public_warning(course):
        print("drawn with the public seed, so anyone can know it; begin a term: labkit term new")
    return 0


def _handed_in(
    course: Course, assignment: str, student: str | None, failures: Failures
) -> list[str]:
    """The students who handed in, or the one asked for; folders with unfit names are failures."""
    from ..submission import misnamed, none_of, students

    found = students(course, assignment)
    who = [student] if student else found
    if student is None:
        failures.add("not graded", misnamed(course, assignment))
    if set(who) - set(found) or not (who or failures.code):
        raise LabkitError(none_of(course, assignment, student))
    return who


COMMANDS = (grade, explain, defence)
