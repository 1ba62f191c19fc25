"""A worker: what it loses it makes again, what it cannot do it says, and nothing outlives it."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from handmade import QUICK, ROOT, add, hand_in
from processes import below, child, wait_until_gone

from labkit.course.bundle import Bundle
from labkit.errors import LabkitError
from labkit.grader.batch import job
from labkit.grader.sandbox.limits import Limits
from labkit.grader.submission import Submission, read_file
from labkit.grader.worker import Desk, _answer

NAME = "01_paths"


@pytest.fixture
def told(course, solved):
    """What a worker is told of an honest submission."""
    hand_in(course, NAME, "ada", solved)
    return job(course, Bundle.of(course, NAME), Submission.of(course, NAME, "ada"), QUICK)


@pytest.fixture
def dying_bwrap(monkeypatch, tmp_path):
    """A bubblewrap that is killed as soon as it starts, so many times; returns how to set that."""
    real = shutil.which("bwrap")
    program, left = tmp_path / "bin" / "bwrap", tmp_path / "left"
    program.parent.mkdir()
    program.write_text(
        f'#!/bin/sh\nleft=$(cat {left})\nif [ "$left" -gt 0 ]; then\n'
        f'  echo $((left - 1)) > {left}\n  kill -9 $$\nfi\nexec {real} "$@"\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    return lambda times: left.write_text(f"{times}\n")


def test_a_sandbox_killed_while_it_starts_is_made_again(dying_bwrap, told):
    """What the kernel ends at its start, for want of memory, costs a retry and no mark."""
    dying_bwrap(1)
    desk = Desk(isolated=True)
    try:
        assert desk.do(told).score == 20
    finally:
        desk.close()


def test_a_forkserver_killed_while_it_loads_is_made_again(told):
    """What is ended when it has said something already, such as a library's banner, is no fault."""

    def kill():
        for pid, _ in below(child(os.getpid(), "bwrap"), at_least=3):
            if Path(f"/proc/{pid}/cmdline").read_text().startswith(sys.executable):
                os.kill(pid, signal.SIGKILL)

    killer = threading.Thread(target=kill)
    desk = Desk(isolated=True)
    killer.start()
    try:
        assert desk.do(told).score == 20
    finally:
        killer.join()
        desk.close()


def test_a_sandbox_killed_each_time_costs_one_submission(dying_bwrap, told):
    """After two tries the submission is named, without a mark; the next one is graded."""
    dying_bwrap(2)
    desk = Desk(isolated=True)
    try:
        with pytest.raises(LabkitError, match=r"lost 2 times \(it was killed while it started\)"):
            desk.do(told)
        assert desk.do(told).score == 20
    finally:
        desk.close()


def test_a_machine_without_rights_is_not_mistaken_for_one_without_memory(
    monkeypatch, told, tmp_path
):
    """A bubblewrap that says why it fails ends the run with its sentence."""
    program = tmp_path / "bwrap"
    program.write_text(
        "#!/bin/sh\necho 'bwrap: setting up uid map: Permission denied' >&2\nexit 1\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert "Permission denied" in _answer(Desk(isolated=True), told)["no isolation"]


def test_whatever_keeps_a_result_from_being_made_is_said(monkeypatch, told):
    """Too little memory, a sandbox that is lost, a fault of ours: a sentence each, never a mark."""
    desk = Desk(isolated=True)
    for error, words in (
        (MemoryError(), "over 1024 MB"),
        (LabkitError("its sandbox was lost"), "its sandbox was lost"),
        (ZeroDivisionError("oh"), "the grader failed: ZeroDivisionError: oh"),
    ):

        def do(job, error=error):
            raise error

        monkeypatch.setattr(desk, "do", do)
        assert words in _answer(desk, told)["failed"]


def test_the_process_that_judges_has_a_limit_of_memory():
    """Memory that it takes for one submission ends in an error of its own, not of the machine."""
    code = """
from labkit.grader.worker import MEMORY, limit_memory
limit_memory()
keep = bytearray(MEMORY // 2)
try:
    more = bytearray(MEMORY)
except MemoryError:
    print("limited")
"""
    run = subprocess.run(
        [sys.executable, "-c", code],
        env=dict(os.environ, PYTHONPATH=str(ROOT)),
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout == "limited\n"


@pytest.fixture
def worker():
    """A worker's process, killed at the end."""
    with subprocess.Popen(
        [sys.executable, "-m", "labkit.grader.worker"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=dict(os.environ, PYTHONPATH=str(ROOT)),
    ) as process:
        yield process
        process.kill()


def tell(worker, told):
    worker.stdin.write(json.dumps(told).encode() + b"\n")
    worker.stdin.flush()


def test_the_sandbox_does_not_inherit_the_workers_limit(told, course, solved, worker):
    """A student's process has the memory that its own limits say."""
    source = "import resource\nraise ValueError(resource.getrlimit(resource.RLIMIT_DATA))"
    hand_in(course, NAME, "ada", add(solved, source))
    tell(worker, told)
    (cell,) = json.loads(json.loads(worker.stdout.readline())["result"])["cells"]
    assert cell["error"].startswith("(-1, -1)")


@pytest.mark.parametrize("how", ["nobody listens", "killed"])
def test_a_busy_worker_ends_with_its_sandbox(how, course, solved, worker):
    """A worker that is at an endless submission ends when nobody waits for it, or when killed."""
    hand_in(course, NAME, "eve", add(solved, "while True: pass"))
    limits = Limits(cell=1000.0, cells=1000.0, wall=1000.0)
    tell(worker, job(course, Bundle.of(course, NAME), Submission.of(course, NAME, "eve"), limits))
    everything = below(worker.pid, at_least=5)
    if how == "killed":
        worker.kill()
    else:
        worker.stdin.close()
    wait_until_gone(everything)


def put_there(kind, path):
    """Something at a path that is not a plain file, or one that may not be read."""
    if kind == "folder":
        path.mkdir()
    elif kind == "fifo":
        os.mkfifo(path)
    elif kind == "dangling link":
        path.symlink_to("nowhere")
    elif kind == "link":
        path.symlink_to(ROOT / "README.md")
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(f"/proc/self/fd/{os.open(path.parent, os.O_PATH)}/{path.name}")
    else:
        path.write_text("{}")


@pytest.mark.parametrize(
    "kind", ["folder", "fifo", "dangling link", "link", "socket", "unreadable"]
)
def test_what_is_not_a_plain_file_is_refused_in_a_sentence(kind, course, monkeypatch):
    """Whatever is called like the notebook, nothing but a plain file is read, and it is said."""
    submission = Submission.of(course, NAME, "eve")
    submission.folder.mkdir(parents=True)
    put_there(kind, submission.folder / f"{NAME}.ipynb")
    if kind == "unreadable":  # to root, nothing is

        def refuse(*args):
            raise PermissionError

        monkeypatch.setattr(os, "open", refuse)
    data, _, why = submission.read(1)
    assert not data
    assert "is not a file" in why or "is a link or cannot be opened" in why


def test_a_device_is_not_opened():
    """Opening a device may do something, so that it is looked at first."""
    with pytest.raises(LabkitError, match="zero is not a file"):
        read_file(Path("/dev/zero"), 1)


def test_a_folder_with_the_notebooks_name_has_a_result(course, told):
    """What cannot be read is rejected in a result, so that it is not tried for ever."""
    submission = Submission.of(course, NAME, "eve")
    (submission.folder / f"{NAME}.ipynb").mkdir(parents=True)
    desk = Desk(isolated=True)
    try:
        result = desk.do({**told, "student": "eve", "folder": str(submission.folder)})
    finally:
        desk.close()
    assert "is not a file" in result.rejected
