"""The command ``labkit``: what students and instructors type."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import __version__
from .errors import LabkitError

EXAMPLES = """examples:
  labkit release                    make all assignments, for students and for nbgrader
  labkit release 01_paths --seed 7  one of them, with hidden cases of your own
  labkit grade 01_paths             grade everything under submitted/
  labkit report-card                how well the checks tell right from wrong
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

    verb = verbs.add_parser("grade", help="grade what was handed in")
    verb.add_argument("name", metavar="ASSIGNMENT", help="such as 01_paths")
    verb.add_argument("--student", metavar="S", help="only this one")
    _course(verb)
    verb.set_defaults(do=_grade)

    verb = verbs.add_parser("report-card", help="try the checks on known mistakes")
    verb.add_argument("names", nargs="*", metavar="NAME", help="such as 01_paths; all by default")
    verb.add_argument("--seed", type=int, default=2019, help="of the first draw (default: 2019)")
    of = "a Python file with a dict {} = {{question: [functions]}}"
    verb.add_argument("--mistakes", type=Path, metavar="FILE", help=of.format("MISTAKES"))
    verb.add_argument("--variants", type=Path, metavar="FILE", help=of.format("VARIANTS"))
    _course(verb)
    verb.set_defaults(do=_report_card)
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


def _grade(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.engines import grade_with_nbgrader, students

    course = Course.here(args.course)
    course.notebook_source(args.name)
    found = students(course, args.name)
    who: list[Any] = [args.student] if args.student else found
    if not who or set(who) - set(found):
        raise LabkitError(
            f"nothing of {args.student or 'anybody'} lies in submitted/*/{args.name}; "
            "put notebooks there as submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb"
        )
    for number, student in enumerate(who, start=1):
        mark = grade_with_nbgrader(course, args.name, student)
        got = "not graded" if mark.score is None else f"{mark.score:g} of {mark.points:g}"
        print(
            f"[{number}/{len(who)}] {student}: {got}{'; ' * bool(mark.says)}{mark.says}", flush=True
        )
    return 0


def _report_card(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.report_card import functions_from, report_card, write

    course = Course.here(args.course)
    mistakes = functions_from(args.mistakes)[0] if args.mistakes else None
    variants = functions_from(args.variants)[1] if args.variants else None
    card = report_card(
        course,
        args.names or course.names(),
        args.seed,
        mistakes,
        variants,
        progress=lambda row: print(
            f"{row.assignment} {row.question}: {row.rejected} of {row.mistakes} mistakes rejected, "
            f"{row.accepted} of {row.variants} right answers accepted",
            flush=True,
        ),
    )
    table, page = write(card, course.root / "build")
    print(page.read_text(encoding="utf-8"))
    print(f"written: {table} and {page}")
    return int(any(row.failures for row in card.rows))


if __name__ == "__main__":
    sys.exit(main())
