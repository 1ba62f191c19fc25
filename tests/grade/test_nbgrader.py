"""Controls: attacks pay or harm in nbgrader's own engine; its steps with ours are safe."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from notebooks import add, cell_of, raw

from labkit.grade.engines import grade_with_nbgrader
from labkit.grade.gradebook import open_gradebook

NAME = "01_paths"

CONTROLS = {
    "patched comparison": (
        "import labkit.check\ncheck = lambda name, f: 2.0\nlabkit.check.check = check"
    ),
    "display and execution hooks": (
        "def drop(lines):\n    return ['2.0\\n'] if 'check(' in ''.join(lines) else lines\n"
        "get_ipython().input_transformers_cleanup.append(drop)"
    ),
    "files": (
        "text = open('01_paths.ipynb').read()\n"
        "if 'BEGIN HIDDEN' in text: open('/tmp/labkit-control', 'w').write('GOT')"
    ),
}


def hand_in(course, student, notebook):
    folder = course.submitted / student / NAME
    folder.mkdir(parents=True)
    (folder / f"{NAME}.ipynb").write_bytes(raw(notebook))


@pytest.mark.slow
def test_controls_pay_under_nbgrader(course, blank):
    """Cheats that earn nothing here earn points in one process with the tests."""
    for number, source in enumerate(CONTROLS.values()):
        add(blank, source, at=4 + number)
    Path("/tmp/labkit-control").unlink(missing_ok=True)
    hand_in(course, "mallory", blank)
    mark = grade_with_nbgrader(course, NAME, "mallory")
    assert mark.score == 12, mark.says
    assert Path("/tmp/labkit-control").read_text() == "GOT"
    Path("/tmp/labkit-control").unlink()


@pytest.mark.slow
def test_autograde_of_nbgrader_is_safe(course, blank, solved):
    """`nbgrader autograde` grades in the sandbox: cheats earn 0, doubled cells abort nothing."""
    for source in CONTROLS.values():
        add(blank, source, at=4)
    hand_in(course, "mallory", blank)
    solved["cells"].append(cell_of(solved, "circle"))
    hand_in(course, "zoe", solved)
    Path("/tmp/labkit-control").unlink(missing_ok=True)
    run = subprocess.run(
        [Path(sys.executable).parent / "nbgrader", "autograde", NAME, "--create"],
        cwd=course.root,
        env=dict(os.environ, PYTHONPATH=str(ROOT)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr[-2000:]
    assert not Path("/tmp/labkit-control").exists()
    with open_gradebook(course) as (book, _):
        scores = {s.student.id: s.score for s in book.assignment_submissions(NAME)}
    assert scores == {"mallory": 0, "zoe": 20}
    written = json.loads((course.root / "autograded/zoe" / NAME / f"{NAME}.ipynb").read_text())
    assert "HIDDEN" not in json.dumps(written)
