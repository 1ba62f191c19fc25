"""Analysis of the names in a cell's text, without running it, and of the withheld tools among them.

The check in a notebook and the grader use it, to find the same answers and the same tools in them.
Only the answer's own text is searched.  This tells honest students; whoever hides a tool from it
is asked about the answer in the defence.
"""

from __future__ import annotations

import ast
import re
import symtable
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

Analysis = Mapping[str, Any]
"""What `analyse` returns for a cell, as JSON data."""

RUNS_HERE = ("time", "capture", "prun")
"""Cell magics that run their cell in the notebook's namespace.

Any other, such as ``%%timeit`` or ``%%bash``, defines no name in the notebook.
"""
_TIMED = re.compile(r"^%time[ \t]+(?=[^\s-])", re.MULTILINE)
_MAGIC = re.compile(r"\s*%%(\S+)[^\n]*\n?")
_OTHER_MAGIC = re.compile(r"get_ipython\(\)\.run_cell_magic\('([^']*)'")


def plain(source: str) -> str:
    """A cell as plain Python, line for line.

    The magics of `RUNS_HERE` and ``%time`` are removed; other magics and shell commands become
    calls, as in a notebook.
    """
    source = _TIMED.sub("", source)
    while (found := _MAGIC.match(source)) and found[1] in RUNS_HERE:
        source = "\n" * found[0].count("\n") + source[found.end() :]
    if not any(line.lstrip()[:1] in {"%", "!", "?"} or "?" in line for line in source.split("\n")):
        return source
    from IPython.core.inputtransformer2 import TransformerManager

    text: str = TransformerManager().transform_cell(source)
    return text


@lru_cache(maxsize=1)
def parsed(source: str) -> tuple[str, ast.Module]:
    """A cell as plain Python, and its syntax tree; the last result is cached.

    Raises:
        SyntaxError, ValueError, RecursionError, MemoryError: Python cannot read it.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        text = plain(source)
        return text, ast.parse(text)


@lru_cache(maxsize=4096)
def analyse(source: str) -> Analysis:
    """What a code cell does with names.

    Args:
        source: The text of the cell, which may contain IPython's magics.

    Returns:
        ``functions`` that the cell defines at its top level, all names that it ``binds`` there and
        names that it ``uses``; functions that are still ``stubs``; why it is ``broken``, or "" if
        Python can read it; the ``magic`` that keeps its names from the notebook, or ""; and its
        ``definitions``, see `_definition`.
    """
    found: dict[str, Any] = {
        "functions": [], "binds": [], "uses": [], "stubs": [], "broken": "", "magic": "",
        "definitions": [],
    }  # fmt: skip
    try:
        text, tree = parsed(source)
        other = _OTHER_MAGIC.match(text)
        found["magic"] = other[1] if other else ""
        functions = [x for x in tree.body if isinstance(x, ast.FunctionDef | ast.ClassDef)]
        found["functions"] = [x.name for x in functions]
        found["stubs"] = [x.name for x in functions if is_stub(x)]
        lines = text.split("\n")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            definitions = [_definition(part, lines) for part in _parts(tree.body)]
        binds = {name for definition in definitions for name in definition["binds"]}
        outside = {name for definition in definitions for name in definition["outside"]}
        found["binds"], found["uses"] = sorted(binds), sorted(outside - binds)
        found["definitions"] = definitions
    except SyntaxError as error:
        found["broken"] = f"{type(error).__name__}: {error.msg}, line {error.lineno}"[:200]
    except (ValueError, RecursionError, MemoryError) as error:
        found["broken"] = f"{type(error).__name__}: {error}"[:200]
    return found


def is_stub(statement: ast.AST) -> bool:
    """Whether a statement is a function that only raises NotImplementedError."""
    if not isinstance(statement, ast.FunctionDef):
        return False
    body = [x for x in statement.body if not _is_text(x)]
    if len(body) != 1 or not isinstance(body[0], ast.Raise) or body[0].exc is None:
        return False
    raised = body[0].exc.func if isinstance(body[0].exc, ast.Call) else body[0].exc
    return isinstance(raised, ast.Name) and raised.id == "NotImplementedError"


def dotted(node: ast.AST) -> str:
    """A chain of attributes as text, such as "lk.Model.gravity"; "" if it begins with no name.

    A call stands for the function or class that is called, because an instance has the attributes
    of its class.  A constant name that is passed to ``getattr`` is an attribute.
    """
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        owner = dotted(node.value)
        return owner and f"{owner}.{node.attr}"
    if isinstance(node, ast.Call):
        called = dotted(node.func)
        name = node.args[1] if called == "getattr" and len(node.args) > 1 else None
        if isinstance(name, ast.Constant) and isinstance(name.value, str):
            owner = dotted(node.args[0])
            return owner and f"{owner}.{name.value}"
        return called
    return ""


def imported(node: ast.AST) -> dict[str, str]:
    """The full name of each name that an import binds; empty for any other statement."""
    if isinstance(node, ast.Import):
        return {
            x.asname or x.name.partition(".")[0]: x.name if x.asname else x.name.partition(".")[0]
            for x in node.names
        }
    if isinstance(node, ast.ImportFrom) and node.module and not node.level:
        return {x.asname or x.name: f"{node.module}.{x.name}" for x in node.names}
    return {}


def needed(source: str, name: str, given: Collection[str] = ()) -> list[str]:
    """The statements of a module on which a name depends, as they are written, in order.

    Args:
        source: The text of the module.
        name: The name.
        given: Names that are defined elsewhere.
    """
    lines = source.split("\n")
    parts = _parts(ast.parse(source).body)
    texts = [_text(part, lines) for part in parts]
    scopes = [symtable.symtable(text, "", "exec") for text in texts]
    wanted, found, before = {name}, set[int](), -1
    while before < len(found):
        before = len(found)
        found = {k for k, scope in enumerate(scopes) if not wanted.isdisjoint(_own_names(scope))}
        wanted.update(*(_outside_names(scopes[k]) for k in found))
        wanted.difference_update(given)
    return [texts[k] for k in sorted(found)]


def _parts(body: list[ast.stmt]) -> list[list[ast.stmt]]:
    """Statements one by one, except that those on the same line stay together."""
    parts: list[list[ast.stmt]] = []
    for statement in body:
        if parts and statement.lineno <= (parts[-1][-1].end_lineno or 0):
            parts[-1].append(statement)
        else:
            parts.append([statement])
    return parts


def _text(part: list[ast.stmt], lines: list[str]) -> str:
    """Statements as they are written, with their decorators."""
    first = min(x.lineno for x in [part[0], *getattr(part[0], "decorator_list", ())])
    return "\n".join(lines[first - 1 : part[-1].end_lineno])


def _definition(part: list[ast.stmt], lines: list[str]) -> dict[str, Any]:
    """What a statement at a cell's top level defines, and on what it depends.

    Returns:
        Names that it ``binds``; names that it takes from ``outside``; the dotted names that it
        ``uses``, and the ``attributes`` in it; questions that it ``asks`` `use` about; what the
        names that it imports ``mean``, with "*" for all of a module; and whether it is a ``stub``.
    """
    scope = symtable.symtable(_text(part, lines), "", "exec")
    binds, outside = _own_names(scope), set(_outside_names(scope))
    mean: dict[str, str] = {}
    chains, attributes, asks = set[str](), set[str](), set[str]()
    for node in _nodes(part):
        mean |= imported(node)
        if isinstance(node, ast.Name | ast.Attribute | ast.Call):
            chains.add(chain := dotted(node))
            attributes.update(chain.split(".")[1:] or [getattr(node, "attr", "")])
        if isinstance(node, ast.Call) and dotted(node) == "use" and node.args:
            asks.add(str(getattr(node.args[0], "value", "")))
    uses = {x for x in chains if (root := x.partition(".")[0]) in outside or root in mean}
    return {
        "binds": sorted(binds | (mean.keys() & {"*"})),
        "outside": sorted(outside),
        "uses": sorted(uses),
        "attributes": sorted(attributes - {""}),
        "asks": sorted(asks),
        "mean": mean,
        "stub": is_stub(part[0]),
    }


def _nodes(part: list[ast.stmt]) -> Iterator[ast.AST]:
    """All nodes of statements, except for the stand-ins that they pass to ``use``."""
    waiting: list[ast.AST] = [*part]
    while waiting:
        node = waiting.pop()
        yield node
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "use":
            waiting += [*node.args[:2], *node.args[3:]]
            waiting += [x.value for x in node.keywords if x.arg != "given"]
        else:
            waiting += ast.iter_child_nodes(node)


def _own_names(scope: symtable.SymbolTable) -> set[str]:
    """Names that a scope binds itself."""
    return {x.get_name() for x in scope.get_symbols() if x.is_assigned() or x.is_imported()}


def _outside_names(scope: symtable.SymbolTable) -> Iterator[str]:
    """Names that a scope takes from outside."""
    top = scope.get_type() == "module"
    own = _own_names(scope) if top else set()
    for symbol in scope.get_symbols():
        outside = symbol.is_referenced() and (top or symbol.is_global())
        if outside and symbol.get_name() not in own:
            yield symbol.get_name()
    for inner in scope.get_children():
        yield from (name for name in _outside_names(inner) if name not in own)


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def name_in_notebook(tool: str) -> str:
    """The name of a tool in a notebook, such as "lk.Circle"."""
    return f"lk.{tool.removeprefix('labkit.')}" if tool.startswith("labkit.") else tool


def withheld_tools(cells: Iterable[Analysis], name: str, tools: Sequence[str]) -> tuple[str, ...]:
    """The withheld tools that an answer uses.

    Args:
        cells: What `source.analyse` returned for each cell, in the order in which they run.
        name: The answer's name.
        tools: Dotted names of the withheld tools, such as "labkit.Circle" or "pinocchio".

    Returns:
        Those that are used, in the order given.  A method such as "labkit.Model.gravity" is used
        where an attribute has its name.
    """
    parts = [part for cell in cells for part in cell["definitions"]] if tools else []
    means = {key: full for part in parts for key, full in part["mean"].items()}
    mine: Mapping[str, Any] = {"uses": (), "attributes": (), "mean": {}}
    for part in parts:
        if name in part["binds"] and not (part["stub"] and mine["uses"]):
            mine = part
    used = [*_full_names(mine["uses"], means | mine["mean"])]
    return tuple(tool for tool in tools if _is_used(tool, used, mine["attributes"]))


def _full_names(chains: Iterable[str], means: Mapping[str, str]) -> Iterator[set[str]]:
    """The parts of each dotted name, whose first part is replaced by what was imported as it."""
    for chain in chains:
        root, *rest = chain.split(".")
        star = means.get("*", "").replace("*", root)
        yield {*means.get(root, star).split("."), *rest}


def _is_used(tool: str, used: Iterable[set[str]], attributes: Iterable[str]) -> bool:
    """Whether a tool is meant by its own name or by that of the module that defines it."""
    first, *rest = tool.split(".")
    if rest[1:] and rest[0][0].isupper():  # a function of the library may share a method's name
        functions = (p for p in used if {first, rest[-1]} <= p and rest[0] not in p)
        return rest[-1] in attributes and not any(functions)
    return any({first, *rest[-1:]} <= parts for parts in used)
