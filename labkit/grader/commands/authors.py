"""A command for authors: how well the checks tell right from wrong."""

from __future__ import annotations

import click

from ...course.authoring.layout import PUBLIC_SEED, Course
from ...course.cli import verb
from .course import SEED, names, of_course


@verb("01_paths")
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
    default=2,
    help="Number of draws of hidden cases; 2 by default.",
)
@of_course
def report_card(course: Course, names: tuple[str, ...], seed: int, draws: int) -> int:
    """Print how well the checks tell right from wrong.

    The checks are tried on every known mistake, and on right answers written in other forms. Each
    NAME is an assignment, or one question of it, such as 01_paths/circle. Without a NAME all
    assignments are tried. The exit code is 1 where a check is wrong.
    """
    from ...course.authoring.report_card import rows, table

    card = list(rows(course, names or course.names(), seed, draws))
    print(table(card))
    return int(any(row.failures for row in card))


COMMANDS = (report_card,)
