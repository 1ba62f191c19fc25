"""Known mistakes as edits: one place of somebody's own function, changed as people get it wrong.

Only the text is looked at; nothing of it runs here.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

from ...course.source import plain

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
"""Names that are taken for one another, such as the two Jacobians, or sine and cosine."""
_SIGNS: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.MatMult: "@",
    ast.Pow: "**",
}
_TURNED = {"+": "-", "-": "+"}
_Piece = tuple[Any, str, str]
"""The node that is replaced, by which text, and which mistake that is."""


@dataclass(frozen=True)
class Edit:
    """One line of a cell with a mistake in it.

    Attributes:
        line: Its number in the cell, from 1.
        was: The line as it was handed in.
        now: The line with the mistake.
        says: Which mistake it is, in a few words.
    """

    line: int
    was: str
    now: str
    says: str

    def put_into(self, source: str) -> str:
        """The cell with the mistake in it."""
        lines = plain(source).split("\n")
        lines[self.line - 1] = self.now
        return "\n".join(lines)


def edits(source: str) -> list[Edit]:
    """All mistakes that fit into the functions of a cell, in order of their place.

    Args:
        source: The cell's text; one that is not Python has no functions.
    """
    lines = plain(source).split("\n")
    found: dict[tuple[int, str], Edit] = {}
    for function in _functions(source):
        for node in chain.from_iterable(map(ast.walk, function.body)):
            for piece, now, says in _mistakes(node, lines):
                edit = _edit(piece, now, says, lines)
                if edit and edit.now != edit.was and _is_python(edit.put_into(source)):
                    found.setdefault((edit.line, edit.now), edit)
    return sorted(found.values(), key=lambda edit: (edit.line, edit.now))


def shown(source: str) -> list[int]:
    """The lines of a cell's functions without their docstrings, numbers from 1."""
    numbers: list[int] = []
    for function in _functions(source):
        first = min([function.lineno, *(x.lineno for x in function.decorator_list)])
        left_out: range = range(0)
        if ast.get_docstring(function, clean=False) is not None:
            text = function.body[0]
            left_out = range(text.lineno, (text.end_lineno or text.lineno) + 1)
        whole = range(first, (function.end_lineno or first) + 1)
        numbers += [k for k in whole if k not in left_out]
    return numbers


def _functions(source: str) -> list[ast.FunctionDef]:
    try:
        body = ast.parse(plain(source)).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    return [x for x in body if isinstance(x, ast.FunctionDef)]


def _is_python(source: str) -> bool:
    try:
        ast.parse(source)
    except SyntaxError:
        return False
    return True


def _edit(node: Any, now: str, says: str, lines: list[str]) -> Edit | None:
    """A line in which a node's text is another one; None if the node has several lines."""
    if node.lineno != node.end_lineno:
        return None
    was = lines[node.lineno - 1]
    data = was.encode()
    text = data[: node.col_offset] + now.encode() + data[node.end_col_offset :]
    return Edit(node.lineno, was, text.decode(), says)


def _mistakes(node: Any, lines: list[str]) -> Iterator[_Piece]:
    """The mistakes that fit into one place, each as what is written there instead."""

    def text(node: Any) -> str:
        line = lines[node.lineno - 1].encode()
        return bytes(line[node.col_offset : node.end_col_offset]).decode()

    if isinstance(node, ast.If | ast.IfExp) and isinstance(node.test, ast.Name):
        yield node.test, f"not {node.test.id}", "a condition is reversed"
    if getattr(node, "lineno", None) is None or node.lineno != node.end_lineno:
        return
    match node:
        case ast.BinOp(op=op) if type(op) in _SIGNS:
            yield from _of_two(node, _SIGNS[type(op)], *_sides(node, text(node)))
        case ast.AugAssign(op=ast.Add() | ast.Sub()):
            sign = _SIGNS[type(node.op)]
            now = text(node).replace(f"{sign}=", f"{_TURNED[sign]}=", 1)
            yield node, now, "the sign of a term is reversed"
        case ast.UnaryOp(op=ast.Not()):
            yield node, text(node.operand), "a condition is reversed"
        case ast.UnaryOp(op=ast.USub()):
            yield node, text(node)[1:].lstrip(), "a sign is left out"
        case ast.Attribute(attr="T"):
            yield node, text(node)[: -len(".T")], "a transpose is left out"
        case ast.Attribute(attr=name) if name in EXCHANGED:
            now = text(node).removesuffix(name) + EXCHANGED[name]
            yield node, now, f"{EXCHANGED[name]} stands for {name}"
        case ast.Call(func=ast.Name(id=name)) if name in EXCHANGED:
            yield node.func, EXCHANGED[name], f"{EXCHANGED[name]} stands for {name}"
        case ast.Subscript():
            parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            for part in parts:
                yield from _of_index(part, text)


def _sides(node: ast.BinOp, whole: str) -> tuple[str, str]:
    """The texts on both sides of an operator, with the brackets around them."""
    data = whole.encode()
    end = (node.left.end_col_offset or 0) - node.col_offset
    begin = node.right.col_offset - node.col_offset
    before, _, after = data[end:begin].decode().partition(_SIGNS[type(node.op)])
    left, right = data[:end].decode() + before, after + data[begin:].decode()
    return left.rstrip(), right.lstrip()


def _of_two(node: ast.BinOp, sign: str, left: str, right: str) -> Iterator[_Piece]:
    """The mistakes with an operator: a sign, an order, a side that is left out."""
    of_terms = isinstance(node.left, ast.BinOp) and isinstance(node.left.op, ast.Add | ast.Sub)
    match sign:
        case "+" | "-" if of_terms or sign == "+":
            yield node, f"{left} {_TURNED[sign]} {right}", "the sign of a term is reversed"
            yield node, left, "a term is left out"
            if not of_terms:
                yield node, right, "a term is left out"
        case "-":
            yield node, f"{right} - {left}", "a difference is reversed"
            yield node, f"-{right}", "a term is left out"
        case "*" | "@":
            yield node, right, f"a {'factor' if sign == '*' else 'matrix'} is left out"
        case "/" | "**":
            yield node, left, f"{'a divisor' if sign == '/' else 'an exponent'} is left out"


def _of_index(part: Any, text: Any) -> Iterator[_Piece]:
    """The mistakes with an index: the last one, or the other half of a vector."""
    match part:
        case ast.Constant(value=int()) if not isinstance(part.value, bool):
            yield part, "-1", "the last one is taken (index -1)"
        case ast.Slice(lower=None, upper=ast.Constant(), step=None):
            yield part, f"{text(part.upper)}:", "the other part of a vector is taken"
        case ast.Slice(lower=ast.Constant(), upper=None, step=None):
            yield part, f":{text(part.lower)}", "the other part of a vector is taken"
