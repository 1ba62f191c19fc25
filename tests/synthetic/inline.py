"""Writes a function of the course as a self-contained text, as if a student had typed it."""

from __future__ import annotations

import ast
import copy
import importlib
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from types import ModuleType
from typing import Any

LAMBDA = "<lambda>"
Key = tuple[str, str]
"""A definition, given by its module and its name in the module."""


def names_defined(node: ast.stmt) -> list[str]:
    """The names that a statement of a module defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    if isinstance(node, ast.ImportFrom) and node.module == "__future__":
        return []
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [alias.asname or alias.name.partition(".")[0] for alias in node.names]
    targets = node.targets if isinstance(node, ast.Assign) else []
    targets = [node.target] if isinstance(node, ast.AnnAssign) else targets
    parts = [x for target in targets for x in ast.walk(target) if isinstance(x, ast.Name)]
    return [x.id for x in parts if isinstance(x.ctx, ast.Store)]


@dataclass
class _Part:
    """A definition that becomes a part of the text, and the meanings of its names.

    Attributes:
        node: The definition.
        means: Names in the definition that are definitions of the course, or imports.
        attributes: Attributes of the course's modules in it, such as ``right.msd``, likewise.
    """

    node: ast.stmt
    means: dict[str, Key] = field(default_factory=dict)
    attributes: dict[tuple[str, str], Key] = field(default_factory=dict)


def inline(function: Callable[..., Any], name: str) -> str:
    """The source of a function, under a new name, and of all that it needs from its package.

    Args:
        function: A function, or an instance of a class with ``__call__``.
        name: The name that the text is to define.
    """
    package = (function if inspect.isfunction(function) else type(function)).__module__
    package = package.partition(".")[0]
    parts: dict[Key, _Part] = {}
    _take_value(function, package, parts)
    heads, names = ["from __future__ import annotations"], {}
    for key, part in parts.items():
        if isinstance(part.node, ast.Import | ast.ImportFrom):
            heads.append(ast.unparse(part.node))
            names[key] = key[1]
        else:
            plain = key[1].lstrip("_")  # classes change names with two underscores
            twins = sum(plain == other.lstrip("_") for _, other in names)
            names[key] = f"_{plain}" + (f"_{twins + 1}" if twins else "")
    bodies = []
    for key, part in parts.items():
        if not isinstance(part.node, ast.Import | ast.ImportFrom):
            renamed = _Renamed(
                {local: names[x] for local, x in part.means.items()} | {key[1]: names[key]},
                {pair: names[x] for pair, x in part.attributes.items()},
            ).visit(copy.deepcopy(part.node))
            bodies.append(ast.unparse(ast.fix_missing_locations(renamed)))
    made = _written(function, package, names)
    last = f"def {name}(*args, **kwargs):\n    return {made}(*args, **kwargs)"
    return "\n\n".join(["\n".join(dict.fromkeys(heads)), *bodies, last])


def _definition(value: Any, package: str) -> Any:
    """The function or class of a package that is the value or that made it; else None."""
    thing = value if inspect.isfunction(value) else type(value)
    return thing if thing.__module__.partition(".")[0] == package else None


def _elsewhere(value: Any) -> str:
    """The module of a function from outside the course, such as numpy's; else ""."""
    return value.__module__ if callable(value) and hasattr(value, "__name__") else ""


def _made_with(value: Any) -> dict[str, Any]:
    """The arguments of an instance: its attributes that are parameters of its class."""
    parameters = {} if inspect.isfunction(value) else inspect.signature(type(value)).parameters
    return {name: vars(value)[name] for name in parameters if name in vars(value)}


def _take_value(value: Any, package: str, parts: dict[Key, _Part]) -> None:
    """Collect the definitions for writing a value, and those for its arguments."""
    thing = _definition(value, package)
    if thing is not None:
        module = inspect.getmodule(thing)
        assert module is not None
        if thing.__name__ == LAMBDA:
            name = ast.Name(_key(thing)[1], ast.Store())
            node = ast.Assign([name], _lambda(thing))
            _take_node(_key(thing), ast.fix_missing_locations(node), module, parts)
        else:
            _take(thing.__name__, module, parts)
        for inner in _made_with(value).values():
            _take_value(inner, package, parts)
    elif home := _elsewhere(value):
        parts[home, home] = _Part(ast.Import([ast.alias(home)]))


def _written(value: Any, package: str, names: Mapping[Key, str]) -> str:
    """A value as an expression."""
    thing = _definition(value, package)
    if thing is None:
        home = _elsewhere(value)
        return f"{names[home, home]}.{value.__name__}" if home else repr(value)
    made = names[_key(thing)]
    inner = (f"{name}={_written(x, package, names)}" for name, x in _made_with(value).items())
    return made if inspect.isfunction(value) else f"{made}({', '.join(inner)})"


def _take(name: str, module: ModuleType, parts: dict[Key, _Part]) -> Key | None:
    """Collect the definition of a module's name after those it needs; None for Python's names."""
    node = next((x for x in _tree(module).body if name in names_defined(x)), None)
    if node is None:
        return None
    home = _home(node, module)
    if home is not None:
        return _take(_called_there(node, name), home, parts)
    key = (module.__name__, name)
    if key not in parts:
        _take_node(key, node, module, parts)
    return key


def _take_node(key: Key, node: ast.stmt, module: ModuleType, parts: dict[Key, _Part]) -> None:
    """Collect a definition after those that it needs."""
    name = key[1]
    part = parts[key] = _Part(node)  # first, because a function may call itself
    if isinstance(node, ast.Import | ast.ImportFrom):
        return
    inner = [x for x in ast.walk(node) if isinstance(x, ast.ImportFrom) and _home(x, module)]
    for used in dict.fromkeys(_used(node)):
        place = next((x for x in inner if used in names_defined(x)), None)
        source = (place and _home(place, module)) or module
        there = _called_there(place, used) if place else used
        whole = _whole(used, module)
        if whole is not None:
            for attribute in sorted(set(_attributes(node, used))):
                found = _take(attribute, whole, parts)
                if found is not None:
                    part.attributes[used, attribute] = found
        elif used != name and (found := _take(there, source, parts)) is not None:
            part.means[used] = found
    parts[key] = parts.pop(key)


def _key(thing: Any) -> Key:
    """The module and the name of a definition; a lambda is named after its line."""
    line = f"lambda_{thing.__code__.co_firstlineno}" if thing.__name__ == LAMBDA else ""
    return thing.__module__, line or thing.__name__


def _lambda(function: Any) -> ast.Lambda:
    """The source of a lambda, which is the one on its line with the same parameters."""
    code, module = function.__code__, inspect.getmodule(function)
    assert module is not None
    (found,) = (
        x
        for x in ast.walk(_tree(module))
        if isinstance(x, ast.Lambda)
        and x.lineno == code.co_firstlineno
        and [a.arg for a in x.args.args] == list(code.co_varnames[: code.co_argcount])
    )
    return found


@cache
def _tree(module: ModuleType) -> ast.Module:
    return ast.parse(inspect.getsource(module))


def _attributes(node: ast.AST, name: str) -> Iterator[str]:
    """The attributes of ``name`` that are used, as in ``name.something``."""
    for x in ast.walk(node):
        if isinstance(x, ast.Attribute) and isinstance(x.value, ast.Name) and x.value.id == name:
            yield x.attr


def _called_there(node: ast.stmt, name: str) -> str:
    """The original name of what an import binds to ``name``."""
    assert isinstance(node, ast.ImportFrom)
    return next(alias.name for alias in node.names if name == (alias.asname or alias.name))


def _whole(name: str, module: ModuleType) -> ModuleType | None:
    """The module of the course that a module imports as a whole under this name."""
    node = next((x for x in _tree(module).body if name in names_defined(x)), None)
    home = _home(node, module) if node is not None else None
    if node is None or home is None:
        return None
    found = getattr(home, _called_there(node, name), None)
    return found if isinstance(found, ModuleType) else None


def _used(node: ast.AST, bound: frozenset[str] = frozenset()) -> Iterator[str]:
    """Names from outside, without annotations, which are not evaluated, and without parameters."""
    if isinstance(node, ast.Name) and node.id not in bound:
        yield node.id
    inside = bound | _parameters(node)
    for place, value in ast.iter_fields(node):
        if place in {"annotation", "returns"}:
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _used(child, inside if place == "body" else bound)


def _parameters(node: ast.AST) -> frozenset[str]:
    if not isinstance(node, ast.FunctionDef | ast.Lambda):
        return frozenset()
    return frozenset(x.arg for x in ast.walk(node.args) if isinstance(x, ast.arg))


def _home(node: ast.stmt, module: ModuleType) -> ModuleType | None:
    """The module of the same package from which an import takes names, or None."""
    if not isinstance(node, ast.ImportFrom):
        return None
    full = node.module or ""
    if node.level:
        base = module.__name__.split(".")[: -node.level]
        full = ".".join([*base, *filter(None, [node.module])])
    if full.partition(".")[0] != module.__name__.partition(".")[0]:
        return None
    return importlib.import_module(full)


class _Renamed(ast.NodeTransformer):
    """Renames the collected definitions, so that none has the name of a question."""

    def __init__(self, names: dict[str, str], attributes: dict[tuple[str, str], str]) -> None:
        self.names, self.attributes = names, attributes

    def within(self, node: ast.FunctionDef | ast.Lambda) -> _Renamed:
        """Rename inside a function, whose parameters keep their names."""
        bound = _parameters(node)
        names = {old: new for old, new in self.names.items() if old not in bound}
        return _Renamed(names, self.attributes)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Rename a name that is used."""
        return ast.Name(self.names.get(node.id, node.id), node.ctx)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Rename an attribute of a module of the course."""
        if isinstance(node.value, ast.Name):
            new = self.attributes.get((node.value.id, node.attr))
            if new is not None:
                return ast.Name(new, node.ctx)
        self.generic_visit(node)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """Rename within a function, and remove its docstring."""
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
        inside = self.within(node)
        node.body = [inside.visit(x) for x in node.body]
        node.args = self.visit(node.args)
        node.decorator_list = [self.visit(x) for x in node.decorator_list]
        node.name = self.names.get(node.name, node.name)
        return node

    def visit_Lambda(self, node: ast.Lambda) -> ast.AST:
        """Rename within a lambda."""
        node.body = self.within(node).visit(node.body)
        node.args = self.visit(node.args)
        return node

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        """Rename within a class, and remove its docstring."""
        if ast.get_docstring(node) is not None:
            node.body = node.body[1:] or [ast.Pass()]
        self.generic_visit(node)
        node.name = self.names.get(node.name, node.name)
        return node

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST:
        """Remove an import from the course, because its definitions are above."""
        inside = node.level or (node.module or "").partition(".")[0] == "solutions"
        return ast.Pass() if inside else node
