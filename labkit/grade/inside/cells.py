"""Read a notebook that somebody else wrote: its sources, and what each cell defines and uses.

Outputs are dropped unread, so a notebook full of pictures is as welcome as any.
"""

from __future__ import annotations

import ast
import json
import symtable
import warnings
from collections.abc import Iterator
from typing import Any

MOST_CELLS = 1000
MOST_SOURCE = 2_000_000  # characters, in all cells together


class Rejected(Exception):
    """The file is no notebook that can be graded; the message says why, in one sentence."""


def read(data: bytes) -> dict[str, Any]:
    """The cells of a notebook, or why there are none.

    Args:
        data: The file.

    Returns:
        ``{"cells": [...]}``, or ``{"rejected": sentence}``.  Each cell has ``id``, ``grade_id``,
        ``type``, ``source``, and for code what `look` finds.
    """
    try:
        return {"cells": list(_cells(_notebook(data)))}
    except Rejected as why:
        return {"rejected": str(why)}


def look(source: str) -> dict[str, Any]:
    """What a code cell does with names, without running it.

    Args:
        source: Python as a notebook understands it.

    Returns:
        ``functions`` and ``binds`` that it defines at its top level, names that it ``uses``,
        functions that are still ``stubs``, and why it is ``broken``, empty if it is not.
    """
    found: dict[str, Any] = {"functions": [], "binds": [], "uses": [], "stubs": [], "broken": ""}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(plain(source))
            functions = [x for x in tree.body if isinstance(x, ast.FunctionDef | ast.ClassDef)]
            found["functions"] = [x.name for x in functions]
            found["stubs"] = [x.name for x in functions if _is_stub(x)]
            found["binds"] = sorted(set(_bound(tree.body)))
            found["uses"] = sorted(_needed(symtable.symtable(plain(source), "cell", "exec")))
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        found["broken"] = f"{type(error).__name__}: {error}"[:200]
    return found


def plain(source: str) -> str:
    """A cell as plain Python: a notebook's own ``%`` and ``!`` lines become calls."""
    if not any(line.lstrip()[:1] in {"%", "!", "?"} or "?" in line for line in source.split("\n")):
        return source
    from IPython.core.inputtransformer2 import TransformerManager

    text: str = TransformerManager().transform_cell(source)
    return text


def _notebook(data: bytes) -> dict[str, Any]:
    if not data.strip():
        raise Rejected("the file is empty")
    try:
        notebook = json.loads(data)
    except (ValueError, RecursionError) as error:
        what = "nested too deeply" if isinstance(error, RecursionError) else f"broken: {error}"
        raise Rejected(f"the file is not a notebook; its JSON is {what}"[:200]) from None
    except MemoryError:
        raise Rejected("the file is too large to read") from None
    if not isinstance(notebook, dict) or not isinstance(notebook.get("cells"), list):
        raise Rejected("the file is not a notebook of format 4: it has no cells")
    if notebook.get("nbformat") != 4:
        raise Rejected(f"the notebook's format is {str(notebook.get('nbformat'))[:20]}, not 4")
    if len(notebook["cells"]) > MOST_CELLS:
        raise Rejected(f"{len(notebook['cells'])} cells are too many; the limit is {MOST_CELLS}")
    return notebook


def _cells(notebook: dict[str, Any]) -> Iterator[dict[str, Any]]:
    total = 0
    for cell in notebook["cells"]:
        if not isinstance(cell, dict):
            continue
        source = cell.get("source", "")
        if isinstance(source, list):
            source = "".join(x for x in source if isinstance(x, str))
        if not isinstance(source, str):
            source = ""
        total += len(source)
        if total > MOST_SOURCE:
            raise Rejected(f"the sources are over {MOST_SOURCE // 10**6} MB of text")
        kind = "code" if cell.get("cell_type") == "code" else "text"
        out = {
            "id": _text(cell.get("id")),
            "grade_id": _text(_within(_within(cell, "metadata"), "nbgrader").get("grade_id")),
            "type": kind,
            "source": source,
        }
        yield out | (look(source) if kind == "code" else {})


def _within(cell: Any, key: str) -> dict[str, Any]:
    inner = cell.get(key)
    return inner if isinstance(inner, dict) else {}


def _text(x: Any) -> str:
    return x[:100] if isinstance(x, str) else ""


def _is_stub(function: ast.AST) -> bool:
    """Whether a function does nothing but raise NotImplementedError."""
    if not isinstance(function, ast.FunctionDef):
        return False
    body = [x for x in function.body if not _is_text(x)]
    if len(body) != 1 or not isinstance(body[0], ast.Raise) or body[0].exc is None:
        return False
    raised = body[0].exc.func if isinstance(body[0].exc, ast.Call) else body[0].exc
    return isinstance(raised, ast.Name) and raised.id == "NotImplementedError"


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _bound(body: list[ast.stmt]) -> Iterator[str]:
    """Names that statements bind at their own level."""
    waiting: list[ast.AST] = list(body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
            continue
        if isinstance(node, ast.Lambda):
            continue
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield from (x.asname or x.name.partition(".")[0] for x in node.names)
        waiting += ast.iter_child_nodes(node)


def _needed(scope: symtable.SymbolTable) -> Iterator[str]:
    """Names that a cell takes from the cells before it."""
    top = scope.get_type() == "module"
    own = (
        {x.get_name() for x in scope.get_symbols() if x.is_assigned() or x.is_imported()}
        if top
        else set()
    )
    for symbol in scope.get_symbols():
        outside = symbol.is_referenced() and (top or symbol.is_global())
        if outside and symbol.get_name() not in own:
            yield symbol.get_name()
    for inner in scope.get_children():
        yield from (name for name in _needed(inner) if name not in own)
