"""The instructor's verbs for the rest of the term: feedback, marks, regrade, report, collect."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..errors import LabkitError
from ..verbs import Verbs, whole
from .verbs import in_part, nobody
from .verbs_course import assignment_verb, course_with


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
    from .results import Results

    here = course_with(args)
    results = [r for r in Results(here, args.name) if args.student in {None, r.student}]
    if not results:
        raise nobody(args.name, args.student)
    made = write_feedback(here, args.name, results, comments(here, args.name))
    size = sum(path.stat().st_size for path in made) / 1e6
    print(f"pages in {here.root / 'feedback'}: {len(made)}, {size:.1f} MB")
    came_through = [for_exchange(here, args.name, page) for page in made]
    if any(came_through):
        print(f"back to the exchange: nbgrader release_feedback {args.name}")
    if args.moodle:
        count = moodle_zip(here, args.name, made, args.moodle)
        size = args.moodle.stat().st_size / 1e6
        print(f"for Moodle, {count} of {len(made)}, {size:.1f} MB: {args.moodle}")
    return 0


def export(args: argparse.Namespace) -> int:
    """Write the table."""
    from .export import LAYOUTS, as_csv, left_out, rows

    here = course_with(args)
    marks = list(rows(here, args.name))
    if not marks:
        raise nobody(args.name, None)
    lost = left_out(args.layout, marks)
    if lost:
        print(lost, file=sys.stderr)
    _out(as_csv(LAYOUTS[args.layout](args.column or args.name, marks)), args.to)
    return 0


def regrade(args: argparse.Namespace) -> int:
    """Say whose mark moves; without ``--diff``, let it."""
    from .batch import How, workers
    from .gradebook import record
    from .regrade import Move, accept, moves

    here = course_with(args)
    who = in_part(here, args.name, args.student)
    found = list(moves(here, args.name, who, How(jobs=args.jobs or workers())))
    moved = [m for m in found if isinstance(m, Move)]
    failed = [error for error in found if isinstance(error, LabkitError)]
    for move in sorted(moved, key=lambda m: m.by):
        if move.by or move.before is None:
            print(move)
    changed = sum(bool(m.by) for m in moved)
    print(f"{changed} of {len(moved)} marks move, {sum(m.by < 0 for m in moved)} of them down")
    before = {m.before.points for m in moved if m.before} - {m.after.points for m in moved}
    if before:
        full = ", ".join(f"{points:g}" for points in sorted(before))
        print(f"full marks were {full} and are {moved[0].after.points:g} now")
    for error in failed:
        print(f"not graded: {error}", file=sys.stderr)
    if not args.diff:
        accepted = accept(here, args.name, moved, lower=args.lower)
        if len(accepted) < len(moved):
            left = len(moved) - len(accepted)
            print(f"{left} marks would fall and stay as they are; --lower lets them")
        for sentence in record(here, args.name, accepted):
            print(sentence)
    return 1 if failed else 0


def class_report(args: argparse.Namespace) -> int:
    """Write the report."""
    from .class_report import for_jplag, report
    from .pseudonyms import pseudonyms
    from .results import Results

    here = course_with(args)
    results = list(Results(here, args.name))
    if not results:
        raise nobody(args.name, None)
    problems = {p.name: p for p in here.problems(args.name)}
    pseudonym = pseudonyms(here)
    _out(report(args.name, results, problems, str if args.names else pseudonym), args.to)
    if args.jplag:
        print(
            f"{for_jplag(results, args.jplag, pseudonym)} answers in {args.jplag}", file=sys.stderr
        )
    return 0


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
    from .batch import How, workers
    from .rehearsal import rehearse as play

    here = course_with(args)
    for sentence in play(here, args.name, args.to, args.count, How(jobs=args.jobs or workers())):
        print(sentence, flush=True)
    return 0


def _out(text: str, where: Path | None) -> None:
    if where is None:
        sys.stdout.write(text)
    else:
        where.write_text(text, encoding="utf-8")
        print(f"written: {where}")
