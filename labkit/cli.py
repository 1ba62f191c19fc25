"""The command ``labkit``: what students and instructors type."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from io import TextIOWrapper
from pathlib import Path

from . import __version__
from .errors import LabkitError
from .verbs import add_verb

EXAMPLES = """examples:
  labkit submit-check 01_paths.ipynb    before handing in: is the notebook whole?
"""
EXAMPLES_FOR_INSTRUCTORS = """\
  labkit release                        make all assignments, for students and for graders
  labkit release 01_paths --seed 7      one of them, with hidden cases of your own
  labkit student-bundle                 a zip for students, with a start page
  labkit grade 01_paths                 grade everything under submitted/
  labkit report-card                    how well the checks tell right from wrong
"""
FOR_INSTRUCTORS = ("nbgrader", "jupytext", "sqlalchemy")
"""Packages that a student's environment does without."""


def parser() -> argparse.ArgumentParser:
    """The command's words; a students' repository comes without those of instructors."""
    instructors = find_spec("labkit.grader") is not None
    top = argparse.ArgumentParser(
        prog="labkit",
        description="A teaching laboratory for robot control.",
        epilog=EXAMPLES + EXAMPLES_FOR_INSTRUCTORS * instructors,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"labkit {__version__}")
    verbs = top.add_subparsers(dest="verb", required=True, metavar="VERB")

    does = "before handing in: is the notebook whole?"
    verb = add_verb(verbs, "submit-check", _submit_check, does, "01_paths.ipynb")
    verb.add_argument("notebook", type=Path, metavar="NOTEBOOK")
    verb.add_argument("--forum", action="store_true", help="print a block to copy into a forum")

    does = "bring your work into a corrected release"
    example = "01_paths.ipynb new/01_paths.ipynb --to merged.ipynb"
    verb = add_verb(verbs, "merge", _merge, does, example)
    verb.add_argument("mine", type=Path, metavar="MINE", help="the notebook you worked in")
    verb.add_argument("new", type=Path, metavar="NEW", help="the corrected one")
    verb.add_argument("--to", type=Path, required=True, metavar="FILE", help="where to write")

    if instructors:
        from .grader import verbs as verbs_grading
        from .grader import verbs_course, verbs_students, verbs_term

        verbs_course.add(verbs)
        verbs_grading.add(verbs)
        verbs_students.add(verbs)
        verbs_term.add(verbs)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; a mistake of the caller's ends in one sentence and exit code 2."""
    args = parser().parse_args(argv)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files may hold anything
    try:
        return int(args.do(args))
    except LabkitError as error:
        print(f"labkit {args.verb}: {_printable(str(error))}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in FOR_INSTRUCTORS:
            raise
        mend = "type: pip install 'labkit[instructor]'"
        print(f"labkit {args.verb}: {package} is missing; {mend}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"labkit {args.verb}: stopped", file=sys.stderr)
        return 130
    except BrokenPipeError:  # whoever was reading has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 1
    except OSError as error:  # a folder that is not there, a disk that is full
        where = "" if error.filename is None else _printable(f"{error.filename}: ")
        print(f"labkit {args.verb}: {where}{error.strerror or error}", file=sys.stderr)
        return 2


def _printable(text: str) -> str:
    """A sentence without what a terminal would obey: somebody's file may be called so."""
    return "".join(x if x.isprintable() or x == "\n" else "\ufffd" for x in text)


def _submit_check(args: argparse.Namespace) -> int:
    from .course.handin import look

    found = look(args.notebook)
    print(found.for_the_forum() if args.forum else found)
    return 1 if found.problems else 0


def _merge(args: argparse.Namespace) -> int:
    from .course.handin import merge
    from .course.notebook import read_cells

    mine, new = read_cells(args.mine), read_cells(args.new)
    if args.to.exists():
        raise LabkitError(f"{args.to} is there already; give another name with --to")
    notebook = json.loads(args.new.read_text(encoding="utf-8")) | {"cells": merge(mine, new)}
    text = json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
    args.to.write_text(text, encoding="utf-8", errors="replace")  # a lone surrogate is no text
    print(f"{args.to}: the new release with your work; look it through, then run it all")
    return 0


if __name__ == "__main__":
    sys.exit(main())
