"""The program ``labkit``, or ``python -m labkit``, with the commands of students and instructors.

A student's labkit does not include the folder ``grader``, so it lacks the instructor's commands.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.util import find_spec
from io import TextIOWrapper

try:
    import click
except ModuleNotFoundError:
    sys.exit("labkit: click is missing; type: pip install 'labkit[notebook]'")

from . import __version__
from .course.cli import submit_check

EXAMPLES = """\b
examples:
  labkit submit-check 01_paths.ipynb    before you hand in: run a copy of the notebook
"""
EXAMPLES_FOR_INSTRUCTORS = """\
  labkit release                        make all assignments, for students and graders
  labkit student-zip                 a zip for students, with a start page
  labkit grade 01_paths                 grade everything under submitted/
  labkit report-card                    measure how well checks tell right from wrong
"""


def program() -> click.Group:
    """All commands of this installation."""
    commands: list[click.Command] = [submit_check]
    examples = EXAMPLES
    if find_spec("labkit.grader"):
        from .grader.commands import authors, course, export, grading, pages, term

        by_time = (course, term, authors, grading, pages, export)
        commands += [one for module in by_time for one in module.COMMANDS]
        examples += EXAMPLES_FOR_INSTRUCTORS
    group = click.Group(
        "labkit",
        help="A teaching laboratory for robot control.",
        epilog=examples,
        context_settings={"help_option_names": ["-h", "--help"]},
        subcommand_metavar="VERB ...",
    )
    for command in commands:
        group.add_command(command)
    return click.version_option(__version__, message="labkit %(version)s")(group)


def main(words: Sequence[str] | None = None) -> int:
    """Run a command.

    Args:
        words: The arguments after ``labkit``; by default those of this process.

    Returns:
        The exit code.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name may contain any character
    try:
        return int(program().main(words, "labkit", standalone_mode=False))
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except click.Abort:
        return 130


if __name__ == "__main__":
    sys.exit(main())
