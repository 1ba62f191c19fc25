"""The command that begins, lists and forgets terms."""

from __future__ import annotations

import sys

import click

from ...course.authoring.layout import Course
from ...course.cli import verb
from ...errors import LabkitError
from .course import names, of_course
from .pages import tell


@verb("new 01_paths")
@click.argument(
    "action",
    type=click.Choice(["new", "list", "return", "forget"]),
    metavar="new|list|return|forget",
)
@names
@click.option("--student", metavar="S", help="forget: everything of one student.")
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
    """Begin a term, list terms, delete old records.

    \b
    new     archives the last term and releases each NAME, or all assignments,
            with a new secret; refuses, without --yes, if the last term has
            students, submissions or marks
    list    lists the terms that are stored
    return  returns to the archived term NAME; the term under way is archived
    forget  lists what it would delete: terms that ended some YEARS ago, or
            everything of one student, in all terms or in those named (the
            term under way is called now); with --yes it deletes them

    The law may say how long marks must be kept.
    """  # noqa: D301
    from ..terms.by_hand import left_by_hand, unknown
    from ..terms.forget import (
        entries_of,
        files_of,
        forget,
        shared_work,
        shorter_extensions,
        terms_of,
    )
    from ..terms.older import relocate
    from ..terms.term import about, archives, new_term, old_rules, refuse_running, restore, running

    if action == "new":
        if not yes:
            refuse_running(course)
        there = running(course)
        record = new_term(course, names)
        if record["archived"]:
            empty = "the last release, in which there were no students and no marks"
            print(f"archived: {there or empty}")
            print(f"to return to it, type: labkit term return {record['archived']}")
        print(f"a new term begins, released: {', '.join(record['bundles'])}")
        print("its secret is in course_private/term.json; keep a copy")
        tell(filter(None, [old_rules(course)]), sys.stdout)
    elif action == "list":
        print("\n".join(about(course)))
    elif action == "return":
        stored = {one.folder.name: one.folder for one in archives(course)}
        if len(names) != 1 or names[0] not in stored:
            raise LabkitError(f"name one archive: {', '.join(stored) or 'there is none'}")
        relocate(Course(stored[names[0]]), archived=True)
        undone, released = restore(course, stored[names[0]])
        if undone:
            print(f"archived: course_private/{undone.name}")
        print(f"the term of {names[0]} is under way again, released: {', '.join(released)}")
    else:
        if (student is None) == (older is None):
            raise LabkitError("say what to forget: --older YEARS, or --student NAME")
        if names and student is None:
            raise LabkitError("--older YEARS chooses the terms; name none beside it")
        terms, entries, by_hand, shared = [], [], [], []
        if student is None:
            found = [one.folder for one in archives(course, older or 0.0)]
            by_hand = [str(one) for one in archives(course) if one.ended is None]
        else:
            terms = terms_of(course, student, names)
            found, entries = files_of(terms, student), entries_of(terms, student)
            if not (found or entries):
                raise unknown(course, student, names)
            by_hand = list(left_by_hand(course, terms, student))
            shared = shared_work(terms, student)
        if yes:
            forget(course, found, terms, student or "")
        done, changed = ("deleted", "no more in") if yes else ("would go", "would go from")
        for one, name, mate in shared:
            place = (one.submitted / str(student) / name).relative_to(course.root)
            says = "moved" if yes else "would move"
            print(f"{says} to {mate}, with its mark, which is the team's: {place}")
        tell(shorter_extensions(course, str(student), shared), sys.stdout)
        tell((f"{done}: {path.relative_to(course.root)}" for path in found), sys.stdout)
        tell((f"{changed} {path.relative_to(course.root)}" for path in entries), sys.stdout)
        tell(by_hand, sys.stdout)
        if not found and student is None:
            print("there is nothing to forget")
        elif not yes:
            print("nothing is deleted yet; add --yes")
    return 0


COMMANDS = (term,)
