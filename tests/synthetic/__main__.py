"""Write a synthetic class into a course, or run a whole term with it in a separate folder."""

import argparse
import os
import sys
from functools import partial
from pathlib import Path

from labkit.course.authoring.layout import PUBLIC_SEED, Course
from labkit.grader.batch import GradeOptions
from labkit.grader.each import Failures

from . import expected_file, make_class
from .rehearsal import rehearse


def main() -> int:
    """Run the command line; the exit code is 1 if a step failed for somebody."""
    parser = argparse.ArgumentParser(prog="python -m tests.synthetic", description=__doc__)
    parser.add_argument("assignment", help="such as 01_paths")
    parser.add_argument("--seed", type=int, default=PUBLIC_SEED, help="of the class")
    parser.add_argument("--count", type=int, default=40, help="how many students")
    parser.add_argument("--course", type=Path, metavar="DIR", help="default: the one around you")
    parser.add_argument("--rehearse", type=Path, metavar="DIR", help="play the term through there")
    args = parser.parse_args()
    course = Course.here(args.course)
    course.notebook_source(args.assignment)
    if args.rehearse is None:
        record = course.root / "course_private" / "term.json"
        if record.exists():
            print(f"{course.root} has begun a term; give --rehearse DIR", file=sys.stderr)
            return 2
        made = make_class(course, args.assignment, args.seed, args.count)
        print(f"{len(made)} submissions in {course.submitted}")
        print(f"what they deserve: {expected_file(course, args.assignment)}")
        return 0
    with Failures() as failures:
        how = GradeOptions(jobs=len(os.sched_getaffinity(0)), tell=partial(print, flush=True))
        steps = rehearse(course, args.assignment, args.rehearse, args.count, how)
        for sentence in failures.sift(steps, "failed"):
            print(sentence, flush=True)
    return failures.code


if __name__ == "__main__":
    sys.exit(main())
