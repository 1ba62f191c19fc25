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
_TURNED = {
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
    """All mistakes that fit the functions of a cell, sorted by line.

    Args:
        source: The cell's text; one that Python cannot read has no functions.
    """
    found: dict[tuple[int, str], Edit] = {}
    try:
        cell, functions = _parsed(source)
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


def shown(source: str) -> list[str]:
    """The lines of a cell's functions, as a defence shows them."""
    try:
        return _written(_parsed(source)[1])
    except _UNREADABLE:
        return []


def _parsed(source: str) -> tuple[ast.Module, list[ast.FunctionDef]]:
    """A cell and its functions, without their docstrings."""
    cell = deepcopy(parsed(source)[1])
    functions = [x for x in cell.body if isinstance(x, ast.FunctionDef)]
    for function in functions:
        if ast.get_docstring(function, clean=False) is not None:
            function.body = function.body[1:] or [ast.Pass()]
    return cell, functions


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
        case ast.If(test=ast.Name()) | ast.IfExp(test=ast.Name()):
            yield _with(node, test=ast.UnaryOp(ast.Not(), node.test)), "a condition is reversed"
        case ast.UnaryOp(op=ast.Not()):
            yield node.operand, "a condition is reversed"
        case ast.UnaryOp(op=ast.USub()):
            yield node.operand, "a sign is left out"
        case ast.AugAssign(op=ast.Add() | ast.Sub()):
            yield _with(node, op=_TURNED[type(node.op)]()), "the sign of a term is reversed"
        case ast.Compare(ops=[op]) if type(op) in _TURNED:
            yield _with(node, ops=[_TURNED[type(op)]()]), "a comparison is reversed"
        case ast.BinOp():
            yield from _operator_mistakes(node)
        case ast.Attribute(attr="T"):
            yield node.value, "a transpose is left out"
        case ast.Attribute(attr=name) if name in EXCHANGED:
            yield _with(node, attr=EXCHANGED[name]), f"{EXCHANGED[name]} stands for {name}"
        case ast.Call(func=ast.Name(id=name)) if name in EXCHANGED:
            func = ast.Name(EXCHANGED[name])
            yield _with(node, func=func), f"{EXCHANGED[name]} stands for {name}"
        case ast.Subscript(slice=ast.Tuple(elts=parts) as indices):
            for k, part in enumerate(parts):
                for wrong, says in _index_mistakes(part):
                    elts = [*parts[:k], wrong, *parts[k + 1 :]]
                    yield _with(node, slice=_with(indices, elts=elts)), says
        case ast.Subscript():
            for wrong, says in _index_mistakes(node.slice):
                yield _with(node, slice=wrong), says


def _with(node: ast.AST, **fields: Any) -> Any:
    """A node with some fields changed."""
    new = copy(node)
    for name, value in fields.items():
        setattr(new, name, value)
    return new


def _operator_mistakes(node: ast.BinOp) -> Iterator[tuple[ast.AST, str]]:
    """Mistakes with an operator: a sign, an order, an operand that is left out."""
    left, right = node.left, node.right
    of_terms = isinstance(left, ast.BinOp) and isinstance(left.op, ast.Add | ast.Sub)
    match node.op:
        case ast.Add() | ast.Sub() if of_terms or isinstance(node.op, ast.Add):
            yield _with(node, op=_TURNED[type(node.op)]()), "the sign of a term is reversed"
            yield left, "a term is left out"
            if not of_terms:
                yield right, "a term is left out"
        case ast.Sub():
            yield _with(node, left=right, right=left), "a difference is reversed"
            yield ast.UnaryOp(ast.USub(), right), "a term is left out"
        case ast.Mult():
            yield right, "a factor is left out"
        case ast.MatMult():
            yield right, "a matrix is left out"
        case ast.Div():
            yield left, "a divisor is left out"
        case ast.Pow():
            yield left, "an exponent is left out"


def _index_mistakes(part: ast.expr) -> Iterator[tuple[ast.expr, str]]:
    """Mistakes with an index: the last element, or the other part of a vector."""
    match part:
        case ast.Constant(value=int()) if not isinstance(part.value, bool):
            yield ast.Constant(-1), "the last one is taken (index -1)"
        case ast.Slice(lower=None, upper=ast.Constant(), step=None):
            yield ast.Slice(part.upper), "the other part of a vector is taken"
        case ast.Slice(lower=ast.Constant(), upper=None, step=None):
            yield ast.Slice(None, part.lower), "the other part of a vector is taken"
