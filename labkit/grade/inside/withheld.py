"""Names that a question asks to write: they stop working for the student's code.

labkit's own code goes on using them, because inputs may be made of them.  This keeps an honest
student honest; whoever copies labkit's public source by hand is seen by the report, not stopped.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from importlib import import_module
from inspect import isclass, isfunction
from types import FunctionType, ModuleType
from typing import Any

TRUSTED = ("labkit", "numpy", "scipy", "pinocchio", "matplotlib", "dataclasses")


class Withheld(Exception):
    """A question's own answer was used in place of one."""


def withhold(names: Iterable[str], question: str, student: dict[str, Any]) -> None:
    """Make names unusable from outside the libraries, in this process.

    Args:
        names: Dotted names, such as "labkit.Circle" or "scipy.interpolate".
        question: What to call the question in the sentence.
        student: The student's globals, where a reference may lie already.
    """
    for name in names:
        owner, target = find(name)
        if target is None:
            continue
        says = f"the question asks you to write {question} yourself; {name} may not be used here"
        if isinstance(target, ModuleType):
            things = {k: v for k, v in vars(target).items() if not k.startswith("_")}
            for key, thing in things.items():
                home = getattr(thing, "__module__", None) or ""
                if callable(thing) and home.startswith(name):
                    _stop(target, key, thing, says, student)
        else:
            _stop(owner, name.rpartition(".")[2], target, says, student)


def _stop(owner: Any, key: str, target: Any, says: str, student: dict[str, Any]) -> None:
    if not callable(target):
        raise AssertionError(key)
    if isclass(target):
        try:
            made = target.__init__
            type.__setattr__(target, "__init__", _guarded(made, says))
            return
        except TypeError:  # a class written in C
            pass
    elif isfunction(target) and not target.__closure__:
        _stop_in_place(target, says)
        return
    guard = _guarded(target, says)
    setattr(owner, key, guard)
    for name, value in list(student.items()):
        if value is target:
            student[name] = guard


def _stop_in_place(function: FunctionType, says: str) -> None:
    """Change a function itself, so that references taken earlier stop too."""
    copy = FunctionType(
        function.__code__, function.__globals__, function.__name__, function.__defaults__
    )
    copy.__kwdefaults__ = function.__kwdefaults__
    inner = f"_withheld_{id(function)}"
    function.__globals__[inner] = _guarded(copy, says)
    made: dict[str, Any] = {}
    exec(f"def stub(*args, **kwargs):\n    return {inner}(*args, **kwargs)\n", made)
    function.__code__ = made["stub"].__code__
    function.__defaults__ = None
    function.__kwdefaults__ = None


def _guarded(function: Callable[..., Any], says: str) -> Callable[..., Any]:
    def guard(*args: Any, **kwargs: Any) -> Any:
        frame = sys._getframe(1)
        if frame.f_code.co_name == "stub" and frame.f_back is not None:
            frame = frame.f_back
        if str(frame.f_globals.get("__name__")).partition(".")[0] not in TRUSTED:
            raise Withheld(says)
        return function(*args, **kwargs)

    return guard


def find(name: str) -> tuple[Any, Any]:
    """What holds a dotted name, and the thing itself; None where there is no such thing."""
    parts = name.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            owner: Any = None
            thing: Any = import_module(".".join(parts[:cut]))
        except ImportError:
            continue
        for part in parts[cut:]:
            owner, thing = thing, getattr(thing, part, None)
        if cut == len(parts) and cut > 1:
            owner = sys.modules[".".join(parts[: cut - 1])]
        return owner, thing
    return None, None
