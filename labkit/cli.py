"""The command ``labkit``: what students and instructors type."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from . import __version__
from .errors import LabkitError

EXAMPLES = """examples:
  labkit release                    make all assignments, for students and for nbgrader
  labkit release 01_paths --seed 7  one of them, with hidden cases of your own
  labkit grade 01_paths             grade everything under submitted/
"""


def parser() -> argparse.ArgumentParser:
    """The command's words."""
    top = argparse.ArgumentParser(
        prog="labkit",
        description="A teaching laboratory for robot control.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"labkit {__version__}")
    verbs = top.add_subparsers(dest="verb", required=True, metavar="VERB")

    verb = verbs.add_parser("release", help="make the students' notebooks")
    verb.add_argument("names", nargs="*", metavar="NAME", help="such as 01_paths; all by default")
    verb.add_argument("--seed", type=int, default=2019, help="of the hidden cases (default: 2019)")
    _course(verb)
    verb.set_defaults(do=_release)

    from .grade import verbs as instructors
    from .grade import verbs_term

    instructors.add_grade(verbs)
    instructors.add_make_class(verbs)
    instructors.add_doctor(verbs)
    verbs_term.add_all(verbs)
    return top


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; a mistake of the caller's ends in one sentence and exit code 2."""
    args = parser().parse_args(argv)
    try:
        return int(args.do(args))
    except LabkitError as error:
        print(f"labkit {args.verb}: {error}", file=sys.stderr)
        return 2


def _course(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("--course", type=Path, metavar="DIR", help="the course; found by default")


def _release(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.release import release

    course = Course.here(args.course)
    for name in args.names or course.names():
        print(release(course, name, args.seed), flush=True)
    print(f"for students: {course.release}\nfor graders, with hidden cases: {course.build}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
