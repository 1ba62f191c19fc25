"""The solved notebook, for after the deadline: the answers' own source where the stubs were."""

from __future__ import annotations

import ast
import copy
import inspect
import textwrap
from collections.abc import Mapping
from typing import Any

from ..errors import LabkitError
from .notebook import Notebook, grade_id, kind
from .problem import Problem
from .source import names_defined


def solution_notebook(source: Notebook, problems: Mapping[str, Problem]) -> Notebook:
    """The solved notebook: the answers' own source in place of the stubs, model texts for whys."""
    notebook = copy.deepcopy(source)
    for cell in notebook.cells:
        if kind(cell) == "answer" and grade_id(cell) in problems:
            cell.source = inlined(problems[grade_id(cell)])
        elif kind(cell) == "why":
            cell.source = "\n".join(cell.source.splitlines()[1:-1])
    return notebook


def inlined(problem: Problem) -> str:
    """The answer's source as a cell of its own, with the imports and helpers that it needs.

    Raises:
        LabkitError: The answer leans on something that cannot be copied.
    """
    function = inspect.unwrap(problem.answer)
    module = inspect.getmodule(function)
    assert module is not None
    source = inspect.getsource(module)
    tree = ast.parse(source)
    defined = {name: node for node in tree.body for name in names_defined(node)}
    wanted, parts = [function.__name__], []
    seen: set[str] = set()
    while wanted:
        name = wanted.pop(0)
        node = defined.get(name)
        if name in seen or node is None:
            continue
        seen.add(name)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("solutions"):
            raise LabkitError(f"the answer of {problem.name} imports {node.module}: keep it whole")
        parts.append(node)
        wanted += [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]
    ordered = sorted({id(node): node for node in parts}.values(), key=lambda node: node.lineno)
    imports = [ast.unparse(n) for n in ordered if isinstance(n, ast.Import | ast.ImportFrom)]
    lines = source.splitlines()
    bodies = [
        textwrap.dedent("\n".join(lines[_first_line(n) - 1 : n.end_lineno]))
        for n in ordered
        if not isinstance(n, ast.Import | ast.ImportFrom)
    ]
    return "\n\n\n".join(["\n".join(imports), *bodies] if imports else bodies)


def _first_line(node: Any) -> int:
    decorators = [d.lineno for d in getattr(node, "decorator_list", ())]
    return int(min([node.lineno, *decorators]))
