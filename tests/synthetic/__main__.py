"""Write a synthetic class into a course, for a trial."""

import argparse
import sys
from pathlib import Path

from labkit.course.authoring.layout import PUBLIC_SEED, Course

from . import expected_file, make_class


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.synthetic", description=__doc__)
    parser.add_argument("assignment", help="such as 01_paths")
    parser.add_argument("--seed", type=int, default=PUBLIC_SEED, help="of the class")
    parser.add_argument("--count", type=int, default=40, help="how many students")
    parser.add_argument("--course", type=Path, metavar="DIR", help="default: the one around you")
    args = parser.parse_args()
    course = Course.here(args.course)
    course.notebook_source(args.assignment)
    if course.term.exists():
        print(f"{course.root} has begun a term; name a copy with --course", file=sys.stderr)
        return 2
    made = make_class(course, args.assignment, args.seed, args.count)
    print(f"{len(made)} submissions in {course.submitted}")
    print(f"what they deserve: {expected_file(course, args.assignment)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
