"""Controls: what earns and harms nothing here does so in one process with the tests."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import threading
from contextlib import contextmanager, suppress
from pathlib import Path

import nbformat
import pytest
from attacks import CLASSES
from controls import CONTROLS, PLAIN, VICTIM, After
from handmade import FULL, add, hand_in, nbgrader
from plain_nbgrader import pack_hidden

from labkit.course.notebook import kind
from labkit.grader.feedback.page import page
from labkit.grader.grading.batch import GradedSubmission, GradeOptions, grade_class
from labkit.grader.nbgrader.gradebook import open_gradebook
from labkit.grader.sandbox.limits import Limits
from labkit.grader.submission import students

NAME = "01_paths"
FAST = GradeOptions(limits=Limits(cell=0.5, call=0.3, question=5.0, wall=30.0))
EVERYBODY = (*CONTROLS, VICTIM)


def student(kind):
    """A name that sorts as the controls stand, so that the one that ends the run comes last."""
    return f"{EVERYBODY.index(kind):02d} {kind}"


@pytest.fixture
def graded(course, tmp_path):
    """A class of attackers and one honest student, graded by nbgrader, then in isolation."""
    mark = f"0.000{os.getpid()}"
    with (course.root / "nbgrader_config.py").open("a") as file:
        file.write(
            "for name in ('Autograde', 'HTMLExporter', 'GenerateFeedback'): c.pop(name)\n"
        )  # nbgrader's own steps
    pack_hidden(course, NAME)
    ask_plainly(course)
    try:
        with server() as (port, heard):
            own = {"loot": tmp_path / "loot", "port": port, "mark": mark}
            for kind, control in CONTROLS.items():
                notebook = short(course.release / NAME / f"{NAME}.ipynb")
                hand_in(course, NAME, student(kind), control.attack.planted(notebook, 0, **own))
                if control.plain:
                    plain = json.loads((course.release / "plain" / "plain.ipynb").read_text())
                    hand_in(course, "plain", student(kind), control.attack.planted(plain, 0))
            solved = short(course.solution / NAME / f"{NAME}.ipynb")
            hand_in(course, NAME, student(VICTIM), solved)
            yield tuple(
                look(grade, course, heard, own) for grade in (grade_with_nbgrader, grade_isolated)
            )
    finally:
        end(mark, str(course.root))


@contextmanager
def server():
    """A server outside the sandbox: its port, and what it was told."""
    heard = bytearray()

    def listen():
        with suppress(OSError):
            while True:
                caller, _ = end.accept()
                with caller:
                    heard.extend(caller.recv(100))

    with socket.create_server(("127.0.0.1", 0)) as end:
        thread = threading.Thread(target=listen, daemon=True)
        thread.start()
        try:
            yield end.getsockname()[1], heard
        finally:
            end.shutdown(socket.SHUT_RDWR)
            thread.join()


def end(*signs):
    """End processes that were started with a word or work in a folder; which ones there were."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            words = (folder / "cmdline").read_bytes().decode(errors="replace").split("\0")
            place = os.readlink(folder / "cwd")
            if any(sign in words or place.startswith(sign) for sign in signs):
                os.kill(int(folder.name), signal.SIGKILL)
                found.append(int(folder.name))
    return found


def ask_plainly(course):
    """Release "plain": one question with a test as many are written."""
    marks = {"schema_version": 3, "locked": False, "task": False, "grade": False, "solution": False}
    stub = nbformat.v4.new_code_cell("### BEGIN SOLUTION\n### END SOLUTION", id="stub")
    stub.metadata["nbgrader"] = marks | {"grade_id": "bang_bang", "solution": True}
    test = nbformat.v4.new_code_cell(PLAIN, id="test")
    test.metadata["nbgrader"] = marks | {"grade_id": "test", "grade": True, "points": 3}
    (course.source / "plain").mkdir()
    notebook = nbformat.v4.new_notebook(cells=[stub, test])
    nbformat.write(notebook, course.source / "plain" / "plain.ipynb")
    nbgrader(course.root, "generate_assignment", "plain", "--create")


def short(path):
    """A notebook of which only what is graded is left, so that it runs quickly."""
    notebook = json.loads(path.read_text())
    kept = ("answer", "check")
    notebook["cells"] = [c for c in notebook["cells"] if kind(c) in kept]
    return add(notebook, "from labkit.course import check, predict", at=0)


def grade_with_nbgrader(course):
    """Grade with nbgrader's own steps, every student in one run."""
    fed = student("feedback injection")
    nbgrader(course.root, "autograde", "plain", "--create")
    nbgrader(course.root, "autograde", NAME, "--create")
    nbgrader(course.root, "generate_feedback", NAME, "--student", fed)
    scores, written = dict.fromkeys(EVERYBODY), dict.fromkeys(EVERYBODY, 0)
    with open_gradebook(course) as book:
        for kind in EVERYBODY:
            name = "plain" if kind in CONTROLS and CONTROLS[kind].plain else NAME
            file = course.root / "autograded" / student(kind) / name / f"{name}.ipynb"
            with suppress(Exception):  # nobody graded him
                written[kind] = file.stat().st_size
                scores[kind] = book.find_submission(name, student(kind)).score
    fed = course.root / "feedback" / fed / NAME / f"{NAME}.html"
    return scores, written, {"feedback injection": fed.read_text()}


def grade_isolated(course):
    """Grade with the isolated engine, every student in one run."""
    done = list(grade_class(course, NAME, students(course, NAME), FAST))
    assert all(isinstance(one, GradedSubmission) and not one.result.rejected for one in done), done
    results = {one.result.student: one.result for one in done}
    of = {kind: results[student(kind)] for kind in EVERYBODY}
    return (
        {kind: result.score for kind, result in of.items()},
        {kind: len(result.text()) for kind, result in of.items()},
        {kind: page(result) for kind, result in of.items()},
    )


def look(grade, course, heard, own):
    """Grade, and see what came of it."""
    own["loot"].mkdir()
    heard.clear()
    scores, written, pages = grade(course)
    taken = {path.name for path in own["loot"].iterdir()}
    shutil.rmtree(own["loot"])
    return After(scores, written, pages, taken, bytes(heard), end(own["mark"]))


def test_every_class_has_its_control():
    """No class of attack is without one."""
    assert CONTROLS.keys() == CLASSES.keys()


@pytest.mark.slow
def test_controls(graded):
    """Each pays or harms under plain nbgrader, and not here: nothing earned, taken or left."""
    nbgraders, ours = graded
    assert not [kind for kind, one in CONTROLS.items() if not one.does(nbgraders, kind)]
    assert not [kind for kind, one in CONTROLS.items() if one.does(ours, kind)]
    assert ours.scores == dict.fromkeys(CONTROLS, 0.0) | {VICTIM: FULL}
    assert not ours.loot and not ours.calls and not ours.left
