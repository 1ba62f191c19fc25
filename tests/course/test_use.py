"""What `use` gives: the student's answer in the form of the right one, or a stand-in."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course import student as notebook
from labkit.course import use
from solutions.paths import answers


@pytest.mark.parametrize("form", [tuple, list, lambda parts: [x.tolist() for x in parts]])
def test_given_cells_get_the_type_of_the_right_answer(tmp_path, monkeypatch, capsys, form):
    """What the check accepts in place of a sample or an array drives the arm like one."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(Path(__file__).parents[2] / "assignments/01_paths/checks.json", tmp_path)
    start, centre = np.array([0.6, 0.1, 0.2]), np.array([0.5, 0.0, 0.3])
    my_circle = use("circle", lambda *args: form(answers.circle(*args)), None)
    path = lk.Trajectory(lambda s: my_circle(s, start, centre), lk.Quintic(2.0))
    right = lk.Trajectory(lk.Circle(start, centre), lk.Quintic(2.0))(0.7)
    assert np.allclose(path(0.7), right) and type(my_circle(0.3, start, centre)) is lk.Sample
    shutil.copy(Path(__file__).parents[2] / "assignments/00_warmup/checks.json", tmp_path)
    notebook._desks.clear()
    my_error = use("joint_error", lambda a, b: (a.position - b.q).tolist(), None)
    state, target = lk.State(0.0, np.zeros(7), np.zeros(7)), lk.Sample(*np.ones((3, 7)))
    assert type(my_error(target, state)) is np.ndarray and capsys.readouterr().out == ""
