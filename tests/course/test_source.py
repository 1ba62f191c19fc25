"""Withheld tools in an answer's text: found however they are imported, never where none is."""

import pytest

from labkit.course.source import analyse, needed, withheld_tools

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


def test_a_long_sum_is_readable():
    """Its names are found, also where Python cannot rewrite its hundreds of terms."""
    cell = analyse("total = " + " + ".join(f"a{k}" for k in range(600)))
    assert not cell["broken"]
    assert len(cell["uses"]) == 600
