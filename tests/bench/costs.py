"""The cost of grading a class with open questions, closed loops or answers that never end."""

import json
import os
import time
from contextlib import contextmanager

from labkit.grader.batch import GradeOptions, grade_class
from labkit.grader.release import release
from labkit.grader.submission import students

from .courses import fresh_course

OPEN, LOOPS = "01_paths", "05_impedance"
ENDLESS = "\n\ndef {name}(*args, **kwargs):\n    while True:\n        pass\n"


def endless(notebook, most):
    """Change the first answers, at most `most` of them, so that they never end."""
    answers = (x for x in notebook["cells"] if x["metadata"].get("nbgrader", {}).get("solution"))
    code = [cell for cell in answers if cell["cell_type"] == "code"]
    for cell in code[:most]:
        name = cell["metadata"]["nbgrader"]["grade_id"]
        cell["source"] = "".join(cell["source"]) + ENDLESS.format(name=name)
    return notebook


@contextmanager
def handed_in(assignment, count, never_end=0):
    """A course in which `count` students hand in a solved notebook with some endless answers."""
    with fresh_course() as course:
        release(course, assignment, seed=1)
        path = course.solution / assignment / f"{assignment}.ipynb"
        text = json.dumps(endless(json.loads(path.read_text()), never_end))
        for k in range(count):
            place = course.submitted / f"s{k:03d}" / assignment
            place.mkdir(parents=True)
            (place / path.name).write_text(text)
        yield course


def graded(course, assignment, options):
    """Grade everybody; return the seconds that passed, and the share of the students' own code."""
    who = students(course, assignment)
    start = time.perf_counter()
    done = [one.result for one in grade_class(course, assignment, who, options)]
    elapsed = time.perf_counter() - start
    if len(done) != len(who) or len({result.score for result in done}) != 1:
        raise RuntimeError(f"{len(done)} of {len(who)} were graded, or with different results")
    whole, own = (sum(result.seconds[part] for result in done) for part in ("all", "student"))
    return elapsed, own / whole


def measure(opened=600, loops=100, never=4):
    """Costs: a worker's seconds for a submission, submissions per minute, the students' share.

    ``open`` is a solved notebook 01, ``loops`` a solved 05 with its runs of the arm, ``answer`` a
    01 with one answer that never ends, ``endless`` a 01 in which no answer ends.  ``dask`` is the
    same with two workers of Dask.  The start of the workers is included.

    Args:
        opened: Number of students who hand in a solved 01.
        loops: Number of students who hand in a solved 05.
        never: Number of students who hand in a 01 that does not end.
    """
    from distributed import LocalCluster

    jobs, figures = len(os.sched_getaffinity(0)), {}
    cores = GradeOptions(jobs=jobs)
    for key, assignment, count in (("open", OPEN, opened), ("loops", LOOPS, loops)):
        with handed_in(assignment, count) as course:
            seconds, share = graded(course, assignment, cores)
            figures[f"cost_{key}_s"] = seconds * jobs / count
            figures[f"cost_{key}_per_minute"] = 60.0 * count / seconds
            figures[f"cost_{key}_own_share"] = share
            with LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
                options = GradeOptions(dask=cluster.scheduler_address, again=True)
                seconds, _ = graded(course, assignment, options)
            figures[f"cost_{key}_dask_per_minute"] = 60.0 * count / seconds
    for key, most in (("answer", 1), ("endless", 1000)):
        with handed_in(OPEN, never, most) as course:
            seconds, _ = graded(course, OPEN, cores)
            figures[f"cost_{key}_s"] = seconds * jobs / never
    return figures
