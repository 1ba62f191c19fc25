"""Gradescope: what its autograder is given, and what its container grades."""

from __future__ import annotations

import json
import os
import signal
import stat
import subprocess
import sys
import time
import zipfile

import pytest
from autograder import as_root, graded, packed, unpacked
from handmade import FULL, QUICK, ROOT, add, hand_in, raw
from made import NAME, result_of

from labkit.__main__ import FOR_INSTRUCTORS, main
from labkit.course.authoring.bundle import Bundle
from labkit.grader import gradescope
from labkit.grader.grade import grade
from labkit.grader.gradescope import gradescope_results

DAEMON = """
import os, signal
if not os.fork():
    os.setsid()
    if not os.fork():
        signal.pause()
    os._exit(0)
os.wait()
"""
HOSTILE = """
import ctypes, os, signal
got, root = [] if os.getuid() else ["root"], "{place}"
for folder in ("", "/source", "/source/build/course/bundle", "/results"):
    try:
        got.append(os.listdir(root + folder))
    except OSError:
        pass
for write in ("results/results.json", "source/x", "submission/x"):
    try:
        got.append(open(f"{root}/{write}", "w"))
    except OSError:
        pass
for pid in filter(str.isdigit, os.listdir("/proc")):
    for part in ("environ", "mem", "maps"):
        try:
            mine = os.stat(f"/proc/{pid}").st_uid == os.getuid()
            if not mine and open(f"/proc/{pid}/{part}", "rb").read(1):
                got.append((pid, part))
        except OSError:
            pass
    try:
        if os.getuid() and int(pid) != os.getpid():
            os.kill(int(pid), signal.SIGKILL)
            got.append(f"killed {pid}")
    except OSError:
        pass
libc = ctypes.CDLL(None)
got += [name for name in ("unshare", "setuid", "setns") if getattr(libc, name)(0) == 0]
try:
    import socket
    got.append(socket.socket())
except OSError:
    pass
"""
"""It reads, writes and kills."""


@pytest.fixture
def archive(course, tmp_path, monkeypatch):
    return packed(course, NAME, tmp_path / "autograder.zip", monkeypatch)


def test_the_zip_has_what_gradescope_asks_for(archive, course):
    """Two scripts that can be executed at its top, the release's bundle, and nobody reads it."""
    found = zipfile.ZipFile(archive)
    for name in ("setup.sh", "run_autograder"):
        assert found.getinfo(name).external_attr >> 16 == 0o755
        assert found.read(name).startswith(b"#!/bin/sh\n")
        subprocess.run(["sh", "-n"], input=found.read(name), check=True)
    inside = json.loads(found.read(f"build/course/bundle/{NAME}.json"))
    assert inside == Bundle.of(course, NAME).data
    assert stat.S_IMODE(archive.stat().st_mode) == 0o600
    assert not [name for name in found.namelist() if "handles" in name or "solutions" in name]


def test_a_report_has_points_and_words_for_each_question(course):
    """What a person marks has a sentence and no points."""
    bundle = Bundle.of(course, NAME)
    result = result_of(course, "ada", written={"why_slower": "So."})
    whole = gradescope_results(bundle, result)
    assert whole["score"] == FULL == sum(t.get("max_score", 0) for t in whole["tests"])
    (why,) = (t for t in whole["tests"] if t["name"] == "why_slower")
    assert "score" not in why and "So." in why["output"]
    assert [t["name"] for t in whole["tests"] if t["visibility"] == "hidden"] == [
        "for the instructor"
    ]


@pytest.mark.slow
def test_a_notebook_of_another_assignment_is_named(course, bundle, sandbox, solved, capsys):
    """Where it is graded, here and at Gradescope; a right one with cells of its own is not."""
    other = (ROOT / "assignments/02_model/02_model.ipynb").read_bytes()
    result = grade(other, "ada", bundle, sandbox, QUICK)
    assert result.rejected and result.rejected in gradescope_results(bundle, result)["output"]
    assert not grade(raw(add(solved, "x = 1")), "bob", bundle, sandbox, QUICK).rejected
    hand_in(course, NAME, "ada", other)
    hand_in(course, NAME, "bob", solved)
    assert main(["grade", NAME, "--course", str(course.root)]) == 1
    assert f"ada: rejected; {result.rejected}" in capsys.readouterr().out


def test_a_file_that_cannot_be_graded_says_why(course):
    """It has 0 points, and the reason is above the questions."""
    refused = result_of(course, "ada", rejected="the file is empty")
    found = gradescope_results(Bundle.of(course, NAME), refused)
    assert found["score"] == 0 and "the file is empty" in found["output"]


def test_the_container_needs_no_package_of_instructors():
    """What runs there imports what a student's labkit brings, and nothing more."""
    code = "import sys, labkit.grader.gradescope\nprint(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {*FOR_INSTRUCTORS, "jinja2"} & set(run.stdout.split())


def endless(place, results):
    time.sleep(60)


def killed(place, results):
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize(("end", "why"), [(endless, "too long"), (killed, "memory ran out")])
def test_the_watchdog_outlives_the_grader(archive, monkeypatch, end, why):
    """Its time and its memory: the report has no points and says why."""
    with unpacked(archive) as place:
        monkeypatch.setenv(gradescope.PLACE, str(place))
        monkeypatch.setattr(gradescope, "_grade", end)
        monkeypatch.setattr(gradescope, "SECONDS", 2.0)
        monkeypatch.setattr("sys.argv", ["gradescope"])
        gradescope.main()
        found = json.loads((place / "results/results.json").read_text())
    assert found["score"] == 0.0 and why in found["output"]


@as_root
@pytest.mark.slow
def test_a_hostile_notebook_gets_nothing_and_keeps_what_it_earned(archive, solved):
    """Grade it with Gradescope's limits and rights: full marks, nothing read, written or killed."""
    with unpacked(archive) as place:
        hostile = HOSTILE.replace("{place}", str(place)) + DAEMON
        hostile += "\nif got:\n    raise Exception(f'GOT {got}')"
        end = graded(place, f"{NAME}.ipynb", raw(add(solved, hostile)))
        assert "GOT" not in end.results["output"] and " failed: " not in end.results["output"]
        assert end.results["score"] == FULL and end.said.splitlines()[-1].startswith("user, ")
        assert end.mode == 0o700
