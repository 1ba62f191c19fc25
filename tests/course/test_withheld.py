"""Tools stop working for a student's code while a question is tried, and for nobody else."""

import dataclasses
import sys
from inspect import isfunction
from pathlib import Path
from types import ModuleType

import numpy as np
import pinocchio
import pytest
from pinocchio import pinocchio_pywrap_default as lower

import labkit as lk
from labkit.course.authoring.layout import Course
from labkit.course.withheld import Withheld, find, withhold

COURSE = Course.here(Path(__file__))
TOOLS = sorted({t for n in COURSE.names() for p in COURSE.problems(n) for t in p.withheld})
Q = np.zeros(7)
UNIT = lk.BangBang(1.0)
CALL, INIT = lk.BangBang.__call__, lk.BangBang.__init__


class Mine(lk.BangBang):
    """A subclass with a constructor of its own."""

    def __init__(self):
        object.__setattr__(self, "duration", 2.0)


def made_by_hand():
    """An instance for which nobody called the class."""
    made = object.__new__(lk.BangBang)
    INIT(made, 2.0)
    return made


@pytest.mark.parametrize(
    "use",
    [
        lambda: lk.BangBang(2.0),
        lambda: lk.BangBang.within(1.0, 1.0, 1.0),
        lambda: UNIT(0.5),
        lambda: UNIT.shape(0.5),
        lambda: CALL(UNIT, 0.5),
        lambda: made_by_hand()(0.5),
        lambda: Mine()(0.5),
        lambda: np.vectorize(lk.BangBang, otypes=[object])(2.0),
        lambda: dataclasses.replace(UNIT, duration=3.0),
        lambda: list(map(UNIT, [0.5])),
    ],
)
def test_a_class_is_stopped_by_whatever_road(use):
    """An instance made before, a saved method, a subclass, a library in between: all raise."""
    use()
    with withhold(["labkit.BangBang"], {}), pytest.raises(Withheld) as caught:
        use()
    assert caught.value.tool == "labkit.BangBang"
    assert str(caught.value) == "lk.BangBang may not be used in this answer"
    use()


def test_others_go_on():
    """A sister class works, and so does labkit's own code that uses the tool."""
    ride = lk.Trajectory(lk.Line([0.0], [1.0]), UNIT)
    with withhold(["labkit.BangBang", "labkit.Model.mass_matrix"], {}):
        assert lk.Cubic(2.0)(1.0)[0] == 0.5
        assert ride(0.5).position == 0.5
        assert lk.Model().operational_inertia(Q).shape == (6, 6)


def test_a_module_is_stopped_in_all_its_parts():
    """What a package's lower modules offer, and what was imported from it before, is the same."""
    names = {"rnea": pinocchio.rnea}
    with withhold(["pinocchio"], names):
        for use in (pinocchio.rnea, lower.rnea, names["rnea"]):
            with pytest.raises(Withheld):
                use()
        assert lk.Model().gravity(Q).shape == (7,)
    assert names["rnea"] is pinocchio.rnea


def everything():
    """What every loaded module, class and function of the tools' packages is made of."""
    found = {}
    for name, module in list(sys.modules.items()):
        if isinstance(module, ModuleType) and name.partition(".")[0] in ("labkit", "pinocchio"):
            for key, thing in list(vars(module).items()):
                found[name, key] = thing
                inner = vars(thing).items() if isinstance(thing, type) else [("", thing)]
                for inside, value in list(inner):
                    function = getattr(value, "__func__", value)
                    if hasattr(function, "__code__"):
                        parts = function.__code__, function.__defaults__, function.__kwdefaults__
                        found[name, key, inside] = parts
    return found


@pytest.mark.parametrize("tool", TOOLS)
def test_each_tool_is_stopped_and_everything_is_put_back(tool):
    """Of each withheld tool of the course a call raises; afterwards nothing has changed."""
    target = find(tool)[1]
    if isinstance(target, ModuleType):
        own = [f for f in vars(target).values() if isfunction(f) and f.__module__ == tool]
        target = next((f for f in own if not f.__name__.startswith("_")), pinocchio.rnea)
    before = everything()
    with pytest.raises(ZeroDivisionError), withhold([tool], {}):
        with pytest.raises(Withheld):
            getattr(find(tool)[1], target.__name__, target)()  # of C there is only the module's
        raise ZeroDivisionError
    after = everything()
    assert before.keys() == after.keys()
    assert all(before[key] is after[key] or before[key] == after[key] for key in before)
