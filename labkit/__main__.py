"""The program ``labkit``, or ``python -m labkit``, with the verbs of students and instructors.

A student's labkit does not include the folder ``grader``, so it lacks the instructor's verbs.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.util import find_spec
from io import TextIOWrapper
from pathlib import Path

try:
    import click
except ModuleNotFoundError:
    sys.exit("labkit: click is missing; type: pip install 'labkit[notebook]'")

from . import __version__
from .errors import LabkitError

FOR_INSTRUCTORS = ("nbgrader", "jupytext", "sqlalchemy")
"""Packages that a student's environment does not have."""


@click.command("submit-check", epilog="example: labkit submit-check 01_paths.ipynb")
@click.argument("notebook", type=click.Path(path_type=Path))
def submit_check(notebook: Path) -> int:
    """Run a copy of your notebook before you hand in."""
    from .course.handin import submit_check

    print(f"Running a copy of {notebook.name}, which takes as long as Run All ...", flush=True)
    found = submit_check(notebook)
    print(found)
    return 1 if found.problems else 0


def program() -> click.Group:
    """All verbs of this installation."""
    verbs: list[click.Command] = [submit_check]
    if find_spec("labkit.grader"):
        from .grader.cli import VERBS

        verbs += VERBS
    group = click.Group(
        "labkit",
        commands=verbs,
        help="A teaching laboratory for robot control.",
        epilog="labkit VERB --help shows an example.",
        context_settings={"help_option_names": ["-h", "--help"]},
        subcommand_metavar="VERB ...",
    )
    return click.version_option(__version__, message="labkit %(version)s")(group)


def main(words: Sequence[str] | None = None) -> int:
    """Do what is asked; whatever stops a verb is rendered here, as one sentence.

    Args:
        words: The arguments after ``labkit``; by default those of this process.

    Returns:
        0; 1 if something is named that needs a look; 2 for wrong use; 130 after Ctrl-C.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name may contain any character
    words, labkit, code = [*(sys.argv[1:] if words is None else words)], program(), 2
    try:
        return int(labkit.main(words, "labkit", standalone_mode=False))
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except click.Abort:
        says, code = "stopped", 130
    except LabkitError as error:
        says = str(error)
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in FOR_INSTRUCTORS:
            raise
        says = f"{package} is missing; type: pip install 'labkit[grader]'"
    except OSError as error:  # a folder that does not exist, a full disk
        where = "" if error.filename is None else f"{error.filename}: "
        says = f"{where}{error.strerror or error}"
    name = next((word for word in words if word in labkit.commands), "")
    said = "".join(x if x.isprintable() or x == "\n" else "\ufffd" for x in f"{name}: {says}")
    print(f"labkit {said}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
