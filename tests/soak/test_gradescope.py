"""Gradescope's container: every assignment, every attack, and limits that are reached."""

from __future__ import annotations

import copy
import tempfile
from contextlib import ExitStack
from pathlib import Path

import pytest
from attacks import CLASSES
from autograder import as_root, closed_to_others, graded, installed, packed, unpacked
from handmade import ROOT, add, put, raw

from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.grader.grading.grade import grade
from labkit.grader.sandbox import mounts
from labkit.grader.sandbox.isolation import processes_of
from labkit.grader.sandbox.launch import Sandbox
from labkit.grader.sandbox.limits import Limits
from labkit.grader.sandbox.mounts import Isolation
from labkit.grader.terms.release import release

from .classes import notebook

pytestmark = [pytest.mark.soak, as_root]

NAMES = Course(ROOT).names()
FAST = Limits(cell=0.5, call=0.3, question=5.0, wall=30.0)
SHARED = ("/etc/passwd", "/proc/", "list_home", "hard_link", "many_files", "fill_disk", "abstract")
"""What a user id alone leaves to a student's code: what everybody may read, and the disk."""
ENDLESS = """
def NAME(*args):
    while True:
        try:
            while True: pass
        except BaseException: pass
"""
HOG = """
def NAME(*args):
    import os
    [os.fork() for _ in range(4)]
    x = []
    while True: x.append(bytearray(10**7))
"""
BOMB = """
import os, time
while True:
    try:
        os.fork()
    except OSError:
        time.sleep(0.001)
"""


@pytest.fixture(scope="module")
def term(tmp_path_factory):
    """A course with everything released."""
    root = tmp_path_factory.mktemp("term")
    (root / "solutions").symlink_to(ROOT / "solutions")
    (root / "nbgrader_config.py").write_text((ROOT / "nbgrader_config.py").read_text())
    for name in NAMES:
        release(Course(root), name, 7)
    return Course(root)


@pytest.mark.parametrize("name", NAMES)
def test_right_answers_have_full_marks(term, name, tmp_path, monkeypatch):
    """On half a processor, in 768 MB and in time, all of them."""
    closed = closed_to_others()
    assert not closed, f"answers import what is below {closed}: clone where everybody may read"
    archive = packed(term, name, tmp_path / "a.zip", monkeypatch)
    with unpacked(archive) as place:
        end = graded(place, f"{name}.ipynb", raw(notebook(term.root, "solved", name)))
    assert end.results["score"] == Bundle.of(term, name).points
    assert "stopped" not in end.results["output"]


@pytest.mark.parametrize("name", NAMES)
def test_answers_that_never_end_leave_a_result(term, name, tmp_path, monkeypatch):
    """Grading comes to its end before the watchdog, whichever answers never end."""
    archive = packed(term, name, tmp_path / "a.zip", monkeypatch)
    work, questions = notebook(term.root, "solved", name), Bundle.of(term, name).questions
    for question in questions:
        put(work, question.name, ENDLESS.replace("NAME", question.name))
    with unpacked(archive) as place:
        end = graded(place, f"{name}.ipynb", raw(work))
    assert end.results["score"] == 0 and "Grading stopped" not in end.results["output"]
    assert [t["name"] for t in end.results["tests"]][: len(questions)] == [
        q.name for q in questions
    ]


@pytest.mark.parametrize("what", ["memory", "forks"])
def test_who_takes_everything_loses_that_question_alone(term, tmp_path, monkeypatch, what):
    """The kernel ends the student's side, not the grader's; the other answers have their marks."""
    archive = packed(term, "01_paths", tmp_path / "a.zip", monkeypatch)
    work = notebook(term.root, "solved")
    if what == "memory":
        put(work, "bang_bang", HOG.replace("NAME", "bang_bang"))
    else:
        add(work, BOMB)
    with unpacked(archive) as place:
        end = graded(place, "01_paths.ipynb", raw(work))
    assert end.score("bang_bang") == (0 if what == "memory" else 3)
    assert end.score("trapezoid") == 4 and end.score("circle") == 4


@pytest.mark.parametrize("kind", CLASSES)
def test_attacks_earn_nothing_by_user_id(term, kind, monkeypatch):
    """What is tried on a sandbox, tried on a user id: no point, no secret, no process left."""
    bundle, wrong = Bundle.of(term, "01_paths"), []
    with ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        monkeypatch.setattr(mounts, "_PACKAGE", installed(Path(folder)))
        sandbox = stack.enter_context(Sandbox(isolation=Isolation.USER))
        for name, attack in CLASSES[kind].items():
            work = attack.planted(copy.deepcopy(notebook(term.root, "blank")), root=term.root)
            result = grade(raw(work), "mallory", bundle, sandbox, FAST)
            said = " ".join(f"{cell['error']} {cell['output']}" for cell in result.cells)
            got = "GOT" in said and not any(x in name for x in SHARED)
            if result.score or result.rejected or got or processes_of(sandbox.uid):
                wrong.append((name, result.score, result.rejected, said[-200:]))
    assert not wrong
