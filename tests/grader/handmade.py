"""Functions that change a notebook's JSON, hand it in, and run nbgrader's own commands."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from labkit.grader.sandbox.limits import Limits

ROOT = Path(__file__).parents[2]
NAME = "01_curves"
"""The assignment of the synthetic course."""
FULL = 22.0
"""The points by machine for a right one; two of its 24 points belong to a why."""
QUICK = Limits(cell=2.0, call=1.0, question=20.0, wall=60.0)


def timeless(result):
    """A result without the parts that depend on the machine; the rest is the same anywhere."""
    return replace(result, seconds={}, isolation="")


def cell_of(notebook, question):
    for cell in notebook["cells"]:
        if cell["metadata"].get("nbgrader", {}).get("grade_id") == question:
            return cell
    raise KeyError(question)


def put(notebook, question, source):
    cell_of(notebook, question)["source"] = source
    return notebook


def add(notebook, source, at=2):
    cell = {"cell_type": "code", "id": f"own-{len(notebook['cells'])}", "metadata": {},
            "source": source, "outputs": [], "execution_count": None}  # fmt: skip
    notebook["cells"].insert(at, cell)
    return notebook


def raw(notebook):
    return json.dumps(notebook).encode()


def hand_in(course, assignment, student, notebook):
    folder = course.submitted / student / assignment
    folder.mkdir(parents=True, exist_ok=True)
    data = notebook if isinstance(notebook, bytes) else raw(notebook)
    (folder / f"{assignment}.ipynb").write_bytes(data)


def nbgrader(folder, *words):
    """Run a command of nbgrader in a folder; return its exit code and its output.

    Processes of students may end the command or outlive it, so do not wait until a pipe closes.
    """
    here = Path(sys.executable).parent
    with tempfile.TemporaryFile() as out:
        run = subprocess.run(
            [here / "nbgrader", *words],
            cwd=folder,
            env=dict(os.environ, PYTHONPATH=str(ROOT), PATH=f"{here}:{os.environ['PATH']}"),
            stdout=out,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            check=False,
        )
        out.seek(0)
        return run.returncode, out.read().decode()
