"""Names in a cell's text: what it binds and uses, and which withheld tools are in an answer."""

import json
from pathlib import Path

import pytest

from labkit.course.authoring.layout import Course
from labkit.course.authoring.release import inlined
from labkit.course.source import analyse, needed, plain, withheld_tools
from tests.synthetic.inline import inline

WITHHELD = (
    "labkit.Circle",
    "labkit.Model.gravity",
    "labkit.se3.inverse",
    "labkit.metrics",
    "pinocchio",
)
SETUP = "import labkit as lk\nfrom labkit.course import check, use\nimport numpy as np"
GIVEN = """\
def given_f(s):
    return lk.Circle([1, 0, 0], [0, 0, 0])(s)
my_f = use("f", f, given_f)
class Schedule:
    def __call__(self, t):
        return t
"""  # fmt: skip


def found(*cells):
    """What is found in an answer called f, in a notebook with a setup cell and a walk's cell."""
    return withheld_tools(map(analyse, (SETUP, GIVEN, *cells)), "f", WITHHELD)


@pytest.mark.parametrize(
    ("cells", "tools"),
    [
        (["def f(s): return lk.Circle([1, 0, 0], [0, 0, 0])(s)"], "labkit.Circle"),
        (["def f(s):\n    from labkit import Circle\n    return Circle(s)"], "labkit.Circle"),
        (["def f(s):\n    from labkit.paths import Circle as C\n    return C(s)"], "labkit.Circle"),
        (["import labkit.paths\ndef f(s): return labkit.paths.Circle(s)"], "labkit.Circle"),
        (["from labkit import *\ndef f(s): return Circle(s)"], "labkit.Circle"),
        (["from labkit.paths import *\ndef f(s): return Circle(s)"], "labkit.Circle"),
        (["def f(s): return getattr(lk, 'Circle')(s)"], "labkit.Circle"),
        (["def f(s): return lk.Circle.__call__(s)"], "labkit.Circle"),
        (["class f(lk.Circle): pass"], "labkit.Circle"),
        (["f = np.vectorize(lk.Circle)"], "labkit.Circle"),
        (["%%time\ndef f(s): return lk.Circle(s)"], "labkit.Circle"),
        (["def f(q): return lk.Model('left').gravity(q)"], "labkit.Model.gravity"),
        (["def f(q): return lk.Model.gravity(lk.Model(), q)"], "labkit.Model.gravity"),
        (["def f(q, models): return models[0].gravity(q)"], "labkit.Model.gravity"),
        (["from labkit import se3", "def f(T): return se3.inverse(T)"], "labkit.se3.inverse"),
        (["def f(q):\n    import pinocchio as pin\n    return pin.rnea(q)"], "pinocchio"),
        (["def f(q): return lk.metrics.summary(q)"], "labkit.metrics"),
        (["from labkit.metrics import summary\ndef f(q): return summary(q)"], "labkit.metrics"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)  # fmt: skip
def test_tools_are_found(cells, tools):
    """Each way to name a withheld tool in the answer's own text is seen."""
    assert found(*cells) == (tools,)


@pytest.mark.parametrize(
    "cells",
    [
        ["def f(s):\n    gravity = 9.81  # no Circle here\n    return 'labkit.Circle', gravity"],
        ["def f(s): return s", "lk.Circle([1, 0, 0], [0, 0, 0])(0.5)"],
        ["def f(s): return s", "ring = lk.Circle([1, 0, 0], [0, 0, 0])\nplot(ring, f)"],
        ["def f(s): return lk.Circle(s)", "def f(s): return s"],
        ["def f(s): return given_f(s)"],
        ["def f(s): return Schedule()(s)"],  # a cell may hold more than what an answer needs of it
        ["def f(s): return g(s)", "ring = lk.Circle(0)", "def g(s, ring=2): return s * ring"],
        ["def f(T): return T.inverse()"],
        ["def f(q): return lk.se3.gravity(q)"],  # a function with the name of a method
        ["class Circle: pass", "def f(s): return Circle()(s)"],
        ["def f(s): return s", "def f(s): raise NotImplementedError"],
        ["def f(s: return lk.Circle(s)"],
        ["%%timeit\ndef f(s): return lk.Circle(s)"],
    ],
)
def test_nothing_is_found_where_nothing_is(cells):
    """Comments, texts, own experiments, other cells, names that only look alike are no tools."""
    assert found(*cells) == ()


MODULE = """\
import numpy as np, math
from pathlib import (
    Path,
)
SCALE = 2.0; OTHER = 3.0
def mass(x):
    return Path(x)
@property
def helper(x):  # as it is written
    mass = SCALE * x
    return mass
def f(x: float) -> float:
    return helper(x) + given(x) + f(0)
def given(x):
    return np.pi
f.name = mass
"""


def test_a_name_needs_what_its_definition_takes_from_outside():
    """No module's function of a local name; whole statements, in order; nothing that is given."""
    parts = needed(MODULE, "f", ["given"])
    assert parts[0] == "SCALE = 2.0; OTHER = 3.0"
    assert [part.splitlines()[0] for part in parts[1:]] == [
        "@property",
        "def f(x: float) -> float:",
    ]
    assert "# as it is written" in parts[1]
    assert needed(MODULE, "mass")[0] == "from pathlib import (\n    Path,\n)"
    assert needed(MODULE, "nothing") == []


def test_a_magic_keeps_names_from_the_notebook_or_not():
    """Those that time or capture run the cell here; any other, known or not, defines nothing."""
    for head in ("", "%%time\n", "\n\n%%capture out --no-stderr\n", "%%prun -q\n%%time\n"):
        assert analyse(f"{head}def f(x): pass")["binds"] == ["f"]
    for head in ("%%timeit -n1\n", "%%bash\n", "%%no_such_magic\n"):
        found = analyse(f"{head}def f(x): pass")
        assert not found["binds"] and found["magic"]


def test_lines_keep_their_numbers():
    """An error below a magic has the number of the line that the student sees."""
    assert plain("%%time\n\n%%capture\nx = 1").split("\n")[3] == "x = 1"
    assert plain("x = 1\n%matplotlib inline\n!ls\ny = 2").split("\n")[3] == "y = 2"


def test_what_a_cell_needs_and_binds():
    """Names by def, class, import, loop and assignment, wherever they stand in a line."""
    found = analyse(
        "import a.b, c as d\nfor e in range(f): g = h; i = (\n 1)\nclass J(k): l = m\nn += 1"
    )
    assert found["binds"] == ["J", "a", "d", "e", "g", "i", "n"]
    assert set(found["uses"]) == {"f", "h", "k", "m", "range"}
    assert analyse("a = (1,\n 2); b = a; from x import *")["binds"] == ["*", "a", "b"]


@pytest.mark.parametrize(
    "source",
    [
        "(" * 500,
        "x = '\0'",
        "def f(:",
        "-" * 100_000 + "1",
        "a" + ".b" * 5000,
        "\ud800",
        "%%",
        "%%\n",
    ],
)
def test_no_text_is_too_odd(source):
    """The analysis of any cell's text has the same parts as that of x = 1."""
    assert set(analyse(source)) == set(analyse("x = 1"))


COURSE = Course.here(Path(__file__))


@pytest.mark.parametrize("assignment", COURSE.names())
def test_no_answer_of_the_course_is_suspected(assignment):
    """Neither the notebooks, nor the answers, the right variants and the known mistakes."""
    file = COURSE.release / assignment / f"{assignment}.ipynb"
    cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    walk = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    problems = COURSE.problems(assignment)
    solved = [*map(analyse, (*walk, *map(inlined, problems)))]
    for problem in problems:
        assert withheld_tools(solved, problem.name, problem.withheld) == ()
        known = [problem.answer, *problem.variants, *(w.function for w in problem.wrong)]
        for text in (inlined(problem), *(inline(f, problem.name) for f in known)):
            cells = [*solved, analyse(text)]
            assert withheld_tools(cells, problem.name, problem.withheld) == (), text
