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
from typing import NamedTuple

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


class Ended(NamedTuple):
    """The end of a run: Gradescope's results, the text for the instructor, the folder's mode."""

    results: dict
    said: str
    mode: int

    def score(self, question):
        return next(t["score"] for t in self.results["tests"] if t["name"] == question)


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


def installed(folder):
    """A folder that every user may read, with only labkit from the checkout."""
    folder.chmod(0o755)
    (folder / "labkit").symlink_to(ROOT / "labkit")
    return folder / "labkit"


@contextmanager
def unpacked(archive):
    """The folder ``/autograder``, made from a zip, in a place that every user may read."""
    with tempfile.TemporaryDirectory(prefix="autograder-") as folder:
        installed(Path(folder))
        place = Path(folder, "autograder")
        for name in ("submission", "results"):
            (place / name).mkdir(parents=True)
        zipfile.ZipFile(archive).extractall(place / "source")
        shutil.copy(place / "source/run_autograder", place)
        (place / "run_autograder").chmod(0o755)
        yield place


def graded(place, name, notebook):
    """Hand in a notebook and start ``run_autograder`` as Gradescope does."""
    (place / "submission" / name).write_bytes(notebook)
    users = [{"email": "ada@example.org", "id": 1, "name": "Ada"}]
    (place / "submission_metadata.json").write_text(json.dumps({"users": users}))
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
    results = json.loads((place / "results/results.json").read_text())
    return Ended(results, run.stdout, place.stat().st_mode & 0o777)
