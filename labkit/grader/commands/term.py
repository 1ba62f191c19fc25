"""The command that begins a term, and deletes what is stored of old ones."""

from __future__ import annotations

import click

from ...course.authoring.layout import Course
from ...course.cli import verb
from ...errors import LabkitError
from .course import names, of_course


@verb("new 01_paths")
@click.argument("action", type=click.Choice(["new", "forget"]), metavar="new|forget")
@names
@click.option("--student", metavar="S", help="forget: everything of one student, in all terms.")
@click.option(
    "--older",
    type=click.FloatRange(0),
    metavar="YEARS",
    help="forget: terms that ended at least YEARS years ago.",
)
@click.option(
    "--yes",
    is_flag=True,
    help="new: end a term that has students or marks; forget: delete, instead of only listing "
    "what would be deleted.",
)
@of_course
def term(
    course: Course,
    action: str,
    names: tuple[str, ...],
    student: str | None,
    older: float | None,
    yes: bool,
) -> int:
    """Begin a term, or delete old records.

    \b
    new     archives the last term and releases each NAME, or all assignments,
            with a new secret; refuses, without --yes, if the last term has
            students, submissions or marks
    forget  lists what it would delete: terms that ended some YEARS ago, or
            everything in folders and files named after one student; with
            --yes it deletes them. It lists what else names the student.

    The law may say how long marks must be kept.
    """  # noqa: D301
    from ..rules import FILE
    from ..term import delete, ended, new_term, of_student, running

    if action == "new":
        if (there := running(course)) and not yes:
            raise LabkitError(
                f"the term under way has {there}; add --yes to archive all this, or use labkit "
                "release NAME for another notebook in it"
            )
        record = new_term(course, names)
        if record["archived"]:
            print(f"archived: {there or 'a release without students'}: {record['archived']}")
        print(f"a new term begins, released: {', '.join(record['bundles'])}")
        print("its secret is in course_private/term.json; keep a copy")
        if (course.root / FILE).exists():
            print(f"{FILE} is as it was: change its dates, and delete its extensions")
        return 0
    if names or (student is None) == (older is None):
        raise LabkitError("say what to forget: --older YEARS, or --student NAME")
    theirs, others = of_student(course, student) if student else (ended(course, older or 0), [])
    if not theirs and not others:
        print(f"there is nothing of {student}" if student else "no term is as old")
        return 0
    if yes:
        delete(theirs)
    for path in theirs:
        print(f"{'deleted' if yes else 'would go'}: {path.relative_to(course.root)}")
    for path in others:
        print(f"names {student}, delete that by hand: {path.relative_to(course.root)}")
    print("delete by hand what lies elsewhere: downloads, tables, zips, backups, the platform")
    if not yes:
        print("nothing is deleted yet; add --yes")
    return 0


COMMANDS = (term,)
