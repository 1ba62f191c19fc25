"""Grader, worker and sandbox killed at random moments: nothing is lost, nothing is left running."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from io import StringIO

import numpy as np
import pytest
from soak.attacks.family import Family, descendants, parent
from soak.attacks.place import NAME, ROOT

from labkit.grader.sandbox.limits import slowness
from tests.synthetic import differences, make_class

STUDENTS = 8
GUARD = 300.0
"""Against waiting for ever, in [s] on a quick machine; nothing is measured by it."""
WHOM = ("grader", "worker", "sandbox")
SIGNALS = (signal.SIGKILL, signal.SIGTERM)
_random = np.random.default_rng(16)
MOMENTS = [(WHOM[k % 3], SIGNALS[k % 2], float(_random.uniform(0.0, 1.0))) for k in range(6)]
"""Whom, by which signal, and when, as a share of an undisturbed run."""


@pytest.fixture(scope="module")
def handed_in(released, tmp_path_factory):
    """A course with a class of which nobody harms anybody."""
    course = _copy(released, tmp_path_factory.mktemp("kills") / "course")
    make_class(course, NAME, seed=3, count=STUDENTS)
    return course


@pytest.fixture(scope="module")
def undisturbed(handed_in, tmp_path_factory):
    """How long grading takes when nobody is killed, in [s]."""
    course = _copy(handed_in, tmp_path_factory.mktemp("undisturbed") / "course")
    began = time.monotonic()
    code, said = _wait(_start(course), course)
    assert code == 0, said
    return time.monotonic() - began


def _copy(course, root):
    subprocess.run(["cp", "-a", str(course.root), str(root)], check=True)
    return type(course)(root)


def _start(course, *words):
    with (course.root / "said.txt").open("wb") as out:
        return subprocess.Popen(
            [sys.executable, "-m", "labkit", *(words or ("grade", NAME, "--jobs", "2"))]
            + ["--course", str(course.root)],
            env=dict(os.environ, PYTHONPATH=str(ROOT)),
            cwd=course.root,
            stdout=out,
            stderr=subprocess.STDOUT,
        )


def _wait(run, course):
    """How a run ended, and what it said."""
    run.wait(GUARD * slowness())
    return run.returncode, (course.root / "said.txt").read_text()


def _process(whom, grader):
    """The process that plays a part in a run, if there is one now."""
    sandboxes = [
        pid
        for (pid, _), words in descendants(grader.pid).items()
        if words.split(" ")[0].endswith("bwrap") and not _is_bwrap(parent(pid))
    ]
    if whom == "grader":
        return grader.pid
    if whom == "sandbox":
        return max(sandboxes, default=None)
    return next((parent(pid) for pid in sandboxes if parent(pid) != grader.pid), None)


def _is_bwrap(pid):
    with suppress(OSError), open(f"/proc/{pid}/cmdline", "rb") as file:
        return file.read().split(b"\0")[0].endswith(b"bwrap")
    return False


def _killed(course, whom, how, when):
    """Kill one of a run's processes; return whether there was one, how it ended, what was said."""
    run = _start(course)
    time.sleep(when)
    while run.poll() is None:
        pid = _process(whom, run)
        if pid:
            with suppress(ProcessLookupError):
                os.kill(pid, how)
                return True, *_wait(run, course)
        time.sleep(0.01)
    return False, *_wait(run, course)


@pytest.mark.parametrize(("whom", "how", "share"), MOMENTS)
def test_killed_at_a_random_moment(handed_in, undisturbed, tmp_path, whom, how, share):
    """What is there is whole and right, nothing runs on, and the next run does the rest."""
    with Family() as family:
        for attempt in range(5):  # who comes too late tries again, earlier
            course = _copy(handed_in, tmp_path / f"course-{attempt}")
            hit, code, said = _killed(course, whom, how, share * undisturbed / 2**attempt)
            if hit:
                break
        assert hit
        assert not family.left()
        assert "Traceback" not in said
        if whom != "grader":
            assert code in (0, 1, 2), said
        for path in (course.root / "results" / NAME).glob("*.json"):
            assert json.loads(path.read_text())["score"] >= 0.0
        assert all(text.endswith("has no result") for text in differences(course, NAME))
        assert _wait(_start(course), course)[0] == 0
        assert not list(differences(course, NAME))
        code, table = _wait(_start(course, "export", NAME), course)
        assert code == 0
        assert not family.left()
    deserved = json.loads((course.root / "build" / "class" / f"{NAME}.json").read_text())
    rows = {row["student"]: row["score"] for row in csv.DictReader(StringIO(table))}
    assert {who: float(rows[who]) for who in deserved} == {
        w: d["score"] for w, d in deserved.items()
    }
