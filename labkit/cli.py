"""The command ``labkit``: what students and instructors type."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import __version__
from .errors import LabkitError

EXAMPLES = """examples:
  labkit release                    make all assignments, for students and for nbgrader
  labkit release 01_paths --seed 7  one of them, with hidden cases of your own
  labkit student-bundle             a zip for students, with a start page
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

    verb = verbs.add_parser("submit-check", help="before handing in: is the notebook whole?")
    verb.add_argument("notebook", type=Path, metavar="NOTEBOOK")
    verb.add_argument("--forum", action="store_true", help="print a block to copy into a forum")
    verb.set_defaults(do=_submit_check)

    verb = verbs.add_parser("merge", help="bring your work into a corrected release")
    verb.add_argument("mine", type=Path, metavar="MINE", help="the notebook you worked in")
    verb.add_argument("new", type=Path, metavar="NEW", help="the corrected one")
    verb.add_argument("--to", type=Path, required=True, metavar="FILE", help="where to write")
    verb.set_defaults(do=_merge)

    verb = verbs.add_parser("new-term", help="archive the last term, release with a new seed")
    verb.add_argument("names", nargs="*", metavar="NAME", help="all by default")
    verb.add_argument("--seed", type=int, help="of the hidden cases; drawn by default")
    _course(verb)
    verb.set_defaults(do=_new_term)

    verb = verbs.add_parser("forget", help="delete archived terms, and the names with them")
    _course(verb)
    verb.set_defaults(do=_forget)

    verb = verbs.add_parser("export-course", help="a repository for students, and a private one")
    verb.add_argument("--to", type=Path, required=True, metavar="DIR")
    _course(verb)
    verb.set_defaults(do=_export_course)

    verb = verbs.add_parser("release", help="make the students' notebooks")
    verb.add_argument("names", nargs="*", metavar="NAME", help="such as 01_paths; all by default")
    verb.add_argument("--seed", type=int, help="of the hidden cases; the term's by default")
    _course(verb)
    verb.set_defaults(do=_release)

    verb = verbs.add_parser("student-bundle", help="a zip for students: labkit and notebooks")
    verb.add_argument("names", nargs="*", metavar="NAME", help="all that are released by default")
    verb.add_argument("--to", type=Path, metavar="FILE", help="default: dist/baxter-lab.zip")
    _course(verb)
    verb.set_defaults(do=_student_bundle)

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


def _submit_check(args: argparse.Namespace) -> int:
    from .check.handin import look

    found = look(args.notebook)
    print(found.for_the_forum() if args.forum else found)
    return 1 if found.problems else 0


def _merge(args: argparse.Namespace) -> int:
    from .check.handin import read_cells
    from .check.merging import merge

    mine, new = read_cells(args.mine), read_cells(args.new)
    if args.to.exists():
        raise LabkitError(f"{args.to} is there already; give another name with --to")
    notebook = json.loads(args.new.read_text(encoding="utf-8")) | {"cells": merge(mine, new)}
    args.to.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{args.to}: the new release with your work; look it through, then run it all")
    return 0


def _new_term(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.term import new_term

    record = new_term(Course.here(args.course), args.seed, tuple(args.names))
    for name, digest in record["bundles"].items():
        print(f"{name}: bundle {digest[:16]}")
    print(
        f"a term with seed {record['seed']} begins; course_private/term.json keeps it, so keep that"
    )
    return 0


def _forget(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.term import forget

    gone = forget(Course.here(args.course))
    print("\n".join(f"deleted {folder.name}" for folder in gone) or "no archived term is there")
    return 0


def _export_course(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.export import export_course

    student, private = export_course(Course.here(args.course), args.to)
    print(f"for students, without answers: {student}\nprivate, everything: {private}")
    return 0


def _release(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.release import release
    from .grade.term import seed_of

    course = Course.here(args.course)
    seed = seed_of(course) if args.seed is None else args.seed
    for name in args.names or course.names():
        print(release(course, name, seed), flush=True)
    print(f"for students: {course.release}\nfor graders, with hidden cases: {course.build}")
    return 0


def _student_bundle(args: argparse.Namespace) -> int:
    from .grade.course import Course
    from .grade.handout import student_bundle

    course = Course.here(args.course)
    path = student_bundle(course, args.names, args.to or course.root / "dist" / "baxter-lab.zip")
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
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
