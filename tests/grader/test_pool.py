"""Workers: nothing runs on when nobody waits for it, nothing runs open that was to be isolated."""

from __future__ import annotations

import json
import subprocess
import threading

import pytest

from labkit.grader import pool
from labkit.grader.sandbox.limits import Limits

DONE = '{"result": "it"}\n'


def test_who_asks_for_isolation_gets_it_after_one_who_did_not(monkeypatch):
    """A Dask worker that has graded without a sandbox makes one for the next batch."""

    class Says:
        def __init__(self, *, isolated):
            self.isolated = isolated

        def ask(self, job):
            return str(self.isolated)

    monkeypatch.setattr(pool, "Worker", Says)
    monkeypatch.setattr(pool, "_here", {})
    said = [pool.on_dask("{}", isolated=isolated) for isolated in (False, True, False)]
    assert said == ["False", "True", "False"]


def test_nothing_is_graded_for_nobody(monkeypatch):
    """Who stops reading stops the rest of the class, though a worker may be at one submission."""
    asked, over = [], threading.Event()

    def ask(self, job):
        asked.append(job["student"])
        if job["student"] != "0":
            over.wait(60.0)  # it is at this one when the reader stops
        return DONE

    monkeypatch.setattr(pool.Worker, "ask", ask)
    monkeypatch.setattr(pool.Worker, "close", lambda self: over.set())
    results = pool.locally([{"student": str(k)} for k in range(20)], 1)
    assert next(results) == "it"
    results.close()
    for thread in threading.enumerate():
        if thread.name.startswith("ThreadPoolExecutor"):
            thread.join(60.0)
    assert asked in (["0"], ["0", "1"])


def test_a_worker_that_was_closed_is_not_started_again(monkeypatch):
    """A process that dies is made again, once, unless it was ended on purpose."""
    starts = []

    def _ask(self, job):
        starts.append(job)
        raise EOFError

    monkeypatch.setattr(pool.Worker, "_ask", _ask)
    worker = pool.Worker()
    assert "died 2 times" in worker.ask({})
    assert len(starts) == 2
    worker.close()
    worker.ask({})
    assert len(starts) == 3


def test_a_closed_worker_starts_no_process(monkeypatch):
    """Whatever a thread is at when the run is stopped, it makes no process after that."""
    monkeypatch.setattr(subprocess, "Popen", pytest.fail)
    worker = pool.Worker()
    worker.close()
    assert "died" in worker.ask({"limits": Limits().data()})


def test_a_worker_that_takes_too_long_is_ended(monkeypatch):
    """A submission whose judging does not end is told by name, not tried again, and over."""
    starts = []

    def started(self):
        starts.append(self)
        self.process = subprocess.Popen(
            ["sleep", "1000"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        return self.process

    monkeypatch.setattr(pool.Worker, "_started", started)
    worker = pool.Worker()
    limits = Limits(parse=0.02, wall=0.02)
    said = json.loads(worker.ask({"limits": limits.data()}))["failed"]
    assert "was ended after" in said and "look at it yourself" in said
    assert len(starts) == 1
    assert worker.process is None


def test_whatever_happens_to_one_is_said_of_him(monkeypatch):
    """A line that is no JSON, or an error that nobody thought of, costs the others nothing."""
    lines = {"ada": "nonsense\n", "bob": DONE}
    monkeypatch.setattr(pool.Worker, "ask", lambda self, job: lines[job["student"]])
    done = list(pool.locally([{"student": name} for name in ("ada", "bob", "eve")], 2))
    assert "it" in done
    assert sorted(str(x)[:13] for x in done if x != "it") == ["ada: JSONDeco", "eve: KeyError"]
