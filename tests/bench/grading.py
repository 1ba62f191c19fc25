"""The speed of grading: its overhead per submission, and compared with nbgrader's engine."""

import os
import shutil
import time

from labkit.course.authoring.layout import Course
from labkit.grader.batch import GradeOptions, grade_class
from labkit.grader.gradebook import nbgrader_api, quiet_database
from labkit.grader.plain import write_plain
from labkit.grader.release import release
from labkit.grader.submission import students

from .courses import fresh_course

ASSIGNMENT = "00_warmup"
COUNT = 100
"""Number of solved submissions that the isolated engine grades."""
SERIAL = 10
"""Number of these submissions that nbgrader's serial engine grades."""


def submit_solved(course):
    """Hand in the solved notebook for each student."""
    release(course, ASSIGNMENT, seed=1)
    solved = course.solution / ASSIGNMENT / f"{ASSIGNMENT}.ipynb"
    for k in range(COUNT):
        place = course.submitted / f"s{k:03d}" / ASSIGNMENT
        place.mkdir(parents=True)
        shutil.copy(solved, place)


def scores_by_nbgrader(course, who):
    """The scores by nbgrader's own engine, in a course that was prepared before the clock ran."""
    api = nbgrader_api(course)
    with quiet_database():
        for student in who:
            result = api.autograde(ASSIGNMENT, student, force=True, create=True)
            assert result["success"], result["log"]
        with api.gradebook as book:
            return {book.find_submission(ASSIGNMENT, student).score for student in who}


def prepared(course, who):
    """A course for nbgrader alone, with some of the submissions."""
    plain = Course(course.root / "plain")
    write_plain(course, [ASSIGNMENT], plain.root)
    for student in who:
        shutil.copytree(course.submitted / student, plain.root / "submitted" / student)
    assert nbgrader_api(plain).generate_assignment(ASSIGNMENT)["success"]
    return plain


def measure():
    """Grading: seconds of a worker for one submission, and throughput relative to nbgrader.

    The seconds include a worker's start and imports and the student's own computation, so they are
    an upper bound, and larger on a busy machine.  Both engines grade in one run, the isolated one
    on all cores.
    """
    jobs = len(os.sched_getaffinity(0))
    with fresh_course() as course:
        submit_solved(course)
        who = students(course, ASSIGNMENT)
        start = time.perf_counter()
        done = list(grade_class(course, ASSIGNMENT, who, GradeOptions(jobs=jobs)))
        isolated = (time.perf_counter() - start) / COUNT
        scores = {getattr(getattr(one, "result", None), "score", None) for one in done}
        plain = prepared(course, who[:SERIAL])
        start = time.perf_counter()
        theirs = scores_by_nbgrader(plain, who[:SERIAL])
        serial = (time.perf_counter() - start) / SERIAL
    if scores != theirs or len(scores) != 1:
        raise RuntimeError(f"the engines disagree: {scores} and {theirs}")
    return {"grading_overhead_s": isolated * jobs, "grading_vs_nbgrader": serial / isolated}
