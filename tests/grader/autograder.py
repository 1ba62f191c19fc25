"""An imitation of Gradescope's container, with its folders and Docker's rights."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from handmade import ROOT

from labkit.grader import gradescope
from labkit.grader.gradescope import PLACE

RIGHTS = (
    "chown dac_override fowner fsetid kill setgid setuid setpcap net_bind_service net_raw "
    "sys_chroot mknod audit_write setfcap"
)
"""The rights of root in a container by default; none of them allows making a namespace."""
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a process another user")
"""Marks a test of what root alone may do; pytest says so to everybody else."""


def packed(course, assignment, to, monkeypatch):
    """The zip of an assignment, which does not contain labkit."""
    shutil.copy(ROOT / "hashes.txt", course.root)
    monkeypatch.setattr("labkit.grader.student_zip.wheel", lambda root, to: None)
    gradescope.autograder(course, assignment, to)
    return to


def processes_of(uid):
    """The processes of a user that still run."""
    found = set()
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if folder.stat().st_uid == uid and (folder / "cmdline").read_bytes():
                found.add(folder.name)
    return found


@contextmanager
def unpacked(archive):
    """The folder ``/autograder``, made from a zip, in a place that every user may read."""
    with tempfile.TemporaryDirectory(prefix="autograder-") as folder:
        Path(folder).chmod(0o755)
        Path(folder, "labkit").symlink_to(ROOT / "labkit")
        place = Path(folder, "autograder")
        for name in ("submission", "results"):
            (place / name).mkdir(parents=True)
        zipfile.ZipFile(archive).extractall(place / "source")
        shutil.copy(place / "source/run_autograder", place)
        (place / "run_autograder").chmod(0o755)
        yield place


def graded(place, name, notebook):
    """Start ``run_autograder`` as Gradescope does: its results, and what it prints."""
    (place / "submission" / name).write_bytes(notebook)
    rights = ",".join(f"+{name}" for name in RIGHTS.split())
    run = subprocess.run(
        ["setpriv", f"--bounding-set=-all,{rights}", "./run_autograder"],
        cwd=place,
        env={"LABKIT_PYTHON": sys.executable, PLACE: str(place), "PYTHONPATH": str(place.parent)}
        | {"PATH": os.environ["PATH"], "XDG_CACHE_HOME": str(place.parent / "cache")},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads((place / "results/results.json").read_text()), run.stdout
