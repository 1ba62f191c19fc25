"""Workers: nothing runs on when nobody waits for it, nothing runs open that was to be isolated."""

from __future__ import annotations

import time

from labkit.grade import pool

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
    asked = []

    def ask(self, job):
        asked.append(job)
        time.sleep(0.02)
        return DONE

    monkeypatch.setattr(pool.Worker, "ask", ask)
    results = pool.locally([{"student": str(k)} for k in range(20)], 1)
    assert next(results) == "it"
    results.close()
    time.sleep(0.2)
    assert len(asked) <= 3


def test_a_worker_that_was_closed_is_not_started_again(monkeypatch):
    """A process that dies is made again, unless it was ended on purpose."""
    starts = []

    def _ask(self, job):
        starts.append(job)
        raise EOFError

    monkeypatch.setattr(pool.Worker, "_ask", _ask)
    worker = pool.Worker()
    assert "died 3 times" in worker.ask({})
    worker.close()
    worker.ask({})
    assert len(starts) == pool.TRIES + 1


def test_whatever_happens_to_one_is_said_of_him(monkeypatch):
    """A line that is no JSON, or an error that nobody thought of, costs the others nothing."""
    lines = {"ada": "nonsense\n", "bob": DONE}
    monkeypatch.setattr(pool.Worker, "ask", lambda self, job: lines[job["student"]])
    done = list(pool.locally([{"student": name} for name in ("ada", "bob", "eve")], 2))
    assert "it" in done
    assert sorted(str(x)[:13] for x in done if x != "it") == ["ada: JSONDeco", "eve: KeyError"]
