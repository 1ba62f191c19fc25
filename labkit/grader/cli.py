"""Commands on what was handed in: collect, grade, hand back, report, export."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import click

from ..course.cli import PATH, verb
from ..course.layout import Course
from ..errors import LabkitError
from .cli_course import of_assignment, of_course
from .each import Failed, Failures, for_student

if TYPE_CHECKING:
    from .regrade import Move

one_student = click.option("--student", metavar="S", help="Only this one.")
jobs = click.option(
    "--jobs", type=click.IntRange(min=1), metavar="N", help="Workers; by default one per core."
)
to_file = click.option("--to", type=PATH, metavar="FILE", help="Instead of the screen.")


class Shard(click.ParamType[tuple[int, int]]):
    """A part of the class, "2/4"."""

    name = "i/n"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, int]:
        """Read it."""
        first, _, last = value.partition("/")
        if not (first.isdigit() and last.isdigit() and 1 <= int(first) <= int(last)):
            self.fail(f"{value} is not a part; write 1/4, 2/4, 3/4 or 4/4", param, ctx)
        return int(first), int(last)


@verb("import participants.csv")
@click.argument("action", type=click.Choice(["import"]), metavar="import")
@click.argument("file", type=PATH, metavar="FILE.csv")
@click.option(
    "--assignment",
    metavar="NAME",
    help="The file is Moodle's grading worksheet of it, which says whose each number is.",
)
@of_course
def students(course: Course, action: str, file: Path, assignment: str | None) -> int:
    """Take a list of students into the roster.

    The list is Moodle's, Canvas's or any table with a line for each student.

    Exit code: 0 if the list was taken, 1 if work of somebody is in two folders (named at the end),
    2 if the list was not taken.
    """
    from .enrol import import_list

    taken = import_list(course, file, assignment)
    _tell(taken.told, sys.stdout)
    _tell((*taken.left, *taken.alike), sys.stderr)
    return 1 if taken.left else 0


@verb("01_paths moodle.zip")
@of_assignment
@click.argument("sources", nargs=-1, required=True, type=PATH, metavar="ZIP|DIR...")
@click.option(
    "--unverified",
    is_flag=True,
    help="From the exchange, also take what users handed in whom this machine does not know.",
)
def collect(course: Course, assignment: str, sources: Sequence[Path], unverified: bool) -> int:
    """Take downloads from Moodle, Canvas or the exchange.

    The exchange is nbgrader's; give its inbound folder. Nothing that was handed in is lost: all of
    it is under attempts/.

    Exit code: 0 if all is well, 1 if something was not taken or it is not certain whose it is
    (named at the end), 2 if nothing could be done.
    """
    from .collect import collect

    doubtful = []
    try:
        for source in sources:
            for taken in collect(course, assignment, source, unverified=unverified):
                if taken.fine:
                    print(taken, flush=True)
                else:
                    doubtful.append(str(taken))
    finally:
        _tell(doubtful, sys.stderr)
    return 1 if doubtful else 0


@verb("01_paths --student ada")
@of_assignment
@one_student
@jobs
@click.option("--json", "as_json", is_flag=True, help="One JSON object per line, for programs.")
@click.option(
    "--engine",
    type=click.Choice(["isolated", "nbgrader"]),
    default="isolated",
    help="nbgrader's own runs students' code beside the hidden cases; for comparison only.",
)
@click.option("--again", is_flag=True, help="Grade anew what is graded already.")
@click.option("--dask", metavar="ADDRESS", help="Of a Dask scheduler that shares the folder.")
@click.option("--shard", type=Shard(), default="1/1", help="Only the i-th of n parts of the class.")
@click.option(
    "--unsafe-no-isolation",
    is_flag=True,
    help="Run students' code with your own rights, able to read and delete your files.",
)
def grade(
    course: Course,
    assignment: str,
    student: str | None,
    jobs: int | None,
    as_json: bool,
    engine: str,
    again: bool,
    dask: str | None,
    shard: tuple[int, int],
    unsafe_no_isolation: bool,
) -> int:
    """Grade what was handed in and is not graded yet.

    Each submission is graded in a sandbox of its own.
    """
    from .batch import How, common_failures, grade_class, workers
    from .gradebook import record
    from .lock import WHOLE
    from .results import Result, Results

    how = How(jobs or workers(), not unsafe_no_isolation, dask, shard, again)
    with Failures() as failures:
        who = _handed_in(course, assignment, student, failures)
        if engine == "nbgrader":
            _with_nbgrader(course, assignment, who, as_json, failures)
            return failures.code
        graded: list[Result] = []
        done = failures.sift(grade_class(course, assignment, who, how), "not graded")
        for number, one in enumerate(done, start=1):
            graded.append(one.result)
            says = f" ({one.says})" if one.says else ""
            line = f"[{number}/{len(who)}] {one.result}{says}"
            print(json.dumps(asdict(one.result)) if as_json else line, flush=True)
        said = sys.stderr if as_json else sys.stdout
        if how.shard == WHOLE:
            recorded = record(course, assignment, graded)
            _tell(failures.sift(recorded, "not in the gradebook"), said)
            everybody = graded if student else list(Results(course, assignment))
            _tell((f"ATTENTION: {says}" for says in common_failures(everybody)), said)
        if graded and not as_json:
            print(f"isolation: {graded[-1].isolation}\nresults: {course.results / assignment}")
    return failures.code


def _with_nbgrader(
    course: Course, assignment: str, who: list[str], as_json: bool, failures: Failures
) -> None:
    from .engines import grade_with_nbgrader

    steps = (for_student(s, partial(grade_with_nbgrader, course, assignment, s)) for s in who)
    for number, mark in enumerate(failures.sift(steps, "not graded"), start=1):
        if mark.score is None:
            failures.add("not graded", [Failed(mark.student, mark.says)])
        if as_json:
            print(json.dumps(vars(mark)), flush=True)
        elif mark.score is not None:
            says = f"{mark.student}: {mark.score:g} of {mark.points:g}"
            print(f"[{number}/{len(who)}] {says}", flush=True)


@verb("01_paths --diff")
@of_assignment
@one_student
@click.option("--diff", is_flag=True, help="Only say whose mark would move.")
@click.option("--lower", is_flag=True, help="Let marks fall too.")
@jobs
def regrade(
    course: Course,
    assignment: str,
    student: str | None,
    diff: bool,
    lower: bool,
    jobs: int | None,
) -> int:
    """Grade again after a test or its points have changed."""
    from .batch import How, workers
    from .gradebook import record
    from .lock import alone
    from .regrade import accept, moves
    from .results import Results

    with Failures() as failures, alone(Results(course, assignment).folder):
        who = _handed_in(course, assignment, student, failures)
        found = moves(course, assignment, who, How(jobs=jobs or workers()))
        moved = list(failures.sift(found, "not graded"))
        _tell(_said_of(moved), sys.stdout)
        if not diff:
            counts = accept(course, assignment, moved, lower=lower)
            accepted = list(failures.sift(counts, "not kept"))
            left = len(moved) - len(counts)
            if left:
                print(f"{left} marks would fall and stay as they are; --lower lets them")
            recorded = record(course, assignment, accepted)
            _tell(failures.sift(recorded, "not in the gradebook"), sys.stdout)
    return failures.code


def _said_of(moved: Sequence[Move]) -> Iterable[str]:
    for move in sorted(moved, key=lambda m: m.by):
        if move.by or move.before is None:
            yield str(move)
    changed = sum(bool(m.by) for m in moved)
    yield f"{changed} of {len(moved)} marks move, {sum(m.by < 0 for m in moved)} of them down"
    before = {m.before.points for m in moved if m.before} - {m.after.points for m in moved}
    if before:
        full = ", ".join(f"{points:g}" for points in sorted(before))
        yield f"full marks were {full} and are {moved[0].after.points:g} now"


@verb("01_paths --student ada")
@of_assignment
@one_student
@click.option(
    "--moodle", type=PATH, metavar="ZIP", help="Also write the feedback files that Moodle takes."
)
def feedback(course: Course, assignment: str, student: str | None, moodle: Path | None) -> int:
    """Write a page for each student."""
    from .exchange import for_exchange
    from .feedback import write_feedback
    from .gradebook import comments
    from .return_feedback import moodle_zip
    from .standing import standing

    with Failures() as failures:
        results = list(failures.sift(standing(course, assignment, student), "no page"))
        if not results and not failures.code:
            raise _nobody(assignment, student)
        pages = write_feedback(course, assignment, results, comments(course, assignment))
        made = list(failures.sift(pages, "no page"))
        size = sum(path.stat().st_size for path in made) / 1e6
        print(f"pages in {course.root / 'feedback'}: {len(made)}, {size:.1f} MB")
        sent = [
            for_student(page.parents[1].name, partial(for_exchange, course, assignment, page))
            for page in made
        ]
        if any(failures.sift(sent, "not for the exchange")):
            print(f"back to the exchange: nbgrader release_feedback {assignment}")
        if moodle:
            count = moodle_zip(course, assignment, made, moodle)
            size = moodle.stat().st_size / 1e6
            print(f"for Moodle, {count} of {len(made)}, {size:.1f} MB: {moodle}")
    return failures.code


@verb("01_paths --to marks.csv")
@of_assignment
@click.option(
    "--layout",
    type=click.Choice(["nbgrader", "questions", "canvas", "moodle", "moodle-worksheet"]),
    default="questions",
    help="moodle is for its gradebook, moodle-worksheet for the assignment's own page.",
)
@click.option(
    "--column", metavar="NAME", help="The assignment as the platform calls it: 'Paths (4711)'."
)
@to_file
def export(
    course: Course, assignment: str, layout: str, column: str | None, to: Path | None
) -> int:
    """Write marks as a table."""
    from .export import LAYOUTS, as_csv, left_out, rows

    marks = list(rows(course, assignment))
    if not marks:
        raise _nobody(assignment, None)
    for row in marks:
        if row.missing or row.remark:
            says = f"no mark: {row.student}: {row.missing}" if row.missing else ""
            print(says or f"{row.student}: {row.remark}", file=sys.stderr)
    _tell(filter(None, [left_out(layout, marks)]), sys.stderr)
    _write(as_csv(LAYOUTS[layout](column or assignment, marks)), to)
    return int(any(row.missing for row in marks))


@verb("01_paths --names")
@of_assignment
@click.option("--names", is_flag=True, help="With names, for your eyes only.")
@to_file
@click.option("--jplag", type=PATH, metavar="DIR", help="Also write answers for JPlag there.")
def class_report(
    course: Course, assignment: str, names: bool, to: Path | None, jplag: Path | None
) -> int:
    """Say what the class got right and wrong."""
    from .class_report import for_jplag, report
    from .pseudonyms import pseudonyms
    from .standing import standing

    with Failures() as failures:
        results = list(failures.sift(standing(course, assignment), "left out"))
        if not results:
            raise _nobody(assignment, None)
        problems = {p.name: p for p in course.problems(assignment)}
        pseudonym = pseudonyms(course)
        called = str if names else pseudonym
        _write(report(assignment, results, problems, called, len(failures.sentences)), to)
        if jplag:
            written = for_jplag(results, jplag, pseudonym)
            print(f"{written} answers in {jplag}", file=sys.stderr)
    return failures.code


@verb("")
def doctor() -> int:
    """Say what this machine lacks, and how to get it."""
    from .doctor import examine

    bad = False
    for finding in examine():
        print(finding, flush=True)
        bad |= finding.needed and not finding.fine
    return 1 if bad else 0


def _handed_in(
    course: Course, assignment: str, student: str | None, failures: Failures
) -> list[str]:
    """Who handed in, or the one asked for; folders with a name that is not fit are failures."""
    from .engines import misnamed
    from .engines import students as found_in

    found = found_in(course, assignment)
    who = [student] if student else found
    if student is None:
        failures.add("not graded", misnamed(course, assignment))
    if set(who) - set(found) or not (who or failures.code):
        raise LabkitError(
            f"nothing of {student or 'anybody'} lies in submitted/*/{assignment}; "
            "put notebooks there as submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb"
        )
    return who


def _nobody(assignment: str, student: str | None) -> LabkitError:
    """What to say where nothing is graded yet."""
    who = f"{student} is not" if student else "nobody is"
    return LabkitError(f"{who} graded in {assignment}; type: labkit grade {assignment}")


def _tell(sentences: Iterable[str], where: TextIO) -> None:
    for sentence in sentences:
        print(sentence, file=where, flush=True)


def _write(text: str, where: Path | None) -> None:
    if where is None:
        sys.stdout.write(text)
    else:
        where.write_text(text, encoding="utf-8")
        print(f"written: {where}")


COMMANDS = (students, collect, grade, regrade, feedback, export, class_report, doctor)
