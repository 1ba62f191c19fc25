"""The speed of grading: compared with nbgrader's engine, and the cost of a class.

The seconds include a worker's start and imports and the student's own computation, so they are an
upper bound, and larger on a busy machine.
"""

import json
import os
import shutil
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

from labkit.course.authoring.layout import Course
from labkit.grader.batch import GradeOptions, grade_class
from labkit.grader.gradebook import nbgrader_api, quiet_database
from labkit.grader.plain import write_plain
from labkit.grader.release import release
from labkit.grader.submission import students

ROOT = Path(__file__).parents[2]
WARMUP, OPEN, LOOPS = "00_warmup", "01_paths", "05_impedance"
SERIAL = 10
"""Number of submissions that nbgrader's serial engine grades."""
ENDLESS = "\n\ndef {name}(*args, **kwargs):\n    while True:\n        pass\n"


@contextmanager
def fresh_course():
    """A course of these sources without a release, which is deleted after the block."""
    with tempfile.TemporaryDirectory(prefix="labkit-bench-") as folder:
        (Path(folder) / "solutions").symlink_to(ROOT / "solutions")
        shutil.copy(ROOT / "nbgrader_config.py", folder)
        yield Course(Path(folder))


def endless(notebook, most):
    """Change the first answers, at most `most` of them, so that they never end."""
    answers = (x for x in notebook["cells"] if x["metadata"].get("nbgrader", {}).get("solution"))
    code = [cell for cell in answers if cell["cell_type"] == "code"]
    for cell in code[:most]:
        name = cell["metadata"]["nbgrader"]["grade_id"]
        cell["source"] = "".join(cell["source"]) + ENDLESS.format(name=name)
    return notebook


def hand_in(course, assignment, count, never_end=0):
    """Let `count` students, and nobody else, hand in a solved notebook with endless answers."""
    release(course, assignment, seed=1)
    path = course.solution / assignment / f"{assignment}.ipynb"
    text = json.dumps(endless(json.loads(path.read_text()), never_end))
    shutil.rmtree(course.submitted, ignore_errors=True)
    for k in range(count):
        place = course.submitted / f"s{k:03d}" / assignment
        place.mkdir(parents=True)
        (place / path.name).write_text(text)


def graded(course, assignment, jobs):
    """Grade everybody; the seconds that passed, the share of the students' code, the score."""
    who = students(course, assignment)
    start = time.perf_counter()
    done = [one.result for one in grade_class(course, assignment, who, GradeOptions(jobs=jobs))]
    elapsed = time.perf_counter() - start
    (score,) = {result.score for result in done}
    whole, own = (sum(result.seconds[part] for result in done) for part in ("all", "student"))
    return elapsed, own / whole, score


def by_nbgrader(course, who):
    """The seconds that nbgrader's own engine takes, after its course was made, and the scores."""
    plain = Course(course.root / "plain")
    write_plain(course, [WARMUP], plain.root)
    for student in who:
        shutil.copytree(course.submitted / student, plain.root / "submitted" / student)
    api = nbgrader_api(plain)
    assert api.generate_assignment(WARMUP)["success"]
    start = time.perf_counter()
    with quiet_database():
        for student in who:
            assert api.autograde(WARMUP, student, force=True, create=True)["success"]
        elapsed = time.perf_counter() - start
        with api.gradebook as book:
            return elapsed, {book.find_submission(WARMUP, student).score for student in who}


def measure(warmup=100, opened=600, loops=100, never=4):
    """Grading: against nbgrader; a worker's seconds for a submission; the students' own share.

    ``open`` is a solved notebook 01, ``loops`` a solved 05 with its runs of the arm, ``answer`` a
    01 with one answer that never ends, ``endless`` a 01 in which no answer ends.

    Args:
        warmup: Number of students who hand in a solved 00.
        opened: Number of students who hand in a solved 01.
        loops: Number of students who hand in a solved 05.
        never: Number of students who hand in a 01 that does not end.
    """
    jobs, figures = len(os.sched_getaffinity(0)), {}
    with fresh_course() as course:
        hand_in(course, WARMUP, warmup)
        seconds, _, score = graded(course, WARMUP, jobs)
        serial, theirs = by_nbgrader(course, students(course, WARMUP)[:SERIAL])
        assert theirs == {score}, "the engines disagree"
        figures["grading_overhead_s"] = seconds * jobs / warmup
        figures["grading_vs_nbgrader"] = (serial / SERIAL) / (seconds / warmup)
        for key, assignment, count, most in (
            ("open", OPEN, opened, 0), ("loops", LOOPS, loops, 0),
            ("answer", OPEN, never, 1), ("endless", OPEN, never, 1000),
        ):  # fmt: skip
            hand_in(course, assignment, count, most)
            seconds, share, _ = graded(course, assignment, jobs)
            figures[f"cost_{key}_s"] = seconds * jobs / count
            if not most:
                figures[f"cost_{key}_per_minute"] = 60.0 * count / seconds
                figures[f"cost_{key}_own_share"] = share
    return figures
