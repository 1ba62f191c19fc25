"""Executors: a death costs its own task, a limit its own submission, and nothing more."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from concurrent.futures import CancelledError
from pathlib import Path

import pytest
from handmade import FULL, QUICK, add, hand_in
from processes import below, child, running, wait_until_gone

from labkit.course.authoring.bundle import Bundle
from labkit.errors import LabkitError
from labkit.grader import worker
from labkit.grader.executor import executor
from labkit.grader.sandbox import limits
from labkit.grader.sandbox.launch import Isolation
from labkit.grader.sandbox.limits import Limits
from labkit.grader.submission import Submission
from labkit.grader.worker import Task, close_sandbox, grade_submission

NAME = "01_curves"


def die():
    """End this worker."""
    os.kill(os.getpid(), signal.SIGKILL)


def exceed_memory():
    """Take more than a process that judges may have."""
    limits.limit_memory()
    keep = bytearray(limits.MEMORY // 2)
    try:
        return len(keep) + len(bytearray(limits.MEMORY))
    except MemoryError:
        return "limited"


@pytest.fixture(scope="module")
def cluster():
    """The address of a Dask cluster with two workers."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        yield cluster.scheduler_address


@pytest.fixture(params=["local", pytest.param("dask", marks=pytest.mark.slow)])
def pool(request):
    """An executor of either kind, with two workers."""
    dask = request.getfixturevalue("cluster") if request.param == "dask" else None
    with executor(2, dask) as pool:
        yield pool


@pytest.fixture
def task(course, solved):
    """An honest submission."""
    return task_of(course, "ada", solved)


def task_of(course, student, notebook, limits=QUICK):
    hand_in(course, NAME, student, notebook)
    submission = Submission.of(course, NAME, student)
    return Task(
        course, submission, Bundle.of(course, NAME).data["hash"], Isolation.BUBBLEWRAP, limits
    )


def test_a_task_that_kills_its_worker_costs_no_other(pool):
    """It fails, and what is submitted before and after it is done."""
    deadly, *others = (pool.submit(*what) for what in ((die,), (abs, -1), (abs, -2)))
    with pytest.raises(Exception, match=r"worker"):
        deadly.result(120.0)
    assert [one.result(120.0) for one in others] == [1, 2]
    assert pool.submit(abs, -3).result(120.0) == 3


def test_a_submission_that_takes_too_long_is_named(course, solved):
    """The kernel ends a worker at its deadline; the submission has no result, the others theirs."""
    hurried = Limits(parse=0.01, wall=0.01)
    with executor(2) as pool:
        late = pool.submit(grade_submission, task_of(course, "eve", solved, hurried))
        honest = pool.submit(grade_submission, task_of(course, "ada", solved))
        assert honest.result(300.0).score == FULL
        with pytest.raises(LabkitError, match="took too long"):
            late.result(300.0)


def test_nothing_is_graded_for_nobody(tmp_path):
    """Leaving early ends what runs, and nothing that waits is begun."""
    with pytest.raises(KeyboardInterrupt), executor(1) as pool:
        running = below(pool.submit(os.getpid).result(120.0), at_least=1)
        futures = [pool.submit(time.sleep, 1000), pool.submit((tmp_path / "later").touch)]
        raise KeyboardInterrupt
    wait_until_gone(running)
    with pytest.raises((LabkitError, CancelledError)):
        futures[0].result(60.0)
    assert futures[1].cancelled()
    assert not (tmp_path / "later").exists()


def test_an_interrupt_at_the_terminal_is_for_the_grader_alone():
    """Ctrl-C reaches every process of the terminal's group; a worker goes on until it is ended."""
    with executor(1) as pool:
        pid = pool.submit(os.getpid).result(120.0)
        os.kill(pid, signal.SIGINT)
        assert pool.submit(os.getpid).result(120.0) == pid


def test_the_process_that_judges_has_a_limit_of_memory():
    """Memory that it takes for one submission ends in an error of its own, not of the machine."""
    with executor(1) as pool:
        assert pool.submit(exceed_memory).result(120.0) == "limited"


def test_the_sandbox_does_not_inherit_the_workers_limit(course, solved):
    """A student's process has the memory that its own limits say."""
    source = "import resource\nraise ValueError(resource.getrlimit(resource.RLIMIT_DATA))"
    with executor(1) as pool:
        task = task_of(course, "ada", add(solved, source))
        result = pool.submit(grade_submission, task).result(300.0)
    assert result.cells[0]["error"].startswith("(-1, -1)")


def test_a_busy_worker_ends_with_its_sandbox(course, solved):
    """When a worker is killed that is busy with an endless submission, nothing of it runs on."""
    limits = Limits(cell=1000.0, cells=1000.0, wall=1000.0)
    with pytest.raises(KeyboardInterrupt), executor(1) as pool:
        endless = task_of(course, "eve", add(solved, "while True: pass"), limits)
        pid = pool.submit(os.getpid).result(120.0)
        pool.submit(grade_submission, endless)
        everything = below(pid, at_least=5)
        os.kill(pid, signal.SIGKILL)
        wait_until_gone(everything)
        raise KeyboardInterrupt


def test_a_folder_with_the_notebooks_name_has_a_result(course, here, task):
    """What cannot be read is rejected in a result, so that it is not tried for ever."""
    folder = Submission.of(course, NAME, "eve").folder
    (folder / f"{NAME}.ipynb").mkdir(parents=True)
    eve = Task(course, Submission.of(course, NAME, "eve"), task.bundle_hash, task.isolation, QUICK)
    assert here(eve).rejected


# In this very process


@pytest.fixture
def here(monkeypatch):
    """This process as a worker, without a limit on its memory."""
    monkeypatch.setattr(worker, "_limit_once", lambda: None)
    yield grade_submission
    close_sandbox()


def test_a_forkserver_killed_while_it_loads_is_made_again(here, task):
    """One that ends after it has said something, such as a library's banner, is replaced too."""
    others = running()  # among them other tests' sandboxes

    def kill():
        for pid, _ in below(child(os.getpid(), "bwrap", others), at_least=3):
            if Path(f"/proc/{pid}/cmdline").read_text().startswith(sys.executable):
                os.kill(pid, signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    assert here(task).score == FULL
    killer.join()


def test_whatever_keeps_a_result_from_being_made_is_said(monkeypatch, here, task):
    """Too little memory, a sandbox that is lost, a fault of ours: a sentence each, never a mark."""
    for error in (MemoryError(), LabkitError("its sandbox was lost"), ZeroDivisionError("oh")):

        def fail(*args, error=error):
            raise error

        monkeypatch.setattr(worker, "_grade", fail)
        with pytest.raises(LabkitError):
            here(task)
