"""A function of the course as text that stands alone, as a student would have typed it."""

from __future__ import annotations

import ast
import importlib
import inspect
from collections.abc import Callable, Iterator
from typing import Any


def inline(function: Callable[..., Any], name: str) -> str:
    """The source of a function and of all that it needs from its package, under a name.

    Args:
        function: A function, or an instance of a class with ``__call__``.
        name: What the text is to define.
    """
    plain = inspect.isfunction(function)
    thing = function if plain else type(function)
    module = inspect.getmodule(thing)
    assert module is not None
    taken: dict[tuple[str, str], ast.stmt] = {}
    _take(thing.__name__, module, taken)
    imports = [x for x in taken.values() if isinstance(x, ast.Import | ast.ImportFrom)]
    others = [x for x in taken.values() if not isinstance(x, ast.Import | ast.ImportFrom)]
    own = {x for node in others for x in _defines(node)}
    bodies = [ast.unparse(ast.fix_missing_locations(_Renamed(own).visit(x))) for x in others]
    made = f"_{thing.__name__}" if plain else f"_{thing.__name__}()"
    last = f"def {name}(*args, **kwargs):\n    return {made}(*args, **kwargs)"
    heads = ["from __future__ import annotations", *map(ast.unparse, imports)]
    return "\n\n".join(["\n".join(dict.fromkeys(heads)), *bodies, last])


def _take(name: str, module: Any, taken: dict[tuple[str, str], ast.stmt]) -> None:
    """Collect a definition, those that it needs first."""
    key = (module.__name__, name)
    if key in taken:
        return
    tree = ast.parse(inspect.getsource(module))
    for node in tree.body:
        if name not in _defines(node):
            continue
        home = _home(node, module)
        if home is not None:
            _take(name, home, taken)
            return
        if isinstance(node, ast.Import | ast.ImportFrom):
            taken[key] = node
            return
        taken[key] = node  # before its needs: a function may call itself
        for inner in ast.walk(node):
            if isinstance(inner, ast.ImportFrom) and (place := _home(inner, module)):
                for alias in inner.names:
                    _take(alias.name, place, taken)
        for used in {x.id for x in _evaluated(node) if isinstance(x, ast.Name)}:
            if used != name:
                _take(used, module, taken)
        taken[key] = taken.pop(key)
        return


def _evaluated(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes but annotations, which nobody evaluates."""
    yield node
    for field, value in ast.iter_fields(node):
        if field in {"annotation", "returns"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _evaluated(child)


def _home(node: ast.stmt, module: Any) -> Any:
    """The module of the same package that an import takes from, or None."""
    if not isinstance(node, ast.ImportFrom):
        return None
    full = node.module or ""
    if node.level:
        base = module.__name__.split(".")[: -node.level]
        full = ".".join([*base, *filter(None, [node.module])])
    if full.partition(".")[0] != module.__name__.partition(".")[0]:
        return None
    return importlib.import_module(full)


def _defines(node: ast.stmt) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [alias.asname or alias.name.partition(".")[0] for alias in node.names]
    targets = node.targets if isinstance(node, ast.Assign) else []
    targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
    return [target.id for target in targets if isinstance(target, ast.Name)]


class _Renamed(ast.NodeTransformer):
    """Puts an underscore before names that come along, so that none is a question's."""

    def __init__(self, names: set[str]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """A name that is used."""
        return ast.Name(f"_{node.id}", node.ctx) if node.id in self.names else node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """A function, without its docstring."""
        self.generic_visit(node)
        if node.name in self.names:
            node.name = f"_{node.name}"
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
        return node

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        """A class, without its docstring."""
        self.generic_visit(node)
        node.name = f"_{node.name}" if node.name in self.names else node.name
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
        return node

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST:
        """An import from the course itself: what it brings stands above."""
        inside = node.level or (node.module or "").partition(".")[0] == "solutions"
        return ast.Pass() if inside else node
