"""The verbs of a term on the command line: begin it, release, hand out, export, forget."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..course.layout import Course
from ..verbs import Do, Verbs, add_verb, whole


def course_option(verb: argparse.ArgumentParser) -> None:
    """The option that says which course."""
    verb.add_argument("--course", type=Path, metavar="DIR", help="default: the one around you")


def assignment_verb(
    verbs: Verbs, name: str, do: Do, does: str, example: str = ""
) -> argparse.ArgumentParser:
    """A verb on one assignment of a course."""
    verb = add_verb(verbs, name, do, does, f"01_paths {example}")
    verb.add_argument("name", metavar="ASSIGNMENT", help="such as 01_paths")
    course_option(verb)
    return verb


def course_with(args: argparse.Namespace) -> Course:
    """The course that is meant, which has the assignment that is meant.

    Raises:
        LabkitError: There is no such course, or no such assignment in it.
    """
    here = Course.here(args.course)
    here.notebook_source(args.name)
    return here


def add(verbs: Verbs) -> None:
    """``release``, ``student-bundle``, ``new-term``, ``forget`` and ``export-course``."""
    verb = add_verb(verbs, "release", release, "make the students' notebooks", "01_paths --seed 7")
    verb.add_argument("names", nargs="*", metavar="NAME", help="such as 01_paths; all by default")
    verb.add_argument(
        "--seed", type=whole(0), help="of the hidden cases; the term's by default, or the last"
    )
    course_option(verb)

    does = "a zip for students: labkit and notebooks"
    example = "00_warmup 01_paths --to week1.zip"
    verb = add_verb(verbs, "student-bundle", student_bundle, does, example)
    verb.add_argument("names", nargs="*", metavar="NAME", help="all that are released by default")
    verb.add_argument("--to", type=Path, metavar="FILE", help="default: dist/baxter-lab.zip")
    course_option(verb)

    does = "archive the last term, release with a new seed"
    verb = add_verb(verbs, "new-term", new_term, does, "00_warmup 01_paths")
    verb.add_argument("names", nargs="*", metavar="NAME", help="all by default")
    verb.add_argument("--seed", type=whole(0), help="of the hidden cases; drawn by default")
    course_option(verb)

    does = "delete archived terms, and the names with them"
    course_option(add_verb(verbs, "forget", forget, does, ""))

    does = "a repository for students, and a private one"
    verb = add_verb(verbs, "export-course", export_course, does, "--to ../handout")
    verb.add_argument("--to", type=Path, required=True, metavar="DIR")
    course_option(verb)


def release(args: argparse.Namespace) -> int:
    """Make assignments."""
    from .release import release
    from .term import said_of, seed_for

    course = Course.here(args.course)
    seeds = set()
    for name in args.names or course.names():
        course.notebook_source(name)
        seed = seed_for(course, name) if args.seed is None else args.seed
        print(release(course, name, seed), flush=True)
        seeds.add(seed)
    for warning in filter(None, map(said_of, seeds)):
        print(warning)
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
