"""nbgrader's own command with the isolated engine in its steps."""

from __future__ import annotations

import json

import pytest
from controls import CONTROLS
from handmade import cell_of, hand_in, nbgrader

from labkit.grade.gradebook import open_gradebook

NAME = "01_paths"


@pytest.mark.slow
def test_autograde_of_nbgrader_is_safe(course, blank, solved, tmp_path):
    """`nbgrader autograde` grades in the sandbox: cheats earn 0, doubled cells abort nothing."""
    for kind in ("patched comparison", "display and execution hooks", "files"):
        CONTROLS[kind].attack.planted(blank, at=4, loot=tmp_path)
    hand_in(course, NAME, "mallory", blank)
    solved["cells"].append(cell_of(solved, "circle"))
    hand_in(course, NAME, "zoe", solved)
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code == 0, said[-2000:]
    assert not (tmp_path / "files").exists()
    with open_gradebook(course) as book:
        scores = {s.student.id: s.score for s in book.assignment_submissions(NAME)}
    assert scores == {"mallory": 0, "zoe": 20}
    written = json.loads((course.root / "autograded/zoe" / NAME / f"{NAME}.ipynb").read_text())
    assert "HIDDEN" not in json.dumps(written)
