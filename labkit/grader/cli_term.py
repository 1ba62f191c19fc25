"""The command that begins, lists and forgets terms."""

from __future__ import annotations

import sys

import click

from ..course.cli import verb
from ..course.layout import Course
from ..errors import LabkitError
from .cli import tell
from .cli_course import SEED, names, of_course


@verb("new 01_paths")
@click.argument("action", type=click.Choice(["new", "list", "forget"]), metavar="new|list|forget")
@names
@click.option(
    "--seed",
    type=SEED,
    help="new: seed of the hidden cases; drawn at random by default.",
)
@click.option(
    "--student",
    metavar="S",
    help="forget: everything of one student, in all terms.",
)
@click.option(
    "--older",
    type=click.FloatRange(0),
    metavar="YEARS",
    help="forget: terms that ended at least YEARS years ago.",
)
@click.option(
    "--yes",
    is_flag=True,
    help="forget: delete, instead of only listing what would be deleted.",
)
@of_course
def term(
    course: Course,
    action: str,
    names: tuple[str, ...],
    seed: int | None,
    student: str | None,
    older: float | None,
    yes: bool,
) -> int:
    """Begin a term, list terms, delete old records.

    \b
    new     archives the last term and releases each NAME, or all assignments,
            with a new seed
    list    lists the terms that are stored
    forget  lists what it would delete: terms that ended some YEARS ago, or
            everything of one student; with --yes it deletes them

    The law may say how long marks must be kept.
    """  # noqa: D301
    from .forget import forget, places_of
    from .term import about, archives, new_term, old_rules

    if action == "new":
        record = new_term(course, seed, names)
        for name, digest in record["bundles"].items():
            print(f"{name}: bundle {digest[:16]}")
        begun = f"a term with seed {record['seed']} begins"
        print(f"{begun}; keep course_private/term.json, which holds it")
        tell(filter(None, [old_rules(course)]), sys.stdout)
    elif action == "list":
        print("\n".join(about(course)))
    else:
        if (student is None) == (older is None):
            raise LabkitError("say what to forget: --older YEARS, or --student NAME")
        if student is not None:
            found = places_of(course, student)
        else:
            found = [one.folder for one in archives(course, older or 0.0)]
        for path in found:
            print(f"{'deleted' if yes else 'would go'}: {path.relative_to(course.root)}")
        if not found and student is None:
            print("there is nothing to forget")
        elif yes:
            for sentence in forget(course, found, student):
                print(sentence)
        else:
            print("nothing is deleted yet; add --yes")
    return 0


COMMANDS = (term,)
