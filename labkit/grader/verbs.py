"""The instructor's verbs on the command line."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..course.layout import PUBLIC_SEED, Course
from ..course.serialize import record_data
from ..errors import LabkitError
from ..verbs import Verbs, add_verb, whole
from .each import Failures
from .verbs_course import assignment_verb, course_option, course_with


def add(verbs: Verbs) -> None:
    """``grade``, ``make-class``, ``report-card`` and ``doctor``."""
    does = "grade what was handed in and is not graded yet, each in a sandbox of its own"
    verb = assignment_verb(verbs, "grade", grade, does, "--student ada")
    verb.add_argument("--student", metavar="S", help="only this one")
    verb.add_argument("--jobs", type=whole(1), metavar="N", help="workers (default: one per core)")
    verb.add_argument("--json", action="store_true", help="one JSON object per line, for programs")
    verb.add_argument("--again", action="store_true", help="grade anew what is graded already")
    verb.add_argument(
        "--dask", metavar="ADDRESS", help="of a Dask scheduler that shares the folder"
    )
    verb.add_argument(
        "--shard",
        type=_shard,
        metavar="i/n",
        default="1/1",
        help="only the i-th of n parts of the class",
    )
    verb.add_argument(
        "--unsafe-no-isolation",
        action="store_true",
        help="run students' code with your own rights, able to read and delete your files",
    )

    does = "write a class that never was, to try things on"
    verb = assignment_verb(verbs, "make-class", make_class, does, "--count 12")
    _seed(verb, "of the class")
    verb.add_argument("--count", type=whole(1), default=40, help="how many students (default: 40)")

    does = "how well the checks tell right from wrong"
    example = "01_paths --mistakes seen_in_class.py"
    verb = add_verb(verbs, "report-card", report_card, does, example)
    verb.add_argument("names", nargs="*", metavar="NAME", help="such as 01_paths; all by default")
    _seed(verb, "of the first draw")
    of = "a Python file with a dict {} = {{question: [functions]}}"
    verb.add_argument("--mistakes", type=Path, metavar="FILE", help=of.format("MISTAKES"))
    verb.add_argument("--variants", type=Path, metavar="FILE", help=of.format("VARIANTS"))
    course_option(verb)

    add_verb(verbs, "doctor", doctor, "what is missing on this machine, and how to get it", "")


def _seed(verb: argparse.ArgumentParser, of: str) -> None:
    says = f"{of} (default: {PUBLIC_SEED})"
    verb.add_argument("--seed", type=whole(0), default=PUBLIC_SEED, help=says)


def report_card(args: argparse.Namespace) -> int:
    """Try the checks on everything that is known, and write down what came of it."""
    from ..course.report_card import functions_from, make, write

    here = Course.here(args.course)
    card = make(
        here,
        args.names or here.names(),
        args.seed,
        functions_from(args.mistakes, "MISTAKES") if args.mistakes else None,
        functions_from(args.variants, "VARIANTS") if args.variants else None,
        progress=lambda row: print(
            f"{row.assignment} {row.question}: {row.rejected} of {row.mistakes} mistakes rejected, "
            f"{row.accepted} of {row.variants} right answers accepted",
            flush=True,
        ),
    )
    table, page = write(card, here.root / "build")
    print(page.read_text(encoding="utf-8"))
    print(f"written: {table} and {page}")
    return int(any(row.failures for row in card.rows))


def make_class(args: argparse.Namespace) -> int:
    """Write a synthetic class, and what it deserves."""
    from .synthetic import expected_file
    from .synthetic import make_class as make

    here = course_with(args)
    made = make(here, args.name, args.seed, args.count)
    print(f"{len(made)} submissions in {here.submitted}")
    print(f"what they deserve: {expected_file(here, args.name)}")
    return 0


def grade(args: argparse.Namespace) -> int:
    """Grade a class, and say what came of it."""
    from .batch import GradeOptions, common_failures, grade_class, workers
    from .gradebook import record
    from .lock import WHOLE
    from .results import Result, Results

    here = course_with(args)
    with Failures() as failures:
        who = in_part(here, args.name, args.student, failures)
        options = GradeOptions(
            jobs=args.jobs or workers(),
            isolated=not args.unsafe_no_isolation,
            dask=args.dask,
            shard=args.shard,
            again=args.again,
        )
        graded: list[Result] = []
        done = failures.sift(grade_class(here, args.name, who, options), "not graded")
        for number, one in enumerate(done, start=1):
            graded.append(one.result)
            if args.json:
                print(json.dumps(record_data(one.result)), flush=True)
            else:
                says = f" ({one.says})" if one.says else ""
                print(f"[{number}/{len(who)}] {one.result}{says}", flush=True)
        say = sys.stderr if args.json else sys.stdout
        if options.shard == WHOLE:
            recorded = record(here, args.name, graded)
            _tell(failures.sift(recorded, "not in the gradebook"), say)
            everybody = graded if args.student else list(Results(here, args.name))
            _tell((f"ATTENTION: {says}" for says in common_failures(everybody)), say)
        if graded and not args.json:
            print(f"isolation: {graded[-1].isolation}\nresults: {here.results / args.name}")
    return failures.code


def in_part(here: Course, name: str, student: str | None, failures: Failures) -> list[str]:
    """Who handed in, or the one asked for; folders with a name that is not fit are failures."""
    from .submission import misnamed, students

    found = students(here, name)
    who = [student] if student else found
    if student is None:
        failures.add("not graded", misnamed(here, name))
    if set(who) - set(found) or not (who or failures.code):
        raise LabkitError(
            f"nothing of {student or 'anybody'} lies in submitted/*/{name}; "
            "put notebooks there as submitted/STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb"
        )
    return who


def nobody(name: str, student: str | None) -> LabkitError:
    """What to say where nothing is graded yet."""
    who = f"{student} is not" if student else "nobody is"
    return LabkitError(f"{who} graded in {name}; type: labkit grade {name}")


def _shard(text: str) -> tuple[int, int]:
    first, _, last = text.partition("/")
    if not (first.isdigit() and last.isdigit() and 1 <= int(first) <= int(last)):
        raise argparse.ArgumentTypeError(f"{text} is no part; write 1/4, 2/4, 3/4 or 4/4")
    return int(first), int(last)


def _tell(sentences: Iterable[str], where: Any) -> None:
    for sentence in sentences:
        print(sentence, file=where, flush=True)


def doctor(args: argparse.Namespace) -> int:
    """Say what was found; 1 if grading would refuse."""
    from .doctor import examine

    bad = False
    for finding in examine():
        print(finding, flush=True)
        bad |= finding.needed and not finding.fine
    return 1 if bad else 0
