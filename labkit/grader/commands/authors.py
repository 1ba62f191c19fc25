"""Commands for authors: how well the checks tell right from wrong; the course as repositories."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from ...course.authoring.layout import Course
from ...course.cli import PATH, verb
from ...course.seed import PUBLIC_SEED
from .course import SEED, names, of_course

Option = Callable[[Callable[..., int]], Callable[..., int]]


def _functions(of: str) -> Option:
    """An option that reads more known answers from a file."""
    says = f"Try more {of}: a Python file with a dict {of.upper()} = {{question: [functions]}}."
    return click.option(f"--{of}", type=PATH, metavar="FILE", help=says)


@verb("01_paths --mistakes seen_in_class.py")
@names
@click.option(
    "--seed",
    type=SEED,
    default=PUBLIC_SEED,
    help=f"Seed of the first draw; {PUBLIC_SEED} by default.",
)
@click.option(
    "--draws",
    type=click.IntRange(1),
    default=20,
    help="Number of draws of hidden cases; 20 by default.",
)
@click.option("--to", type=PATH, metavar="DIR", help="Folder for the report; build by default.")
@_functions("mistakes")
@_functions("variants")
@of_course
def report_card(
    course: Course,
    names: tuple[str, ...],
    seed: int,
    draws: int,
    to: Path | None,
    mistakes: Path | None,
    variants: Path | None,
) -> int:
    """Measure how well the checks tell right from wrong.

    The checks are tried on every known mistake, and on right answers written in other forms, with
    several draws of hidden cases. Each NAME is an assignment, or one question of it, such as
    01_paths/circle. Without a NAME all assignments are tried. The exit code is 1 where a check is
    wrong, or an answer comes nearer to its tolerance than three sigma.
    """
    from ...course.authoring.report_card import functions_from, make, write

    card = make(
        course,
        names or course.names(),
        seed,
        functions_from(mistakes, "MISTAKES") if mistakes else None,
        functions_from(variants, "VARIANTS") if variants else None,
        progress=lambda row: print(
            f"{row.assignment} {row.question}: {row.rejected} of {row.mistakes} mistakes rejected, "
            f"{row.accepted} of {row.variants} right answers accepted",
            flush=True,
        ),
        draws=draws,
    )
    table, page = write(card, to or course.root / "build")
    print(page.read_text(encoding="utf-8"))
    print(f"written: {table} and {page}")
    return int(any(row.failures for row in card.rows))


@verb("--to ../handout")
@click.option(
    "--to", type=PATH, required=True, metavar="DIR", help="A folder that does not exist yet."
)
@of_course
def export_course(course: Course, to: Path) -> int:
    """Write two repositories: one for students, one private."""
    from ..terms.student_bundle import export_course

    student, private = export_course(course, to)
    print(f"for students, without answers: {student}\nprivate, everything: {private}")
    return 0


COMMANDS = (report_card, export_course)
