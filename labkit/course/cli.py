"""The student's commands, ``labkit submit-check`` and ``labkit merge``, and command errors."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from ..errors import LabkitError

PATH = click.Path(path_type=Path)
FOR_INSTRUCTORS = ("nbgrader", "jupytext", "sqlalchemy")
"""Packages that a student's environment does not have."""


class Verb(click.Command):
    """A command that returns its exit code: 0 for success, 1 if the output names failures.

    Wrong use ends with one sentence and exit code 2, and Ctrl-C with exit code 130.
    """

    def invoke(self, ctx: click.Context) -> int:
        """Run the command."""
        try:
            return int(super().invoke(ctx))
        except LabkitError as error:
            return self._stop(str(error))
        except ModuleNotFoundError as error:
            package = (error.name or "").partition(".")[0]
            if package not in FOR_INSTRUCTORS:
                raise
            return self._stop(f"{package} is missing; type: pip install 'labkit[grader]'")
        except KeyboardInterrupt:
            return self._stop("stopped", code=130)
        except BrokenPipeError:  # the reader of the output has seen enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            return 1
        except OSError as error:  # a folder that does not exist, a full disk
            where = "" if error.filename is None else f"{error.filename}: "
            return self._stop(f"{where}{error.strerror or error}")

    def _stop(self, sentence: str, code: int = 2) -> int:
        """Print the reason without control characters, which a file's name may hold."""
        text = "".join(x if x.isprintable() or x == "\n" else "\ufffd" for x in sentence)
        print(f"labkit {self.name}: {text}", file=sys.stderr)
        return code


def verb(example: str) -> Callable[[Callable[..., int]], Verb]:
    """Make a function a command with the same name and docstring.

    Args:
        example: Arguments of the example at the end of the help.
    """

    def make(function: Callable[..., int]) -> Verb:
        name = function.__name__.replace("_", "-")
        epilog = f"example: labkit {name} {example}".rstrip()
        return click.command(name, Verb, epilog=f"\b\n{epilog}")(function)

    return make


@verb("01_paths.ipynb")
@click.argument("notebook", type=PATH)
@click.option("--forum", is_flag=True, help="Print a summary to copy into a forum.")
def submit_check(notebook: Path, forum: bool) -> int:
    """Check before you hand in: is the notebook complete?"""
    from .before_handing_in import examine

    found = examine(notebook)
    print(found.for_the_forum() if forum else found)
    return 1 if found.problems else 0


@verb("01_paths.ipynb new/01_paths.ipynb --to merged.ipynb")
@click.argument("mine", type=PATH)
@click.argument("new", type=PATH)
@click.option(
    "--to",
    type=PATH,
    required=True,
    metavar="FILE",
    help="Notebook to write; it must not exist yet.",
)
def merge(mine: Path, new: Path, to: Path) -> int:
    """Copy your work into a corrected notebook.

    MINE is the notebook that you worked in; NEW is the corrected one from your instructor.
    """
    from .checks_file import FILE
    from .merge import KEPT_TEXT, merge
    from .notebook import read_cells

    cells, released = read_cells(mine), read_cells(new)
    if to.exists():
        raise LabkitError(f"{to} already exists; give another name with --to")
    release = json.loads(new.read_text(encoding="utf-8"))
    if not _is_valid(release):
        raise LabkitError(f"{new.name} is not a valid notebook; fetch the assignment again")
    notebook = release | {"cells": merge(cells, released)}
    text = json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
    to.write_text(text, encoding="utf-8", errors="replace")  # a lone surrogate is not text
    print(
        f"{to}: the new release with your work; look through it, replace your notebook with it, "
        "and run all its cells"
    )
    checks, old = new.with_name(FILE), mine.with_name(FILE)
    if checks.is_file() and not (old.is_file() and old.read_bytes() == checks.read_bytes()):
        print(
            f"copy {checks} over {old} as well, and restart the kernel; until then the checks have "
            "the tests and points of the older release"
        )
    if any(KEPT_TEXT in cell["source"] for cell in notebook["cells"]):
        print(
            "what you wrote in cells that the new release changed or does not have is in added "
            f"cells, below this line: {KEPT_TEXT}"
        )
    return 0


def _is_valid(notebook: dict[str, Any]) -> bool:
    """Whether the data are a valid notebook."""
    from nbformat.validator import isvalid

    try:
        return bool(isvalid(notebook, version=4, version_minor=5))
    except (TypeError, RecursionError):  # an id or a cell's type that is not text; too deep
        return False
