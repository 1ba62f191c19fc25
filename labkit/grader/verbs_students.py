"""The verb ``students`` on the command line: who is in the class."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..course.layout import Course
from ..errors import LabkitError
from ..verbs import Verbs, add_verb
from .verbs_course import course_option


def add(verbs: Verbs) -> None:
    """``students import``."""
    does = "take a list of students into the roster: Moodle's, Canvas's or any table"
    verb = add_verb(verbs, "students", students, does, "import participants.csv")
    verb.add_argument("action", choices=("import",), metavar="import")
    verb.add_argument("file", type=Path, metavar="FILE.csv")
    verb.add_argument(
        "--assignment",
        metavar="NAME",
        help="the file is Moodle's grading worksheet of it, which says whose each number is",
    )
    course_option(verb)
    verb.description = (
        f"{verb.description} Exit code: 0 if the list was taken, 1 if work of somebody is in two "
        "folders (named at the end), 2 if the list was not taken."
    )


def students(args: argparse.Namespace) -> int:
    """Take a list, and say who is new and who could be mistaken for whom."""
    from .enrol import enrol, keep_numbers, settle
    from .lms import alone, known_all_term
    from .roster import FILE, read_roster, save_roster, tell_gradebook
    from .student_list import read_list

    here = Course.here(args.course)
    if args.assignment:
        here.notebook_source(args.assignment)
    entries = read_list(args.file)
    numbered = [entry for entry in entries if entry.participant]
    if args.assignment and not numbered:
        raise LabkitError(
            f"{args.file} has no column 'Identifier'; give the grading worksheet of "
            f"{args.assignment}, in English: Submissions, Actions, Download grading worksheet"
        )
    with alone(here):
        before = read_roster(here)
        done = enrol(before, entries, known_all_term(here))
        save_roster(here, done.roster)
        tell_gradebook(here, done.roster)
        left = settle(here, done.roster)
        left += keep_numbers(here, args.assignment, done.rows) if args.assignment else []
    listed = {student.id for _, student in done.rows}
    absent = [student for student in before.students if student.id not in listed]
    print(f"{FILE}: {len(done.roster.students)} students, {len(done.new)} of them new")
    if absent:
        names = ", ".join(map(str, absent))
        print(f"not in this list, and still in the roster: {names}")
    if args.assignment:
        print(f"participants of {args.assignment}: {len(numbered)}")
    elif numbered:
        print("the participants' numbers are those of one assignment; --assignment NAME keeps them")
    for sentence in left:
        print(sentence, file=sys.stderr)
    for group in [] if args.assignment else done.roster.namesakes():
        print(
            f"called alike: {', '.join(map(str, group))}; a download of Moodle's does not tell who "
            "is who until you import the assignment's grading worksheet, with --assignment",
            file=sys.stderr,
        )
    return 1 if left else 0
