"""Commands before grading: the machine, notebooks for students, roster, hand-ins."""

from __future__ import annotations

import sys
from collections.abc import Callable
from datetime import UTC, datetime
from functools import wraps
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

import click

from ...course.authoring.layout import DEFENCE, Course
from ...course.cli import PATH, verb
from ...errors import LabkitError

SEED = click.IntRange(min=0)
MARKED_BY = {DEFENCE: "labkit defence STUDENT --mark A,B,C"}
"""The command that gives the marks of an assignment without a notebook."""


def of_course(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command the option ``--course`` and hand it the course."""

    @click.option(
        "--course",
        type=PATH,
        metavar="DIR",
        help="Folder of the course; by default the one you are in.",
    )
    @wraps(command)
    def on_course(course: Path | None, **given: Any) -> int:
        return command(course=Course.here(course), **given)

    return on_course


def of_assignment(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command an assignment's name; the course must have a notebook of that name."""

    @click.argument("assignment", required=False, metavar="ASSIGNMENT")
    @of_course
    @wraps(command)
    def on_assignment(course: Course, assignment: str | None, **given: Any) -> int:
        if assignment is None:
            there = {path.name for path in course.submitted.glob("*/*")}
            handed_in = [name for name in course.names() if name in there]
            which = ", ".join(handed_in or course.names())
            raise LabkitError(f"which assignment? {'handed in' if handed_in else 'all'}: {which}")
        if assignment in MARKED_BY:
            raise LabkitError(f"{assignment} is marked by: {MARKED_BY[assignment]}")
        course.notebook_source(assignment)
        return command(course=course, assignment=assignment, **given)

    return on_assignment


names = click.argument("names", nargs=-1, metavar="[NAME]...")


@verb("01_paths")
@names
@of_course
def release(course: Course, names: tuple[str, ...]) -> int:
    """Make the students' notebooks.

    Each NAME is an assignment, such as 01_paths. Without a NAME all assignments are made. If one is
    refused, the others are still made; the reasons come at the end, with exit code 1.
    """
    from ..each import Failures
    from ..release import release
    from ..seeds import public_warning, seed_of

    names = names or course.names()
    for name in names:
        course.notebook_source(name)
    made = False
    with Failures() as failures:
        for name in names:
            try:
                print(release(course, name, seed_of(course)), flush=True)
                made = True
            except LabkitError as error:
                failures.add(f"{name} is not released", [error])
        if made:
            print(
                "tried: known mistakes, stand-ins, public cases from memory; "
                "more by: labkit report-card"
            )
            if warning := public_warning(course):
                print(warning)
            print(f"for students: {course.release}\nfor graders, with hidden cases: {course.build}")
    return failures.code


@verb("00_warmup 01_paths --to week1.zip")
@names
@click.option(
    "--to", type=PATH, metavar="FILE", help="The zip to write; dist/baxter-lab.zip by default."
)
@click.option(
    "--book",
    metavar="ADDRESS",
    help="Link to the book at ADDRESS; by default the zip holds the book, if it was built.",
)
@of_course
def student_zip(course: Course, names: tuple[str, ...], to: Path | None, book: str | None) -> int:
    """Write the zip that students unpack and start.

    Without a NAME the zip holds every assignment that was released.
    """
    from ..student_zip import remarks, student_zip

    path = student_zip(course, names, to or course.root / "dist" / "baxter-lab.zip", book)
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
    for says in remarks(course, names or course.names()):
        print(says, file=sys.stderr)
    return 0


@verb("participants.csv --teams Groups")
@click.argument("file", type=PATH, metavar="LIST.csv")
@click.option(
    "--teams",
    metavar="COLUMN",
    default="",
    help="The column of LIST.csv with teams, which share an arm and hand in one report.",
)
@of_course
def roster(course: Course, file: Path, teams: str) -> int:
    """Add the students of a list to the roster.

    The list comes from Moodle or Canvas, or is any table with a row for each student. Who has
    another role is left out, and named. A student keeps the folder of the first list.
    """
    from ..roster import import_list

    print("\n".join(import_list(course, file, teams)))
    return 0


@verb("01_paths moodle.zip")
@click.argument("assignment")
@of_course
@click.argument("sources", nargs=-1, required=True, type=PATH, metavar="ZIP|DIR...")
@click.option(
    "--unverified",
    is_flag=True,
    help="Exchange: also take hand-ins of users whom this machine does not know.",
)
@click.option(
    "--named",
    metavar="PATTERN",
    help="Where a file's path has a column of the roster: 'paths-{github}/*.ipynb'.",
)
@click.option(
    "--at",
    metavar="TIME",
    help="Time of the hand-ins, where the download has none.",
)
def collect(
    course: Course,
    assignment: str,
    sources: tuple[Path, ...],
    unverified: bool,
    named: str | None,
    at: str | None,
) -> int:
    """Collect what students handed in, from any platform.

    A source is a zip from Moodle or Canvas, or the inbound folder of nbgrader's exchange. Clones
    of GitHub Classroom, and any other folder or zip of files, need --named. Every notebook that
    was taken is kept, in attempts/. A file that fits no one student of the roster is left.

    Exit code: 0 if everything was taken, 1 if a file was left (named at the end), 2 if nothing
    could be collected.
    """
    from ..collect import collect
    from ..rules import read_rules
    from ..submission import read_time

    course.notebook_source(assignment)
    zone = ZoneInfo(read_rules(course).zone)
    when = read_time(at, zone) if at else None
    if at and when is None:
        raise LabkitError(f"{at!r} is not a time; write 2026-11-02 23:59")
    if when and when > (now := datetime.now(UTC)):
        raise LabkitError(
            f"--at {at!r} is in the future, it is now {now.astimezone(zone):%Y-%m-%d %H:%M}; "
            "write when the download was made"
        )
    doubtful = []
    try:
        for source in sources:
            for taken in collect(
                course, assignment, source, unverified=unverified, named=named, at=when
            ):
                if taken.fine:
                    print(taken, flush=True)
                else:
                    doubtful.append(taken)
    finally:
        for taken in doubtful:
            print(taken, file=sys.stderr)
    return 1 if doubtful else 0


@verb("")
def doctor() -> int:
    """Check whether this machine can grade safely.

    The sandbox is tried from inside. If it cannot be made, what your machine needs is printed.
    """
    from ..doctor import examine

    bad = False
    for finding in examine():
        print(finding, flush=True)
        bad |= finding.needed and not finding.fine
    return 1 if bad else 0


COMMANDS = (doctor, release, student_zip, roster, collect)
