"""The student's command, ``labkit submit-check``, and errors of all commands."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

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
def submit_check(notebook: Path) -> int:
    """Run a copy of your notebook before you hand in."""
    from .handin import submit_check

    print(f"Running a copy of {notebook.name}, which takes as long as Run All ...", flush=True)
    found = submit_check(notebook)
    print(found)
    return 1 if found.problems else 0
