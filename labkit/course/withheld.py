"""Tools that a question asks students to write, so its answer may not use them.

The text of an answer is searched for these tools, and while the answer is tried they raise an
exception when the student's code calls them.  labkit's own code can still use them, because inputs
may be made with them.  This reminds honest students; one who evades it is not stopped, but is
listed for the instructor.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from importlib import import_module
from inspect import isclass, isfunction
from itertools import count
from types import FrameType, FunctionType, ModuleType
from typing import Any

from ..errors import LabkitError
from .advice import in_labkit, in_library
from .source import Analysis

_numbers = count()


class Withheld(LabkitError):
    """The answer used a withheld tool.

    Attributes:
        tool: Its dotted name, such as "labkit.Circle".
    """

    def __init__(self, tool: str) -> None:
        """Take the tool's dotted name."""
        super().__init__(tool)
        self.tool = tool

    def __str__(self) -> str:
        return f"{name_in_notebook(self.tool)} may not be used in this answer"


def name_in_notebook(tool: str) -> str:
    """The name of a tool in a notebook, such as "lk.Circle"."""
    return f"lk.{tool.removeprefix('labkit.')}" if tool.startswith("labkit.") else tool


@contextmanager
def withhold(tools: Iterable[str], student: dict[str, Any]) -> Iterator[None]:
    """Make tools raise `Withheld` when the student's code calls them, while the block runs.

    Args:
        tools: Dotted names, such as "labkit.Circle" or "pinocchio".
        student: The student's globals, which may already refer to the tools.
    """
    with ExitStack() as undo:
        for tool in tools:
            owner, target = find(tool)
            if isinstance(target, ModuleType):
                _stop_module(tool, student, undo)
            elif target is not None:
                _stop(tool, owner, tool.rpartition(".")[2], target, student, undo)
        yield


def _stop_module(tool: str, student: dict[str, Any], undo: ExitStack) -> None:
    """Stop every public function and class of a package, in all of its loaded modules.

    Classes written in C are left alone, because they are of no use without the functions.
    """
    stopped: set[int] = set()
    for name, module in list(sys.modules.items()):
        if isinstance(module, ModuleType) and (name == tool or name.startswith(f"{tool}.")):
            for key, thing in list(vars(module).items()):
                home = str(getattr(thing, "__module__", None))
                public = callable(thing) and not key.startswith("_") and home.startswith(tool)
                in_c = isclass(thing) and not isfunction(thing.__init__)
                if public and not in_c and id(thing) not in stopped:
                    _stop(tool, module, key, thing, student, undo)
                if isclass(thing) or isfunction(thing):  # one stop is enough for all references
                    stopped.add(id(thing))


def _stop(
    tool: str, owner: Any, key: str, target: Any, student: dict[str, Any], undo: ExitStack
) -> None:
    if isclass(target) and isfunction(target.__init__):
        for base, name, function in _methods(target):
            if not function.__closure__:
                _stop_function(function, _guard(tool, _copied(function), target), undo)
            elif vars(base)[name] is function:
                undo.callback(type.__setattr__, base, name, function)
                type.__setattr__(base, name, _guard(tool, function, target))
    elif isfunction(target) and not target.__closure__:
        _stop_function(target, _guard(tool, _copied(target)), undo)
    else:
        guard = _guard(tool, target)
        undo.callback(setattr, owner, key, target)
        setattr(owner, key, guard)
        for name in [name for name, value in student.items() if value is target]:
            undo.callback(student.__setitem__, name, target)
            student[name] = guard


def _methods(kind: type) -> Iterator[tuple[type, str, FunctionType]]:
    """The public functions of a class of labkit, with the base class that defines each."""
    for base in kind.__mro__:
        if not base.__module__.startswith("labkit."):
            continue
        for key, thing in list(vars(base).items()):
            function = getattr(thing, "__func__", thing)
            public = not key.startswith("_") or key in ("__init__", "__call__")
            if public and isinstance(function, FunctionType):
                yield base, key, function


def _copied(function: FunctionType) -> FunctionType:
    """A copy of the function, for the guard that replaces it to call."""
    copy = FunctionType(
        function.__code__, function.__globals__, function.__name__, function.__defaults__
    )
    copy.__kwdefaults__ = function.__kwdefaults__
    return copy


def _stop_function(function: FunctionType, guard: Callable[..., Any], undo: ExitStack) -> None:
    """Change the function itself, so that earlier references to it stop too."""
    name = f"_withheld_{next(_numbers)}"
    made: dict[str, Any] = {}
    program = f"def stub(*args, **kwargs):\n    return {name}(*args, **kwargs)\n"
    exec(compile(program, _HERE, "exec"), made)
    for key, value in (
        ("__code__", made["stub"].__code__), ("__defaults__", None), ("__kwdefaults__", None)
    ):  # fmt: skip
        undo.callback(setattr, function, key, getattr(function, key))
        setattr(function, key, value)
    function.__globals__[name] = guard
    undo.callback(function.__globals__.pop, name)


def _guard(tool: str, function: Callable[..., Any], kind: type | None = None) -> Callable[..., Any]:
    def guard(*args: Any, **kwargs: Any) -> Any:
        if (kind is None or _is_of(kind, args)) and _student_asks():
            raise Withheld(tool)
        return function(*args, **kwargs)

    return guard


def _is_of(kind: type, args: tuple[Any, ...]) -> bool:
    """Whether a method is called on the class or its instance, not on a sibling class."""
    return bool(args) and (
        issubclass(args[0], kind) if isclass(args[0]) else isinstance(args[0], kind)
    )


def _student_asks() -> bool:
    """Whether the student's code calls, and not labkit, directly or through a library."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        file = frame.f_code.co_filename
        if file != _HERE:
            if in_labkit(file):
                return False
            if not in_library(file):
                return True
        frame = frame.f_back
    return True  # a thread that labkit did not start


_HERE = _student_asks.__code__.co_filename


def find(name: str) -> tuple[Any, Any]:
    """The owner of what a dotted name means, and the object itself; None if it does not exist."""
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


def withheld_tools(cells: Iterable[Analysis], name: str, tools: Sequence[str]) -> tuple[str, ...]:
    """The withheld tools that an answer uses.

    The use of a tool through an instance, such as ``model.gravity``, is found only when it is
    called; see `withhold`.

    Args:
        cells: What `source.analyse` returned for each cell, in the order in which they run.
        name: The answer's name.
        tools: Dotted names of the withheld tools, such as "labkit.Circle" or "pinocchio".

    Returns:
        Those that are used, in the order given.  Each use counts for one of them alone, preferably
        the one with which the name that was used begins.
    """
    if not tools:
        return ()
    found: set[str] = set()
    for used in set(_uses(last_definitions(cells), name)):
        parts = [tool for tool in tools if _is_part(tool, used)]
        found.update(sorted(parts, key=lambda tool: not _within(used, tool))[:1])
    return tuple(tool for tool in tools if tool in found)


def last_definitions(cells: Iterable[Analysis]) -> dict[str, Mapping[str, Any]]:
    """The last definition of each name; a stub does not replace an answer."""
    means: dict[str, Mapping[str, Any]] = {}
    for cell in cells:
        for definition in cell["definitions"]:
            for name in definition["binds"]:
                if not definition["stub"] or name not in means:
                    means[name] = definition
    return means


def _uses(means: Mapping[str, Mapping[str, Any]], name: str) -> Iterator[str]:
    """The full names of all that a definition uses, directly or through other definitions."""
    imports = {key: d["mean"][key] for key, d in means.items() if key in d["mean"]}
    waiting, seen = [name], {name}
    while waiting:
        definition = means.get(waiting.pop())
        if definition is None:
            continue
        for chain in definition["uses"]:
            root, dot, rest = chain.partition(".")
            home = definition["mean"].get(root, imports.get(root))
            if home is None and root not in means and "*" in imports:
                home = imports["*"].removesuffix("*") + root
            if home is not None:
                yield f"{home}{dot}{rest}"
            elif root not in seen:
                seen.add(root)
                waiting.append(root)


def _is_part(tool: str, other: str) -> bool:
    """Whether a dotted name means a withheld tool, a part of it, or the tool by another name."""
    if _within(other, tool):
        return True
    if other.partition(".")[0] != tool.partition(".")[0]:
        return False
    target = find(tool)[1]
    for thing in _loaded(other):
        if isinstance(target, ModuleType):
            home = getattr(thing, "__module__", None)
            if isinstance(home, str) and _within(home, tool):
                return True
        elif thing is not None and thing is target:
            return True
    return False


def _within(name: str, whole: str) -> bool:
    return name == whole or name.startswith(f"{whole}.")


def _loaded(name: str) -> Iterator[Any]:
    """The objects along a dotted name, without importing a module."""
    first, *parts = name.split(".")
    thing: Any = sys.modules.get(first)
    for part in parts:
        if not isinstance(thing, ModuleType | type):
            return
        thing = getattr(thing, part, None)
        yield thing
