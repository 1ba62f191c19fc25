"""What an author got wrong is a sentence: the file, the question, and what to do."""

from __future__ import annotations

from types import SimpleNamespace

import nbformat
import pytest
from courses import SYNTHETIC
from handmade import NAME

from labkit.course.authoring.layout import Course
from labkit.course.authoring.problem import Problem, Trial, call
from labkit.errors import LabkitError
from labkit.grader import release


def double(x):
    return 2 * x


def problem(**more):
    trials = (Trial("twice", (call(1.0),)),)
    return Problem("double", 2.0, "Double it.", double, trials, **more)


def released(monkeypatch, problems, source="def double(x):\n    pass", first="# 2 points"):
    """Prepare an assignment of these problems."""
    cells = [nbformat.v4.new_markdown_cell(first), nbformat.v4.new_code_cell(source)]
    cells[1].metadata = {"lab": "answer", "nbgrader": {"grade_id": "double", "solution": True}}
    monkeypatch.setattr(Course, "problems", lambda self, name: problems)

    def prepare(course, name, seed):
        made = {p.name: p.question(seed) for p in problems}
        return SimpleNamespace(source=SimpleNamespace(cells=cells), questions=made)

    monkeypatch.setattr(release, "prepare", prepare)
    return release.prepared(Course(SYNTHETIC.parent), NAME, 1)


def test_what_is_in_order_passes(monkeypatch):
    """A tuple of problems, stubs that Python reads, points that sum."""
    assert released(monkeypatch, (problem(),)).questions["double"].points == 2.0


def test_a_stub_that_is_not_python_is_refused(monkeypatch):
    """No student could run it."""
    with pytest.raises(LabkitError, match="cell 2 double is not Python: SyntaxError"):
        released(monkeypatch, (problem(),), source="def double(x/")


def test_points_have_to_add_up(monkeypatch):
    """What the first cell promises is what the questions give."""
    with pytest.raises(LabkitError, match=r"the first cell says 9 points, .* come to 2$"):
        released(monkeypatch, (problem(),), first="about 4 hours · 9 points")
