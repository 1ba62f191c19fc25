"""Nobody honest is suspected: in no answer that the course knows a tool or a trick is found."""

import json
from pathlib import Path

import numpy as np
import pytest

from labkit.course.authoring.layout import Course
from labkit.course.authoring.solved import inlined
from labkit.course.source import analyse
from labkit.course.withheld import withheld_tools
from labkit.grader.grading.plan import plan
from labkit.grader.sandbox.parse import read
from labkit.grader.sandbox.tricks import find_tricks
from tests.synthetic import Draft, kinds
from tests.synthetic.inline import inline

COURSE = Course.here(Path(__file__))


@pytest.mark.parametrize("assignment", COURSE.names())
def test_no_answer_of_the_course_is_suspected(assignment):
    """Neither the notebooks, nor the answers, the right variants and the known mistakes."""
    file = COURSE.release / assignment / f"{assignment}.ipynb"
    cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    walk = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    problems = COURSE.problems(assignment)
    solved = [*map(analyse, (*walk, *map(inlined, problems)))]
    assert not [found for text in walk for found in find_tricks(text)]
    for problem in problems:
        assert withheld_tools(solved, problem.name, problem.withheld) == ()
        known = [problem.answer, *problem.variants, *(w.function for w in problem.wrong)]
        for text in (inlined(problem), *(inline(f, problem.name) for f in known)):
            found = withheld_tools([*solved, analyse(text)], problem.name, problem.withheld)
            assert (found, find_tricks(text)) == ((), []), text


class Unmarked(Draft):
    """A submission of which nobody asks what it deserves."""

    def answer_with(self, question, function):
        self.answer(question, inline(function, question), 0.0)


def test_of_the_synthetic_class_only_cheats_are_suspected(released, bundle, blank):
    """Odd files, broken cells, magics and prints do not count as tricks."""
    problems = {p.name: p for p in released.problems("01_paths")}
    questions = {q.name: q for q in bundle.questions}
    suspected = set()
    for kind, make in kinds.KINDS.items():
        cells = json.loads(json.dumps(blank["cells"]))
        draft = Unmarked("01_paths", problems, (), questions, np.random.default_rng(1), cells)
        make(draft)
        found = read(draft.bytes())
        if "cells" in found:
            todo = plan(found["cells"], bundle.data["cells"])
            tools = [withheld_tools(todo.looks, q.name, q.withheld) for q in bundle.questions]
            suspected |= {kind} if todo.tricks or any(tools) else set()
    assert suspected == {
        "an answer that crashes",  # by ctypes
        "cheats: a withheld name",
        "cheats: an object equal to all",  # by __import__
        "cheats: patched comparison",
    }


@pytest.mark.parametrize(
    "source",
    [
        "import copy, sys, inspect, types, functools, threading\nsys.setrecursionlimit(5000)",
        "class A:\n    def __init__(self): super().__init__(); self._data = 1\nA()._data",
        "if __name__ == '__main__': print(f.__name__, lk.__version__, lk.Circle.__doc__)",
        "lk.plotting.show('x'); plt.rcParams['figure.dpi'] = 90; np.random.seed(1)",
        "fields = {name: getattr(log, name) for name in ('q', 'dq')}; vars(args)",
        "from labkit.course import check, hint, use\nimport labkit.tags.tag",
        "x = lk.Circle(a, b)(0.3)\nring = lk.BangBang(2.0)\nhelp(lk); dir(lk)",
        "import pinocchio as pin\npin.rnea(model, data, q, dq, ddq)",
        "np.testing.assert_allclose(a, b)\nwith open('notes.txt') as file: text = file.read()",
        "evaluate = 1; execute = 2; compiled = 'eval(x)'  # exec(y)",
        "import os, operator\nos.path.join('a', 'b')\nsorted(x, key=operator.itemgetter(1))",
        "from concurrent.futures import ThreadPoolExecutor\nThreadPoolExecutor(2).map(f, x)",
        "%load_ext autoreload\n%autoreload 2\n!pip install x\nplt?",
    ],
)  # fmt: skip
def test_what_students_do_is_no_trick(source):
    """Own classes, experiments, plots, files of one's own, comments and magics."""
    assert find_tricks(source) == []


@pytest.mark.parametrize(
    ("source", "says"),
    [
        ("__name__ = 'numpy'", "sets __name__"),
        ("global_ = 1\ndef f():\n    global __name__\n    __name__ = 'x'", "sets __name__"),
        ("import pickle as p", "imports pickle"),
        ("from importlib import util", "imports importlib.util"),
        ("import pinocchio.lower as p", "imports pinocchio.lower"),
        ("from labkit.course.serialize import decode", "uses labkit.course.serialize.decode"),
        ("import labkit.grader.sandbox.forkserver", "uses labkit.grader.sandbox.forkserver"),
        ("import labkit\nlabkit.course.marking.mark = 1", "changes labkit.course.marking.mark"),
        ("import sys\ndel sys.modules['labkit']", "uses sys.modules"),
        ("np.abs = max", "changes numpy.abs"),
        ("object.__new__(lk.BangBang)", "uses __new__"),
        ("saved = lk.BangBang.__init__", "uses __init__"),
        ("lk.paths._Profile", "uses labkit.paths._Profile"),
        ("open(lk.paths.__file__)", "uses labkit.paths.__file__"),
        ("vars(lk)['BangBang']", "reaches into labkit by vars"),
        ("getattr(lk, 'Bang' + 'Bang')", "reaches into labkit by getattr"),
        ("exec('x')", "calls exec"),
        ("import subprocess, sys\nsubprocess.run([sys.executable])", "imports subprocess"),
        ("from multiprocessing import Pool", "imports multiprocessing.Pool"),
        ("import os\nos.popen('python')", "uses os.popen"),
        ("from os import execv", "uses os.execv"),
        ("from asyncio import create_subprocess_exec", "uses asyncio.create_subprocess_exec"),
        ("import operator\nf = operator.attrgetter(name)(lk)", "uses operator.attrgetter"),
    ],
)  # fmt: skip
def test_a_trick_is_told_in_words(source, says):
    """Each is the end of a sentence that begins with the cell."""
    assert says in find_tricks(source)
