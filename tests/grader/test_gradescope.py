"""Gradescope: what its autograder is given, and what its container grades."""

from __future__ import annotations

import json
import stat
import subprocess
import sys
import zipfile

import pytest
from autograder import as_root, graded, packed, unpacked
from handmade import FULL, add, raw
from made import NAME, result_of

from labkit.__main__ import FOR_INSTRUCTORS
from labkit.course.authoring.bundle import Bundle
from labkit.grader.gradescope import gradescope_results

HOSTILE = """
import os, signal
got, root = [] if os.getuid() else ["root"], "{place}"
for folder in ("", "/source/build/course/bundle", "/results"):
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
    try:
        if os.getuid() and int(pid) != os.getpid():
            os.kill(int(pid), signal.SIGKILL)
            got.append(f"killed {pid}")
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


@as_root
@pytest.mark.slow
def test_a_hostile_notebook_gets_nothing_and_keeps_what_it_earned(archive, solved):
    """Grade it with Gradescope's limits and rights: full marks, nothing read, written or killed."""
    with unpacked(archive) as place:
        hostile = HOSTILE.replace("{place}", str(place))
        hostile += "\nif got:\n    raise Exception(f'GOT {got}')"
        results, said = graded(place, f"{NAME}.ipynb", raw(add(solved, hostile)))
        assert stat.S_IMODE(place.stat().st_mode) == 0o700
    assert "GOT" not in results["output"] and " failed: " not in results["output"]
    assert results["score"] == FULL and said.splitlines()[-1].startswith("user, ")
