"""Every notebook runs from its first cell to its last, whatever is solved."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from labkit import replay
from labkit.course.predictions import Prediction

sys.path.insert(0, str(Path(__file__).parent))
from student import BROKEN, COURSE, FORGETS, STUB, questions, run_here, run_kernel, solved

NAMES = [name for name in COURSE.names() if COURSE.problems(name)]
POINTS = {name: {p.name: p.points for p in COURSE.problems(name)} for name in NAMES}


@pytest.mark.parametrize("which", ["none", "all"])
@pytest.mark.parametrize("name", NAMES)
def test_it_runs_to_the_end(name, which, tmp_path, monkeypatch):
    """No cell raises; one badge for each unsolved part that is used; marks do not depend on it."""
    random = np.random.default_rng(list(name.encode()))
    parts = {q: str(random.choice([STUB, BROKEN, FORGETS])) for q in questions(name)}
    done = which == "all"
    sheet = run_here(name, solved(name) if done else parts, tmp_path, monkeypatch)
    for q in questions(name):
        assert sheet.earned[q] == (POINTS[name][q] if done else 0.0), q
        assert sheet.badges(q) == (q in sheet.used and not done), q


@pytest.mark.soak
@pytest.mark.parametrize("name", NAMES)
def test_no_stand_in_tells_another_truth(name, tmp_path, monkeypatch):
    """With nothing solved, what is shown for a prediction is what a solved notebook shows."""
    foretold = {p.name: p for p in COURSE.predictions(name) if isinstance(p, Prediction)}
    parts = {p.name: p.solved() for p in foretold.values()}
    told = " ".join(run_here(name, parts, tmp_path, monkeypatch, shortest=np.inf).printed.split())
    assert "That is not what you said" not in told
    for times in re.findall(r"Your number is ([\d.e+-]+) times", told):
        assert 0.8 < float(times) < 1.25  # theory says 4, where twelve noisy pictures say 3.6


@pytest.mark.soak
@pytest.mark.parametrize("name", NAMES)
def test_every_arm_that_is_shown_moves(name, tmp_path, monkeypatch):
    """Solved, an arm in a replay moves, unless the title says that it is held."""
    motion_of, shown = replay.motion_of, []

    def kept(*args, **options):
        shown.append(motion_of(*args, **options))
        return shown[-1]

    monkeypatch.setattr(replay, "motion_of", kept)
    run_here(name, solved(name), tmp_path, monkeypatch, shortest=np.inf)
    assert shown
    for motion in shown:
        moves = np.ptp(motion.q, axis=0).max() > 0.005
        assert moves != (" held by " in f" {motion.title.lower()} "), motion.title


IN_A_KERNEL = pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=() if n == "03_velocity_control" else pytest.mark.soak) for n in NAMES],
)


@pytest.mark.slow
@IN_A_KERNEL
def test_solved_in_a_kernel(name, tmp_path, monkeypatch):
    """Solved, it has full marks, with at most 1 GB of memory and 1 MB of file.

    Pictures have words.
    """
    monkeypatch.setenv(
        "NBGRADER_EXECUTION", "autograde"
    )  # as nbgrader does; else no number is shown
    notebook, megabytes = run_kernel(name, solved(name), tmp_path)
    assert megabytes < 1024.0
    size = len(json.dumps(notebook).encode())
    assert size < 1_000_000
    replays = 0
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            assert output.output_type != "stream" or output.name == "stdout", output
            replays += "lk-saved" in output.get("data", {}).get("text/html", "")
            if "image/png" in output.get("data", {}):
                alt = output.metadata["image/png"]["alt"]
                assert len(alt) > 40
        if cell.metadata["lab"] == "check":
            points = cell.metadata.nbgrader.points
            assert float(cell.outputs[-1].data["text/plain"]) == points, cell.source
    assert replays >= 1


@pytest.mark.slow
@IN_A_KERNEL
def test_released_in_a_kernel(name, tmp_path):
    """As it is handed out, it runs, earns nothing, shows no number and writes nothing to stderr."""
    notebook, _ = run_kernel(name, {}, tmp_path)
    for cell in notebook.cells:
        assert not [o.text for o in cell.get("outputs", ()) if o.get("name") == "stderr"]
        if cell.metadata["lab"] == "check":
            (output,) = cell.outputs
            assert "not attempted yet" in output.data["text/plain"]
