"""A week of `labkit grade --watch`: the waiting times, and the number of lost hand-ins."""

import json
import math
import os
import random
import signal
import statistics
import subprocess
import sys
import time
from datetime import timedelta

from labkit.grader.grading.results import Results
from labkit.grader.submission import digest
from labkit.grader.terms.release import release

from .courses import ROOT, fresh_course

ASSIGNMENT = "01_paths"
PEOPLE = 150
WEEK = timedelta(days=7).total_seconds()
HURRY = timedelta(hours=2).total_seconds()
"""Time before the deadline at which a typical late hand-in comes."""
PACE = 60.0
"""Factor by which the hours with hand-ins pass faster than the clock."""
LONGEST = 1.0
"""The longest gap between two hand-ins [s]; a longer wait of the grader would show nothing new."""
PATIENCE = 600.0


def hand_ins(seed=1):
    """The times in [s] and the students of hand-ins: each hands in early, and again at the end."""
    draw = random.Random(seed)
    early = [(draw.uniform(0.0, WEEK - HURRY), k) for k in range(PEOPLE)]
    late = [(max(0.0, WEEK - draw.expovariate(1.0 / HURRY)), k) for k in range(PEOPLE)]
    return [(moment, f"s{k:03d}") for moment, k in sorted(early + late)]


class Watching:
    """A separate process of `labkit grade --watch`, as an instructor starts it."""

    def __init__(self, course):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "labkit", "grade", ASSIGNMENT, "--watch"],
            cwd=course.root,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stdout=subprocess.DEVNULL,
        )

    def end(self, how):
        """End the process with a signal."""
        self.process.send_signal(how)
        self.process.wait()


def waits(course, handed_in):
    """Seconds from each person's last hand-in to its result; infinite if there is no result yet."""
    results = Results(course, ASSIGNMENT)
    for student, (moment, data) in handed_in.items():
        result = results.get(student)
        done = result is not None and result.hashes["submission"] == digest(data)
        yield results.path(student).stat().st_mtime - moment if done else math.inf


def measure():
    """A week with `grade --watch`: seconds that people wait, and hand-ins that are lost.

    150 people hand in notebook 01 twice, most of them in the last hours, which pass sixty times
    faster than the clock.  In the middle of the rush the grader is killed and started again.
    """
    with fresh_course() as course:
        release(course, ASSIGNMENT, seed=1)
        solved = course.solution / ASSIGNMENT / f"{ASSIGNMENT}.ipynb"
        notebook = json.loads(solved.read_text())
        handed_in = {}

        def hand_in(student, number):
            """Put a notebook where the grader looks for it, in one atomic step."""
            notebook["metadata"]["hand-in"] = number  # so that all files differ
            data = json.dumps(notebook).encode()
            place = course.submitted / student / ASSIGNMENT
            place.mkdir(parents=True, exist_ok=True)
            (place.parent / "coming").write_bytes(data)
            (place.parent / "coming").replace(place / solved.name)
            handed_in[student] = time.time(), data

        def all_waited(until):
            """The waiting times, as soon as nobody waits any more."""
            while math.inf in (waited := list(waits(course, handed_in))):
                if time.monotonic() > until:
                    break
                time.sleep(0.5)
            return waited

        watching, before = Watching(course), 0.0
        plan = hand_ins()
        for number, (moment, student) in enumerate(plan):
            time.sleep(min((moment - before) / PACE, LONGEST))
            before = moment
            hand_in(student, number)
            if number == 3 * len(plan) // 4:
                watching.end(signal.SIGKILL)
                watching = Watching(course)
        waited = all_waited(time.monotonic() + PATIENCE)
        hand_in("alone", len(plan))
        alone = all_waited(time.monotonic() + PATIENCE)[-1]
        watching.end(signal.SIGTERM)
        own = Results(course, ASSIGNMENT).get("alone").seconds["student"]
        marks = {result.score for result in Results(course, ASSIGNMENT)}
    if len(marks) != 1:
        raise RuntimeError(f"one notebook has the marks {sorted(marks)}")
    return {
        "week_median_wait_s": statistics.median(waited),
        "week_longest_wait_s": max(waited),
        "week_lost": waited.count(math.inf),
        "watch_overhead_s": alone - own,
    }
