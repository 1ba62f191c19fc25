"""Executors: a death costs its own task one retry, a limit its own submission, and nothing more."""

from __future__ import annotations

import os
import shutil
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
from labkit.grader.grading import executor as pools
from labkit.grader.grading import worker
from labkit.grader.grading.executor import LocalExecutor, executor
from labkit.grader.grading.worker import Task, close_sandbox, grade_submission
from labkit.grader.sandbox import cgroup
from labkit.grader.sandbox.limits import Limits
from labkit.grader.sandbox.mounts import Isolation, NoIsolation
from labkit.grader.submission import Submission

NAME = "01_curves"


def noted(path):
    """Note that this process was asked; return how often that happened."""
    with path.open("a") as file:
        file.write("x")
    return path.stat().st_size


def die(path, times):
    """End this worker so many times, and then return."""
    if noted(path) <= times:
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def exceed_memory():
    """Take more than a process that judges may have."""
    cgroup.limit_memory()
    keep = bytearray(cgroup.MEMORY // 2)
    try:
        return len(keep) + len(bytearray(cgroup.MEMORY))
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
    return Task(course, submission, Bundle.of(course, NAME).data["hash"], True, limits)


def test_a_dead_worker_costs_its_own_task_one_retry_and_the_others_nothing(pool, tmp_path):
    """A task whose worker dies once is done by another one; each other task runs just once."""
    futures = [pool.submit(die, tmp_path / str(k), int(k == 1)) for k in range(6)]
    assert [future.result(120.0) for future in futures] == ["done"] * 6
    assert [(tmp_path / str(k)).stat().st_size for k in range(6)] == [1, 2, 1, 1, 1, 1]


def test_a_task_that_kills_its_workers_takes_two_of_them(pool, tmp_path):
    """It fails after two tries, and what is submitted later is done."""
    deadly = pool.submit(die, tmp_path / "deadly", 9)
    with pytest.raises(Exception, match=r"died 2 times|on 2 different workers"):
        deadly.result(120.0)
    assert (tmp_path / "deadly").stat().st_size == 2
    assert pool.submit(die, tmp_path / "later", 0).result(120.0) == "done"


def test_a_submission_that_takes_too_long_is_named(course, solved):
    """The kernel ends a worker at its deadline; the submission has no result, the others theirs."""
    hurried = Limits(parse=0.01, wall=0.01)
    with executor(2) as pool:
        late = pool.submit(grade_submission, task_of(course, "eve", solved, hurried))
        honest = pool.submit(grade_submission, task_of(course, "ada", solved))
        assert honest.result(300.0).score == FULL
        with pytest.raises(LabkitError, match="took too long; look at the submission"):
            late.result(300.0)


def test_nothing_is_graded_for_nobody(tmp_path):
    """Leaving early ends what runs, and nothing that waits is begun."""
    with pytest.raises(KeyboardInterrupt), executor(1) as pool:
        running = below(pool.submit(os.getpid).result(120.0), at_least=1)
        futures = [pool.submit(time.sleep, 1000), pool.submit(noted, tmp_path / "later")]
        raise KeyboardInterrupt
    wait_until_gone(running)
    with pytest.raises((LabkitError, CancelledError)):
        futures[0].result(60.0)
    assert futures[1].cancelled()
    assert not (tmp_path / "later").exists()


def test_an_executor_that_was_shut_down_starts_no_process(monkeypatch):
    """Whatever a thread is doing when the run is stopped, it starts no process after that."""
    pool = LocalExecutor(1)
    pool.shutdown(wait=False)
    monkeypatch.setattr(pools, "ProcessPoolExecutor", pytest.fail)
    with pytest.raises(LabkitError, match="died"):
        pool._call(os.getpid)


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
    eve = Task(course, Submission.of(course, NAME, "eve"), task.bundle_hash, True, QUICK)
    assert "is not a file" in here(eve).rejected


# In this very process


@pytest.fixture
def here(monkeypatch):
    """This process as a worker, without a limit on its memory."""
    monkeypatch.setattr(worker, "_limit_once", lambda: None)
    yield grade_submission
    close_sandbox()


@pytest.fixture
def dying_bwrap(monkeypatch, tmp_path):
    """A bubblewrap that is killed as soon as it starts, so many times; returns how to set that.

    As the real one does then, it leaves a half behind that waits for it, with all its lines.
    """
    real = shutil.which("bwrap")
    program, left, half = tmp_path / "bin" / "bwrap", tmp_path / "left", tmp_path / "half"
    program.parent.mkdir()
    program.write_text(
        f'#!/bin/sh\nleft=$(cat {left})\nif [ "$left" -gt 0 ]; then\n'
        f"  echo $((left - 1)) > {left}\n  exec 3<&0\n  sleep 600 <&3 &\n  echo $! > {half}\n"
        f'  kill -9 $$\nfi\nexec {real} "$@"\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    return lambda times: left.write_text(f"{times}\n")


def test_a_sandbox_killed_while_it_starts_is_made_again(dying_bwrap, here, task, tmp_path):
    """What the kernel ends at its start costs a retry and no mark, and leaves nothing running."""
    dying_bwrap(1)
    assert here(task).score == FULL
    assert int((tmp_path / "half").read_text()) not in running()


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


def test_a_sandbox_killed_each_time_costs_one_submission(dying_bwrap, here, task):
    """After two tries the submission is named, without a mark; the next one is graded."""
    dying_bwrap(2)
    with pytest.raises(LabkitError, match=r"lost 2 times \(it was killed while it started\)"):
        here(task)
    assert here(task).score == FULL


def test_a_machine_without_rights_is_not_mistaken_for_one_without_memory(
    monkeypatch, task, tmp_path
):
    """A bubblewrap that says why it fails ends the run with its sentence."""
    program = tmp_path / "bwrap"
    program.write_text(
        "#!/bin/sh\necho 'bwrap: setting up uid map: Permission denied' >&2\nexit 1\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    with executor(1) as pool, pytest.raises(NoIsolation, match="Permission denied"):
        pool.submit(grade_submission, task).result(300.0)


def test_whatever_keeps_a_result_from_being_made_is_said(monkeypatch, here, task):
    """Too little memory, a sandbox that is lost, a fault of ours: a sentence each, never a mark."""
    for error, words in (
        (MemoryError(), "more than 1024 MB"),
        (LabkitError("its sandbox was lost"), "its sandbox was lost"),
        (ZeroDivisionError("oh"), "the grader failed: ZeroDivisionError: oh"),
    ):

        def fail(*args, error=error):
            raise error

        monkeypatch.setattr(worker, "_grade", fail)
        with pytest.raises(LabkitError, match=words):
            here(task)


def test_a_submission_that_is_to_be_isolated_is(monkeypatch, task):
    """A worker that has graded without a sandbox makes one for the next batch."""
    made = []

    class Fake:
        def __init__(self, loads, hidden, isolation):
            made.append(isolation is Isolation.BUBBLEWRAP)

        def close(self):
            made.append("closed")

    monkeypatch.setattr(worker, "Sandbox", Fake)
    for isolated in (False, True, True, False):
        worker.in_sandbox(id, task.course, (), isolated=isolated)
    close_sandbox()
    assert made == [False, "closed", True, "closed", False, "closed"]
