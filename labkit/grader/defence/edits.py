"""Edits that put a typical mistake into one place of a student's own function.

Functions are shown as Python writes them out, without docstrings and comments; so neither the
spacing nor a comment tells which line was changed.  Nothing of them runs here.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from copy import copy, deepcopy
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any

from ...course.source import parsed

EXCHANGED = {
    "acceleration": "velocity",
    "body_jacobian": "tip_jacobian",
    "cos": "sin",
    "max": "min",
    "maximum": "minimum",
    "min": "max",
    "minimum": "maximum",
    "sin": "cos",
    "tip_jacobian": "body_jacobian",
}
"""Names that students confuse, such as the two Jacobians, or sine and cosine."""
MOST = 300
"""The most mistakes that are tried in one cell; real functions have fewer."""
_TURNED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Lt: ast.Gt,
    ast.Gt: ast.Lt,
    ast.LtE: ast.GtE,
    ast.GtE: ast.LtE,
}
_UNREADABLE = SyntaxError, ValueError, RecursionError, MemoryError


@dataclass(frozen=True)
class Edit:
    """A cell with a mistake in one line of its functions.

    Attributes:
        cell: The cell with the mistake.
        lines: The lines of its functions, with the mistake.
        at: The number of the line with the mistake, from 1.
        was: The same line without the mistake.
        says: The mistake in a few words.
    """

    cell: str
    lines: tuple[str, ...]
    at: int
    was: str
    says: str

    @property
    def now(self) -> str:
        """The line with the mistake."""
        return self.lines[self.at - 1]


def edits(source: str) -> list[Edit]:
    """All mistakes that fit the functions of a cell, by line; none without Python."""
    found: dict[tuple[int, str], Edit] = {}
    try:
        cell = deepcopy(parsed(source)[1])
        functions = [x for x in cell.body if isinstance(x, ast.FunctionDef)]
        for function in functions:
            if ast.get_docstring(function, clean=False) is not None:
                function.body = function.body[1:] or [ast.Pass()]
        before = _written(functions)
        mistakes = ((*x, *wrong) for x in _places(functions) for wrong in _mistakes(x[0]))
        for node, put, wrong, says in islice(mistakes, MOST):
            put(wrong)
            lines = _written(functions)
            differ = [k for k, line in enumerate(lines) if before[k : k + 1] != [line]]
            if len(differ) == 1 and len(before) == len(lines):
                (k,) = differ
                edit = Edit(ast.unparse(cell), tuple(lines), k + 1, before[k], says)
                found.setdefault((k, lines[k]), edit)
            put(node)
    except _UNREADABLE:
        return []
    return [found[place] for place in sorted(found)]


def _written(functions: list[ast.FunctionDef]) -> list[str]:
    return [line for function in functions for line in ast.unparse(function).split("\n")]


def _places(functions: list[ast.FunctionDef]) -> Iterator[tuple[ast.AST, Callable[[Any], None]]]:
    """All nodes in the functions' bodies, each with a function that replaces it."""
    waiting: list[ast.AST] = [ast.Module(function.body, []) for function in functions]
    while waiting:
        parent = waiting.pop()
        for name, value in ast.iter_fields(parent):
            there = [(value, partial(setattr, parent, name))]
            if isinstance(value, list):
                there = [(part, partial(value.__setitem__, k)) for k, part in enumerate(value)]
            for node, put in there:
                if isinstance(node, ast.AST):
                    waiting.append(node)
                    yield node, put


def _mistakes(node: ast.AST) -> Iterator[tuple[ast.AST, str]]:
    """The mistakes that fit one node, each as the node that replaces it."""
    match node:
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand, "a sign, or a not, is left out"
        case ast.BinOp(op=ast.Add() | ast.Sub()) | ast.AugAssign(op=ast.Add() | ast.Sub()):
            yield _with(node, op=_TURNED[type(node.op)]()), "the sign of a term is reversed"
            if isinstance(node, ast.BinOp):
                yield node.left, "a term is left out"
        case ast.BinOp(op=ast.Mult() | ast.MatMult()):
            yield node.right, "a factor is left out"
        case ast.BinOp():
            yield node.left, "a divisor or an exponent is left out"
        case ast.Compare(ops=[op]) if type(op) in _TURNED:
            yield _with(node, ops=[_TURNED[type(op)]()]), "a comparison is reversed"
        case ast.Attribute(attr="T"):
            yield node.value, "a transpose is left out"
        case ast.Attribute(attr=name) if name in EXCHANGED:
            yield _with(node, attr=EXCHANGED[name]), f"{EXCHANGED[name]} stands for {name}"
        case ast.Name(id=name) if name in EXCHANGED:
            yield _with(node, id=EXCHANGED[name]), f"{EXCHANGED[name]} stands for {name}"
        case ast.Subscript(slice=ast.Constant(value=int())):
            yield _with(node, slice=ast.Constant(-1)), "the last one is taken (index -1)"
        case ast.Slice(lower=None, upper=ast.Constant(), step=None):
            yield ast.Slice(node.upper), "the other part of a vector is taken"


def _with(node: ast.AST, **fields: Any) -> Any:
    """A node with some fields changed."""
    new = copy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new
