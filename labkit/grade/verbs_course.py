"""The verbs of a term on the command line: begin it, release, hand out, export, forget."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from .course import Course

Verbs = Any


def course_option(verb: argparse.ArgumentParser) -> None:
    """The option that says which course."""
    verb.add_argument("--course", type=Path, metavar="DIR", help="the course; found by default")


def add(verbs: Verbs) -> None:
    """``release``, ``student-bundle``, ``new-term``, ``forget`` and ``export-course``."""
    verb = verbs.add_parser("release", help="make the students' notebooks")
    verb.add_argument("names", nargs="*", metavar="NAME", help="such as 01_paths; all by default")
    verb.add_argument("--seed", type=int, help="of the hidden cases; the term's by default")
    course_option(verb)
    verb.set_defaults(do=release)

    verb = verbs.add_parser("student-bundle", help="a zip for students: labkit and notebooks")
    verb.add_argument("names", nargs="*", metavar="NAME", help="all that are released by default")
    verb.add_argument("--to", type=Path, metavar="FILE", help="default: dist/baxter-lab.zip")
    course_option(verb)
    verb.set_defaults(do=student_bundle)

    verb = verbs.add_parser("new-term", help="archive the last term, release with a new seed")
    verb.add_argument("names", nargs="*", metavar="NAME", help="all by default")
    verb.add_argument("--seed", type=int, help="of the hidden cases; drawn by default")
    course_option(verb)
    verb.set_defaults(do=new_term)

    verb = verbs.add_parser("forget", help="delete archived terms, and the names with them")
    course_option(verb)
    verb.set_defaults(do=forget)

    verb = verbs.add_parser("export-course", help="a repository for students, and a private one")
    verb.add_argument("--to", type=Path, required=True, metavar="DIR")
    course_option(verb)
    verb.set_defaults(do=export_course)


def release(args: argparse.Namespace) -> int:
    """Make assignments."""
    from .release import release
    from .term import seed_of

    course = Course.here(args.course)
    seed = seed_of(course) if args.seed is None else args.seed
    for name in args.names or course.names():
        print(release(course, name, seed), flush=True)
    print(f"for students: {course.release}\nfor graders, with hidden cases: {course.build}")
    return 0


def student_bundle(args: argparse.Namespace) -> int:
    """Write the students' zip."""
    from .handout import student_bundle

    course = Course.here(args.course)
    path = student_bundle(course, args.names, args.to or course.root / "dist" / "baxter-lab.zip")
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
    return 0


def new_term(args: argparse.Namespace) -> int:
    """Begin a term."""
    from .term import new_term

    record = new_term(Course.here(args.course), args.seed, tuple(args.names))
    for name, digest in record["bundles"].items():
        print(f"{name}: bundle {digest[:16]}")
    print(
        f"a term with seed {record['seed']} begins; keep course_private/term.json, which holds it"
    )
    return 0


def forget(args: argparse.Namespace) -> int:
    """Delete archived terms."""
    from .term import forget

    gone = forget(Course.here(args.course))
    print("\n".join(f"deleted {folder.name}" for folder in gone) or "no archived term is there")
    return 0


def export_course(args: argparse.Namespace) -> int:
    """Write two repositories."""
    from .repositories import export_course

    student, private = export_course(Course.here(args.course), args.to)
    print(f"for students, without answers: {student}\nprivate, everything: {private}")
    return 0
