"""The instructor's verbs for the rest of the term: feedback, marks, regrade, report, collect."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ..verbs import Verbs, whole
from .each import Failures, for_student
from .verbs import in_part, nobody
from .verbs_course import assignment_verb, course_with

if TYPE_CHECKING:
    from .regrade import Move


def add(verbs: Verbs) -> None:
    """``feedback``, ``export``, ``regrade``, ``class-report``, ``collect`` and ``rehearse``."""
    verb = assignment_verb(
        verbs, "feedback", feedback, "write a page for each student", "--student ada"
    )
    verb.add_argument("--student", metavar="S", help="only this one")
    verb.add_argument(
        "--moodle", type=Path, metavar="ZIP", help="also write the feedback files that Moodle takes"
    )
    verb = assignment_verb(verbs, "export", export, "marks as a table", "--to marks.csv")
    verb.add_argument(
        "--layout",
        choices=("nbgrader", "questions", "canvas", "moodle", "moodle-worksheet"),
        default="questions",
        help="moodle is for its gradebook, moodle-worksheet for the assignment's own page",
    )
    verb.add_argument(
        "--column", metavar="NAME", help="the assignment as the platform calls it: 'Paths (4711)'"
    )
    verb.add_argument("--to", type=Path, metavar="FILE", help="instead of the screen")
    does = "grade again after a test or its points have changed"
    verb = assignment_verb(verbs, "regrade", regrade, does, "--diff")
    verb.add_argument("--student", metavar="S", help="only this one")
    verb.add_argument("--diff", action="store_true", help="only say whose mark would move")
    verb.add_argument("--lower", action="store_true", help="let marks fall too")
    verb.add_argument("--jobs", type=whole(1), metavar="N", help="workers (default: one per core)")
    does = "what the class got right, and what it got wrong"
    verb = assignment_verb(verbs, "class-report", class_report, does, "--names")
    verb.add_argument("--names", action="store_true", help="with names, for your eyes only")
    verb.add_argument("--to", type=Path, metavar="FILE", help="instead of the screen")
    verb.add_argument(
        "--jplag", type=Path, metavar="DIR", help="also write answers for JPlag there"
    )
    does = "take downloads from Moodle, Canvas or nbgrader's exchange"
    verb = assignment_verb(verbs, "collect", collect, does, "moodle.zip")
    verb.add_argument("sources", nargs="+", type=Path, metavar="ZIP|DIR")
    verb.add_argument(
        "--unverified",
        action="store_true",
        help="from the exchange, take also what users handed in whom this machine does not know",
    )
    verb.description = (
        f"{verb.description} Nothing that was handed in is lost: all of it is under attempts/. "
        "Exit code: 0 if all is well, 1 if something was not taken or it is not certain whose it "
        "is (named at the end), 2 if nothing could be done."
    )
    does = "play a term through with a class that never was, in a folder"
    verb = assignment_verb(verbs, "rehearse", rehearse, does, "--to trial")
    verb.add_argument("--count", type=whole(1), default=12, help="how many students (default: 12)")
    verb.add_argument("--to", type=Path, required=True, metavar="DIR", help="made if need be")
    verb.add_argument("--jobs", type=whole(1), metavar="N", help="workers (default: one per core)")


def feedback(args: argparse.Namespace) -> int:
    """Write the pages."""
    from .feedback import write_feedback
    from .gradebook import comments
    from .handback import for_exchange, moodle_zip
    from .standing import standing

    here = course_with(args)
    with Failures() as failures:
        results = list(failures.sift(standing(here, args.name, args.student), "no page"))
        if not results and not failures.code:
            raise nobody(args.name, args.student)
        pages = write_feedback(here, args.name, results, comments(here, args.name))
        made = list(failures.sift(pages, "no page"))
        size = sum(path.stat().st_size for path in made) / 1e6
        print(f"pages in {here.root / 'feedback'}: {len(made)}, {size:.1f} MB")
        steps = [partial(for_exchange, here, args.name, page) for page in made]
        sent = [for_student(p.parents[1].name, s) for p, s in zip(made, steps, strict=True)]
        if any(failures.sift(sent, "not for the exchange")):
            print(f"back to the exchange: nbgrader release_feedback {args.name}")
        if args.moodle:
            count = moodle_zip(here, args.name, made, args.moodle)
            size = args.moodle.stat().st_size / 1e6
            print(f"for Moodle, {count} of {len(made)}, {size:.1f} MB: {args.moodle}")
    return failures.code


def export(args: argparse.Namespace) -> int:
    """Write the table."""
    from .export import LAYOUTS, as_csv, left_out, rows

    here = course_with(args)
    marks = list(rows(here, args.name))
    if not marks:
        raise nobody(args.name, None)
    for row in marks:
        if row.missing or row.remark:
            says = f"no mark: {row.student}: {row.missing}" if row.missing else ""
            print(says or f"{row.student}: {row.remark}", file=sys.stderr)
    lost = left_out(args.layout, marks)
    if lost:
        print(lost, file=sys.stderr)
    _out(as_csv(LAYOUTS[args.layout](args.column or args.name, marks)), args.to)
    return int(any(row.missing for row in marks))


def regrade(args: argparse.Namespace) -> int:
    """Say whose mark moves; without ``--diff``, let it."""
    from .batch import GradeOptions, workers
    from .gradebook import record
    from .lock import exclusive_run
    from .regrade import accept, moves
    from .results import Results

    here = course_with(args)
    with Failures() as failures, exclusive_run(Results(here, args.name).folder):
        who = in_part(here, args.name, args.student, failures)
        found = moves(here, args.name, who, GradeOptions(jobs=args.jobs or workers()))
        moved = list(failures.sift(found, "not graded"))
        _tell_moves(moved)
        if not args.diff:
            counts = accept(here, args.name, moved, lower=args.lower)
            accepted = list(failures.sift(counts, "not kept"))
            left = len(moved) - len(counts)
            if left:
                print(f"{left} marks would fall and stay as they are; --lower lets them")
            recorded = record(here, args.name, accepted)
            for sentence in failures.sift(recorded, "not in the gradebook"):
                print(sentence)
    return failures.code


def _tell_moves(moved: Sequence[Move]) -> None:
    for move in sorted(moved, key=lambda m: m.by):
        if move.by or move.before is None:
            print(move)
    changed = sum(bool(m.by) for m in moved)
    print(f"{changed} of {len(moved)} marks move, {sum(m.by < 0 for m in moved)} of them down")
    before = {m.before.points for m in moved if m.before} - {m.after.points for m in moved}
    if before:
        full = ", ".join(f"{points:g}" for points in sorted(before))
        print(f"full marks were {full} and are {moved[0].after.points:g} now")


def class_report(args: argparse.Namespace) -> int:
    """Write the report."""
    from .class_report import for_jplag, report
    from .pseudonyms import pseudonyms
    from .standing import standing

    here = course_with(args)
    with Failures() as failures:
        results = list(failures.sift(standing(here, args.name), "left out"))
        if not results:
            raise nobody(args.name, None)
        problems = {p.name: p for p in here.problems(args.name)}
        pseudonym = pseudonyms(here)
        called = str if args.names else pseudonym
        left_out = len(failures.sentences)
        _out(report(args.name, results, problems, called, left_out), args.to)
        if args.jplag:
            written = for_jplag(results, args.jplag, pseudonym)
            print(f"{written} answers in {args.jplag}", file=sys.stderr)
    return failures.code


def collect(args: argparse.Namespace) -> int:
    """Take what lies there, and say what was done with it."""
    from .collect import collect as take

    here = course_with(args)
    doubtful = []
    try:
        for source in args.sources:
            for taken in take(here, args.name, source, unverified=args.unverified):
                if taken.fine:
                    print(taken, flush=True)
                else:
                    doubtful.append(taken)
    finally:
        for taken in doubtful:
            print(taken, file=sys.stderr)
    return 1 if doubtful else 0


def rehearse(args: argparse.Namespace) -> int:
    """Download, collect, grade, hand back, report, export; go on where it was stopped."""
    from .batch import GradeOptions, workers
    from .rehearsal import rehearse as play

    here = course_with(args)
    options = GradeOptions(jobs=args.jobs or workers())
    with Failures() as failures:
        for sentence in failures.sift(
            play(here, args.name, args.to, args.count, options), "failed"
        ):
            print(sentence, flush=True)
    return failures.code


def _out(text: str, where: Path | None) -> None:
    if where is None:
        sys.stdout.write(text)
    else:
        where.write_text(text, encoding="utf-8")
        print(f"written: {where}")
