"""Does a function lean on a name that the question asks to write?

It reads the function's source, and that of the functions beside it that it calls.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Iterable
from importlib import import_module
from types import ModuleType
from typing import Any


def withheld_names(function: Callable[..., Any], withheld: Iterable[str]) -> list[str]:
    """The withheld names that a function uses.

    Args:
        function: A student's function.
        withheld: Dotted names, such as "labkit.Circle" or "labkit.Model.gravity".

    Returns:
        Those that occur, in the order given; empty if the source cannot be read.
    """
    names = tuple(withheld)
    found: set[str] = set()
    seen: set[int] = set()
    waiting: list[Any] = [function]
    while waiting:
        f = inspect.unwrap(waiting.pop())
        if id(f) in seen or not hasattr(f, "__globals__"):
            continue
        seen.add(id(f))
        try:
            tree = ast.parse(textwrap.dedent(inspect.getsource(f)))
        except (OSError, TypeError, SyntaxError):
            continue
        here = f.__module__
        for node in ast.walk(tree):
            thing = _thing(node, f.__globals__)
            found |= {name for name in names if _is(name, node, thing)}
            if inspect.isfunction(thing) and thing.__module__ == here:
                waiting.append(thing)
    return [name for name in names if name in found]


def _thing(node: ast.AST, names: dict[str, Any]) -> Any:
    """What a name or a dotted name stands for, as far as the function's globals tell."""
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, ast.Attribute):
        owner = _thing(node.value, names)
        return getattr(owner, node.attr, None) if isinstance(owner, ModuleType | type) else None
    return None


def _is(name: str, node: ast.AST, thing: Any) -> bool:
    module, _, last = name.rpartition(".")
    if isinstance(node, ast.Import):
        return any(_within(alias.name, name) for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        source = node.module or ""
        return _within(source, name) or any(
            f"{source}.{alias.name}" == name
            or (source.split(".")[0] == module.split(".")[0] and alias.name == last)
            for alias in node.names
        )
    target = _resolved(name)
    if inspect.isfunction(target) and "." in target.__qualname__:  # a method: any owner will do
        return isinstance(node, ast.Attribute) and node.attr == last
    if thing is None or target is None:
        return False
    if isinstance(target, ModuleType):
        return thing is target or _within(getattr(thing, "__module__", "") or "", name)
    return thing is target


def _within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


def _resolved(name: str) -> Any:
    """The thing of that dotted name, or None."""
    parts = name.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            thing: Any = import_module(".".join(parts[:cut]))
        except ImportError:
            continue
        for part in parts[cut:]:
            thing = getattr(thing, part, None)
        return thing
    return None
