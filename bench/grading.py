"""How quick grading is: its overhead per submission, and against nbgrader's own engine.

python bench/grading.py [--assignment 00_warmup] [--count 100] [--nbgrader 10]
"""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from labkit.grade.batch import How, grade_class, workers
from labkit.grade.course import Course
from labkit.grade.engines import grade_with_nbgrader, students
from labkit.grade.release import release

ROOT = Path(__file__).parents[1]


@contextmanager
def honest_class(assignment: str, count: int) -> Iterator[Course]:
    """A course of its own with so many solved submissions."""
    with tempfile.TemporaryDirectory(prefix="labkit-bench-") as folder:
        root = Path(folder)
        (root / "solutions").symlink_to(ROOT / "solutions")
        shutil.copy(ROOT / "nbgrader_config.py", root)
        course = Course(root)
        release(course, assignment, seed=1)
        solved = course.solution / assignment / f"{assignment}.ipynb"
        for k in range(count):
            place = course.submitted / f"s{k:03d}" / assignment
            place.mkdir(parents=True)
            shutil.copy(solved, place)
        yield course


def grading(
    assignment: str | None = None, count: int = 100, with_nbgrader: int = 10
) -> dict[str, float]:
    """Grade a class with both engines, in one run on all cores.

    Args:
        assignment: Which; by default 00_warmup, or the first there is.
        count: How many submissions the isolated engine grades.
        with_nbgrader: How many of them nbgrader's engine grades, which is serial.

    Returns:
        ``grading_overhead_s``: seconds of a worker for one submission, start and imports included
        and nothing taken off for the student's own computation; ``grading_vs_nbgrader``: ratio of
        the two throughputs.
    """
    names = Course(ROOT).names()
    assignment = assignment or names[0]
    jobs = workers()
    with honest_class(assignment, count) as course:
        who = students(course, assignment)
        start = time.perf_counter()
        done = list(grade_class(course, assignment, who, How(jobs=jobs)))
        isolated = (time.perf_counter() - start) / count
        scores = {getattr(getattr(one, "result", None), "score", None) for one in done}
        start = time.perf_counter()
        theirs = {grade_with_nbgrader(course, assignment, s).score for s in who[:with_nbgrader]}
        serial = (time.perf_counter() - start) / with_nbgrader
    if scores != theirs or len(scores) != 1:
        raise SystemExit(f"the engines disagree: {scores} and {theirs}")
    return {
        "grading_overhead_s": round(isolated * jobs, 4),
        "grading_vs_nbgrader": round(serial / isolated, 2),
    }


if __name__ == "__main__":
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--assignment")
    words.add_argument("--count", type=int, default=100)
    words.add_argument("--nbgrader", type=int, default=10)
    given = words.parse_args()
    print(json.dumps(grading(given.assignment, given.count, given.nbgrader)))
