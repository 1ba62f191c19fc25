"""Commands that run students' code: grade it, explain a mark."""

from __future__ import annotations

import json
import os
import sys
from typing import TYPE_CHECKING, Any

import click

from ..course.cli import verb
from ..course.layout import Course
from ..errors import LabkitError
from .cli import one_student, tell
from .cli_course import of_assignment, of_course
from .each import Failures

if TYPE_CHECKING:
    from .batch import GradedSubmission

jobs = click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    default=lambda: len(os.sched_getaffinity(0)),
    help="Workers; by default one per core.",
)


def _shard(text: str) -> tuple[int, int]:
    first, _, last = text.partition("/")
    if not (first.isdigit() and last.isdigit() and 1 <= int(first) <= int(last)):
        raise click.BadParameter(f"{text} is not a part; write 1/4, 2/4, 3/4 or 4/4")
    return int(first), int(last)


@verb("01_paths --student ada")
@of_assignment
@one_student
@jobs
@click.option("--json", "as_json", is_flag=True, help="One JSON object per line, for programs.")
@click.option("--again", is_flag=True, help="Grade anew what is graded already.")
@click.option("--diff", is_flag=True, help="Only say whose mark would move.")
@click.option("--watch", is_flag=True, help="Grade what comes in from now on, until Ctrl-C.")
@click.option("--lower", is_flag=True, help="Let marks fall that would, after a test has changed.")
@click.option("--dask", metavar="ADDRESS", help="Of a Dask scheduler that shares the folder.")
@click.option(
    "--shard", type=_shard, default="1/1", metavar="i/n", help="Only the i-th of n parts."
)
@click.option(
    "--unsafe-no-isolation",
    "isolated",
    flag_value=False,
    default=True,
    help="Run students' code with your own rights, able to read and delete your files.",
)
def grade(course: Course, assignment: str, student: str | None, as_json: bool, **how: Any) -> int:
    """Grade what was handed in and is not graded yet.

    Each submission is graded in a sandbox of its own. After a test has changed and was released,
    all are graded again; no mark falls unless you say --lower.
    """
    from .batch import GradeOptions, common_failures, grade_class, watch
    from .changes import changes, summary
    from .gradebook import record
    from .lock import WHOLE, exclusive_run
    from .results import Result, Results

    diff, watching = how.pop("diff"), how.pop("watch")
    options, said = GradeOptions(**how), sys.stderr if as_json else sys.stdout
    with Failures() as failures:
        if watching:
            for one in failures.sift(watch(course, assignment, options), "not graded"):
                print(_line(one, as_json), flush=True)
                recorded = record(course, assignment, [one.result])
                tell(failures.sift(recorded, "not in the gradebook"), said)
        who = _handed_in(course, assignment, student, failures)
        if diff:
            with exclusive_run(Results(course, assignment).folder):
                found = changes(course, assignment, who, options)
                tell(summary(list(failures.sift(found, "not graded"))), sys.stdout)
            return failures.code
        graded: list[Result] = []
        done = failures.sift(grade_class(course, assignment, who, options), "not graded")
        for number, one in enumerate(done, start=1):
            graded.append(one.result)
            print(_line(one, as_json, f"[{number}/{len(who)}] "), flush=True)
        if options.shard == WHOLE:
            recorded = record(course, assignment, graded)
            tell(failures.sift(recorded, "not in the gradebook"), said)
            everybody = graded if student else list(Results(course, assignment))
            tell((f"ATTENTION: {says}" for says in common_failures(everybody)), said)
        if graded and not as_json:
            print(f"isolation: {graded[-1].isolation}\nresults: {course.results / assignment}")
    return failures.code


def _line(one: GradedSubmission, as_json: bool, number: str = "") -> str:
    """What is printed of a submission that was graded."""
    from ..course.serialize import record_data

    says = f" ({one.says})" if one.says else ""
    return json.dumps(record_data(one.result)) if as_json else f"{number}{one.result}{says}"


@verb("ada bang_bang")
@click.argument("student")
@click.argument("question")
@click.option("--assignment", metavar="NAME", help="If several have a question of that name.")
@of_course
def explain(course: Course, student: str, question: str, assignment: str | None) -> int:
    """Say why an answer has its mark, with its numbers.

    The answer runs once more in the sandbox, with the hidden case that decided laid open: that part
    is for you, and what the student may be shown is marked.
    """
    from .explain import explain

    print(explain(course, student, question, assignment))
    return 0


def _handed_in(
    course: Course, assignment: str, student: str | None, failures: Failures
) -> list[str]:
    """Who handed in, or the one asked for; folders with a name that is not fit are failures."""
    from .submission import misnamed, students

    found = students(course, assignment)
    who = [student] if student else found
    if student is None:
        failures.add("not graded", misnamed(course, assignment))
    if set(who) - set(found) or not (who or failures.code):
        raise LabkitError(
            f"nothing of {student or 'anybody'} is in submitted/*/{assignment}; "
            "put notebooks there as submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb"
        )
    return who


COMMANDS = (grade, explain)
