"""Stand-ins: what a notebook falls back to where an answer is missing, read from its source.

The notebook says `use(question, answer, stand_in)`.  Of all that stands before it only what the
stand-in needs is run, so no arm moves and no figure is drawn; the other answers are right there.
"""

from __future__ import annotations

import ast
import dis
from collections.abc import Callable, Iterator, Sequence
from types import CodeType
from typing import Any

from .notebook import Notebook
from .source import names_defined

USE = "def use(name, function, given, yours=None):\n    return yours or function\n"
"""Takes the place of the notebook's, since the other parts are right."""


def stand_ins(source: Notebook) -> dict[str, str]:
    """The stand-in of each question that has one, as Python text that defines it by that name.

    Args:
        source: The notebook with its solution regions.
    """
    cells = (ast.parse(cell.source).body for cell in source.cells if cell.cell_type == "code")
    statements = [statement for body in cells for statement in body]
    found = {}
    for k, statement in enumerate(statements):
        for node in ast.walk(statement):
            match node:
                case ast.Call(ast.Name("use"), [ast.Constant(str() as name), _, given, *_]):
                    found[name] = _text(name, given, statements[:k])
    return found


def run(name: str, text: str) -> Callable[..., Any]:
    """The function of that name which a text defines."""
    names: dict[str, Any] = {"__name__": f"the stand-in of {name}"}
    exec(text, names)
    function: Callable[..., Any] = names[name]
    return function


def _text(name: str, given: ast.expr, before: Sequence[ast.stmt]) -> str:
    """The stand-in as a function of its own, after all that it needs from what stands before."""
    call = f"return ({ast.unparse(given)})(*args, **kwargs)"
    parts = [f"def {name}(*args, **kwargs):\n    {call}\n"]
    wanted = set(_needs(parts[0]))
    for statement in reversed(before):
        if not wanted.isdisjoint({*names_defined(statement)} - {"use"}):
            parts.append(ast.unparse(statement))
            wanted.update(_needs(parts[-1]))
    return "\n\n".join([USE, *reversed(parts)])


def _needs(text: str) -> Iterator[str]:
    """The names that a statement takes from outside, its functions' bodies included."""
    waiting = [compile(text, "", "exec")]
    while waiting:
        code = waiting.pop()
        waiting += [x for x in code.co_consts if isinstance(x, CodeType)]
        yield from (
            x.argval for x in dis.get_instructions(code) if x.opname in ("LOAD_GLOBAL", "LOAD_NAME")
        )
