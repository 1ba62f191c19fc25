"""Find tricks: code that may get around a withheld tool, for the instructor to look at.

Tricks do not change a mark.  They are what no answer to the course's questions needs: labkit's
internals, text that is run as code, and modules that are loaded dynamically.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping

from ...course.source import dotted, imported, parsed

MODULES = {
    "builtins", "code", "codeop", "ctypes", "dill", "gc", "imp", "importlib", "marshal",
    "multiprocessing", "pickle", "pkgutil", "runpy", "solutions", "subprocess", "zipimport",
}  # fmt: skip
"""Modules that load, rebuild or find objects without naming them, or that start Python."""
CALLS = {"__import__", "compile", "eval", "exec"}
ATTRIBUTES = {
    "__bases__", "__closure__", "__code__", "__dict__", "__getattribute__", "__globals__",
    "__init__", "__loader__", "__mro__", "__new__", "__reduce__", "__reduce_ex__", "__setattr__",
    "__spec__", "__subclasses__", "__wrapped__", "_getframe", "_pin", "attrgetter", "methodcaller",
}  # fmt: skip
"""Attributes that give access to what has been put away."""
INSIDE = (
    *("labkit.course.", "labkit.grader.", "sys.modules.", "sys.meta_path.", "sys.path_hooks."),
    *("os.exec", "os.popen.", "os.posix_spawn", "os.spawn", "os.system.", "operator.attrgetter."),
    *("operator.methodcaller.", "asyncio.create_subprocess_", "concurrent.futures.ProcessPool"),
)
OURS = ("labkit", "numpy", "pinocchio", "builtins", "sys")
"""Modules that no answer needs to change."""
_TELLING = (ast.Import, ast.ImportFrom, ast.Name, ast.Attribute, ast.Call)
STUDENTS = {"labkit.course"} | {
    f"labkit.course.{name}" for name in ("check", "hint", "predict", "use")
}


def find_tricks(source: str) -> list[str]:
    """Find what a code cell does that no answer needs.

    Args:
        source: The text of the cell, in which magics are allowed.

    Returns:
        Predicates of sentences whose subject is the cell, such as "imports pickle".
    """
    try:
        return list(dict.fromkeys(_found(parsed(source)[1])))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []


def _found(tree: ast.AST) -> Iterator[str]:
    nodes = [node for node in ast.walk(tree) if isinstance(node, _TELLING)]
    means = {"lk": "labkit", "np": "numpy"}
    for node in nodes:
        means |= imported(node)
    for node in nodes:
        match node:
            case ast.Import():
                yield from _imports(alias.name for alias in node.names)
            case ast.ImportFrom():
                yield from _imports(imported(node).values())
            case ast.Name("__name__", ast.Store()):
                yield "sets __name__"
            case ast.Attribute():
                yield from _attribute(node, _full(node, means))
            case ast.Call(ast.Name(name)) if name in CALLS:
                yield f"calls {name}"
            case ast.Call(ast.Name("getattr" | "setattr" | "vars" as name), [first, *_]):
                if (_full(first, means) + ".").startswith("labkit."):
                    yield f"reaches into {_full(first, means)} by {name}"


def _full(node: ast.AST, means: Mapping[str, str]) -> str:
    """A dotted name whose first part is replaced by what was imported under it."""
    root, dot, rest = dotted(node).partition(".")
    return means.get(root, root) + dot + rest


def _imports(names: Iterable[str]) -> Iterator[str]:
    for name in names:
        if name.partition(".")[0] in MODULES or name.startswith("pinocchio."):
            yield f"imports {name}"
        elif _is_inside(name):
            yield f"uses {name}"


def _attribute(node: ast.Attribute, name: str) -> Iterator[str]:
    ours = name.partition(".")[0] in OURS
    private = name.startswith("labkit.") and re.match("_[^_]", node.attr)
    if ours and not isinstance(node.ctx, ast.Load):
        yield f"changes {name}"
    elif _is_inside(name) or (ours and node.attr == "__file__") or private:
        yield f"uses {name}"
    elif node.attr in ATTRIBUTES and dotted(node.value) != "super":
        yield f"uses {node.attr}"


def _is_inside(name: str) -> bool:
    return name not in STUDENTS and f"{name}.".startswith(INSIDE)
